"""The contacts at one pose as the mechanics needs them: a row for each place where two parts touch, with its wrenches.

A point that touches several faces of one box lies on an edge: going in means that every one of them goes in (2.4), so
one face that holds or leaves is enough. Such faces form a group, of which one is chosen at a time. Faces of different
boxes hold each on its own. The same holds for sharp features of two shapes that meet at one place with several normals.
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
from cagepose.kernels.shapes.bend import Bend, curvatures, write_bend, write_twin
from cagepose.kernels.shapes.features import FACE, HOLE
from cagepose.kernels.shapes.flat_rims import write_on_rim
from cagepose.kernels.shapes.meeting import Meeting
from cagepose.kernels.shapes.touching import is_at_place, most_meetings

SAME_NORMAL = 1e-9
"""Radians. Flush faces of two boxes give one contact."""

CONTACTS_PER_POINT = 12
"""Faces that a point may touch, taken over all points. More: the run stalls, by name."""


class ContactRow:
    """The geometry of one contact; a record.

    Attributes
    ----------
    point, box
        Indices of the cage's point or shape, and of the object's box or shape.
    axis, side
        Of the box's face over a point: index of the axis, and +1 or -1.
    feature, cage_feature
        Of shapes that touch: indices of their features; -1: they are a point and a box.
    gap
        Distance, below zero: how deep, metres.
    group
        The first row of the same point and box; -1: the row does not count, as flush faces of another box say all
        that it does.
    is_added
        Whether it is a point of a flat rim that was not listed at first, see `on_rim`.
    directions, arm
        Outward unit normal and two tangents, rows, and the place as seen from the centre of gravity, in the world. The
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
    feature: int
    cage_feature: int
    gap: float
    group: int
    is_added: bool
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
    stays_flat
        Whether it is a listed point of a rim that lies flat, and the motion leaves it so, be it that others carry.
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
    stays_flat: bool
    slip_speed: float
    is_rejected: bool
    has_carried: bool
    kept_chosen: bool
    kept_forces: Annotated[FloatArray, 3]


class ContactSet(NamedTuple):
    """The contacts at one pose, 0 to used - 1 (``used`` is (1,)): their geometry, and what they do.

    ``bends`` are those of rows whose ``feature`` is not -1; there are none without shapes.
    """

    used: IntArray
    rows: Rows[ContactRow]
    states: Rows[ContactState]
    bends: Rows[Bend]


def empty_contact_set(n_rows: int, n_bends: int = 0) -> ContactSet:
    """Return a set with memory for ``n_rows`` contacts (plain Python)."""
    return ContactSet(
        np.zeros(1, np.int64),
        empty_rows(ContactRow, n_rows),
        empty_rows(ContactState, n_rows),
        empty_rows(Bend, n_bends),
    )


def most_contacts(geometry: Geometry) -> int:
    """Return how many contacts there may be at one pose (plain Python)."""
    return CONTACTS_PER_POINT * len(geometry.points_world) + most_meetings(
        len(geometry.held.parts), len(geometry.cage.parts)
    )


def contact_set_for(geometry: Geometry) -> ContactSet:
    """Return a set with memory for all contacts that there may be at one pose (plain Python)."""
    n_rows = most_contacts(geometry)
    return empty_contact_set(n_rows, n_rows if len(geometry.held.parts) > 0 else 0)


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
    contact.feature = contact.cage_feature = -1
    contact.is_added = False
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
    if len(geometry.held.parts) == 0:
        return True
    return add_meetings(geometry, placement, friction, center, frame, touch_m, contacts)


@kernel
def add_meetings(
    geometry: Geometry,
    placement: Placement,
    friction: Friction,
    center: Vector,
    frame: Frame,
    touch_m: float,
    contacts: ContactSet,
) -> bool:
    """Append the contacts of shapes; False: there are more than there is room for.

    Meetings of two parts at one place are a group: parts that are apart along any of the normals are apart. Not so at
    the bottom of a hole, where its wall and its floor are in the way.
    """
    meetings = placement.meetings
    if meetings.used[0] < 0 or contacts.used[0] + meetings.used[0] > len(contacts.rows):
        return False
    for at in range(meetings.used[0]):
        met = meetings.rows[at]
        if met.is_hidden or is_in_group(geometry, placement, at, touch_m):
            continue
        first = contacts.used[0]
        for other in range(at, meetings.used[0]):
            row = meetings.rows[other]
            if row.part != met.part or row.cage_part != met.cage_part:
                break
            if not row.is_hidden and are_grouped(geometry, placement, at, other, touch_m):
                append_meeting(geometry, placement, friction, other, first, center, frame, contacts)
    return True


