"""Where features end: whether a place lies on one, and a normal is one of its outward normals, equation (2.11)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import beyond_circle, circle_of, is_on_arc, outward_at
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    HALF_SPACE,
    INSIDE,
    LINE,
    SEGMENT,
    Bound,
    Boundary,
    PlacedBoundary,
    in_body,
    seen_from_feature,
)
from cagepose.kernels.circles.places import angle_toward
from cagepose.kernels.native.kernel import kernel


@kernel
def beyond_bound(bound: Bound, x: Vector) -> float:
    """Return how far a normal or a place is beyond a half-space or a circle; below zero: within it."""
    direction = vector_from(bound.direction)
    if bound.kind == HALF_SPACE:
        return dot(direction, x) - bound.limit
    away = norm(minus(x, direction)) - bound.limit
    return away if bound.kind == INSIDE else -away


@kernel
def beyond_normals(body: PlacedBoundary, i: int, normal: Vector, core: Vector) -> float:
    """Return how far a direction is beyond the outward normals of a vertex, a line or, at a place of it, a circle, a
    sine; -inf: all directions are.
    """
    feature = body.own.features[i]
    if feature.kind == CIRCLE:
        return beyond_circle(body.features[i], outward_at(body.features[i], core), normal)
    farthest = -math.inf
    if feature.first_bound < feature.last_bound:
        seen = in_body(body, normal)
        for k in range(feature.first_bound, feature.last_bound):
            farthest = max(farthest, beyond_bound(body.own.bounds[k], seen))
    return farthest


@kernel
def beyond_face(body: PlacedBoundary, i: int, place: Vector) -> float:
    """Return how far a place in the plane of a face is beyond its bounds, metres; below zero: how far within."""
    return beyond_borders(body.own, i, seen_from_feature(body, i, place), math.inf)


@kernel
def beyond_borders(own: Boundary, i: int, seen: Vector, enough_m: float) -> float:
    """Return how far a place is beyond the bounds of a face, as seen from its point, in the frame of the body; how far
    at least, if that is farther than enough.
    """
    feature = own.features[i]
    farthest, nearest, is_within, has_segments = -math.inf, math.inf, False, False
    for k in range(feature.first_bound, feature.last_bound):
        bound = own.bounds[k]
        if bound.kind != SEGMENT:
            farthest = max(farthest, beyond_bound(bound, seen))
            if farthest > enough_m:
                return farthest
            continue
        has_segments = True
        nearest = min(nearest, distance_from_segment(bound, seen))
        is_within = is_within != crosses(bound, seen, vector_from(feature.toward), vector_from(feature.direction))
    if not has_segments:
        return farthest
    return max(farthest, -nearest if is_within else nearest)


@kernel
def distance_from_segment(segment: Bound, place: Vector) -> float:
    """Return how far a place is from a segment."""
    start, end = vector_from(segment.direction), vector_from(segment.end)
    along, seen = minus(end, start), minus(place, start)
    share = min(max(dot(along, seen) / dot(along, along), 0.0), 1.0)
    return norm(minus(seen, scaled(along, share)))


@kernel
def crosses(segment: Bound, place: Vector, toward: Vector, normal: Vector) -> bool:
    """Whether a ray from a place in a plane along ``toward``, which is in the plane, crosses a segment: its start is
    not below the ray, and its end is, or the other way round.
    """
    start, end = minus(vector_from(segment.direction), place), minus(vector_from(segment.end), place)
    aside = cross(normal, toward)
    below, above = dot(start, aside), dot(end, aside)
    if (below < 0.0) == (above < 0.0):
        return False
    share = below / (below - above)
    return dot(plus(scaled(start, 1.0 - share), scaled(end, share)), toward) > 0.0


@kernel
def reaches(body: PlacedBoundary, i: int, normal: Vector, core: Vector, slack: float, slack_m: float) -> bool:
    """Whether a feature has this outward normal at this place of its core, to a sine and a length beyond its end."""
    feature = body.features[i]
    if feature.kind == FACE:
        return beyond_face(body, i, core) <= slack_m
    if feature.kind == LINE:
        seen = minus(core, vector_from(feature.point))
        along = dot(vector_from(feature.direction), seen) / (1.0 - feature.taper * feature.taper)
        if along < -slack_m or along > feature.length + slack_m:
            return False
    if feature.kind == CIRCLE and not is_on_arc(feature, angle_toward(circle_of(feature), core), slack_m):
        return False
    return beyond_normals(body, i, normal, core) <= slack
