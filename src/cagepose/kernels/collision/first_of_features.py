"""First contact of two features while the object moves at a constant twist."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.vector import cross, dot, minus, norm, vector_from
from cagepose.kernels.collision.waiting import Waiting, write_waiting
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.advancement import (
    ADVANCES,
    VISIT,
    advance,
    approach,
    are_curved,
    away_from_arc,
    clear_of_arc,
    second_pair,
    surely_clear,
)
from cagepose.kernels.shapes.along_motion import ahead, can_touch, clear_step, first_touch, safe_step
from cagepose.kernels.shapes.features import EDGE, RIM, Feature, Shapes, is_of_mouth
from cagepose.kernels.shapes.meeting import SAME_PLACE, Meeting, both_reach, meeting
from cagepose.kernels.shapes.rims import lie_flat
from cagepose.kernels.shapes.touching import Meetings

LEAVES = 1e-6
"""Fraction of the fastest speed of a part. Features that touch and move apart faster leave each other, and may meet
again."""
CLOSE = 4.0
"""In touch tolerances: where an arc is nearer, its places are followed one by one."""
TOGETHER = 40
"""Steps after which they are, too."""


class Search(NamedTuple):
    """What the first meeting of two parts is asked with.

    Attributes
    ----------
    near_m, near_depth_m
        Features nearer than the one may go so deep as the other.
    slack, exact
        Sines: whether features touch now is asked with the one, as contacts are; where they meet first with the other,
        that which a touch tolerance makes across both parts: slender parts would meet long before they do.
    speed
        That no point of the object's part exceeds.
    touch_m
        The touch tolerance.
    """

    near_m: float
    near_depth_m: float
    slack: float
    exact: float
    speed: float
    touch_m: float


class Reached(NamedTuple):
    """When two features touch first, inf: never; and how far apart they are now, metres."""

    amount: float
    gap: float


NEVER = Reached(math.inf, math.inf)


@kernel
def is_hollow(feature: Feature) -> bool:
    """Whether a feature is the wall or the mouth of a hole: what leaves it straight ahead may meet it again."""
    return feature.radius < 0.0 or is_of_mouth(feature)


@kernel
def is_there(meetings: Meetings, met: Meeting, is_kept: bool, touch_m: float) -> bool:
    """Whether features meet where there is a contact, or one that carries."""
    found = False
    for at in range(meetings.used[0]):
        row = meetings.rows[at]
        if (row.is_kept or not (is_kept or row.is_hidden)) and dot(vector_from(row.normal), met.normal) > 0.0:
            found = found or norm(minus(vector_from(row.place), met.place)) <= SAME_PLACE * touch_m
    return found


@kernel
def may_touch(
    held: Shapes,
    one: int,
    i: int,
    cage: Shapes,
    other: int,
    j: int,
    motion: Motion,
    begin: float,
    until: float,
    search: Search,
    moved: Shapes,
    row: Waiting,
) -> bool:
    """Whether two features may touch before ``until``; write them as a pair that waits then. Curved ones do not before
    ``begin``.
    """
    if not can_touch(held, i, cage, j):
        return False
    if are_curved(held, i, cage, j):
        if held.features[i].is_second or cage.features[j].is_second:  # asked with the first ones
            return False
        earliest = max(begin, (away_from_arc(held, i, cage, j) - search.touch_m) / search.speed)
        write_waiting(one, other, i, j, earliest, until, False, False, row)
        return earliest < until
    earliest = safe_step(ahead(held, i, cage, j, motion, 0.0, 0.0, 1.0, until))
    if earliest >= until:
        return False
    clear = clear_step(held, i, cage, j, motion, 0.0, moved)
    is_near = clear * search.speed <= SAME_PLACE * max(search.near_m, search.touch_m)  # and may be deep already
    earliest = 0.0 if is_near else max(earliest, clear)
    write_waiting(one, other, i, j, earliest, until, True, is_near, row)
    return earliest < until


@kernel
def look_at(held: Shapes, cage: Shapes, motion: Motion, search: Search, row: Waiting) -> None:
    """Note how far apart two curved features are, and until when they surely do not touch."""
    i, j = row.feature, row.cage_feature
    row.of_arc = second_pair(held, i, cage, j)[0] >= 0
    now = approach(held, i, cage, j, motion, 0.0, row.of_arc)
    row.is_seen = True
    row.is_near = abs(now.gap) <= max(search.near_m, search.touch_m)
    if abs(now.gap) <= search.touch_m and lie_flat(held.features[i], cage.features[j], search.touch_m):
        row.earliest = math.inf  # their vertices touch
    elif now.gap > 0.0:
        row.earliest = max(row.earliest, surely_clear(now, now.gap))


@kernel
def look_closer(
    held: Shapes, cage: Shapes, motion: Motion, until: float, search: Search, row: Waiting, moved: Shapes
) -> Reached:
    """Look some steps farther whether two features that wait, curved and apart, touch; note until when they do not."""
    i, j, begin, behind = row.feature, row.cage_feature, row.earliest, row.behind
    is_last = row.n_advances + VISIT >= ADVANCES
    found = advance(
        held, i, cage, j, motion, begin, behind, until, 0.0, search.exact, search.touch_m, VISIT, is_last, moved
    )
    row.earliest, row.behind = found.clear, found.behind
    row.n_advances += VISIT
    gap = meeting(held, i, cage, j).gap if found.amount < math.inf else math.inf
    return Reached(found.amount, gap)


@kernel
def look_along_arc(
    held: Shapes, cage: Shapes, motion: Motion, until: float, search: Search, row: Waiting, moved: Shapes
) -> bool:
    """Look some steps farther along an arc and what it meets; return whether each of its places is to be followed by
    itself: where they are close, or take many steps.
    """
    close_m = CLOSE * max(search.near_m, search.touch_m)
    row.earliest, is_close = clear_of_arc(
        held, row.feature, cage, row.cage_feature, motion, row.earliest, until, close_m, moved
    )
    row.n_advances += VISIT
    row.of_arc = not is_close and row.n_advances < TOGETHER
    return row.earliest < until and not row.of_arc


@kernel
def first_of_features(
    held: Shapes,
    i: int,
    cage: Shapes,
    j: int,
    motion: Motion,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: Shapes,
) -> Reached:
    """Return when two features that do not touch, or leave each other, reach each other."""
    touch_m, speed = search.touch_m, search.speed
    met = meeting(held, i, cage, j)
    touches = met.is_one and abs(met.gap) <= touch_m
    leaves = touches and both_reach(held, i, cage, j, met, search.slack, 2.0 * touch_m)
    is_hollow_pair = is_hollow(held.features[i]) or is_hollow(cage.features[j])
    curls = is_hollow_pair and (held.features[i].kind != RIM or cage.features[j].kind != RIM)
    curls = curls and leaves and not is_there(meetings, met, True, touch_m)
    closing = dot(met.normal, velocity_at(motion, met.place)) if touches else -math.inf
    if touches and not leaves:
        if abs(closing) <= LEAVES * speed and is_there(meetings, met, False, touch_m):  # that of features next to them
            return NEVER
        closing = -math.inf
    if leaves and motion.rate == 0.0 and not is_hollow_pair:
        return NEVER
    if closing >= (1.0 if curls else -1.0) * LEAVES * speed:  # a contact that carries, or it would not go into it
        return NEVER
    level, side = 0.0, 0.0
    if met.is_one and abs(met.gap) <= max(search.near_m, touch_m):
        level = search.near_depth_m if leaves or abs(met.gap) <= search.near_m else 0.0
        if not leaves or closing >= -LEAVES * speed:
            level = max(level, 2.0 * touch_m)  # they do not reach there now, but might; or a wall bends into the way
        if held.features[i].kind == EDGE and cage.features[j].kind == EDGE:
            crossed = cross(vector_from(held.features[i].direction), vector_from(cage.features[j].direction))
            side = -math.copysign(1.0, dot(met.normal, crossed))
    if are_curved(held, i, cage, j):
        found = advance(held, i, cage, j, motion, 0.0, 0.0, until, level, search.exact, touch_m, ADVANCES, True, moved)
        return Reached(found.amount, met.gap)
    amount = first_touch(held, i, cage, j, motion, until, level, side, search.exact, touch_m, moved)
    return Reached(amount, met.gap)
