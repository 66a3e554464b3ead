"""First contact of shapes while the object moves at a constant twist."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.vector import Vector, minus, norm, vector_from
from cagepose.kernels.collision.first_of_features import (
    Reached,
    Search,
    first_of_features,
    look_along_arc,
    look_at,
    look_closer,
    may_touch,
)
from cagepose.kernels.collision.geometry import Geometry, Placement
from cagepose.kernels.collision.waiting import Waiting, drop_first, keep_last, note_near, settle_first, write_waiting
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.advancement import approach, are_curved, second_pair, surely_clear
from cagepose.kernels.shapes.along_motion import ahead, is_near_part, safe_step
from cagepose.kernels.shapes.body import place_asked
from cagepose.kernels.shapes.features import HOLE, SOLID, Shapes, is_end
from cagepose.kernels.shapes.meetings import balls_apart, slack_of
from cagepose.kernels.shapes.touching import Meetings

SAFE = 1.0 + 1e-9
THIN = 0.1
"""Share of the reach of the smaller of two parts. It may not go deeper, or could come out on the other side. A point
has no sides: it may go as far as the other part's reach says."""
ALMOST_STRAIGHT, PAST = 0.25, 1.01
"""Radians; and how many times longer than its chord an arc that turns by no more is at most."""
LEAST_SLACK = 1e-12
"""Sine, of rounding."""


class Hit(NamedTuple):
    """What is reached, and after which amount of a motion.

    Attributes
    ----------
    amount
        Inf: nothing is.
    point, box
        Indices of the cage's point or shape and of the object's box or shape; -1: nothing.
    feature, cage_feature
        Of shapes: indices of their features; -1: a point reaches a box.
    gap
        How far apart they are now, metres.
    """

    amount: float
    point: int
    box: int
    feature: int
    cage_feature: int
    gap: float


NO_HIT = Hit(math.inf, -1, -1, -1, -1, math.inf)


@kernel
def greatest_speed(motion: Motion, middle: Vector, reach: float) -> float:
    """Return a speed that no point of a ball around ``middle`` exceeds."""
    return norm(velocity_at(motion, middle)) + motion.rate * reach


@kernel
def until_past(held: Shapes, one: int, cage: Shapes, other: int, motion: Motion, end: float) -> float:
    """Return an amount, up to ``end``, after which two parts do not meet: on a motion that turns little they are past
    each other then.
    """
    middle = vector_from(held.parts[one].middle)
    speed = norm(velocity_at(motion, middle))
    if speed == 0.0 or motion.rate * end > ALMOST_STRAIGHT:
        return end
    between = norm(minus(middle, vector_from(cage.parts[other].middle)))
    return min(end, PAST * (between + held.parts[one].reach + cage.parts[other].reach) / speed)


@kernel
def are_convex(held: Shapes, one: int, cage: Shapes, other: int) -> bool:
    """Whether two parts have no holes: convex ones that leave each other on a travel do not meet again."""
    return held.parts[one].kind == SOLID and cage.parts[other].kind == SOLID


@kernel
def touch(meetings: Meetings, one: int, other: int) -> bool:
    """Whether two parts have a contact."""
    found = False
    for at in range(meetings.used[0]):
        found = found or (meetings.rows[at].part == one and meetings.rows[at].cage_part == other)
    return found


