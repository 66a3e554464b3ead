"""Where a sliding contact runs over the edge of its face: the point's other two coordinates on the screw (2.3)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import Motion, motion_of
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, row, scaled, vector_from
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point, point_in_box, vector_in_box
from cagepose.kernels.collision.screw import next_below
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet
from cagepose.kernels.contact.on_rim import is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.straying import STRAYED, strayed
from cagepose.kernels.shapes.along_motion import place_moved
from cagepose.kernels.shapes.flat_rims import SAME_WAY
from cagepose.kernels.shapes.meeting import both_reach, meeting, twin_pair
from cagepose.kernels.shapes.meetings import slack_of

CLEAR = 2.0
"""In touch tolerances: how far beyond the edge a contact is let go, so that it does not touch the next face too."""
MERGED = 0.99995
"""Cosine between the normals of a contact and of another one on the same arc that takes its place as the two come
together: neither is at an edge.
"""
HALVINGS = 50
"""A motion is halved so many times to find where a contact of two shapes ends."""


@kernel
def travel_to_edge(coordinate: float, rate: float, limit: float) -> float:
    """Return when a coordinate that grows by ``rate`` leaves [-limit, limit]."""
    if rate == 0.0:
        return math.inf
    return max(0.0, (math.copysign(limit, rate) - coordinate) / rate)


@kernel
def still_meet(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    contact: ContactRow,
    motion: Motion,
    amount: float,
    touch_m: float,
    within_m: float,
) -> bool:
    """Whether two features still reach where they meet, after an amount of a motion, by so much within their ends.

    Those that do with quite another normal have come apart: an edge and the rim that lay across it.
    """
    held, cage, moved = placement.body.world, geometry.cage, placement.moved
    one, other = contact.feature, contact.cage_feature
    place_moved(held, one, motion, amount, moved)
    met, twins, normal = meeting(moved, one, cage, other), twin_pair(moved, one, cage, other), contact.directions[0]
    if not met.is_one and twins[0] >= 0:
        one, other = twins  # where the first of two places on an arc has left it, the second one is the first
        place_moved(held, one, motion, amount, moved)
        met = meeting(moved, one, cage, other)
        if is_listed(contacts, one, other) and dot(met.normal, vector_from(normal)) < MERGED:
            return False
    if dot(met.normal, vector_from(normal)) < SAME_WAY:
        return False
    least = min(held.parts[contact.box].least_length, cage.parts[contact.point].least_length)
    slack = CLEAR * slack_of(held, contact.box, cage, contact.point, touch_m) - within_m / least
    slack_m = 2.0 * CLEAR * touch_m - within_m
    return both_reach(moved, one, cage, other, met, slack, slack_m)


@kernel
def is_listed(contacts: ContactSet, feature: int, cage_feature: int) -> bool:
    """Whether there is a contact of two features."""
    found = False
    for i in range(contacts.used[0]):
        row = contacts.rows[i]
        found = found or (row.feature == feature and row.cage_feature == cage_feature)
    return found


@kernel
def end_of_meeting(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    contact: ContactRow,
    motion: Motion,
    end: float,
    touch_m: float,
) -> float:
    """Return the amount of a motion, up to ``end``, after which a contact runs over the end of one of its features;
    inf: it does not.
    """
    if end == math.inf:
        held, cage = placement.body.world.parts[contact.box], geometry.cage.parts[contact.point]
        end = 2.0 * (held.reach + cage.reach + touch_m) / norm(motion.velocity)
    if still_meet(geometry, placement, contacts, contact, motion, end, touch_m, 0.0):
        return math.inf
    low, high = 0.0, end
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if still_meet(geometry, placement, contacts, contact, motion, middle, touch_m, 0.0):
            low = middle
        else:
            high = middle
    return high


@kernel
def first_edge_crossing(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    center: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    end: float,
    touch_m: float,
) -> float:
    """Return the amount of a twist, up to ``end``, after which a contact leaves the face that it stays on; inf: none.

    Where it would only because contacts stray, by the square of the way, it is passed over: they are put back. So it is
    where one of them has no place there any more: it may have one when it is put back.
    """
    first = math.inf
    rate = norm(spin)
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if not is_kept(contacts, i):
            continue
        if contact.feature >= 0:
            motion = motion_of(center, velocity, spin)
            crossing = end_of_meeting(geometry, placement, contacts, contact, motion, min(end, first), touch_m)
            if crossing < first:
                reach = STRAYED * strayed(
                    geometry, contacts, center, quaternion, velocity, spin, crossing, math.inf, placement.moved
                )
                if still_meet(geometry, placement, contacts, contact, motion, 0.0, touch_m, reach):
                    first = crossing
            continue
        box = contact.box
        half_size = row(geometry.half_sizes, box)
        point_box = box_point(placement, box, contact.point)
        spin_box = vector_in_box(placement, box, spin)
        arm = minus(point_box, point_in_box(placement, box, center))
        moves = plus(vector_in_box(placement, box, velocity), cross(spin_box, arm))
        for k in range(3):
            if k == contact.axis:
                continue
            limit = half_size[k] + CLEAR * touch_m
            if rate == 0.0:
                first = min(first, travel_to_edge(point_box[k], -moves[k], limit))
                continue
            axis = scaled(spin_box, 1.0 / rate)
            per_radian = scaled(moves, 1.0 / rate)
            rise = scaled(axis, dot(axis, per_radian))
            across = minus(per_radian, rise)
            lever = cross(across, axis)
            for side in (1.0, -1.0):
                wave = (limit - side * point_box[k], -side * lever[k], side * across[k], side * rise[k])
                crossing = next_below(wave, 0.0, end * rate) / rate
                if crossing < first and crossing <= end:
                    reach = STRAYED * strayed(
                        geometry, contacts, center, quaternion, velocity, spin, crossing, math.inf, placement.moved
                    )
                    if wave[0] > reach:
                        first = crossing
    return first if first <= end else math.inf
