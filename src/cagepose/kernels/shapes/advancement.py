"""When curved features touch first: conservative advancement, then Newton's method on the gap, equation (2.14).

Of rims, of the sides of cones and of holes no bound on the second derivative of the gap is known that serves. But their
gap falls no faster than the one moves toward the other, and where that is the wall of a bar or a plane, motion along it
does not count. So a step by the gap over this speed jumps over no contact; where the gap is within the touch tolerance,
Newton's method gives the digits.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.along_motion import (
    BEHIND,
    LEAST_STEP,
    distance_from,
    gone_on,
    keeps_radius,
    place_moved,
    touches_after,
)
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, Feature, Shapes
from cagepose.kernels.shapes.feet import clearance_of_arc, distance_from_arc, foot_on
from cagepose.kernels.shapes.meeting import Meeting, meeting, twin_pair
from cagepose.kernels.shapes.rims import distance_at, middle_of_arc, reach_of_arc

ADVANCES = 6000
"""Steps for one pair of features; only where they graze each other more than some tens are taken."""
VISIT = 4
"""After so many of these steps another pair may be the one that can touch first."""
NEWTON = 12
"""Steps of Newton's method at most."""
ROUNDING, CONVERGES = 1e-3, 0.5
"""Fraction of the touch tolerance, below which a gap is a root; and fraction of such a gap, of which a step that leaves
more no longer helps."""


class Approach(NamedTuple):
    """How two features come nearer.

    Attributes
    ----------
    has_foot
        Whether there is a place on the arc, if one of them is one, that the other one is nearest to.
    gap
        No more than how far apart they are, of planes and lines without end; below zero: about how deep in each other,
        metres.
    speed, growth
        The gap falls no faster than this, metres for each unit of the amount; and how fast this may grow.
    apart, fastest
        How far apart they are as far as they reach, or less, and a speed that no point of the smaller one exceeds.
    """

    has_foot: bool
    gap: float
    speed: float
    growth: float
    apart: float
    fastest: float


@kernel
def are_curved(a: Shapes, i: int, b: Shapes, j: int) -> bool:
    """Whether first contact of two features is found here: of rims, and of edges with the sides of cones."""
    one, other = a.features[i], b.features[j]
    if one.kind == RIM or other.kind == RIM:
        return True
    return one.kind == EDGE and other.kind == EDGE and (one.taper != 0.0 or other.taper != 0.0)


@kernel
def away_from_arc(a: Shapes, i: int, b: Shapes, j: int) -> float:
    """Return a length that two features, one of which is an arc, are surely apart; below zero: none is known."""
    away = -math.inf
    if b.features[j].kind == RIM:
        away = away_from_rim(b.features[j], a, i)
    if a.features[i].kind == RIM:
        away = max(away, away_from_rim(a.features[i], b, j))
    return away


@kernel
def away_from_rim(rim: Feature, shapes: Shapes, i: int) -> float:
    other, middle, away = shapes.features[i], middle_of_arc(rim), -math.inf
    if other.kind == RIM or not keeps_radius(other):
        away = distance_at(other, middle)
    if keeps_radius(other):
        away = max(away, distance_from(shapes, i, middle) - other.radius)
    return away - reach_of_arc(rim)


@kernel
def ball_around(feature: Feature) -> tuple[Vector, float]:
    """Return middle and radius of a ball around the core of a vertex, an edge or an arc."""
    if feature.kind == RIM:
        return middle_of_arc(feature), reach_of_arc(feature)
    half = 0.5 * feature.length if feature.kind == EDGE else 0.0
    return plus(vector_from(feature.point), scaled(vector_from(feature.direction), half)), half


@kernel
def is_smaller(one: Feature, other: Feature) -> bool:
    """Whether a ball around the one says more than a ball around the other."""
    if one.kind == FACE or other.kind == FACE:
        return other.kind == FACE
    return ball_around(one)[1] <= ball_around(other)[1]


@kernel
def lines_apart(one: Feature, other: Feature) -> float:
    """Return how far apart two features are, of planes and lines without end, where they do not meet."""
    if one.kind == RIM or other.kind == RIM:
        rim, from_rim = (one, other) if one.kind == RIM else (other, one)
        if from_rim.kind == EDGE or from_rim.kind == RIM:
            return distance_from_arc(rim, from_rim)
        foot = foot_on(rim, from_rim)
        if from_rim.kind == FACE:
            across = minus(foot.point, vector_from(from_rim.point))
            return dot(vector_from(from_rim.direction), across) - from_rim.radius
        return norm(minus(foot.point, vector_from(from_rim.point))) - from_rim.radius
    return 0.0