@kernel
def first_meeting(
    geometry: Geometry, placement: Placement, motion: Motion, end: float, near_m: float, near_depth_m: float
) -> Hit:
    """Return what shapes reach first, up to ``end``, but for what touches already.

    Features nearer than ``near_m`` may go ``near_depth_m`` deep. On a travel, parts without holes that touch do not
    meet again.
    """
    held, cage, touch_m, queue, hit = placement.body.world, geometry.cage, geometry.touch_m, placement.queue, NO_HIT
    rows = queue.rows
    let_parts_wait(geometry, placement, motion, end)
    while queue.used[1] > 0:
        at = rows[0].heap
        row = rows[at]
        if row.earliest >= min(end, hit.amount):
            break
        search = search_between(held, row.part, cage, row.cage_part, motion, near_m, near_depth_m, touch_m)
        if row.feature < 0:
            drop_first(queue)
            hit = let_features_wait(geometry, placement, motion, search, row, hit)
            continue
        hit = sooner(geometry, placement, motion, search, row, hit)
        if not row.is_near and row.earliest < min(row.until, hit.amount):
            settle_first(queue)
            continue
        drop_first(queue)
        if row.is_near:
            note_near(queue, at)
    for k in range(queue.used[2]):  # last, as they seldom reach anything
        row = rows[rows[k].near]
        if row.earliest < min(row.until, hit.amount):
            search = search_between(held, row.part, cage, row.cage_part, motion, near_m, near_depth_m, touch_m)
            hit = sooner(geometry, placement, motion, search, row, hit)
    return hit


@kernel
def let_parts_wait(geometry: Geometry, placement: Placement, motion: Motion, end: float) -> None:
    """Let all pairs of parts wait that may touch up to ``end``, and no others."""
    held, cage, queue = placement.body.world, geometry.cage, placement.queue
    n_points = len(geometry.points_world)
    queue.used[0] = queue.used[1] = queue.used[2] = 0
    for one in range(len(held.parts)):
        speed = greatest_speed(motion, vector_from(held.parts[one].middle), held.parts[one].reach)
        for other in range(len(cage.parts)):
            if speed == 0.0 or (one < geometry.n_own_boxes and other < n_points):
                continue
            gap = max(placement.meetings.gaps[one, other], balls_apart(held, one, cage, other))
            if gap > SAFE * speed * end:
                continue
            if motion.rate == 0.0 and are_convex(held, one, cage, other) and touch(placement.meetings, one, other):
                continue
            place_asked(geometry.held, one, placement.body)
            until = until_past(held, one, cage, other, motion, end)
            earliest = earliest_touch(held, one, cage, other, motion, until)
            if earliest < until:
                earliest = max(earliest, gap / speed)
                write_waiting(one, other, -1, -1, earliest, until, False, False, queue.rows[queue.used[0]])
                keep_last(queue)


@kernel
def search_between(
    held: Shapes,
    one: int,
    cage: Shapes,
    other: int,
    motion: Motion,
    near_m: float,
    near_depth_m: float,
    touch_m: float,
) -> Search:
    """Return what the first meeting of two parts is asked with."""
    reach, cage_reach = held.parts[one].reach, cage.parts[other].reach
    speed = greatest_speed(motion, vector_from(held.parts[one].middle), reach)
    thinner = min(reach, cage_reach) if min(reach, cage_reach) > touch_m else max(reach, cage_reach)
    depth = min(near_depth_m, THIN * thinner)
    exact = max(LEAST_SLACK, touch_m / (reach + cage_reach))
    return Search(near_m, depth, slack_of(held, one, cage, other, touch_m), exact, speed, touch_m)


@kernel
def let_features_wait(
    geometry: Geometry, placement: Placement, motion: Motion, search: Search, parts: Waiting, hit: Hit
) -> Hit:
    """Let the features of two parts wait that may touch; return what is reached by those that there is no room for, or
    ``hit``, which is known.
    """
    held, cage, queue, one, other = placement.body.world, geometry.cage, placement.queue, parts.part, parts.cage_part
    begin, until, are_near = parts.earliest, min(parts.until, hit.amount), placement.meetings.are_near
    within_m = search.touch_m + search.speed * until
    for j in range(cage.parts[other].first, cage.parts[other].last):
        are_near[j] = is_near_part(cage, j, held, one, within_m)
    for i in range(held.parts[one].first, held.parts[one].last):
        if not is_near_part(held, i, cage, other, within_m):
            continue
        for j in range(cage.parts[other].first, cage.parts[other].last):
            if not are_near[j]:
                continue
            row = queue.rows[queue.used[0]]
            if not may_touch(held, one, i, cage, other, j, motion, begin, until, search, placement.moved, row):
                continue
            if queue.used[0] + 1 < len(queue.rows):
                keep_last(queue)
                continue
            while row.earliest < min(until, hit.amount):
                hit = sooner(geometry, placement, motion, search, row, hit)
    return hit


