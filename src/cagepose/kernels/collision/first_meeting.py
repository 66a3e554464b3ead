"""First contact of shapes while the object moves at a constant twist."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, vector_from
from cagepose.kernels.collision.geometry import Geometry, Placement
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.along_motion import ahead, can_touch, first_touch, safe_step
from cagepose.kernels.shapes.features import EDGE, Shapes
from cagepose.kernels.shapes.meeting import both_reach, meeting
from cagepose.kernels.shapes.meetings import balls_apart, slack_of
from cagepose.kernels.shapes.motion import Motion, velocity_at

SAFE = 1.0 + 1e-9
THIN = 0.1
"""Of the reach of a part: nothing may go deeper into it, or it could come out on the other side."""


LEAVES = 1e-6
"""Of the fastest speed of a part: features that touch and move apart faster leave each other, and may meet again."""
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
def fastest(motion: Motion, middle: Vector, reach: float) -> float:
    """Return a speed that no point of a ball around ``middle`` exceeds."""
    return norm(velocity_at(motion, middle)) + motion.rate * reach


@kernel
def until_past(held: Shapes, one: int, cage: Shapes, other: int, speed: float) -> float:
    """Return an amount of a travel after which two parts move apart for ever."""
    between = minus(vector_from(held.parts[one].middle), vector_from(cage.parts[other].middle))
    return SAFE * (norm(between) + held.parts[one].reach + cage.parts[other].reach) / speed


@kernel
def first_meeting(
    geometry: Geometry, placement: Placement, motion: Motion, end: float, near_m: float, near_depth_m: float
) -> Hit:
    """Return what shapes reach first, up to ``end``, but for what touches already.

    Features nearer than ``near_m`` may go ``near_depth_m`` deep. On a travel, parts that touch do not meet again.
    """
    held, cage, touch_m = placement.held, geometry.cage, geometry.touch_m
    n_points = len(geometry.points_world)
    hit = NO_HIT
    least = end
    for one in range(len(held.parts)):
        speed = fastest(motion, vector_from(held.parts[one].middle), held.parts[one].reach)
        if speed == 0.0:
            continue
        for other in range(len(cage.parts)):
            if one < geometry.n_own_boxes and other < n_points:
                continue
            gap = max(placement.meetings.gaps[one, other], balls_apart(held, one, cage, other))
            if gap > SAFE * speed * least or (motion.rate == 0.0 and gap <= touch_m):
                continue
            until = least if motion.rate > 0.0 else min(least, until_past(held, one, cage, other, speed))
            depth = min(near_depth_m, THIN * min(held.parts[one].reach, max(cage.parts[other].reach, touch_m)))
            slack = slack_of(held, one, cage, other, touch_m)
            exact = max(LEAST_SLACK, touch_m / (held.parts[one].reach + cage.parts[other].reach))
            for i in range(held.parts[one].first, held.parts[one].last):
                for j in range(cage.parts[other].first, cage.parts[other].last):
                    found = first_of_features(
                        held, i, cage, j, motion, until, near_m, depth, slack, exact, speed, touch_m, placement.moved
                    )
                    if found[0] < least:
                        least = until = found[0]
                        hit = Hit(least, other, one, i, j, found[1])
    return hit


@kernel
def first_of_features(
    held: Shapes,
    i: int,
    cage: Shapes,
    j: int,
    motion: Motion,
    until: float,
    near_m: float,
    near_depth_m: float,
    slack: float,
    exact: float,
    speed: float,
    touch_m: float,
    moved: Shapes,
) -> tuple[float, float]:
    """Return when two features that do not touch, or leave each other, reach each other, inf if they do not, and how far
    apart they are.

    Whether they touch now is asked with ``slack``, as contacts are; where they meet first is asked with the sine ``exact``
    that a touch tolerance makes across both parts, or slender parts would meet long before they do.
    """
    if not can_touch(held, i, cage, j):
        return math.inf, math.inf
    if safe_step(ahead(held, i, cage, j, motion, 0.0, 0.0, 1.0, until)) >= until:
        return math.inf, math.inf
    met = meeting(held, i, cage, j)
    touches = met.is_one and abs(met.gap) <= touch_m
    if touches and motion.rate == 0.0:
        return math.inf, math.inf
    touches = touches and both_reach(held, i, cage, j, met, slack, 2.0 * touch_m)
    if touches and dot(met.normal, velocity_at(motion, met.place)) >= -LEAVES * speed:
        return math.inf, math.inf
    level, side = 0.0, 0.0
    if touches or (met.is_one and abs(met.gap) <= near_m):
        level = near_depth_m
        if held.features[i].kind == EDGE and cage.features[j].kind == EDGE:
            crossed = cross(vector_from(held.features[i].direction), vector_from(cage.features[j].direction))
            side = -math.copysign(1.0, dot(met.normal, crossed))
    found = first_touch(held, i, cage, j, motion, until, level, side, exact, touch_m, moved)
    return found, met.gap