@kernel
def gap_of(one: Feature, other: Feature, met: Meeting, level: float) -> float:
    """Return the gap of two features, of planes and lines without end.

    Where sharp ones are far apart their fences do not tell on which side of each other they are.
    """
    if not met.is_one:
        return lines_apart(one, other) if met.gap == math.inf else met.gap
    is_sharp = one.radius == other.radius == 0.0 and one.kind != FACE and other.kind != FACE
    return abs(met.gap) if is_sharp and abs(met.gap) > level else met.gap


@kernel
def second_pair(a: Shapes, i: int, b: Shapes, j: int) -> tuple[int, int]:
    """Return the features that meet at the last place on an arc, where these meet at the first; (-1, -1): an edge or
    another rim alone is nearest to an arc at two places.
    """
    if a.features[i].is_second or b.features[j].is_second:
        return -1, -1
    return twin_pair(a, i, b, j)


@kernel
def approach(moved: Shapes, i: int, b: Shapes, j: int, motion: Motion, level: float, of_arc: bool) -> Approach:
    """Return how feature i of the object, placed, and feature j of the cage come nearer; with ``of_arc``, all of an arc
    and what it meets, whether there is a foot or not.
    """
    one, other = moved.features[i], b.features[j]
    first = is_smaller(one, other)
    small, wide = (one, other) if first else (other, one)
    middle, reach = ball_around(small)
    way, spread = velocity_at(motion, middle), motion.rate * reach
    fastest, along = norm(way) + spread, vector_from(wide.direction)
    apart = 0.0
    if keeps_radius(small) and keeps_radius(wide):
        apart = distance_from(b, j, middle) if first else distance_from(moved, i, middle)
        apart -= reach + small.radius + wide.radius
    if of_arc:
        gap, has_foot = clearance_of_arc(one, other) if one.kind == RIM else clearance_of_arc(other, one), True
    else:
        met = meeting(moved, i, b, j)
        gap, has_foot = gap_of(one, other, met, level), met.is_one or (one.kind != RIM and other.kind != RIM)
        if met.is_one and small.kind == RIM:  # a circle that turns about its own axis goes nowhere
            way, spread = slower_of_circle(small, motion, way, spread)
    growth = motion.rate * (norm(way) + spread)
    if wide.kind == FACE:
        spread *= norm(cross(motion.axis, along))
        return Approach(has_foot, gap, abs(dot(way, along)) + spread, growth, apart, fastest)
    speed, growth = (fastest, 0.0) if wide.kind != EDGE else (speed_toward_side(wide, way) + spread, growth)
    if wide.kind == EDGE or (wide.kind == RIM and small.kind == RIM and first):  # all of it, not an arc of it
        slower, grows = speed_toward_round(wide, motion, middle, reach, fastest)
        if slower < speed:
            speed, growth = slower, grows
    return Approach(has_foot, gap, speed, growth, apart, fastest)


@kernel
def speed_toward_side(side: Feature, way: Vector) -> float:
    """Return how much of a velocity leads across an edge's side, at most."""
    along = vector_from(side.direction)
    rise = dot(way, along)
    return norm(minus(way, scaled(along, rise))) + abs(side.taper * rise)


@kernel
def speed_toward_round(
    wide: Feature, motion: Motion, middle: Vector, reach: float, fastest: float
) -> tuple[float, float]:
    """Return how fast, at most, a ball comes nearer to a side or a whole rim, and how fast this may grow, equation
    (2.15): by turning about its axis it comes no nearer. The ends of an arc of it do.
    """
    along, start = vector_from(wide.direction), vector_from(wide.point)
    on_axis = plus(start, scaled(along, dot(along, minus(middle, start))))
    way, lean = velocity_at(motion, on_axis), motion.rate * norm(cross(motion.axis, along))
    rise = dot(way, along)
    slope = 1.0 if wide.kind == RIM else abs(wide.taper)
    climbs = abs(rise) + lean * (norm(minus(middle, on_axis)) + reach)
    speed = norm(minus(way, scaled(along, rise))) + lean * reach + slope * climbs
    return speed, (1.0 + slope) * lean * fastest