@kernel
def sooner(geometry: Geometry, placement: Placement, motion: Motion, search: Search, row: Waiting, hit: Hit) -> Hit:
    """Return what a pair that waits reaches, as far as it is looked at now, or ``hit``, which is known."""
    held, cage, moved, i, j = placement.body.world, geometry.cage, placement.moved, row.feature, row.cage_feature
    end = min(row.until, hit.amount)
    if not row.is_seen:
        look_at(held, cage, motion, search, row)
        return hit
    if not row.is_near and row.of_arc:
        if look_along_arc(held, cage, motion, end, search, row, moved):
            hit = with_second_pair(geometry, placement, motion, search, row, hit)
        return hit
    if not row.is_near and are_curved(held, i, cage, j):
        return reached(row, i, j, look_closer(held, cage, motion, end, search, row, moved), hit)
    row.earliest = math.inf
    for _ in range(2):
        end = min(row.until, hit.amount)
        found = first_of_features(held, i, cage, j, motion, end, search, placement.meetings, moved)
        hit = reached(row, i, j, found, hit)
        i, j = second_pair(held, i, cage, j)
        if i < 0:
            break
    return hit


@kernel
def with_second_pair(
    geometry: Geometry, placement: Placement, motion: Motion, search: Search, row: Waiting, hit: Hit
) -> Hit:
    """Let the second pair of a pair that waits wait, too; return what it reaches if there is no room, or ``hit``."""
    held, cage, queue = placement.body.world, geometry.cage, placement.queue
    i, j = second_pair(held, row.feature, cage, row.cage_feature)
    second = queue.rows[queue.used[0]]
    if queue.used[0] + 1 < len(queue.rows):
        write_waiting(row.part, row.cage_part, i, j, row.earliest, row.until, True, False, second)
        keep_last(queue)
        return hit
    found = first_of_features(
        held, i, cage, j, motion, min(row.until, hit.amount), search, placement.meetings, placement.moved
    )
    return reached(row, i, j, found, hit)


@kernel
def reached(row: Waiting, i: int, j: int, found: Reached, hit: Hit) -> Hit:
    """Return what features of two parts reach if that is sooner than ``hit``, and else this."""
    if found.amount < min(row.until, hit.amount):
        return Hit(found.amount, row.cage_part, row.part, i, j, found.gap)
    return hit


@kernel
def earliest_touch(held: Shapes, one: int, cage: Shapes, other: int, motion: Motion, until: float) -> float:
    """Return an amount before which two parts do not touch: so long all of the one is beyond a face of the other."""
    latest = 0.0
    if held.parts[one].kind == HOLE or cage.parts[other].kind == HOLE:  # which ends in more than its vertices
        return latest
    for i in range(held.parts[one].first_face, held.parts[one].last):
        first = until
        for j in range(cage.parts[other].first, cage.parts[other].last):
            if first <= latest or not is_end(cage.features[j]):
                break
            first = min(first, until_plane(held, i, cage, j, motion, until))
        latest = max(latest, first)
    for j in range(cage.parts[other].first_face, cage.parts[other].last):
        first = until
        for i in range(held.parts[one].first, held.parts[one].last):
            if first <= latest or not is_end(held.features[i]):
                break
            first = min(first, until_plane(held, i, cage, j, motion, until))
        latest = max(latest, first)
    return latest


@kernel
def until_plane(held: Shapes, i: int, cage: Shapes, j: int, motion: Motion, until: float) -> float:
    """Return an amount before which an end of one part does not reach the plane of a face of the other."""
    if are_curved(held, i, cage, j):
        now = approach(held, i, cage, j, motion, 0.0, False)
        return surely_clear(now, now.gap) if now.gap > 0.0 else 0.0
    at = ahead(held, i, cage, j, motion, 0.0, 0.0, 1.0, until)
    return safe_step(at) if at.value > 0.0 else 0.0
