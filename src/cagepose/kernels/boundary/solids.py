"""How deep a point is in a convex solid of a body, and what of the solid is nearest to it."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import HALF_SPACE, TURNED, Bound, Boundary, Cover
from cagepose.kernels.native.kernel import kernel

IN_PLANE = 1e-3
"""In touch tolerances: a point that is no farther beyond the sides of a face is over it."""


class Nearest(NamedTuple):
    """What of a solid is nearest to a point: itself, if it is inside; and how deep it is, below zero: how far away."""

    point: Vector
    depth: float


@kernel
def nearest_in(own: Boundary, which: int, point: Vector) -> Nearest:
    """Return what of a solid is nearest to a point, all in the frame of the body."""
    cover, origin = own.covers[which], vector_from(own.covers[which].point)
    seen = minus(point, origin)
    near = nearest_in_turned(cover, seen) if cover.kind == TURNED else nearest_in_hull(own.bounds, cover, seen)
    return Nearest(plus(near.point, origin), near.depth)


@kernel
def nearest_in_turned(cover: Cover, seen: Vector) -> Nearest:
    """Return what of a turned solid is nearest to a point, both seen from its first end."""
    axis, rise, narrows = vector_from(cover.axis), cover.length, cover.radius - cover.other_radius
    height = dot(axis, seen)
    across = minus(seen, scaled(axis, height))
    away, slant = norm(across), math.hypot(rise, narrows)
    beyond_side = ((away - cover.radius) * rise + height * narrows) / slant
    beyond = max(-height, height - rise, beyond_side)
    if beyond <= 0.0:
        return Nearest(seen, -beyond)
    share = min(max((height * rise - (away - cover.radius) * narrows) / (slant * slant), 0.0), 1.0)
    wide, level = cover.radius - share * narrows, share * rise
    distance = math.hypot(away - wide, height - level)
    low, high = min(away, cover.radius), min(away, cover.other_radius)
    if math.hypot(away - low, height) < distance:
        wide, level, distance = low, 0.0, math.hypot(away - low, height)
    if math.hypot(away - high, height - rise) < distance:
        wide, level, distance = high, rise, math.hypot(away - high, height - rise)
    out = scaled(across, wide / away) if away > 0.0 else across
    return Nearest(plus(out, scaled(axis, level)), -distance)


@kernel
def nearest_in_hull(bounds: Rows[Bound], cover: Cover, seen: Vector) -> Nearest:
    """Return what of a hull, rounded or sharp, is nearest to a point, both seen from the hull's own point."""
    beyond = beyond_planes(bounds, cover, seen)
    if -math.inf < beyond <= 0.0:
        return Nearest(seen, cover.radius - beyond)
    nearest, away = seen, math.inf
    for k in range(cover.first_bound, cover.last_bound):
        bound = bounds[k]
        if bound.kind == HALF_SPACE:
            height = dot(vector_from(bound.direction), seen) - bound.limit
            if not 0.0 < height < away:
                continue
            foot = minus(seen, scaled(vector_from(bound.direction), height))
            if beyond_planes(bounds, cover, foot) > IN_PLANE * cover.touch_m:
                continue
        else:
            foot = nearest_on_segment(bound, seen)
        distance = norm(minus(seen, foot))
        if distance < away:
            nearest, away = foot, distance
    if away <= cover.radius:
        return Nearest(seen, cover.radius - away)
    return Nearest(plus(nearest, scaled(minus(seen, nearest), cover.radius / away)), cover.radius - away)


@kernel
def beyond_planes(bounds: Rows[Bound], cover: Cover, seen: Vector) -> float:
    """Return how far a point is above the highest plane of a hull; -inf: it has none."""
    beyond = -math.inf
    for k in range(cover.first_bound, cover.last_bound):
        if bounds[k].kind == HALF_SPACE:
            beyond = max(beyond, dot(vector_from(bounds[k].direction), seen) - bounds[k].limit)
    return beyond


@kernel
def nearest_on_segment(segment: Bound, seen: Vector) -> Vector:
    """Return what of a segment, or of a single point, is nearest to a point."""
    start, end = vector_from(segment.direction), vector_from(segment.end)
    along = minus(end, start)
    square = dot(along, along)
    share = min(max(dot(along, minus(seen, start)) / square, 0.0), 1.0) if square > 0.0 else 0.0
    return plus(start, scaled(along, share))


@kernel
def depth_in_openings(own: Boundary, which: int, point: Vector) -> float:
    """Return how deep a point is in what holes take away from a solid, metres; -inf: it has none."""
    depth = -math.inf
    for k in range(own.covers[which].first_opening, own.covers[which].last_opening):
        opening = own.covers[own.cover_list[k]]
        if opening.reach - norm(minus(point, vector_from(opening.point))) > depth:
            depth = max(depth, nearest_in(own, own.cover_list[k], point).depth)
    return depth


@kernel
def depth_in_material(own: Boundary, which: int, point: Vector) -> float:
    """Return how deep a point is in the material of a solid, which holes may open, metres; below zero: outside."""
    depth = nearest_in(own, which, point).depth
    if own.covers[which].first_opening == own.covers[which].last_opening:
        return depth
    return min(depth, -depth_in_openings(own, which, point))
