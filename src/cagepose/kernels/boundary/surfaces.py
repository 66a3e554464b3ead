"""The surface of a feature in the frame of its body: how far a place is from it, and where a straight line crosses it.

A face, the round side of a line, the ball around a vertex and the tube around a circle have one; a sharp vertex, line
or circle has none.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.chart import beyond_trim, is_trimmed
from cagepose.kernels.boundary.features import CIRCLE, FACE, VERTEX, Boundary, Feature
from cagepose.kernels.boundary.reach import beyond_borders, beyond_bound
from cagepose.kernels.boundary.tube import (
    MOST_CROSSINGS,
    beside_tube,
    beyond_tube,
    distance_from_tube,
    tube_crossing,
)
from cagepose.kernels.native.kernel import kernel

PARALLEL = 1e-14
"""A line that makes a smaller sine with a plane does not cross it."""
FLATTEST = 1e-6
"""Cosine between a line and a normal: a flatter crossing is looked for no farther beyond the line's ends."""


class Crossing(NamedTuple):
    """Where a straight line crosses a surface.

    Attributes
    ----------
    is_one
        Whether it does.
    along
        Where on the line, metres.
    beyond
        How far this is beyond the bounds of the feature, metres; below zero: how far within.
    slope
        Cosine of the angle between the line and the outward normal.
    """

    is_one: bool
    along: float
    beyond: float
    slope: float


NO_CROSSING = Crossing(False, 0.0, 0.0, 0.0)


@kernel
def has_surface(feature: Feature) -> bool:
    return feature.kind == FACE or feature.radius != 0.0


@kernel
def most_crossings(feature: Feature) -> int:
    """Return how often a straight line crosses a surface at most."""
    if feature.kind == FACE:
        return 1
    return MOST_CROSSINGS if feature.kind == CIRCLE else 2


@kernel
def normal_of_face(own: Boundary, i: int) -> Vector:
    planes = own.planes
    return (planes[0, i], planes[1, i], planes[2, i])


@kernel
def height_over(own: Boundary, i: int, place: Vector) -> float:
    """Return how far a place is above the plane of a face, metres."""
    return dot(normal_of_face(own, i), place) - float(own.planes[3, i])


@kernel
def beyond_cone(own: Boundary, i: int, normal: Vector) -> float:
    """Return how far a direction is beyond the outward normals of a vertex or a line, a sine; -1: all are."""
    farthest = -1.0
    if not is_trimmed(own, i):
        for k in range(own.features[i].first_bound, own.features[i].last_bound):
            farthest = max(farthest, beyond_bound(own.bounds[k], normal))
    return farthest


@kernel
def slant_of_side(line: Feature) -> float:
    """Return the cosine of the taper of a round side, below zero of a hole's wall."""
    return math.copysign(math.sqrt(1.0 - line.taper * line.taper), line.radius)


@kernel
def out_of_axis(line: Feature, seen: Vector) -> Vector:
    """Return the unit vector from the axis of a line to a place seen from its point; of one on the axis, some."""
    axis = vector_from(line.direction)
    across = minus(seen, scaled(axis, dot(seen, axis)))
    across = minus(across, scaled(axis, dot(across, axis)))
    size = norm(across)
    if size > 0.0:
        return scaled(across, 1.0 / size)
    some = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.6 else (0.0, 1.0, 0.0)
    some = minus(some, scaled(axis, dot(some, axis)))
    return scaled(some, 1.0 / norm(some))


@kernel
def distance_from(own: Boundary, i: int, place: Vector, within_m: float) -> float:
    """Return how far a place is at least from a surface, metres: exactly so where its foot is within the bounds. Not
    exact if it is farther than a length.
    """
    feature = own.features[i]
    if feature.kind == CIRCLE:
        return distance_from_tube(feature, place)
    seen = minus(place, vector_from(feature.point))
    if feature.kind == FACE:
        normal = vector_from(feature.direction)
        height = dot(normal, seen)
        gap = abs(height - feature.radius)
        if gap >= within_m:
            return gap
        return math.hypot(gap, max(0.0, beyond_borders(own, i, minus(seen, scaled(normal, height)), within_m)))
    if feature.kind == VERTEX:
        rho, along = norm(seen), 0.0
        normal = scaled(seen, 1.0 / rho) if rho > 0.0 else (1.0, 0.0, 0.0)
        gap, other = rho - feature.radius, feature.radius
    else:
        axis, slant = vector_from(feature.direction), slant_of_side(feature)
        out, height = out_of_axis(feature, seen), dot(axis, seen)
        normal = plus(scaled(out, slant), scaled(axis, feature.taper))
        rho = dot(out, seen)
        gap = slant * rho + feature.taper * height - feature.radius
        other = abs(rho - slant * gap)
        foot = height - feature.taper * (gap + feature.radius)
        along = max(0.0, -foot, foot - feature.length * slant * slant)
        if is_trimmed(own, i) and abs(gap) < within_m:
            beyond = max(0.0, beyond_trim(own, i, normal, foot / (slant * slant)))
            return math.hypot(gap, min(1.0, rho / other) * beyond if other > 0.0 else beyond)
    if abs(gap) >= within_m:
        return abs(gap)
    aside = max(0.0, beyond_cone(own, i, normal))
    return math.sqrt(gap * gap + along * along + aside * aside * rho * other)


