"""After a step: contacts that carry are put on their faces, and what came into the object on the way is pushed out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.first_contact import allowed_depth
from cagepose.kernels.collision.first_meeting import are_convex
from cagepose.kernels.collision.geometry import Geometry, Placement, place_object
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet
from cagepose.kernels.contact.on_rim import is_along_wall, is_kept, is_of_same_rim
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.projection import (
    ALONG,
    FLAT,
    GAP,
    Constraints,
    add_constraint,
    constrain_features,
    drop_constraint,
    empty_constraints,
    has_slips,
    projected,
)
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.shapes.features import VERTEX, Feature, is_of_mouth
from cagepose.kernels.shapes.meeting import meeting
from cagepose.kernels.shapes.rims import EQUALLY_FAR
from cagepose.kernels.shapes.touching import most_meetings

POINTS_PUSHED = 8
"""Points and shapes that may be pushed out of the object after a step."""
NONE_DEEP, UNKNOWN_DEEP = -1, -2
"""Instead of a meeting that is too deep."""


class StepWorkspace(NamedTuple):
    """Workspace for one step: contacts to keep, and the depth allowed to each point, (n_points,), and to each pair of
    shapes, (n_parts, n_cage_parts), metres.
    """

    constraints: Constraints
    allowed: FloatArray
    allowed_shapes: FloatArray


def empty_step_workspace(geometry: Geometry) -> StepWorkspace:
    """Return a workspace for one step (plain Python)."""
    n_points, pairs = len(geometry.points_world), (len(geometry.held.parts), len(geometry.cage.parts))
    n_constraints = 3 * (n_points + most_meetings(*pairs)) + POINTS_PUSHED
    return StepWorkspace(empty_constraints(n_constraints), np.zeros(n_points), np.zeros(pairs))


@kernel
def shallowest_face(geometry: Geometry, placement: Placement, point: int, box: int) -> tuple[int, float]:
    """Return (axis, side) of the face of ``box`` that the point is nearest to from inside, or farthest beyond."""
    best_axis, best_gap = 0, -math.inf
    for axis in range(3):
        gap = abs(placement.points_box[box, axis, point]) - geometry.half_sizes[box, axis]
        if gap > best_gap:
            best_axis, best_gap = axis, gap
    return best_axis, math.copysign(1.0, placement.points_box[box, best_axis, point])


@kernel
def constrain_to_face(geometry: Geometry, placement: Placement, point: int, box: int, constraints: Constraints) -> bool:
    """Constrain a point to the face of a box that it has reached."""
    axis, side = shallowest_face(geometry, placement, point, box)
    return add_constraint(constraints, point, box, axis, side, geometry.half_sizes[box, axis])


@kernel
def kept_gap(geometry: Geometry, placement: Placement, contact: ContactRow, closed_m: float) -> float:
    """Return the gap that a contact of shapes keeps: see `constrain_contacts`.

    An arc of a mouth that lies flat is within the touch tolerance as its vertices are, with a gap of its own, which may
    be below zero: a point that was added on it has that of a vertex.
    """
    held, cage = placement.body.world, geometry.cage
    if is_of_mouth(held.features[contact.feature]) or is_of_mouth(cage.features[contact.cage_feature]):
        met = meeting(held, contact.feature, cage, contact.cage_feature)
        if met.is_one:
            return met.gap if abs(met.gap) > closed_m else 0.0
    return contact.gap if contact.gap > closed_m else 0.0


@kernel
def least_along_wall(contacts: ContactSet, i: int, closed_m: float) -> float:
    """Return the gap that a rim keeps from the wall that it lies along, see `constrain_contacts`: the least of its
    contacts, where it is on the wall as it would be anywhere else after a turn.
    """
    least = contacts.rows[i].gap
    for other in range(contacts.used[0]):
        if is_of_same_rim(contacts, i, other):
            least = min(least, contacts.rows[other].gap)
    return least if least > closed_m else 0.0


@kernel
def constrain_contacts(
    geometry: Geometry, placement: Placement, contacts: ContactSet, closed_m: float, constraints: Constraints
) -> None:
    """Constrain the contacts that stay on their faces, and where they stick also in the face.

    Gaps above ``closed_m`` are kept: to close them could take work, or bring another point in.
    """
    constraints.scratch[0].used = 0
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if not is_kept(contacts, i):
            continue
        if is_along_wall(contacts, i):
            kept = least_along_wall(contacts, i, closed_m)
            constrain_features(constraints, contact.feature, contact.cage_feature, FLAT, kept)
        elif contact.feature >= 0:
            which = FLAT if contacts.states[i].stays_flat else GAP
            kept = kept_gap(geometry, placement, contact, closed_m)
            constrain_features(constraints, contact.feature, contact.cage_feature, which, kept)
        else:
            at = geometry.half_sizes[contact.box, contact.axis]
            if contact.gap > closed_m:
                at += contact.gap
            add_constraint(constraints, contact.point, contact.box, contact.axis, contact.side, at)
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if contacts.states[i].forces[0] > 0.0 and contacts.states[i].is_sticking:
            for turn in range(1, 3):
                if contact.feature >= 0:
                    constrain_features(constraints, contact.feature, contact.cage_feature, turn, 0.0)
                    continue
                axis = (contact.axis + turn) % 3
                at = placement.points_box[contact.box, axis, contact.point]
                add_constraint(constraints, contact.point, contact.box, axis, 1.0, at)


@kernel
def deepest_offender(placement: Placement, allowed: FloatArray) -> int:
    """Return the point that is farthest deeper than it may; -1: none."""
    worst_point, worst = -1, 0.0
    for point in range(len(allowed)):
        excess = placement.depths[point] - allowed[point]
        if excess > worst:
            worst_point, worst = point, excess
    return worst_point


@kernel
def box_around(geometry: Geometry, placement: Placement, point: int) -> int:
    """Return the box that the point lies deepest in."""
    best_box, best_gap = 0, math.inf
    for box in range(len(geometry.half_sizes)):
        gap = placement.gaps[box, point]
        if gap < best_gap:
            best_box, best_gap = box, gap
    return best_box


@kernel
def put_back(
    setting: Setting, placement: Placement, position: Vector, quaternion: Quaternion, constraints: Constraints
) -> tuple[bool, Vector, Quaternion]:
    """Make all constraints hold, and if that cannot be let what sticks slip as little as closing the gaps needs."""
    geometry, body, size_m = setting.geometry, setting.body, setting.size_m
    done, end, turned = projected(geometry, body, position, quaternion, constraints, size_m, False, placement.moved)
    if done or not has_slips(constraints):
        return done, end, turned
    return projected(geometry, body, position, quaternion, constraints, size_m, True, placement.moved)


@kernel
def pushed_out(
    setting: Setting, placement: Placement, position: Vector, quaternion: Quaternion, work: StepWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Make all constraints hold, and push points out of the object that this has brought in; placement is filled."""
    geometry = setting.geometry
    holds = True
    for _ in range(POINTS_PUSHED):
        if work.constraints.scratch[0].used > 0:
            holds, position, quaternion = put_back(setting, placement, position, quaternion, work.constraints)
        place_object(geometry, position, quaternion, placement)
        point, meeting = deepest_offender(placement, work.allowed), deepest_meeting(placement, work)
        if not holds or (point < 0 and meeting == NONE_DEEP):
            break
        if point >= 0:
            box = box_around(geometry, placement, point)
            if not constrain_to_face(geometry, placement, point, box, work.constraints):
                return False, position, quaternion
        elif meeting == UNKNOWN_DEEP or not constrain_meeting(geometry, placement, meeting, work.constraints):
            return False, position, quaternion
    is_out = deepest_offender(placement, work.allowed) < 0 and deepest_meeting(placement, work) == NONE_DEEP
    return holds and is_out, position, quaternion


