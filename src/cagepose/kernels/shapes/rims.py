"""Round rims, in arcs: their points, normals and ends, and what lies flat on them.

A rim is a row of vertices without end: what meets it meets one of them, its foot, see `feet`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, RIM, VERTEX, Feature

ARCS = 8
"""One circle has so many arcs."""
HALF_ARC = math.pi / ARCS
SEARCHED = 1.05 * HALF_ARC
"""To each side of an arc's middle: a little beyond its ends."""
EQUALLY_FAR = 0.5
"""In touch tolerances: where distances along an arc differ by more, its vertices may not have the normal that it
has."""
REACH = 2.0 * math.sin(0.5 * SEARCHED)
"""Distance of the farthest point of an arc from its middle, in radii."""


class Foot(NamedTuple):
    """A point of an arc that another feature is nearest to.

    Attributes
    ----------
    is_within
        Whether it is nearest among its neighbours, too; else there is no such point.
    point
        In the world.
    tangent
        Unit vector along the rim there.
    """

    is_within: bool
    point: Vector
    tangent: Vector


class OnAxis(NamedTuple):
    """What of an edge is nearest to a point: a place on its axis, where it has a radius, and how far the point is from
    there, below zero in a hole.
    """

    place: Vector
    radius: float
    away: float


@kernel
def nearest_on_edge(edge: Feature, point: Vector) -> OnAxis:
    """Return what of an edge's line is nearest to a point."""
    along = vector_from(edge.direction)
    seen = minus(point, vector_from(edge.point))
    height = dot(along, seen)
    if edge.taper != 0.0:
        side = norm(minus(seen, scaled(along, height))) / math.sqrt(1.0 - edge.taper * edge.taper)
        height -= math.copysign(side, edge.radius) * edge.taper
    place = plus(vector_from(edge.point), scaled(along, height))
    radius = edge.radius - edge.taper * height
    return OnAxis(place, radius, math.copysign(norm(minus(point, place)), edge.radius))


@kernel
def outward_at(rim: Feature, point: Vector) -> Vector:
    """Return the outward normal along the flat end, at a point of a rim."""
    return scaled(minus(point, vector_from(rim.point)), 1.0 / rim.length)


@kernel
def on_rim(rim: Feature, angle: float, is_within: bool) -> Foot:
    """Return the point of a rim at an angle from its arc's middle."""
    return towards(rim, math.cos(angle), math.sin(angle), is_within)


@kernel
def towards(rim: Feature, cosine: float, sine: float, is_within: bool) -> Foot:
    """Return the point of a rim at an angle with this cosine and sine from its arc's middle."""
    toward, axis = vector_from(rim.toward), vector_from(rim.direction)
    outward = plus(scaled(toward, cosine), scaled(cross(axis, toward), sine))
    return Foot(is_within, plus(vector_from(rim.point), scaled(outward, rim.length)), cross(axis, outward))


@kernel
def nearest_on_rim(rim: Feature, point: Vector) -> Vector:
    """Return the point of a whole rim that is nearest to a point."""
    axis = vector_from(rim.direction)
    seen = minus(point, vector_from(rim.point))
    across = minus(seen, scaled(axis, dot(seen, axis)))
    size = norm(across)
    if size == 0.0:
        across, size = vector_from(rim.toward), 1.0
    return plus(vector_from(rim.point), scaled(across, abs(rim.length) / size))


@kernel
def distance_at(other: Feature, point: Vector) -> float:
    """Return how far a point of a rim is from an edge's side or another rim."""
    if other.kind == EDGE:
        nearest = nearest_on_edge(other, point)
        return nearest.away - nearest.radius
    return norm(minus(point, nearest_on_rim(other, point)))


@kernel
def is_on_arc(rim: Feature, point: Vector, slack_m: float) -> bool:
    """Whether a point of a rim is on its arc, to a length beyond its ends."""
    return dot(outward_at(rim, point), vector_from(rim.toward)) >= math.cos(HALF_ARC) - slack_m / abs(rim.length)


@kernel
def is_near_arc(rim: Feature, point: Vector) -> bool:
    """Whether a point of a rim is on an arc or on the half that is nearer of one next to it."""
    return dot(outward_at(rim, point), vector_from(rim.toward)) >= math.cos(2.0 * HALF_ARC)


@kernel
def beyond_normals(rim: Feature, point: Vector, normal: Vector) -> float:
    """Return how far a direction across the tangent is beyond the outward normals of a rim at one of its points, a
    sine.
    """
    out, along = dot(outward_at(rim, point), normal), dot(vector_from(rim.direction), normal)
    below = rim.taper * out - math.sqrt(1.0 - rim.taper * rim.taper) * along
    return max(below, math.sqrt(1.0 - rim.end_taper * rim.end_taper) * along - rim.end_taper * out)


@kernel
def middle_of_arc(rim: Feature) -> Vector:
    return plus(vector_from(rim.point), scaled(vector_from(rim.toward), rim.length))


@kernel
def end_of_arc(rim: Feature, side: float) -> Vector:
    """Return the end of an arc before (side -1) or after its middle."""
    return on_rim(rim, side * HALF_ARC, True).point


@kernel
def reach_of_arc(rim: Feature) -> float:
    return REACH * abs(rim.length)


@kernel
def lie_flat(one: Feature, other: Feature, touch_m: float) -> bool:
    """Whether a face, a ball or a round side lies on all of an arc of a rim, to the touch tolerance: then the rim's
    vertices tell all.
    """
    rim, on_rim = (one, other) if one.kind == RIM else (other, one)
    if rim.kind != RIM or on_rim.kind == RIM:
        return False
    if on_rim.kind == EDGE:
        return lies_along(rim, on_rim, touch_m)
    axis, way, away = vector_from(rim.direction), vector_from(on_rim.direction), 1.0
    if on_rim.kind == VERTEX:
        way = minus(vector_from(on_rim.point), vector_from(rim.point))
        away = math.hypot(rim.length, norm(way))
    return abs(rim.length) * norm(cross(axis, way)) <= touch_m * away


@kernel
def is_vertex_of_rim(feature: Feature) -> bool:
    return bool(feature.kind == VERTEX and feature.length != 0.0)


@kernel
def is_rim_on_side(one: Feature, other: Feature) -> bool:
    """Whether one of two features is a vertex of a rim and the other one a round side."""
    return bool((is_vertex_of_rim(one) and other.kind == EDGE) or (is_vertex_of_rim(other) and one.kind == EDGE))


@kernel
def is_rim_on_wall(one: Feature, other: Feature) -> bool:
    """Whether one of two features is of a rim, be it an arc or a vertex, and the other one the wall of a hole."""
    if one.kind == EDGE:
        return bool(one.radius < 0.0 and (other.kind == RIM or is_vertex_of_rim(other)))
    return bool(other.kind == EDGE and other.radius < 0.0 and (one.kind == RIM or is_vertex_of_rim(one)))


@kernel
def lies_along(rim: Feature, side: Feature, touch_m: float) -> bool:
    """Whether a round side lies on all of an arc: at its ends and in its middle they are equally far apart."""
    first, middle = distance_at(side, end_of_arc(rim, -1.0)), distance_at(side, middle_of_arc(rim))
    last = distance_at(side, end_of_arc(rim, 1.0))
    least, most = min(first, middle, last), max(first, middle, last)
    return most - least <= EQUALLY_FAR * touch_m and max(most, -least) <= touch_m
