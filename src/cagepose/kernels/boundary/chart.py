"""Round sides that borders trim: where a place is in the chart of one, and how far beyond its borders."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, vector_from
from cagepose.kernels.boundary.features import LINE, SEGMENT, Bound, Boundary
from cagepose.kernels.circles.places import within_turn
from cagepose.kernels.native.kernel import kernel


@kernel
def is_trimmed(own: Boundary, i: int) -> bool:
    """Whether a feature is a round side with borders."""
    feature = own.features[i]
    is_side = feature.kind == LINE and feature.radius != 0.0 and feature.first_bound < feature.last_bound
    return bool(is_side and own.bounds[feature.first_bound].kind == SEGMENT)


class ChartPlace(NamedTuple):
    """A place in the chart of a round side.

    Attributes
    ----------
    angle, height
        About the axis, radians, and along it, metres, as `Bound` has them.
    radius, slant
        Metres on the side for a radian, and for a metre of height.
    """

    angle: float
    height: float
    radius: float
    slant: float


@kernel
def chart_place(own: Boundary, i: int, normal: Vector, height: float) -> ChartPlace:
    """Return where an outward normal, in the frame of the body, and a height are in the chart of a round side."""
    line = own.features[i]
    toward, axis = vector_from(line.toward), vector_from(line.direction)
    sense, slant = math.copysign(1.0, line.radius), math.sqrt(1.0 - line.taper * line.taper)
    angle = math.atan2(sense * dot(normal, cross(axis, toward)), sense * dot(normal, toward))
    return ChartPlace(angle, height, slant * abs(line.radius - line.taper * height), slant)


@kernel
def wide_of(border: Bound) -> float:
    """Return the angle from the start of a border to its end, less than half a turn."""
    wide: float = within_turn(border.end[0] - border.direction[0])
    return wide


@kernel
def start_in_chart(border: Bound, at: ChartPlace) -> float:
    """Return by which angle the start of a border is ahead of a place, of the turn in which its middle is nearest."""
    half = 0.5 * wide_of(border)
    ahead: float = within_turn(border.direction[0] + half - at.angle) - half
    return ahead


@kernel
def distance_in_chart(border: Bound, at: ChartPlace) -> float:
    """Return how far a place of a round side is from a border of it, metres."""
    wide, high = wide_of(border), at.slant * (border.end[1] - border.direction[1])
    start, low = start_in_chart(border, at), at.slant * (border.direction[1] - at.height)
    across = at.radius * wide
    share = min(max(-(at.radius * start * across + low * high) / (across * across + high * high), 0.0), 1.0)
    chord = 2.0 * at.radius * math.sin(min(0.5 * abs(start + share * wide), 0.5 * math.pi))
    return math.hypot(chord, low + share * high)


@kernel
def beyond_trim(own: Boundary, i: int, normal: Vector, height: float) -> float:
    """Return how far a place of a round side is beyond the borders that trim it, metres, below zero: within; -inf: none
    do. The outward normal there is given in the frame of the body, the height along the axis as `Feature.length` is.
    """
    if not is_trimmed(own, i):
        return -math.inf
    line, at, nearest, is_within = own.features[i], chart_place(own, i, normal, height), math.inf, False
    for k in range(line.first_bound, line.last_bound):
        border = own.bounds[k]
        nearest = min(nearest, distance_in_chart(border, at))
        # it crosses the way to the wide end, where there is a border always: asked of each corner by itself, so that
        # two borders that meet in a corner have it on the same side, however near to it the way passes
        start, end = within_turn(border.direction[0] - at.angle), within_turn(border.end[0] - at.angle)
        if (start < 0.0) != (end < 0.0) and abs(end - start) < math.pi:
            level = border.direction[1] - (border.end[1] - border.direction[1]) * start / (end - start)
            is_within = is_within != (level < height)
    return -nearest if is_within else nearest
