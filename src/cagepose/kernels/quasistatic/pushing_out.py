"""After a step: contacts that carry are put on their faces, and what came into the object on the way is pushed out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances, allowed_depth
from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, vector_from
from cagepose.kernels.boundary.features import number_of_bodies
from cagepose.kernels.boundary.geometry import Geometry, Placement, meetings_with, most_rows, place_object
from cagepose.kernels.boundary.meetings import EQUALLY_FAR
from cagepose.kernels.boundary.touching import SAME_PLACE, Meetings, Touching, is_around
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.on_circle import is_along_wall, is_kept, is_of_same_circle
from cagepose.kernels.contact.tolerances import SAME_NORMAL_RAD
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.projection import (
    ALONG,
    FIXED,
    GAP,
    Constraints,
    PositionConstraint,
    constrain_features,
    drop_constraint,
    empty_constraints,
    has_slips,
    is_slip,
    lack,
    projected,
)
from cagepose.kernels.quasistatic.setting import Setting

MEETINGS_PUSHED = 8
"""So many times what is in each other may be pushed out after a step."""


class StepWorkspace(NamedTuple):
    """Workspace for one step: contacts to keep, and how deep the bodies may be in each other, (1,), metres."""

    constraints: Constraints
    allowed_m: FloatArray


def empty_step_workspace(geometry: Geometry) -> StepWorkspace:
    """Return a workspace for one step (plain Python)."""
    return StepWorkspace(empty_constraints(3 * most_rows(geometry) + MEETINGS_PUSHED), np.zeros(1))


@kernel
def is_fixed(contacts: ContactSet, i: int) -> bool:
    """Whether a contact stays at its place of a circle: of one that stays flat on a face, or lies around a side, be it
    listed or added.
    """
    around = contacts.bends[i].on_circle
    is_around = around.is_on_ball and (around.length != 0.0 or contacts.rows[i].is_added)
    return bool(contacts.states[i].stays_flat or is_around)


@kernel
def has_fixed(contacts: ContactSet) -> bool:
    """Whether a contact that a motion keeps stays at its place of a circle."""
    found = False
    for i in range(contacts.used[0]):
        found = found or (is_kept(contacts, i) and is_fixed(contacts, i))
    return found


@kernel
def least_along_wall(contacts: ContactSet, i: int, closed_m: float) -> float:
    """Return the gap that a rim keeps from the wall that it lies along, see `constrain_contacts`: the least of its
    contacts, where it is on the wall as it would be anywhere else after a turn.
    """
    least = contacts.rows[i].gap
    for other in range(contacts.used[0]):
        if is_of_same_circle(contacts, i, other):
            least = min(least, contacts.rows[other].gap)
    return least if least > closed_m else 0.0


@kernel
def constrain_contacts(contacts: ContactSet, closed_m: float, constraints: Constraints) -> None:
    """Constrain the contacts that stay on their faces, and where they stick also in the face.

    Gaps above ``closed_m`` are kept: to close them could take work, or bring another point in.
    """
    constraints.scratch[0].used = 0
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if not is_kept(contacts, i):
            continue
        kept = contact.gap if contact.gap > closed_m else 0.0
        if is_along_wall(contacts, i):
            kept = least_along_wall(contacts, i, closed_m)
        which = FIXED if is_fixed(contacts, i) else GAP
        constrain_features(constraints, contact.feature, contact.cage_feature, contact.angle, which, kept)
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if contacts.states[i].forces[0] > 0.0 and contacts.states[i].is_sticking:
            for which in range(ALONG, ALONG + 2):
                constrain_features(constraints, contact.feature, contact.cage_feature, contact.angle, which, 0.0)


@kernel
def put_back(
    setting: Setting, placement: Placement, position: Vector, quaternion: Quaternion, constraints: Constraints
) -> tuple[bool, Vector, Quaternion]:
    """Make all constraints hold, and if that cannot be let what sticks slip as little as closing the gaps needs."""
    geometry, body, size_m = setting.geometry, setting.body, setting.size_m
    done, end, turned = projected(geometry, body, position, quaternion, constraints, size_m, False, placement)
    if done or not has_slips(constraints):
        return done, end, turned
    return projected(geometry, body, position, quaternion, constraints, size_m, True, placement)


@kernel
def pushed_out(
    setting: Setting, placement: Placement, position: Vector, quaternion: Quaternion, work: StepWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Make all constraints hold, and push out what this has brought into the cage; placement is filled."""
    geometry = setting.geometry
    holds = True
    for _ in range(MEETINGS_PUSHED):
        if work.constraints.scratch[0].used > 0:
            holds, position, quaternion = put_back(setting, placement, position, quaternion, work.constraints)
        place_object(geometry, position, quaternion, placement)
        body, at = deepest_meeting(geometry, placement, work)
        if not holds or at < 0:
            break
        row = meetings_with(placement, body).rows[at]
        if not constrain_meeting(geometry, placement, row, position, quaternion, work.constraints):
            return False, position, quaternion
    return holds and deepest_meeting(geometry, placement, work)[0] < 0, position, quaternion