@kernel
def are_grouped(geometry: Geometry, placement: Placement, one: int, other: int, touch_m: float) -> bool:
    """Whether two meetings of the same parts are a group."""
    if is_on_floor(geometry, placement, one) != is_on_floor(geometry, placement, other):
        return False
    return is_at_place(placement.meetings, one, other, touch_m)


@kernel
def is_on_floor(geometry: Geometry, placement: Placement, at: int) -> bool:
    """Whether a meeting is on the floor of a hole."""
    row, held, cage = placement.meetings.rows[at], placement.body.world, geometry.cage
    if held.parts[row.part].kind == HOLE:
        return held.features[row.feature].kind == FACE
    return cage.parts[row.cage_part].kind == HOLE and cage.features[row.cage_feature].kind == FACE


@kernel
def is_in_group(geometry: Geometry, placement: Placement, at: int, touch_m: float) -> bool:
    """Whether a meeting of the same parts before this one is of the same group."""
    rows = placement.meetings.rows
    for before in range(at - 1, -1, -1):
        if rows[before].part != rows[at].part or rows[before].cage_part != rows[at].cage_part:
            return False
        if not rows[before].is_hidden and are_grouped(geometry, placement, before, at, touch_m):
            return True
    return False


@kernel
def tangents_to(normal: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors across a unit normal and each other."""
    x, y, z = abs(normal[0]), abs(normal[1]), abs(normal[2])
    least = (
        1.0 if x <= y and x <= z else 0.0,
        1.0 if y < x and y <= z else 0.0,
        1.0 if z < x and z < y else 0.0,
    )
    one = cross(normal, least)
    one = scaled(one, 1.0 / norm(one))
    return one, cross(normal, one)


@kernel
def write_directions(contact: ContactRow, normal: Vector, arm: Vector, share: float, frame: Frame) -> None:
    """Write normal and tangents of a contact of shapes, and its wrenches; the tangents are ``share`` long."""
    one, other = tangents_to(normal)
    directions = (normal, scaled(one, share), scaled(other, share))
    for k in range(3):
        contact.arm[k] = arm[k]
    for j in range(3):
        for k in range(3):
            contact.directions[j, k] = directions[j][k]
        write_scaled_wrench(directions[j], cross(arm, directions[j]), frame, contact.columns[j])


@kernel
def append_meeting(
    geometry: Geometry,
    placement: Placement,
    friction: Friction,
    at: int,
    first: int,
    center: Vector,
    frame: Frame,
    contacts: ContactSet,
) -> None:
    """Append one contact of shapes to the group that begins with row ``first``."""
    met = placement.meetings.rows[at]
    place = contacts.used[0]
    contact = contacts.rows[place]
    contact.point, contact.box, contact.axis, contact.side = met.cage_part, met.part, 0, 1.0
    contact.feature, contact.cage_feature = met.feature, met.cage_feature
    contact.gap, contact.group, contact.is_added = met.gap, first, False
    choose(contacts, place, place == first)
    normal, arm = vector_from(met.normal), minus(vector_from(met.place), center)
    share = friction_share(friction, met.cage_part, met.part)
    write_directions(contact, normal, arm, share, frame)
    held, cage, meeting = placement.body.world, geometry.cage, Meeting(True, met.gap, normal, vector_from(met.place))
    found = curvatures(held, met.feature, cage, met.cage_feature, meeting)
    write_bend(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    on_rim = contacts.bends[place].on_rim
    write_on_rim(held, met.feature, cage, met.cage_feature, meeting, center, geometry.touch_m, on_rim)
    if met.twin >= 0:
        found = curvatures(held, met.twin, cage, met.cage_twin, meeting)
        write_twin(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    contacts.used[0] += 1
