"""When a circle touches another feature first, or a line the side of a cone: conservative advancement, then Newton's
method on the gap, equation (2.14).

The gap at any place of a circle falls no faster than the one moves toward the other, so a step by the least gap over
this speed jumps over no contact: a place that comes up on the way has been no nearer than those that were there. Where
a gap is within the touch tolerance, Newton's method gives the digits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import circle_of, outward_at
from cagepose.kernels.boundary.circle_places import (
    GREATEST,
    SADDLE,
    WHOLE,
    Place,
    on_circle,
    within_turn,
    write_place,
)
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, Feature, PlacedBoundary
from cagepose.kernels.boundary.first_touch import place_after
from cagepose.kernels.boundary.meeting import both_reach
from cagepose.kernels.boundary.meetings import PLACES_AROUND, find_circle_places, meeting_at
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.advancement import speed_toward_round, speed_toward_side
from cagepose.kernels.shapes.along_motion import BEHIND, LEAST_STEP, between_segments, gone_on
from cagepose.kernels.shapes.motion import Motion, velocity_at

ADVANCES = 2000
"""Steps for one pair of features; only where they graze each other more than some tens are taken."""
NEWTON_STEPS = 12
ROOT_OF_TOUCH, CONVERGES = 1e-3, 0.5
"""Of the touch tolerance: a gap that is less is a root; and of such a gap: a step that leaves more no longer helps."""
KEPT_STEP = 1.0 / 32.0
"""In amounts of the whole motion: a place that touches is looked at at least so often, whether it is still there."""
SAME_ANGLE = 0.3
"""Radians: a place that touches now is the one that is nearer to where it was, as the motion goes on."""


class Closing(NamedTuple):
    """The gap falls no faster than ``speed``, metres for each unit of the amount, and how fast this may grow."""

    speed: float
    growth: float


@kernel
def closing_of(one: Feature, other: Feature, motion: Motion) -> Closing:
    """Return how fast a feature of the object, at its place on the way, and one of the cage may come nearer, of which
    one is a circle: the velocity of the object's material at the circle, without what leads along the other one.
    """
    small, wide = (one, other) if is_smaller(one, other) else (other, one)
    middle, reach = middle_of(small), small.length if small.kind == CIRCLE else 0.5 * small.length
    way, along, spread = velocity_at(motion, middle), vector_from(wide.direction), motion.rate * reach
    fastest, growth = norm(way) + spread, motion.rate * (norm(way) + spread)
    if wide.kind == FACE:
        return Closing(abs(dot(way, along)) + spread * norm(cross(motion.axis, along)), growth)
    speed, grows = fastest, 0.0
    if small.kind == CIRCLE:  # which goes nowhere by turning about its own axis
        speed = norm(way) + spread * norm(cross(motion.axis, vector_from(small.direction)))
    if wide.kind == LINE:
        across = speed_toward_side(wide, way) + spread  # type: ignore[arg-type]
        if across < speed:
            speed, grows = across, growth
    if wide.kind == LINE or wide.kind == CIRCLE:
        slower, slower_grows = speed_toward_round(wide, motion, middle, reach, fastest)  # type: ignore[arg-type]
        if slower < speed:
            speed, grows = slower, slower_grows
    return Closing(speed, grows)


@kernel
def is_smaller(one: Feature, other: Feature) -> bool:
    """Whether the first of two features is the circle, or the smaller circle, or the shorter line."""
    if one.kind != other.kind:
        return bool(one.kind == CIRCLE)
    return bool(one.length <= other.length)


@kernel
def middle_of(feature: Feature) -> Vector:
    """Return the centre of a circle, or the middle of a line."""
    if feature.kind == CIRCLE:
        return vector_from(feature.point)
    return plus(vector_from(feature.point), scaled(vector_from(feature.direction), 0.5 * feature.length))


@kernel
def surely_clear(now: Closing, gap: float) -> float:
    """Return for how long features do not touch that are so far apart."""
    if gap == math.inf:
        return math.inf
    root = math.sqrt(now.speed * now.speed + 2.0 * now.growth * gap) + now.speed
    return 2.0 * gap / root if root > 0.0 else math.inf


@kernel
def place_touches(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    place: Place,
    motion: Motion,
    slack: float,
    slack_m: float,
) -> bool:
    """Whether two features, as they are placed, reach where they meet at a place and come nearer."""
    met = meeting_at(a, i, b, j, place)
    if met.gap < -slack_m or not both_reach(a, i, b, j, met, slack, slack_m):
        return False
    return dot(met.normal, velocity_at(motion, met.place)) > 0.0


@kernel
def place_near(one: Feature, other: Feature, angle: float, touch_m: float, places: Rows[Place]) -> int:
    """Write the places of two features and return which of them is nearest to an angle; -1: none is that near."""
    n_places = find_circle_places(one, other, touch_m, places)
    nearest, least = -1, SAME_ANGLE
    if n_places == WHOLE:
        write_place(places[0], angle, 0.0, 0, True)
        return 0
    for k in range(n_places):
        away = abs(within_turn(places[k].angle - angle))
        if places[k].kind not in (GREATEST, SADDLE) and away < least:
            nearest, least = k, away
    return nearest


class Root(NamedTuple):
    """Where the gap of a place is zero: the amount, inf: nowhere; and the angle of the place there."""

    amount: float
    angle: float


@kernel
def root_of_gap(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    amount: float,
    angle: float,
    touch_m: float,
    moved: PlacedBoundary,
    places: Rows[Place],
) -> Root:
    """Return where Newton's method leads on the gap at the place of a circle that is near an angle."""
    root, least = Root(math.inf, angle), ROOT_OF_TOUCH * touch_m / CONVERGES
    for _ in range(NEWTON_STEPS):
        place_after(a, i, motion, amount, moved)
        at = place_near(moved.features[i], b.features[j], angle, touch_m, places)
        if at < 0:
            break
        angle = places[at].angle
        met = meeting_at(moved, i, b, j, places[at])
        closing = dot(met.normal, velocity_at(motion, met.place))
        if not met.is_one or closing <= 0.0:
            break
        left = abs(met.gap)
        if left <= ROOT_OF_TOUCH * touch_m:
            if left >= CONVERGES * least:
                break
            root, least = Root(amount, angle), left
        amount += met.gap / closing
    return root