@kernel
def deepest_meeting(geometry: Geometry, placement: Placement, work: StepWorkspace) -> tuple[int, int]:
    """Return (body of the cage, meeting) where the object is farthest deeper than it may be, of each group the meeting
    that is least deep; (-1, -1): it is nowhere.
    """
    found, at, worst = -1, -1, work.allowed_m[0]
    for body in range(number_of_bodies(geometry.cage)):
        meetings = meetings_with(placement, body)
        for group in range(meetings.used[0]):
            if meetings.rows[group].group != group:
                continue
            outermost = outermost_of_group(meetings, group)
            if -meetings.rows[outermost].gap > worst:
                found, at, worst = body, outermost, -meetings.rows[outermost].gap
    return found, at


@kernel
def outermost_of_group(meetings: Meetings, group: int) -> int:
    """Return the meeting of a group that is least deep: the object is out of the cage there if this one is."""
    rows, found = meetings.rows, group
    for at in range(group + 1, meetings.used[0]):
        if rows[at].group == group and rows[at].gap > rows[found].gap:
            found = at
    return found


@kernel
def is_at_meeting(
    geometry: Geometry,
    constraint: PositionConstraint,
    row: Touching,
    position: Vector,
    quaternion: Quaternion,
    placement: Placement,
) -> bool:
    """Whether features that are kept together meet at the place and with the normal of others that meet at a pose."""
    if constraint.which == FIXED:
        return False
    kept = lack(geometry, constraint, position, quaternion, placement)
    away = minus(plus(position, kept.arm), vector_from(row.place))
    if kept.value == math.inf or norm(away) > SAME_PLACE * geometry.touch_m:
        return False
    return is_slip(constraint) or norm(minus(kept.direction, vector_from(row.normal))) <= SAME_NORMAL_RAD


@kernel
def constrain_meeting(
    geometry: Geometry,
    placement: Placement,
    row: Touching,
    position: Vector,
    quaternion: Quaternion,
    constraints: Constraints,
) -> bool:
    """Constrain the gap of a meeting that is too deep to zero. The deepest place of a circle takes the place of those
    of it that were to stay where they are, and features that of others that meet there, which are farther out then.
    """
    i, j, sticks = row.feature, row.cage_feature, False
    for k in range(constraints.scratch[0].used - 1, -1, -1):
        other = constraints.rows[k]
        is_same = (other.feature, other.cage_feature) == (i, j)
        if is_same and other.which == GAP:
            continue
        if is_same or is_at_meeting(geometry, other, row, position, quaternion, placement):
            sticks = sticks or is_slip(other)
            drop_constraint(constraints, k)
    for which in range(ALONG, ALONG + 2 if sticks else ALONG):
        constrain_features(constraints, i, j, row.angle, which, 0.0)
    return constrain_features(constraints, i, j, row.angle, GAP, 0.0)


@kernel
def allow_depths(geometry: Geometry, placement: Placement, tolerances: KernelTolerances, work: StepWorkspace) -> None:
    """Write how deep the bodies may be in each other after the step: no deeper than they are, or than a circle that
    lies all around may be between its places.
    """
    work.allowed_m[0] = allowed_depth(0.0, tolerances)
    for body in range(number_of_bodies(geometry.cage)):
        meetings = meetings_with(placement, body)
        for at in range(meetings.used[0]):
            row = meetings.rows[at]
            if row.group != at:
                continue
            depth = allowed_depth(-meetings.rows[outermost_of_group(meetings, at)].gap, tolerances)
            if is_around(row):
                depth = max(depth, EQUALLY_FAR * tolerances.touch_m)
            work.allowed_m[0] = max(work.allowed_m[0], depth)
