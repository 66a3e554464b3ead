"""First contact of shapes while the object moves at a constant twist."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, vector_from
from cagepose.kernels.collision.geometry import Geometry, Placement
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.advancement import (
    approach,
    are_curved,
    first_curved_touch,
    is_far_from_arc,
    surely_clear,
)
from cagepose.kernels.shapes.along_motion import ahead, can_touch, clear_step, first_touch, safe_step
from cagepose.kernels.shapes.body import place_asked
from cagepose.kernels.shapes.features import EDGE, HOLE, RIM, SOLID, Feature, Shapes, is_end, is_of_mouth
from cagepose.kernels.shapes.meeting import SAME_PLACE, Meeting, both_reach, meeting
from cagepose.kernels.shapes.meetings import Meetings, balls_apart, slack_of
from cagepose.kernels.shapes.motion import Motion, velocity_at
from cagepose.kernels.shapes.rims import lie_flat

SAFE = 1.0 + 1e-9
THIN = 0.1
"""Of the reach of a part: nothing may go deeper into it, or it could come out on the other side."""
LEAVES = 1e-6
"""Of the fastest speed of a part: features that touch and move apart faster leave each other, and may meet again."""
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
    held, cage, touch_m, earliest = placement.body.world, geometry.cage, geometry.touch_m, placement.earliest
    n_points = len(geometry.points_world)
    for one in range(len(held.parts)):
        speed = greatest_speed(motion, vector_from(held.parts[one].middle), held.parts[one].reach)
        for other in range(len(cage.parts)):
            earliest[one, other] = math.inf
            if speed == 0.0 or (one < geometry.n_own_boxes and other < n_points):
                continue
            gap = max(placement.meetings.gaps[one, other], balls_apart(held, one, cage, other))
            if gap > SAFE * speed * end:
                continue
            if motion.rate == 0.0 and are_convex(held, one, cage, other) and touch(placement.meetings, one, other):
                continue
            place_asked(geometry.held, one, placement.body)
            until = until_past(held, one, cage, other, motion, end)
            first = earliest_touch(held, one, cage, other, motion, until)
            if first < until:
                earliest[one, other] = max(first, gap / speed)
    hit = NO_HIT
    one, other = next_pair(earliest, end)
    while one >= 0:
        until = until_past(held, one, cage, other, motion, min(end, hit.amount))
        speed = greatest_speed(motion, vector_from(held.parts[one].middle), held.parts[one].reach)
        depth = min(near_depth_m, THIN * min(held.parts[one].reach, max(cage.parts[other].reach, touch_m)))
        exact = max(LEAST_SLACK, touch_m / (held.parts[one].reach + cage.parts[other].reach))
        search = Search(near_m, depth, slack_of(held, one, cage, other, touch_m), exact, speed, touch_m)
        for i in range(held.parts[one].first, held.parts[one].last):
            for j in range(cage.parts[other].first, cage.parts[other].last):
                found = first_of_features(held, i, cage, j, motion, until, search, placement.meetings, placement.moved)
                if found[0] < until:
                    until = found[0]
                    hit = Hit(until, other, one, i, j, found[1])
        earliest[one, other] = math.inf
        one, other = next_pair(earliest, min(end, hit.amount))
    return hit


@kernel
def next_pair(earliest: FloatArray, end: float) -> tuple[int, int]:
    """Return the pair of parts that can touch first, before ``end``; (-1, -1): there is none."""
    found, least = (-1, -1), end
    for one in range(earliest.shape[0]):
        for other in range(earliest.shape[1]):
            if earliest[one, other] < least:
                found, least = (one, other), earliest[one, other]
    return found


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
        now = approach(held, i, cage, j, motion, 0.0)
        return surely_clear(now, now.gap) if now.gap > 0.0 else 0.0
    at = ahead(held, i, cage, j, motion, 0.0, 0.0, 1.0, until)
    return safe_step(at) if at.value > 0.0 else 0.0


@kernel
def surely_apart(held: Shapes, i: int, cage: Shapes, j: int, motion: Motion, until: float, moved: Shapes) -> bool:
    """Whether it is soon told that two features do not meet."""
    if safe_step(ahead(held, i, cage, j, motion, 0.0, 0.0, 1.0, until)) >= until:
        return True
    return clear_step(held, i, cage, j, motion, 0.0, moved) >= until


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
) -> tuple[float, float]:
    """Return when two features that do not touch, or leave each other, reach each other, inf if they do not, and how
    far apart they are now.
    """
    touch_m, speed = search.touch_m, search.speed
    if not can_touch(held, i, cage, j):
        return math.inf, math.inf
    curved = are_curved(held, i, cage, j)
    if curved:
        if is_far_from_arc(held, i, cage, j, touch_m + speed * until):
            return math.inf, math.inf
        now = approach(held, i, cage, j, motion, 0.0)
        if abs(now.gap) <= touch_m and lie_flat(held.features[i], cage.features[j], touch_m):  # its vertices touch
            return math.inf, math.inf
        if now.gap > 0.0 and surely_clear(now, now.gap) >= until:
            return math.inf, math.inf
    elif surely_apart(held, i, cage, j, motion, until, moved):
        return math.inf, math.inf
    met = meeting(held, i, cage, j)
    touches = met.is_one and abs(met.gap) <= touch_m
    leaves = touches and both_reach(held, i, cage, j, met, search.slack, 2.0 * touch_m)
    is_hollow_pair = is_hollow(held.features[i]) or is_hollow(cage.features[j])
    curls = is_hollow_pair and (held.features[i].kind != RIM or cage.features[j].kind != RIM)
    curls = curls and leaves and not is_there(meetings, met, True, touch_m)
    closing = dot(met.normal, velocity_at(motion, met.place)) if touches else -math.inf
    if touches and not leaves:
        if abs(closing) <= LEAVES * speed and is_there(meetings, met, False, touch_m):  # that of features next to them
            return math.inf, math.inf
        closing = -math.inf
    if leaves and motion.rate == 0.0 and not is_hollow_pair:
        return math.inf, math.inf
    if closing >= (1.0 if curls else -1.0) * LEAVES * speed:  # a contact that carries, or it would not go into it
        return math.inf, math.inf
    level, side = 0.0, 0.0
    if met.is_one and abs(met.gap) <= max(search.near_m, touch_m):
        level = search.near_depth_m if leaves or abs(met.gap) <= search.near_m else 0.0
        if not leaves or closing >= -LEAVES * speed:
            level = max(level, 2.0 * touch_m)  # they do not reach there now, but might; or a wall bends into the way
        if held.features[i].kind == EDGE and cage.features[j].kind == EDGE:
            crossed = cross(vector_from(held.features[i].direction), vector_from(cage.features[j].direction))
            side = -math.copysign(1.0, dot(met.normal, crossed))
    if curved:
        return first_curved_touch(held, i, cage, j, motion, until, level, search.exact, touch_m, moved), met.gap
    return first_touch(held, i, cage, j, motion, until, level, side, search.exact, touch_m, moved), met.gap
