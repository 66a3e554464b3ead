"""Which meetings at one place are alternatives: the object is out of the cage there if it is along one of the normals.

A corner that sticks into nothing but its own faces is out of another body as soon as it is out along one of them. At a
place where faces meet in a concave edge, each of them is in the way by itself. So two meetings are alternatives if, on
either body, the material between their features is convex there.
"""

from __future__ import annotations

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, times, vector_from
from cagepose.kernels.boundary.features import (
    FACE,
    HALF_SPACE,
    INSIDE,
    LINE,
    SEGMENT,
    Bound,
    PlacedBoundary,
    rotation_of,
    seen_from_feature,
)
from cagepose.kernels.boundary.meetings import slack_of
from cagepose.kernels.boundary.reach import beyond_bound, beyond_normals, distance_from_segment
from cagepose.kernels.boundary.touching import Meetings, is_at_place
from cagepose.kernels.native.kernel import kernel

NEAR = 4.0
"""In touch tolerances: a place is at a bound that is nearer."""
CONVEX_SINE = 1e-9
"""A face that leads into the material of another one by more is at a convex edge with it."""


@kernel
def is_surface(body: PlacedBoundary, i: int) -> bool:
    """Whether a feature is a face or a round side: it has one normal at a place."""
    feature = body.own.features[i]
    return feature.kind == FACE or (feature.kind == LINE and feature.first_bound == feature.last_bound)


@kernel
def out_of_bound(bound: Bound, x: Vector) -> Vector:
    """Return the unit vector out of what a half-space or a circle holds, at a place."""
    direction = vector_from(bound.direction)
    if bound.kind == HALF_SPACE:
        return direction
    seen = minus(x, direction)
    size = norm(seen)
    if size == 0.0:
        return seen
    return scaled(seen, (1.0 if bound.kind == INSIDE else -1.0) / size)


@kernel
def inward_at(body: PlacedBoundary, i: int, normal: Vector, place: Vector, touch_m: float) -> Vector:
    """Return a direction in which a surface goes on from a place at its border, in the world; zero: at none."""
    feature, inward = body.own.features[i], (0.0, 0.0, 0.0)
    if feature.kind == LINE:
        along, core = vector_from(body.features[i].direction), minus(place, scaled(normal, feature.radius))
        height = dot(along, minus(core, vector_from(body.features[i].point))) / (1.0 - feature.taper * feature.taper)
        way = minus(along, scaled(normal, dot(along, normal)))
        if height <= NEAR * touch_m:
            inward = plus(inward, way)
        if height >= feature.length - NEAR * touch_m:
            inward = minus(inward, way)
        return inward
    seen, own_normal = seen_from_feature(body, i, place), vector_from(feature.direction)
    for k in range(feature.first_bound, feature.last_bound):
        bound = body.own.bounds[k]
        if bound.kind == SEGMENT:
            if distance_from_segment(bound, seen) <= NEAR * touch_m:
                along = minus(vector_from(bound.end), vector_from(bound.direction))
                inward = plus(inward, scaled(cross(own_normal, along), 1.0 / norm(along)))
        elif beyond_bound(bound, seen) >= -NEAR * touch_m:
            inward = minus(inward, out_of_bound(bound, seen))
    return times(rotation_of(body), inward)


@kernel
def is_convex_between(
    body: PlacedBoundary,
    i: int,
    normal: Vector,
    j: int,
    other_normal: Vector,
    place: Vector,
    slack: float,
    touch_m: float,
) -> bool:
    """Whether the material of a body between two features, with these outward normals at a place, is convex."""
    if i == j:
        return True
    if not is_surface(body, i):
        return beyond_normals(body, i, other_normal, place) <= slack
    if not is_surface(body, j):
        return beyond_normals(body, j, normal, place) <= slack
    inward = inward_at(body, i, normal, place, touch_m)
    other_inward = inward_at(body, j, other_normal, place, touch_m)
    return dot(inward, other_normal) < -CONVEX_SINE and dot(other_inward, normal) < -CONVEX_SINE


@kernel
def are_alternatives(
    held: PlacedBoundary, cage: PlacedBoundary, one: int, other: int, touch_m: float, found: Meetings
) -> bool:
    """Whether two meetings are at one place and alternatives there."""
    if not is_at_place(found, one, other, touch_m):
        return False
    row, second = found.rows[one], found.rows[other]
    i, j, place = row.feature, second.feature, vector_from(row.place)
    normal, second_normal = vector_from(row.normal), vector_from(second.normal)
    slack = slack_of(held.own.features[i], held.own.features[j], touch_m)
    if not is_convex_between(held, i, normal, j, second_normal, place, slack, touch_m):
        return False
    i, j = row.cage_feature, second.cage_feature
    normal, second_normal = scaled(normal, -1.0), scaled(second_normal, -1.0)
    slack = slack_of(cage.own.features[i], cage.own.features[j], touch_m)
    return is_convex_between(cage, i, normal, j, second_normal, place, slack, touch_m)


@kernel
def number_groups(held: PlacedBoundary, cage: PlacedBoundary, touch_m: float, found: Meetings) -> None:
    """Write the group of each meeting."""
    for at in range(found.used[0]):
        group = at
        for first in range(at):
            if found.rows[first].group == first and are_alternatives(held, cage, first, at, touch_m, found):
                group = first
                break
        found.rows[at].group = group
