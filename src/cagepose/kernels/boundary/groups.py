"""Which meetings at one place are alternatives: the object is out of the cage there if it is along one of the normals.

A corner that sticks into nothing but its own faces is out of another body as soon as it is out along one of them. At a
place where faces meet in a concave edge, each of them is in the way by itself. So two meetings are alternatives if, on
either body, the material between their features is convex there.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, times, vector_from
from cagepose.kernels.boundary.chart import chart_place, distance_in_chart, is_trimmed, wide_of
from cagepose.kernels.boundary.features import (
    FACE,
    HALF_SPACE,
    INSIDE,
    LINE,
    SEGMENT,
    Bound,
    Boundary,
    PlacedBoundary,
    in_body,
    rotation_of,
    seen_from_feature,
)
from cagepose.kernels.boundary.meetings import slack_of
from cagepose.kernels.boundary.neighbours import NONE, first_in_layer, forget_layers, layer_of, put_in_layer
from cagepose.kernels.boundary.reach import (
    beyond_bound,
    beyond_normals,
    distance_from_segment,
)
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
    is_whole = feature.kind == LINE and feature.first_bound == feature.last_bound
    return feature.kind == FACE or is_whole or is_trimmed(body.own, i)


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
        if is_trimmed(body.own, i):
            aside = scaled(cross(along, normal), math.copysign(1.0, feature.radius))
            into = inward_in_chart(body.own, i, in_body(body, normal), height, touch_m)
            return plus(scaled(aside, into[0] / norm(aside)), scaled(way, into[1] / norm(way)))
        if height <= NEAR * touch_m:
            inward = plus(inward, way)
        if height >= feature.length - NEAR * touch_m:
            inward = minus(inward, way)
        return inward
    seen, own_normal = seen_from_feature(body, i, place), vector_from(feature.direction)
    for k in range(feature.first_bound, feature.last_bound):
        bound = body.own.bounds[k]
        if bound.kind == SEGMENT:
            if distance_from_segment(bound, seen, own_normal) <= NEAR * touch_m:
                along = minus(vector_from(bound.end), vector_from(bound.direction))
                inward = plus(inward, scaled(cross(own_normal, along), 1.0 / norm(along)))
        elif beyond_bound(bound, seen) >= -NEAR * touch_m:
            inward = minus(inward, out_of_bound(bound, seen))
    return times(rotation_of(body), inward)


@kernel
def inward_in_chart(own: Boundary, i: int, normal: Vector, height: float, touch_m: float) -> tuple[float, float]:
    """Return in which direction of its chart, around and along, a round side with borders goes on from a place on one
    of these; zero: it is on none.
    """
    line, at, around, up = own.features[i], chart_place(own, i, normal, height), 0.0, 0.0
    for k in range(line.first_bound, line.last_bound):
        border = own.bounds[k]
        if distance_in_chart(border, at) <= NEAR * touch_m:
            x, y = at.radius * wide_of(border), at.slant * (border.end[1] - border.direction[1])
            around, up = around - y / math.hypot(x, y), up + x / math.hypot(x, y)
    return around, up


@kernel
def beyond_edge(body: PlacedBoundary, i: int, normal: Vector, place: Vector, touch_m: float) -> float:
    """Return how far a direction is beyond the outward normals of a vertex or an edge at a place of it, a sine. A line
    that goes on from there has none that lead along it.
    """
    beyond, feature = beyond_normals(body, i, normal, place), body.own.features[i]
    if feature.kind != LINE:
        return beyond
    along = vector_from(body.features[i].direction)
    height, leads = dot(along, minus(place, vector_from(body.features[i].point))), dot(along, normal)
    if height < feature.length - NEAR * touch_m:
        beyond = max(beyond, leads)
    if height > NEAR * touch_m:
        beyond = max(beyond, -leads)
    return beyond


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
        return beyond_edge(body, i, other_normal, place, touch_m) <= slack
    if not is_surface(body, j):
        return beyond_edge(body, j, normal, place, touch_m) <= slack
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
    place, normal, second_normal = vector_from(row.place), vector_from(row.normal), vector_from(second.normal)
    pairs = (row.feature, row.beside), (second.feature, second.beside)
    if not is_convex_at(held, pairs[0], normal, pairs[1], second_normal, place, touch_m):
        return False
    pairs = (row.cage_feature, row.cage_beside), (second.cage_feature, second.cage_beside)
    return is_convex_at(cage, pairs[0], scaled(normal, -1.0), pairs[1], scaled(second_normal, -1.0), place, touch_m)


@kernel
def is_convex_at(
    body: PlacedBoundary,
    ones: tuple[int, int],
    normal: Vector,
    others: tuple[int, int],
    other_normal: Vector,
    place: Vector,
    touch_m: float,
) -> bool:
    """Whether the material of a body between two features at a place is convex, or between others that are flush with
    them there, -1: none are.
    """
    is_convex = False
    for i in ones:
        for j in others:
            if i >= 0 and j >= 0 and not is_convex:
                slack = slack_of(body.own.features[i], body.own.features[j], touch_m)
                is_convex = is_convex_between(body, i, normal, j, other_normal, place, slack, touch_m)
    return is_convex


@kernel
def fits_group(
    held: PlacedBoundary, cage: PlacedBoundary, group: int, at: int, touch_m: float, found: Meetings
) -> bool:
    """Whether a meeting and all of a group are alternatives, of which the first is at the group's number."""
    if not is_at_place(found, group, at, touch_m):
        return False
    layer, fits = layer_of(found, group, touch_m), True
    for beside in range(layer - 1, layer + 2):
        member = first_in_layer(found, beside)
        while member >= 0 and fits:
            if member != at and found.rows[member].group == group:
                fits = are_alternatives(held, cage, member, at, touch_m, found)
            member = int(found.behind[member])
    return fits


