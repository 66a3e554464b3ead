"""Where features end: whether a place lies on one, and a normal is one of its outward normals, equation (2.11)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.chart import beyond_trim, is_trimmed
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
    if feature.first_bound < feature.last_bound and not is_trimmed(body.own, i):
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
        has_segments, normal = True, vector_from(feature.direction)
        nearest = min(nearest, distance_from_segment(bound, seen, normal))
        is_within = is_within != crosses(bound, seen, vector_from(feature.toward), normal)
    if not has_segments:
        return farthest
    return max(farthest, -nearest if is_within else nearest)


@kernel
def distance_from_segment(segment: Bound, place: Vector, normal: Vector) -> float:
    """Return how far a place is from a segment, which may be an arc in the plane with a unit normal."""
    start, end = vector_from(segment.direction), vector_from(segment.end)
    along, seen = minus(end, start), minus(place, start)
    if segment.limit != 0.0:
        center, radius = center_of(segment, normal), 1.0 / abs(segment.limit)
        arm = minus(place, center)
        away = norm(arm)
        if away > 0.0 and bulge_at(segment, plus(center, scaled(arm, radius / away)), normal) >= 0.0:
            return abs(away - radius)
        return min(norm(seen), norm(minus(place, end)))
    share = min(max(dot(along, seen) / dot(along, along), 0.0), 1.0)
    return norm(minus(seen, scaled(along, share)))


@kernel
def center_of(arc: Bound, normal: Vector) -> Vector:
    """Return the centre of a segment that is an arc in the plane with a unit normal."""
    start, end = vector_from(arc.direction), vector_from(arc.end)
    along, radius = minus(end, start), 1.0 / arc.limit
    half = 0.5 * norm(along)
    away = math.copysign(math.sqrt(max(0.0, radius * radius - half * half)), radius)
    return plus(scaled(plus(start, end), 0.5), scaled(cross(normal, along), 0.5 * away / half))


@kernel
def bulge_at(arc: Bound, place: Vector, normal: Vector) -> float:
    """Return how far a place is from the chord of a segment that is an arc, to the side of the arc, metres."""
    start = vector_from(arc.direction)
    along = minus(vector_from(arc.end), start)
    aside = dot(cross(along, normal), minus(place, start)) / norm(along)
    return aside if arc.limit > 0.0 else -aside


@kernel
def crosses(segment: Bound, place: Vector, toward: Vector, normal: Vector) -> bool:
    """Whether a ray from a place in a plane along ``toward``, which is in the plane, crosses a segment an odd number of
    times. It crosses a straight one whose start is not below the ray, and its end is, or the other way round; an arc,
    as its chord, unless the place is between the two.
    """
    start, end = minus(vector_from(segment.direction), place), minus(vector_from(segment.end), place)
    aside = cross(normal, toward)
    below, above = dot(start, aside), dot(end, aside)
    is_crossed = False
    if (below < 0.0) != (above < 0.0):
        share = below / (below - above)
        is_crossed = dot(plus(scaled(start, 1.0 - share), scaled(end, share)), toward) > 0.0
    if segment.limit != 0.0 and bulge_at(segment, place, normal) > 0.0:
        between = norm(minus(place, center_of(segment, normal))) * abs(segment.limit) < 1.0
        return is_crossed != between
    return is_crossed


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
        if is_trimmed(body.own, i) and beyond_trim(body.own, i, in_body(body, normal), along) > slack_m:
            return False
    if feature.kind == CIRCLE and not is_on_arc(feature, angle_toward(circle_of(feature), core), slack_m):
        return False
    return beyond_normals(body, i, normal, core) <= slack
