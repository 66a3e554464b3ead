"""Which places of features other parts of the same body cover: these touch nothing.

A union of sharp polyhedra has no such features; this is for round parts, and for what holes are open to. A surface is
covered at a place if all of it is that lies around there: a seam between two flush covers is covered, the border of a
cover is not. An edge or a vertex sticks out along a normal only if no cover reaches beyond the plane across it: what of
a convex cover is nearest to a place above must be the place itself.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.tolerances import PROBE, PROBE_MARGIN
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import outward_at
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Boundary,
    Feature,
    PlacedBoundary,
    in_body,
    seen_from_feature,
)
from cagepose.kernels.boundary.reach import beyond_borders
from cagepose.kernels.boundary.solids import depth_in_material, depth_in_openings, nearest_in
from cagepose.kernels.native.kernel import kernel

AT, INSIDE_OF = 2.0, 4.0
"""In touch tolerances: a place no farther away from a cover is on it, one that is deeper is inside."""
BESIDE, DIRECTIONS = 12.0, 12
"""Where it is asked around a place, in touch tolerances, and in how many directions."""
AROUND, ROOM = 40.0, 60.0
"""In touch tolerances: how far around an edge it is asked for the material beside a hole, and where that is needed."""
TURNS = (0.0, math.radians(30.0), math.radians(60.0), math.radians(80.0), math.radians(87.0))
"""From the normal of an edge, radians: material in such a direction is in the way."""


@kernel
def is_covered(body: PlacedBoundary, i: int, normal: Vector, core: Vector) -> bool:
    """Whether a feature is covered where it has this place of its core and this outward normal, both in the world."""
    feature = body.own.features[i]
    if feature.first_cover == feature.last_cover:
        return False
    out = in_body(body, normal)
    place = plus(plus(seen_from_feature(body, i, core), vector_from(feature.point)), scaled(out, feature.radius))
    if feature.kind == FACE or feature.radius != 0.0:
        return is_surface_covered(body.own, i, place, out)
    return is_edge_covered(body.own, i, place, out)


@kernel
def touch_of(own: Boundary, i: int) -> float:
    """Return the touch tolerance of what covers a feature."""
    touch_m: float = own.covers[int(own.cover_list[own.features[i].first_cover])].touch_m
    return touch_m


@kernel
def beyond_end(own: Boundary, i: int, place: Vector, normal: Vector) -> float:
    """Return how far a place of a surface is beyond where it ends, metres; -inf: it goes over into others evenly."""
    feature = own.features[i]
    seen = minus(place, vector_from(feature.point))
    if feature.kind == FACE and feature.radius == 0.0:
        return beyond_borders(own, i, seen, math.inf)
    if feature.kind == LINE and feature.first_bound == feature.last_bound:
        along = dot(vector_from(feature.direction), minus(seen, scaled(normal, feature.radius)))
        along /= 1.0 - feature.taper * feature.taper
        return max(-along, along - feature.length)
    return -math.inf


@kernel
def deepest_over(own: Boundary, i: int, place: Vector, normal: Vector) -> float:
    """Return how deep a probe above a place of a surface is in the material of its covers, metres."""
    deepest, touch_m = -math.inf, touch_of(own, i)
    probe = plus(place, scaled(normal, PROBE * touch_m))
    for k in range(own.features[i].first_cover, own.features[i].last_cover):
        which = own.cover_list[k]
        if norm(minus(probe, vector_from(own.covers[which].point))) <= own.covers[which].reach + BESIDE * touch_m:
            deepest = max(deepest, depth_in_material(own, which, probe))
    return deepest


@kernel
def is_surface_covered(own: Boundary, i: int, place: Vector, normal: Vector) -> bool:
    """Whether all of a surface at and around a place is covered."""
    touch_m = touch_of(own, i)
    least, inmost, any_within = beyond_end(own, i, place, normal), place, False
    if least <= -PROBE_MARGIN * touch_m:
        depth = deepest_over(own, i, place, normal)
        if depth <= -PROBE_MARGIN * touch_m:
            return False
        if depth >= (BESIDE + 2.0 * PROBE) * touch_m:
            return True
    one = across(normal)
    other = cross(normal, one)
    for k in range(DIRECTIONS):
        angle = 2.0 * math.pi * k / DIRECTIONS
        way = plus(scaled(one, math.cos(angle)), scaled(other, math.sin(angle)))
        beside = plus(place, scaled(way, BESIDE * touch_m))
        beyond = beyond_end(own, i, beside, normal)
        if beyond > -PROBE_MARGIN * touch_m:
            if beyond < least:
                least, inmost = beyond, beside
            continue
        any_within = True
        if deepest_over(own, i, beside, normal) <= -PROBE_MARGIN * touch_m:
            return False
    return any_within or deepest_over(own, i, inmost, normal) > -PROBE_MARGIN * touch_m


@kernel
def across(direction: Vector) -> Vector:
    """Return a unit vector across another one."""
    x, y, z = abs(direction[0]), abs(direction[1]), abs(direction[2])
    axis = (1.0, 0.0, 0.0) if x <= y and x <= z else ((0.0, 1.0, 0.0) if y <= z else (0.0, 0.0, 1.0))
    found = cross(direction, axis)
    return scaled(found, 1.0 / norm(found))


@kernel
def tangent_of(feature: Feature, place: Vector) -> Vector:
    """Return the unit vector along an edge at a place; at a vertex: zero."""
    if feature.kind == CIRCLE:
        return cross(vector_from(feature.direction), outward_at(feature, place))
    return vector_from(feature.direction)


@kernel
def is_edge_covered(own: Boundary, i: int, place: Vector, normal: Vector) -> bool:
    """Whether a vertex, or an edge at and around a place, is covered for a normal."""
    feature, beside_m = own.features[i], BESIDE * touch_of(own, i)
    along = tangent_of(feature, place)
    if not is_in_the_way(own, i, place, normal, along):
        return False
    if feature.kind == VERTEX:
        return True
    height = dot(along, minus(place, vector_from(feature.point)))
    for k in range(2):
        step = beside_m if k == 0 else -beside_m
        if feature.kind == LINE and not 0.0 <= height + step <= feature.length:
            continue
        if not is_in_the_way(own, i, plus(place, scaled(along, step)), normal, along):
            return False
    return True


@kernel
def is_in_the_way(own: Boundary, i: int, place: Vector, normal: Vector, along: Vector) -> bool:
    """Whether at a place of an edge some cover has material beyond the plane across a normal."""
    feature = own.features[i]
    for k in range(feature.first_cover, feature.last_cover):
        which = own.cover_list[k]
        cover, touch_m = own.covers[which], own.covers[which].touch_m
        if norm(minus(place, vector_from(cover.point))) > cover.reach + AT * touch_m:
            continue
        depth = nearest_in(own, which, place).depth
        if depth < -AT * touch_m:
            continue
        opening = depth_in_openings(own, which, place)
        if opening > ROOM * touch_m:
            continue
        if opening >= -ROOM * touch_m:
            if is_beside_hole(own, which, place, normal, along):
                return True
            continue
        if depth > INSIDE_OF * touch_m:
            return True
        above = min(feature.least, cover.reach)
        nearest = nearest_in(own, which, plus(place, scaled(normal, above))).point
        if norm(minus(nearest, place)) > INSIDE_OF * touch_m:
            return True
    return False


@kernel
def is_beside_hole(own: Boundary, which: int, place: Vector, normal: Vector, along: Vector) -> bool:
    """Whether material of a cover that is open near a place of an edge is beyond the plane across a normal, by probes
    around it: of an edge, in the plane across it.
    """
    touch_m, is_edge = own.covers[which].touch_m, dot(along, along) > 0.0
    one = cross(along, normal) if is_edge else across(normal)
    other, n_ways = cross(normal, one), (2 if is_edge else DIRECTIONS)
    for k in range(n_ways):
        angle = 2.0 * math.pi * k / n_ways
        way = plus(scaled(one, math.cos(angle)), scaled(other, math.sin(angle)))
        for turn in TURNS:
            toward = plus(scaled(normal, math.cos(turn)), scaled(way, math.sin(turn)))
            if depth_in_material(own, which, plus(place, scaled(toward, AROUND * touch_m))) >= PROBE_MARGIN * touch_m:
                return True
    return False