@kernel
def list_again(found: Meetings, at: int, group: int, touch_m: float) -> bool:
    """List a meeting once more, in another group, as of the features that are flush with its own; False: there is no
    room.
    """
    last = found.used[0]
    if last == len(found.rows):
        found.used[0] = found.used[1] = -1
        return False
    found.rows[last] = found.rows[at]  # type: ignore[index]
    put_in_layer(found, last, touch_m)
    row = found.rows[last]
    row.group = group
    if row.beside >= 0:
        row.feature, row.beside = row.beside, row.feature
    if row.cage_beside >= 0:
        row.cage_feature, row.cage_beside = row.cage_beside, row.cage_feature
    found.used[0] = found.used[1] = last + 1
    return True


@kernel
def next_alternative(
    held: PlacedBoundary, cage: PlacedBoundary, at: int, joins: bool, last: int, touch_m: float, found: Meetings
) -> int:
    """Return the first row behind ``last`` of a group that a meeting joins; or, where ``joins`` is false, of a meeting
    before it that joins its own group. -1: there is none.
    """
    layer, least = layer_of(found, at, touch_m), NONE
    for beside in range(layer - 1, layer + 2):
        other = first_in_layer(found, beside)
        while other >= 0:
            is_asked = found.rows[other].group == other if joins else other < at
            if is_asked and other > last and (least < 0 or other < least):
                group, member = (other, at) if joins else (at, other)
                if fits_group(held, cage, group, member, touch_m, found):
                    least = other
            other = int(found.behind[other])
    return least


@kernel
def number_groups(held: PlacedBoundary, cage: PlacedBoundary, touch_m: float, found: Meetings) -> None:
    """Write the group of each meeting, the first of those that are alternatives. One that is an alternative of several
    that are none of each other is listed in each of their groups: below a corner where two walls of a plate meet in a
    hollow edge, its bottom is one of either wall.
    """
    forget_layers(found)
    for at in range(found.used[0]):
        group = next_alternative(held, cage, at, True, NONE, touch_m, found)
        found.rows[at].group = at if group < 0 else group
        put_in_layer(found, at, touch_m)
        before = next_alternative(held, cage, at, False, NONE, touch_m, found) if group < 0 else NONE
        while group >= 0 or before >= 0:
            if group >= 0:
                group = next_alternative(held, cage, at, True, group, touch_m, found)
                fits = group < 0 or list_again(found, at, group, touch_m)
            else:
                fits = list_again(found, before, at, touch_m)
                before = next_alternative(held, cage, at, False, before, touch_m, found)
            if not fits:
                return