@kernel
def slower_of_circle(rim: Feature, motion: Motion, way: Vector, spread: float) -> tuple[Vector, float]:
    """Return the velocity of a rim's centre, and how much faster than that the circle moves across itself; or those
    given, of the ball around an arc of it, if they are less.
    """
    of_center = velocity_at(motion, vector_from(rim.point))
    turning = motion.rate * abs(rim.length) * norm(cross(motion.axis, vector_from(rim.direction)))
    if norm(of_center) + turning < norm(way) + spread:
        return of_center, turning
    return way, spread


@kernel
def surely_clear(now: Approach, gap: float) -> float:
    """Return for how long features do not touch whose lines and planes are so far apart."""
    root = math.sqrt(now.speed * now.speed + 2.0 * now.growth * gap) + now.speed
    clear = 2.0 * gap / root if root > 0.0 else math.inf
    if now.apart > 0.0:
        clear = max(clear, now.apart / now.fastest if now.fastest > 0.0 else math.inf)
    return clear


@kernel
def root_of_gap(
    a: Shapes, i: int, b: Shapes, j: int, motion: Motion, amount: float, level: float, slack_m: float, moved: Shapes
) -> float:
    """Return where Newton's method leads on the gap of two features that come nearer; inf: nowhere."""
    root, least = math.inf, ROUNDING * slack_m / CONVERGES
    for _ in range(NEWTON):
        place_moved(a, i, motion, amount, moved)
        met = meeting(moved, i, b, j)
        closing = dot(met.normal, velocity_at(motion, met.place))
        if not met.is_one or closing <= 0.0:
            break
        left = abs(met.gap + level)
        if left <= ROUNDING * slack_m:
            if left >= CONVERGES * least:
                break
            root, least = amount, left
        amount += (met.gap + level) / closing
    return root


class Advance(NamedTuple):
    """Where two features touch first.

    Attributes
    ----------
    amount
        Inf: they do not, up to ``clear``.
    clear
        Inf: as far as was asked.
    behind
        How far behind the next root the search goes on, see `gone_on`.
    """

    amount: float
    clear: float
    behind: float


NOT_TOUCHING = Advance(math.inf, math.inf, 0.0)


@kernel
def advance(
    a: Shapes,
    i: int,
    b: Shapes,
    j: int,
    motion: Motion,
    begin: float,
    behind: float,
    end: float,
    level: float,
    slack: float,
    slack_m: float,
    steps: int,
    is_last: bool,
    moved: Shapes,
) -> Advance:
    """Look for the first contact of two features, see `first_touch`, from an amount before which they do not touch on,
    in so many steps. If these are the last ones, and graze, the features touch where they end.
    """
    amount, behind = begin, max(behind, BEHIND * end)
    for _ in range(steps):
        place_moved(a, i, motion, amount, moved)
        now = approach(moved, i, b, j, motion, level, False)
        if level > 0.0 and now.gap > level:
            level = 0.0
        value = now.gap + level
        if level == 0.0 and not now.has_foot and value <= slack_m:  # what comes there has met the next arc before
            return NOT_TOUCHING
        is_past = value < 0.0
        if -ROUNDING * slack_m <= value <= slack_m:
            root = max(root_of_gap(a, i, b, j, motion, amount, level, slack_m, moved), amount)
            if root <= end:
                if touches_after(a, i, b, j, motion, root, level, slack, slack_m, moved):
                    return Advance(root, root, behind)
                is_past = True
        step = surely_clear(now, abs(value))
        if step <= LEAST_STEP * end and touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved):
            return Advance(amount, amount, behind)
        if is_past and now.fastest > 0.0:  # a root that is no contact: on so short a way none is hidden that counts
            step = max(step, slack_m / now.fastest)
        if step >= end - amount:
            return NOT_TOUCHING
        amount, behind = gone_on(amount, step, end, behind)
        if amount >= end:
            return NOT_TOUCHING
    grazes = is_last and touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved)
    return Advance(amount if grazes else math.inf, math.inf if is_last else amount, behind)


@kernel
def clear_of_arc(
    a: Shapes, i: int, b: Shapes, j: int, motion: Motion, begin: float, end: float, close_m: float, moved: Shapes
) -> tuple[float, bool]:
    """Return until when an arc and what it meets, which do not touch before ``begin``, surely do not, in a few steps,
    inf: up to the end; and whether they are nearer than ``close_m`` then.
    """
    amount = begin
    for _ in range(VISIT):
        place_moved(a, i, motion, amount, moved)
        now = approach(moved, i, b, j, motion, 0.0, True)
        if now.gap <= close_m:
            return amount, True
        step = surely_clear(now, now.gap)
        if step >= end - amount:
            return math.inf, False
        amount += step
    return amount, False
