"""The contacts at one pose, found: of points and boxes, and of shapes that touch."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, row, scaled, vector_from
from cagepose.kernels.boundary.bend import curvatures, write_bend, write_twin
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.on_circle import write_on_circle
from cagepose.kernels.boundary.touching import is_around
from cagepose.kernels.collision.contacts import face_normal, is_hidden, touches_face
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point, held_at, is_shaped
from cagepose.kernels.contact.contact_set import ContactSet, choose, write_directions
from cagepose.kernels.contact.friction import Friction, friction_share
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.contact.seats import seat_circles
from cagepose.kernels.contact.tolerances import SAME_NORMAL_RAD
from cagepose.kernels.native.kernel import kernel


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
    contact.angle = 0.0
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
    if is_shaped(geometry):
        return add_meetings(geometry, placement, friction, center, frame, contacts)
    return True


@kernel
def add_meetings(
    geometry: Geometry, placement: Placement, friction: Friction, center: Vector, frame: Frame, contacts: ContactSet
) -> bool:
    """Append the contacts of shapes, those of a group together; False: there are more than there is room for."""
    meetings = placement.meetings
    if meetings.used[0] < 0 or meetings.used[0] > len(contacts.rows):
        return False
    for at in range(meetings.used[0]):
        if meetings.rows[at].group != at:
            continue
        first = contacts.used[0]
        for other in range(at, meetings.used[0]):
            if meetings.rows[other].group == at:
                append_meeting(geometry, placement, friction, other, first, center, frame, contacts)
    seat_circles(geometry, contacts, frame)
    return True


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
    row, held, cage = placement.meetings.rows[at], held_at(geometry, placement), geometry.cage
    part, cage_part = held.own.features[row.feature].part, cage.own.features[row.cage_feature].part
    place = contacts.used[0]
    contact = contacts.rows[place]
    contact.point, contact.box, contact.axis, contact.side = cage_part, part, 0, 1.0
    contact.feature, contact.cage_feature, contact.angle = row.feature, row.cage_feature, row.angle
    contact.gap, contact.group, contact.is_added = row.gap, first, False
    choose(contacts, place, place == first)
    normal, arm = vector_from(row.normal), minus(vector_from(row.place), center)
    write_directions(contact, normal, arm, friction_share(friction, cage_part, part), frame)
    met = Meeting(True, row.gap, normal, vector_from(row.place))
    found = curvatures(held, row.feature, cage, row.cage_feature, met, is_around(row))
    write_bend(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    if row.twin >= 0:
        found = curvatures(held, row.twin, cage, row.cage_twin, met, False)
        write_twin(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    write_on_circle(held, row.feature, cage, row.cage_feature, row, center, contacts.bends[place].on_circle)
    contacts.used[0] += 1
