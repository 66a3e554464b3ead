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
from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, row, scaled, vector_from
from cagepose.kernels.collision.contacts import face_normal, is_hidden, touches_face
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point
from cagepose.kernels.contact.friction import Friction, friction_share
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.native.kernel import kernel

SAME_NORMAL = 1e-9
"""Radians. Flush faces of two boxes give one contact."""

CONTACTS_PER_POINT = 12
"""Faces that a point may touch, taken over all points. More: the run stalls, by name."""


class ContactRow:
    """The geometry of one contact; a record.

    Attributes
    ----------
    point, box, axis
        Indices of the cage point, the box and the axis of the face.
    side
        +1 or -1: which of the two faces along the axis.
    gap
        Distance from the plane of the face, below zero inside, metres.
    group
        The first row of the same point and box; -1: the row does not count, as flush faces of another box say all
        that it does.
    directions, arm
        Outward unit normal and two tangents, rows, and the point as seen from the centre of gravity, in the world. The
        tangents are as long as the contact's coefficient of friction is of the greatest one, so that one coefficient
        does for all contacts: with tangential forces and slip in this unit Coulomb's law reads the same.
    columns
        Scaled wrenches of a force along these directions. The contact pushes along their negative. What contacts
        without play lock is taken out of them, see `self_stress`.
    """

    point: int
    box: int
    axis: int
    side: float
    gap: float
    group: int
    directions: Annotated[FloatArray, 3, 3]
    arm: Annotated[FloatArray, 3]
    columns: Annotated[FloatArray, 3, 6]


class ContactState:
    """What one contact does in the problem that is being solved; a record.

    Attributes
    ----------
    chosen
        Whether it is the face that is asked of its group: all are but the other faces on an edge.
    counts
        Whether it takes part in the problem: chosen, and not left out of it because of what others lock.
    forces
        What the contact carries along its columns.
    is_sticking
        Whether it carries and does not slip.
    is_locked
        Whether its gap stays as it is because contacts without play press against each other, see `self_stress`.
    slip_speed, is_rejected
        Of the problem with round cones: De Saxce's correction (5.7), and whether its generator did not help.
    has_carried
        In the first row of a group: whether one of its faces carried, or was locked, in a choice that has been asked.
    kept_chosen, kept_forces
        Of the choice of faces that is kept.
    """

    chosen: bool
    counts: bool
    forces: Annotated[FloatArray, 3]
    is_sticking: bool
    is_locked: bool
    slip_speed: float
    is_rejected: bool
    has_carried: bool
    kept_chosen: bool
    kept_forces: Annotated[FloatArray, 3]


class ContactSet(NamedTuple):
    """The contacts at one pose, 0 to used - 1 (``used`` is (1,)): their geometry, and what they do."""

    used: IntArray
    rows: Rows[ContactRow]
    states: Rows[ContactState]


def empty_contact_set(n_rows: int) -> ContactSet:
    """Return a set with memory for ``n_rows`` contacts (plain Python)."""
    return ContactSet(np.zeros(1, np.int64), empty_rows(ContactRow, n_rows), empty_rows(ContactState, n_rows))


@kernel
def is_smooth(contact: ContactRow) -> bool:
    """Whether a contact has no friction, though others may have."""
    greatest = 0.0
    for k in range(6):
        greatest = max(greatest, abs(contact.columns[1, k]), abs(contact.columns[2, k]))
    return greatest == 0.0


@kernel
def stays_on_face(contacts: ContactSet, i: int) -> bool:
    """Whether a contact keeps its gap in a motion that begins: it carries, or is locked."""
    return contacts.states[i].forces[0] > 0.0 or contacts.states[i].is_locked


@kernel
def choose(contacts: ContactSet, i: int, chosen: bool) -> None:
    """Choose a face, or not: it counts if it is chosen."""
    contacts.states[i].chosen = contacts.states[i].counts = chosen


@kernel
def face_is_listed(contacts: ContactSet, first: int, point: int, normal: Vector) -> bool:
    """Whether a row before ``first`` holds the same point with the same normal: the flush face of another box."""
    for i in range(first - 1, -1, -1):
        if contacts.rows[i].point != point:
            return False
        if norm(minus(vector_from(contacts.rows[i].directions[0]), normal)) <= SAME_NORMAL:
            return True
    return False


@kernel
def append_contact(
    contacts: ContactSet,
    placement: Placement,
    friction: Friction,
    point: int,
    box: int,
    axis: int,
    side: float,
    arm: Vector,
    frame: Frame,
) -> None:
    contact = contacts.rows[contacts.used[0]]
    share = friction_share(friction, point, box)
    contact.point, contact.box, contact.axis, contact.side = point, box, axis, side
    for k in range(3):
        contact.arm[k] = arm[k]
    for j in range(3):
        direction = scaled(face_normal(placement, box, (axis + j) % 3, 1.0), side if j == 0 else share)
        for k in range(3):
            contact.directions[j, k] = direction[k]
        write_scaled_wrench(direction, cross(arm, direction), frame, contact.columns[j])
    contacts.used[0] += 1


@kernel
def find_contacts(
    geometry: Geometry,
    placement: Placement,
    friction: Friction,
    center: Vector,
    frame: Frame,
    touch_m: float,
    contacts: ContactSet,
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
                choose(contacts, contacts.used[0], contacts.used[0] == first)
                append_contact(contacts, placement, friction, point, box, axis, side, arm, frame)
            if n_new == 0:
                for i in range(first, contacts.used[0]):
                    contacts.rows[i].group = -1
                    choose(contacts, i, False)
    return True