@kernel
def deepest_meeting(placement: Placement, work: StepWorkspace) -> int:
    """Return the meeting of shapes that is farthest deeper than it may; UNKNOWN_DEEP: parts are, but at no known place;
    NONE_DEEP: none is.
    """
    meetings, found, worst = placement.meetings, NONE_DEEP, 0.0
    if meetings.used[0] < 0:
        return UNKNOWN_DEEP
    for one in range(meetings.gaps.shape[0]):
        for other in range(meetings.gaps.shape[1]):
            if excess_of(meetings.gaps[one, other], one, other, work) > 0.0:
                found = UNKNOWN_DEEP
    for at in range(meetings.used[0] if found == UNKNOWN_DEEP else 0):
        row = meetings.rows[at]
        excess = excess_of(row.gap, row.part, row.cage_part, work)
        is_deep = excess_of(meetings.gaps[row.part, row.cage_part], row.part, row.cage_part, work) > 0.0
        if is_deep and excess > worst and not row.is_hidden:
            found, worst = at, excess
    return found


@kernel
def excess_of(gap_m: float, one: int, other: int, work: StepWorkspace) -> float:
    """Return how much deeper a gap of two parts is than it may be."""
    allowed_m: float = work.allowed_shapes[one, other]
    return -gap_m - allowed_m


@kernel
def constrain_meeting(geometry: Geometry, placement: Placement, at: int, constraints: Constraints) -> bool:
    """Constrain the gap of a meeting that is too deep to zero. An arc of a rim takes the place of its ends, which are
    farther out then.
    """
    row, held, cage = placement.meetings.rows[at], placement.body.world, geometry.cage
    i, j, sticks = row.feature, row.cage_feature, False
    for k in range(constraints.scratch[0].used - 1, -1, -1):
        one, other = constraints.rows[k].feature, constraints.rows[k].cage_feature
        is_end_of_held = other == j and one >= 0 and is_end_of(held.features[one], i)
        if is_end_of_held or (one == i and is_end_of(cage.features[other], j)):
            sticks = sticks or constraints.rows[k].which not in (GAP, FLAT)
            drop_constraint(constraints, k)
    for which in range(ALONG, ALONG + 2 if sticks else ALONG):
        constrain_features(constraints, i, j, which, 0.0)
    return constrain_features(constraints, i, j, GAP, 0.0)


@kernel
def is_end_of(feature: Feature, arc: int) -> bool:
    """Whether a feature is a vertex at an end of an arc."""
    return feature.kind == VERTEX and arc in (feature.arc_before, feature.arc_after)


@kernel
def allow_depths(geometry: Geometry, placement: Placement, tolerances: KernelTolerances, work: StepWorkspace) -> None:
    """Write how deep each point and each pair of shapes may be after the step: no deeper than it is, or than what lies
    on the mouth of a hole all around may be between its vertices.
    """
    for point in range(len(work.allowed)):
        work.allowed[point] = allowed_depth(placement.depths[point], tolerances)
    gaps, held, cage = placement.meetings.gaps, placement.body.world, geometry.cage
    for one in range(gaps.shape[0]):
        for other in range(gaps.shape[1]):
            least = 0.0 if are_convex(held, one, cage, other) else EQUALLY_FAR * tolerances.touch_m
            work.allowed_shapes[one, other] = max(allowed_depth(-gaps[one, other], tolerances), least)