@kernel
def crossing(own: Boundary, i: int, start: Vector, way: Vector, end: float, slack_m: float, which: int) -> Crossing:
    """Return where a straight line from a place along a unit vector crosses a surface, up to a length from there, or
    where it is less than a slack above the surface. ``which`` counts the crossings from zero on, in no order, see
    `most_crossings`.
    """
    feature = own.features[i]
    if feature.kind == CIRCLE:
        return _through_tube(feature, start, way, end, slack_m, which)
    seen = minus(start, vector_from(feature.point))
    if feature.kind == FACE:
        normal = vector_from(feature.direction)
        slope = dot(way, normal)
        if which == 1 or abs(slope) < PARALLEL:
            return NO_CROSSING
        along = (feature.radius - dot(seen, normal)) / slope
        if _is_off(along, slope, end, slack_m):
            return NO_CROSSING
        core = minus(plus(seen, scaled(way, along)), scaled(normal, feature.radius))
        return Crossing(True, along, beyond_borders(own, i, core, slack_m), slope)
    if feature.kind == VERTEX:
        return _through_ball(own, i, seen, way, end, slack_m, which)
    return _through_side(own, i, seen, way, end, slack_m, which)


@kernel
def _is_off(along: float, slope: float, end: float, slack_m: float) -> bool:
    """Whether a crossing is beyond the ends of a line and higher above it than a slack."""
    room = slack_m / max(abs(slope), FLATTEST)
    return along < -room or along > end + room


@kernel
def _root(a: float, half_b: float, c: float, which: int) -> tuple[bool, float]:
    """Return one of the roots of a t^2 + 2 half_b t + c, if it has one."""
    square = half_b * half_b - a * c
    if square < 0.0:
        return False, 0.0
    q = -(half_b + math.copysign(math.sqrt(square), half_b))
    if which == 0:
        return (True, c / q) if q != 0.0 else (a != 0.0, 0.0)
    return (True, q / a) if abs(a) > PARALLEL and q != 0.0 else (False, 0.0)


@kernel
def _through_ball(own: Boundary, i: int, seen: Vector, way: Vector, end: float, slack_m: float, which: int) -> Crossing:
    radius = own.features[i].radius
    is_one, along = _root(1.0, dot(seen, way), dot(seen, seen) - radius * radius, which)
    if not is_one:
        return NO_CROSSING
    normal = scaled(plus(seen, scaled(way, along)), 1.0 / radius)
    slope = dot(way, normal)
    if _is_off(along, slope, end, slack_m):
        return NO_CROSSING
    return Crossing(True, along, radius * beyond_cone(own, i, normal), slope)


@kernel
def _through_tube(circle: Feature, start: Vector, way: Vector, end: float, slack_m: float, which: int) -> Crossing:
    is_one, along = tube_crossing(circle, start, way, which)
    if not is_one:
        return NO_CROSSING
    at = beside_tube(circle, plus(start, scaled(way, along)))
    slope = dot(way, at.normal)
    if _is_off(along, slope, end, slack_m):
        return NO_CROSSING
    return Crossing(True, along, beyond_tube(circle, at), slope)


@kernel
def _through_side(own: Boundary, i: int, seen: Vector, way: Vector, end: float, slack_m: float, which: int) -> Crossing:
    """On a side, slant rho + taper height = radius."""
    line = own.features[i]
    axis, slant = vector_from(line.direction), slant_of_side(line)
    height, rise, taper, square = dot(axis, seen), dot(axis, way), line.taper, slant * slant
    across, aside = minus(seen, scaled(axis, height)), minus(way, scaled(axis, rise))
    left = line.radius - taper * height
    is_one, along = _root(
        square * dot(aside, aside) - taper * taper * rise * rise,
        square * dot(across, aside) + left * taper * rise,
        square * dot(across, across) - left * left,
        which,
    )
    if not is_one:
        return NO_CROSSING
    there = plus(seen, scaled(way, along))
    level = dot(axis, there)
    if (line.radius - taper * level) * line.radius < 0.0:  # beyond the tip
        return NO_CROSSING
    out = out_of_axis(line, there)
    normal = plus(scaled(out, slant), scaled(axis, taper))
    slope = dot(way, normal)
    if _is_off(along, slope, end, slack_m):
        return NO_CROSSING
    foot = level - taper * line.radius
    beyond = max(-foot, foot - line.length * square, beyond_trim(own, i, normal, foot / square))
    return Crossing(True, along, max(beyond, dot(out, there) * beyond_cone(own, i, normal)), slope)
