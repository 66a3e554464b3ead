"""The contacts at one pose, found: of points and boxes, and of shapes that touch."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, row, scaled, vector_from
from cagepose.kernels.collision.contacts import face_normal, is_hidden, touches_face
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point
from cagepose.kernels.contact.contact_set import ContactSet, choose, write_directions
from cagepose.kernels.contact.friction import Friction, friction_share
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.contact.seats import seat_rims
from cagepose.kernels.contact.tolerances import SAME_NORMAL_RAD
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.bend import curvatures, write_bend, write_twin
from cagepose.kernels.shapes.features import FACE, HOLE
from cagepose.kernels.shapes.flat_rims import write_on_rim
from cagepose.kernels.shapes.meeting import Meeting
from cagepose.kernels.shapes.touching import is_at_place


@kernel
def face_is_listed(contacts: ContactSet, first: int, point: int, normal: Vector) -> bool:
    """Whether a row before ``first`` holds the same point with the same normal: the flush face of another box."""
    for i in range(first - 1, -1, -1):
        if contacts.rows[i].point != point:
            return False
        if norm(minus(vector_from(contacts.rows[i].directions[0]), normal)) <= SAME_NORMAL_RAD:
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
            # each face of the box that the point touches is a choice of one group
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
            # flush faces that other boxes have listed say nothing new
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
    seat_rims(geometry, placement, contacts, frame)
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
