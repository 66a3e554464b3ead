"""The contacts at one pose as the mechanics needs them: one row for each face that a point touches, with its wrenches.

A point that touches several faces of one box lies on an edge: going in means that every one of them goes in (2.4), so
one face that holds or leaves is enough. Such faces form a group, of which one is chosen at a time. Faces of different
boxes hold each on its own.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, row, vector_from
from cagepose.kernels.collision.contacts import face_normal, is_hidden, touches_face
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.native.kernel import kernel

SAME_NORMAL = 1e-9
"""Radians. Flush faces of two boxes give one contact."""

CONTACTS_PER_POINT = 12
"""Faces that a point may touch, taken over all points. More: the run stalls, by name."""


class ContactRow:
    """One contact, and what the solvers note beside it; a record.

    Attributes
    ----------
    point, box, axis
        Indices of the cage point, the box and the axis of the face.
    side
        +1 or -1: which of the two faces along the axis.
    gap
        Distance from the plane of the face, below zero inside, metres.
    group
        The first row of the same point and box; -1: flush faces of another box say all that this one does.
    chosen
        Whether this face counts: all but the other faces on an edge.
    has_carried
        In the first row of a group: whether its faces carried in a combination that has been asked.
    normal, arm
        Outward unit normal, and the point as seen from the centre of gravity, in the world.
    columns
        Scaled wrenches of a unit force along the normal and along two tangents. The contact pushes
        along their negative.
    forces
        What the contact carries along them.
    is_sticking, step_forces
        Of the step that is being made: whether the contact sticks, and what it carries on the way.
    slip, is_rejected
        Slip speed that its generators are charged for (5.7); whether its generator did not help.
    mode, first_unknown, kept_forces
        What the contact does, its place in the system of Newton's method, and its forces before.
    best_chosen, best_forces
        Of the best combination of faces so far.
    is_equality, is_shared
        Whether it may carry in some balance, so that it can never open without work; whether its normal force could be
        another.
    """

    point: int
    box: int
    axis: int
    side: float
    gap: float
    group: int
    chosen: bool
    has_carried: bool
    normal: Annotated[FloatArray, 3]
    arm: Annotated[FloatArray, 3]
    columns: Annotated[FloatArray, 3, 6]
    forces: Annotated[FloatArray, 3]
    is_sticking: bool
    step_forces: Annotated[FloatArray, 3]
    slip: float
    is_rejected: bool
    mode: int
    first_unknown: int
    kept_forces: Annotated[FloatArray, 3]
    best_chosen: bool
    best_forces: Annotated[FloatArray, 3]
    is_equality: bool
    is_shared: bool


class ContactSet(NamedTuple):
    """The contacts at one pose: ``rows`` 0 to used - 1; ``used`` is (1,)."""

    used: IntArray
    rows: Rows[ContactRow]


def empty_contact_set(n_rows: int) -> ContactSet:
    """Return room for ``n_rows`` contacts (plain Python)."""
    return ContactSet(np.zeros(1, np.int64), empty_rows(ContactRow, n_rows))


@kernel
def face_is_listed(contacts: ContactSet, first: int, point: int, normal: Vector) -> bool:
    """Whether a row before ``first`` holds the same point with the same normal: the flush face of another box."""
    for i in range(first - 1, -1, -1):
        if contacts.rows[i].point != point:
            return False
        if norm(minus(vector_from(contacts.rows[i].normal), normal)) <= SAME_NORMAL:
            return True
    return False


@kernel
def append_contact(
    contacts: ContactSet, placement: Placement, point: int, box: int, axis: int, side: float, arm: Vector, frame: Frame
) -> None:
    contact = contacts.rows[contacts.used[0]]
    contact.point, contact.box, contact.axis, contact.side = point, box, axis, side
    normal = face_normal(placement, box, axis, side)
    for k in range(3):
        contact.normal[k] = normal[k]
        contact.arm[k] = arm[k]
    for j in range(3):
        direction = normal if j == 0 else face_normal(placement, box, (axis + j) % 3, 1.0)
        write_scaled_wrench(direction, cross(arm, direction), frame, contact.columns[j])
    contacts.used[0] += 1


@kernel
def find_contacts(
    geometry: Geometry, placement: Placement, center: Vector, frame: Frame, touch_m: float, contacts: ContactSet
) -> bool:
    """Fill ``contacts`` at a pose; False: there are more than it has room for."""
    contacts.used[0] = 0
    for point in range(len(geometry.points_world)):
        if placement.depths[point] < -touch_m:
            continue
        arm = minus(row(geometry.points_world, point), center)
        for box in range(geometry.n_own_boxes):
            half_size = row(geometry.half_sizes, box)
            point_box = box_point(placement, box, point)
            if placement.gaps[box, point] > touch_m:
                continue
            first = contacts.used[0]
            n_new = 0
            for axis in range(3):
                if not touches_face(point_box, half_size, axis, touch_m):
                    continue
                side = math.copysign(1.0, point_box[axis])
                if is_hidden(geometry, placement, box, point, axis, touch_m):
                    continue
                if contacts.used[0] == len(contacts.rows):
                    return False
                if not face_is_listed(contacts, first, point, face_normal(placement, box, axis, side)):
                    n_new += 1
                contact = contacts.rows[contacts.used[0]]
                contact.gap = abs(point_box[axis]) - half_size[axis]
                contact.group = first
                contact.chosen = contacts.used[0] == first
                contact.has_carried = False
                append_contact(contacts, placement, point, box, axis, side, arm, frame)
            if n_new == 0:
                for i in range(first, contacts.used[0]):
                    contacts.rows[i].group, contacts.rows[i].chosen = -1, False
    return True


@kernel
def last_of_group(contacts: ContactSet, first: int) -> int:
    last = first
    while last + 1 < contacts.used[0] and contacts.rows[last + 1].group == first:
        last += 1
    return last


@kernel
def choose_first_faces(contacts: ContactSet) -> None:
    """Choose the faces that `find_contacts` has chosen."""
    for i in range(contacts.used[0]):
        contacts.rows[i].chosen = contacts.rows[i].group == i
        contacts.rows[i].has_carried = False


@kernel
def keep_faces(contacts: ContactSet) -> None:
    """Note the faces that are chosen, with their forces, as the best combination so far."""
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        contact.best_chosen = contact.chosen
        for j in range(3):
            contact.best_forces[j] = contact.forces[j]


@kernel
def put_best_faces_back(contacts: ContactSet) -> None:
    """Choose the faces of the best combination again, with their forces."""
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        contact.chosen = contact.best_chosen
        for j in range(3):
            contact.forces[j] = contact.best_forces[j]


@kernel
def has_one_choice(contacts: ContactSet) -> bool:
    """Whether there is no edge, so that all faces count."""
    n_unchosen = 0
    for i in range(contacts.used[0]):
        if contacts.rows[i].group >= 0 and not contacts.rows[i].chosen:
            n_unchosen += 1
    return bool(n_unchosen == 0)


@kernel
def choose_next_faces(contacts: ContactSet, every: bool) -> bool:
    """Choose the next combination of faces on edges; False: there is none, and the first is chosen again.

    Unless ``every`` one is wanted, those are left out whose answer is known: where no face of a group carried, another
    face of it would not either, and the same forces balance the load (or leave the same motion).
    """
    rows = contacts.rows
    for first in range(contacts.used[0]):
        if rows[first].group != first:
            continue
        last = last_of_group(contacts, first)
        for i in range(first, last + 1):
            if rows[i].chosen and rows[i].forces[0] > 0.0:
                rows[first].has_carried = True
    for first in range(contacts.used[0]):
        if rows[first].group != first:
            continue
        last = last_of_group(contacts, first)
        if every or rows[first].has_carried:
            for i in range(first, last):
                if rows[i].chosen:
                    rows[i].chosen = False
                    rows[i + 1].chosen = True
                    return True
        for i in range(first, last + 1):
            rows[i].chosen = i == first
        rows[first].has_carried = False
    return False
