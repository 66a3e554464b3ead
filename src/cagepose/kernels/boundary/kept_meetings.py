"""Which meetings a motion keeps, and what is beside them: a first contact passes these over."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.vector import dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import LINE, VERTEX, PlacedBoundary
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.touching import SAME_PLACE, Meetings, Touching
from cagepose.kernels.native.kernel import kernel

ANY_GROUP = -1
"""Instead of the number of a group: all of them."""
ON_AXIS = 0.5
"""Of its distance: a ball that comes nearer to the axis of a wall passes it."""


@kernel
def hold_places(i: int, j: int, meetings: Meetings) -> int:
    """Write the places of two features that the motion keeps; return how many there are."""
    n_kept = 0
    for at in range(meetings.used[1]):
        row = meetings.rows[at]
        if row.is_kept and row.feature == i and row.cage_feature == j and n_kept < len(meetings.kept):
            kept = meetings.kept[n_kept]
            kept.angle, kept.other_angle, kept.depth_m, kept.is_held = row.angle, 0.0, math.inf, True
            kept.is_grazing = False
            n_kept += 1
    return n_kept


@kernel
def is_at(row: Touching, met: Meeting, touch_m: float) -> bool:
    """Whether features meet at the place of others that touch."""
    return norm(minus(vector_from(row.place), met.place)) <= SAME_PLACE * touch_m


@kernel
def is_there(meetings: Meetings, met: Meeting, is_kept: bool, touch_m: float) -> bool:
    """Whether features meet where there is a contact, or one that the motion keeps."""
    for at in range(meetings.used[1]):
        row = meetings.rows[at]
        if is_at(row, met, touch_m) and (row.is_kept or not is_kept) and dot(vector_from(row.normal), met.normal) > 0.0:
            return True
    return False


@kernel
def is_beside_kept(i: int, j: int, meetings: Meetings, met: Meeting, touch_m: float) -> bool:
    """Whether two features meet where an alternative is kept, which holds the object out of what they would: as where a
    flat foot slides over the edge of a table that it is flush with. Those that touch have one in each group that they
    are listed in; those that are past the edge are in none, and any that is kept there will do.
    """
    is_listed = False
    for at in range(meetings.used[0]):
        row = meetings.rows[at]
        if row.feature == i and row.cage_feature == j and is_at(row, met, touch_m):
            is_listed = True
            if not is_kept_at(meetings, met, row.group, touch_m):
                return False
    return is_listed or is_kept_at(meetings, met, ANY_GROUP, touch_m)


@kernel
def is_kept_at(meetings: Meetings, met: Meeting, group: int, touch_m: float) -> bool:
    """Whether a meeting of a group is kept where two features meet."""
    for at in range(meetings.used[1]):
        row = meetings.rows[at]
        if row.is_kept and group in (row.group, ANY_GROUP) and is_at(row, met, touch_m):
            return True
    return False


@kernel
def passes_axis(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, motion: Motion) -> float:
    """Return the amount of a motion after which a ball that slides down a hole's slanted wall is nearest to its axis,
    where the wall meets it on all sides; inf: it passes the axis at a distance, or these are other features.
    """
    one, other = held.features[i], cage.features[j]
    ball, wall, sense = (one, other, 1.0) if one.kind == VERTEX else (other, one, -1.0)
    if ball.kind != VERTEX or wall.kind != LINE or wall.taper == 0.0:
        return math.inf
    axis, center = vector_from(wall.direction), vector_from(ball.point)
    off, way = minus(center, vector_from(wall.point)), scaled(velocity_at(motion, center), sense)
    off, way = minus(off, scaled(axis, dot(axis, off))), minus(way, scaled(axis, dot(axis, way)))
    speed = dot(way, way)
    amount = -dot(off, way) / speed if speed > 0.0 else 0.0
    left = norm(plus(off, scaled(way, amount)))
    return amount if amount > 0.0 and left < ON_AXIS * norm(off) else math.inf