@kernel
def first_touch_of_curved(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    end: float,
    slack: float,
    touch_m: float,
    moved: PlacedBoundary,
    places: Rows[Place],
    kept: Rows[Place],
    n_kept: int,
) -> float:
    """Return the amount, up to ``end``, after which two curved features touch; inf: they do not, or it
    is not known: all steps are used up where they stay a hundred touch tolerances apart on the way.

    Parameters
    ----------
    a, i, b, j
        The features, placed in the world.
    motion, end
        That of the object; the end is finite.
    slack, touch_m
        How far beyond its end a feature still counts: the sine of an angle, and metres.
    moved, places
        Memory.
    kept, n_kept
        Places that touch now and do not come nearer, or have been in each other: they count again once they have been
        apart. They are written over.
    """
    amount, behind = 0.0, BEHIND * end
    for _ in range(ADVANCES):
        place_after(a, i, motion, amount, moved)
        one, other = moved.features[i], b.features[j]
        closing = closing_of(one, other, motion)
        n_places = find_circle_places(one, other, touch_m, places)
        is_around = n_places == WHOLE
        least, is_past = math.inf, False
        if is_around and one.kind == CIRCLE and other.kind == CIRCLE:
            least, n_places = circles_apart(one, other), 0
            is_past, is_around = least <= touch_m, False
        for k in range(PLACES_AROUND if is_around else n_places):
            place = places[k]
            if place.kind in (GREATEST, SADDLE):
                continue
            met = meeting_at(moved, i, b, j, place)
            if met.gap == math.inf:  # lines without a common normal
                least = min(least, max(lines_apart(one, other), 0.0))
                continue
            at = kept_at(place.angle, kept, n_kept)
            if at >= 0:
                # One that touched: it is followed until it is apart.
                kept[at].angle = place.angle
                if met.gap > touch_m:
                    n_kept = dropped(kept, n_kept, at)
                if abs(met.gap) > touch_m:
                    least = min(least, abs(met.gap))
                continue
            if -ROOT_OF_TOUCH * touch_m <= met.gap <= touch_m:
                angle = place.angle
                root = root_of_gap(a, i, b, j, motion, amount, angle, touch_m, moved, places)
                reached = max(root.amount, amount)
                if reached <= end:
                    place_after(a, i, motion, reached, moved)
                    at_root = place_near(moved.features[i], b.features[j], root.angle, touch_m, places)
                    if at_root >= 0 and place_touches(moved, i, b, j, places[at_root], motion, slack, touch_m):
                        return reached
                is_past = True
                place_after(a, i, motion, amount, moved)
                find_circle_places(moved.features[i], b.features[j], touch_m, places)
            least = min(least, abs(met.gap))
        step = surely_clear(closing, least)
        if is_past and closing.speed > 0.0:  # a root that is no contact: on so short a way none is hidden that counts
            step = max(step, touch_m / closing.speed)
        if n_kept > 0:
            step = min(step, end * KEPT_STEP)
        if step >= end - amount:
            return math.inf
        if step > LEAST_STEP * end:
            amount += step
        else:
            amount, behind = gone_on(amount, step, end, behind)
    return math.inf


@kernel
def circles_apart(one: Feature, other: Feature) -> float:
    """Return how far a place of a circle is from another one."""
    point = on_circle(circle_of(one), 0.0).point
    nearest = plus(vector_from(other.point), scaled(outward_at(other, point), other.length))
    return max(0.0, norm(minus(point, nearest)) - one.radius - other.radius)


@kernel
def lines_apart(one: Feature, other: Feature) -> float:
    """Return how far two lines are apart at least, as far as they reach."""
    p, u, q, w = (
        vector_from(one.point),
        vector_from(one.direction),
        vector_from(other.point),
        vector_from(other.direction),
    )
    return between_segments(p, u, one.length, q, w, other.length) - one.radius - other.radius


@kernel
def kept_at(angle: float, kept: Rows[Place], n_kept: int) -> int:
    """Return which of the places that touched is near an angle; -1: none."""
    for k in range(n_kept):
        if abs(within_turn(kept[k].angle - angle)) < SAME_ANGLE:
            return k
    return -1


@kernel
def dropped(kept: Rows[Place], n_kept: int, at: int) -> int:
    """Drop a place from those that touched; return how many are left."""
    kept[at].angle = kept[n_kept - 1].angle
    return n_kept - 1
