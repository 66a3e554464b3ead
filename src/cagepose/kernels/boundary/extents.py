"""How far apart two features surely are, told before anything is searched: by boxes around them, and by what is between
a circle as a whole and what it meets.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, Feature
from cagepose.kernels.boundary.tree import PlacedBox, boxes_apart
from cagepose.kernels.native.kernel import kernel


@kernel
def extent_of(feature: Feature) -> PlacedBox:
    """Return the box of the world around a placed feature as far as it reaches; of a face it has no end."""
    point, direction = vector_from(feature.point), vector_from(feature.direction)
    radius = abs(feature.radius)
    if feature.kind == VERTEX:
        return PlacedBox(point, (radius, radius, radius))
    if feature.kind == LINE:
        along = scaled(direction, 0.5 * feature.length)
        return PlacedBox(plus(point, along), (abs(along[0]) + radius, abs(along[1]) + radius, abs(along[2]) + radius))
    if feature.kind == CIRCLE:
        return PlacedBox(
            point,
            (
                feature.length * across_of(direction[0]) + radius,
                feature.length * across_of(direction[1]) + radius,
                feature.length * across_of(direction[2]) + radius,
            ),
        )
    return PlacedBox(point, (math.inf, math.inf, math.inf))


@kernel
def across_of(cosine: float) -> float:
    return math.sqrt(max(0.0, 1.0 - cosine * cosine))


@kernel
def circle_apart(circle: Feature, other: Feature) -> float:
    """Return a length that the gap of a circle and another feature, as far as that goes on without end, nowhere is
    below: by where its centre is, and how it leans.
    """
    center, axis = vector_from(circle.point), vector_from(circle.direction)
    along, radius = vector_from(other.direction), circle.radius
    seen = minus(center, vector_from(other.point))
    height = dot(along, seen)
    if other.kind == VERTEX:
        return abs(norm(seen) - circle.length) - other.radius - radius
    lean = norm(cross(axis, along))
    if other.kind == FACE:
        return height - circle.length * lean - other.radius - radius
    across = norm(minus(seen, scaled(along, height)))
    if other.kind == CIRCLE:
        nearest, farthest = math.hypot(height, across - other.length), math.hypot(height, across + other.length)
        return max(nearest - circle.length, circle.length - farthest) - other.radius - radius
    # a straight edge, a round side or the wall of a hole, of which the circle is on one side
    slant, climbs = across_of(other.taper), abs(other.taper) * circle.length * lean
    sense = math.copysign(1.0, other.radius)
    rho = across + circle.length
    if sense > 0.0:
        upright = abs(dot(axis, along))
        rho = max(0.0, across - circle.length, circle.length * upright - across)
    return sense * slant * rho + other.taper * height - climbs - other.radius - radius


@kernel
def surely_apart(one: Feature, box: PlacedBox, other: Feature) -> float:
    """Return a length that two placed features surely are apart, the first one with the box around it; below zero: none
    is known.
    """
    apart = boxes_apart(box, extent_of(other))
    if one.kind == CIRCLE:
        return max(apart, circle_apart(one, other))
    return max(apart, circle_apart(other, one)) if other.kind == CIRCLE else apart
