"""Circles among the features of a boundary: their places, outward normals, and which places are on their arc."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, scaled, vector_from
from cagepose.kernels.boundary.features import Feature
from cagepose.kernels.circles.places import Circle, within_turn
from cagepose.kernels.native.kernel import kernel

WHOLE_TURN = 2.0 * math.pi - 1e-9
"""Radians: a wider arc is a whole circle."""


@kernel
def circle_of(feature: Feature) -> Circle:
    """Return the whole circle that a feature is on."""
    return Circle(
        vector_from(feature.point), vector_from(feature.direction), vector_from(feature.toward), feature.length
    )


@kernel
def outward_at(circle: Feature, point: Vector) -> Vector:
    """Return the unit vector from the axis of a circle toward a point; of one on the axis, some."""
    axis = vector_from(circle.direction)
    seen = minus(point, vector_from(circle.point))
    across = minus(seen, scaled(axis, dot(seen, axis)))
    size = norm(across)
    return scaled(across, 1.0 / size) if size > 0.0 else vector_from(circle.toward)


@kernel
def is_on_arc(circle: Feature, angle: float, slack_m: float) -> bool:
    """Whether the place of a circle at an angle is on its arc, to a length beyond its ends."""
    if circle.width >= WHOLE_TURN:
        return True
    away = within_turn(angle - circle.start - 0.5 * circle.width)
    return abs(away) <= 0.5 * circle.width + slack_m / circle.length


@kernel
def beyond_circle(circle: Feature, outward: Vector, normal: Vector) -> float:
    """Return how far a direction across the tangent is beyond the outward normals of a circle at a place, a sine; -1:
    all are.
    """
    out, along = dot(outward, normal), dot(vector_from(circle.direction), normal)
    below = math.sin(circle.low) * out - math.cos(circle.low) * along
    above = math.cos(circle.high) * along - math.sin(circle.high) * out
    if circle.high - circle.low <= math.pi:
        return max(below, above)
    return min(below, above) if circle.high - circle.low < WHOLE_TURN else -1.0
