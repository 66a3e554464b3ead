"""Lines whose radii change along them, as the sides of cones: what of one is nearest to a point, and how two cross."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import Feature
from cagepose.kernels.boundary.met import Meeting, apart
from cagepose.kernels.native.kernel import kernel


class OnAxis(NamedTuple):
    """What of a line is nearest to a point: a place on its axis, and its radius there."""

    place: Vector
    radius: float


@kernel
def nearest_on_axis(line: Feature, point: Vector) -> OnAxis:
    """Return what of a line, as far as its axis leads, is nearest to a point."""
    along = vector_from(line.direction)
    seen = minus(point, vector_from(line.point))
    height = dot(along, seen)
    if line.taper != 0.0:
        side = norm(minus(seen, scaled(along, height))) / math.sqrt(1.0 - line.taper * line.taper)
        height -= math.copysign(side, line.radius) * line.taper
    return OnAxis(plus(vector_from(line.point), scaled(along, height)), line.radius - line.taper * height)


@kernel
def tapered_lines(one: Feature, other: Feature, start: Vector, crossed: Vector, sine: float) -> Meeting:
    """Two lines that cross, whose radii change along them: for tapers s and s' the normal has n.u = s, n.w = -s'."""
    u, w = vector_from(one.direction), vector_from(other.direction)
    cosine, square = dot(u, w), sine * sine
    along, other_along = (one.taper + other.taper * cosine) / square, (-other.taper - one.taper * cosine) / square
    beyond = 1.0 - along * one.taper + other_along * other.taper
    if beyond <= 0.0:
        return apart()
    across = math.copysign(math.sqrt(beyond), dot(start, crossed)) / sine
    normal = plus(plus(scaled(u, along), scaled(w, other_along)), scaled(crossed, across))
    gap = dot(normal, start) - one.radius - other.radius
    distance = dot(start, crossed) / (across * square)
    s = dot(cross(minus(start, scaled(normal, distance)), w), crossed) / square
    core = plus(vector_from(one.point), scaled(u, s))
    return Meeting(True, gap, normal, plus(core, scaled(normal, one.radius - one.taper * s)))
