"""How fast the gap of two curved features may close, equations (2.14) and (2.15)."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, Feature
from cagepose.kernels.native.kernel import kernel


class Closing(NamedTuple):
    """The gap falls no faster than ``speed``, metres for each unit of the amount, and how fast this may grow."""

    speed: float
    growth: float


@kernel
def is_smaller(one: Feature, other: Feature) -> bool:
    """Whether the first of two features is a vertex, or the circle, or the smaller circle, or the shorter line."""
    if one.kind == VERTEX or other.kind == VERTEX:
        return bool(one.kind == VERTEX)
    if one.kind != other.kind:
        return bool(one.kind == CIRCLE)
    return bool(one.length <= other.length)


@kernel
def middle_of(feature: Feature) -> Vector:
    """Return a vertex, the centre of a circle, or the middle of a line."""
    if feature.kind != LINE:
        return vector_from(feature.point)
    return plus(vector_from(feature.point), scaled(vector_from(feature.direction), 0.5 * feature.length))


@kernel
def speed_toward_side(side: Feature, way: Vector) -> float:
    """Return how much of a velocity leads across a line's side, at most."""
    along = vector_from(side.direction)
    rise = dot(way, along)
    return norm(minus(way, scaled(along, rise))) + abs(side.taper * rise)


@kernel
def speed_toward_round(
    wide: Feature, motion: Motion, middle: Vector, reach: float, fastest: float
) -> tuple[float, float]:
    """Return how fast, at most, a ball comes nearer to a line's side or a whole circle, and how fast this may grow,
    equation (2.15): by turning about its axis it comes no nearer. The ends of an arc of it do.
    """
    along, start = vector_from(wide.direction), vector_from(wide.point)
    on_axis = plus(start, scaled(along, dot(along, minus(middle, start))))
    way, lean = velocity_at(motion, on_axis), motion.rate * norm(cross(motion.axis, along))
    rise = dot(way, along)
    slope = 1.0 if wide.kind == CIRCLE else abs(wide.taper)
    climbs = abs(rise) + lean * (norm(minus(middle, on_axis)) + reach)
    speed = norm(minus(way, scaled(along, rise))) + lean * reach + slope * climbs
    return speed, (1.0 + slope) * lean * fastest


@kernel
def closing_of(one: Feature, other: Feature, motion: Motion) -> Closing:
    """Return how fast a curved pair, a feature of the object at its place on the way and one of the cage, may come
    nearer: the velocity of the object's material at the smaller one, without what leads along the other one.
    """
    small, wide = (one, other) if is_smaller(one, other) else (other, one)
    middle, reach = middle_of(small), small.length if small.kind == CIRCLE else 0.5 * small.length
    way, along, spread = velocity_at(motion, middle), vector_from(wide.direction), motion.rate * reach
    fastest, growth = norm(way) + spread, motion.rate * (norm(way) + spread)
    if wide.kind == FACE:
        lean = norm(cross(motion.axis, along))
        spun = norm(cross(motion.axis, vector_from(small.direction)))  # a circle goes nowhere by turning about its axis
        return Closing(abs(dot(way, along)) + spread * min(lean, spun), growth * lean)
    speed, grows = fastest, 0.0
    if small.kind == CIRCLE:  # which goes nowhere by turning about its own axis
        speed = norm(way) + spread * norm(cross(motion.axis, vector_from(small.direction)))
    if wide.kind == LINE:
        across = speed_toward_side(wide, way) + spread
        if across < speed:
            speed, grows = across, growth
    if wide.kind == LINE or wide.kind == CIRCLE:
        slower, slower_grows = speed_toward_round(wide, motion, middle, reach, fastest)
        if slower < speed:
            speed, grows = slower, slower_grows
    return Closing(speed, grows)


@kernel
def surely_clear(now: Closing, gap: float) -> float:
    """Return for how long features do not touch that are so far apart."""
    if gap == math.inf:
        return math.inf
    root = math.sqrt(now.speed * now.speed + 2.0 * now.growth * gap) + now.speed
    return 2.0 * gap / root if root > 0.0 else math.inf
