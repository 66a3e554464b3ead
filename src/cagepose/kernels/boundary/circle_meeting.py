"""How a circle meets another feature: at all places where they have a common normal, or all around."""

from __future__ import annotations

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import cross, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import circle_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, VERTEX, Feature, PlacedBoundary
from cagepose.kernels.boundary.meeting import is_turned
from cagepose.kernels.boundary.met import SHARP, Meeting, without_normal
from cagepose.kernels.circles.beside_circle import common_with_circle, near_places_by_circle
from cagepose.kernels.circles.beside_flat import (
    common_with_plane,
    common_with_point,
    places_by_plane,
    places_by_point,
)
from cagepose.kernels.circles.beside_round import Round, common_with_line, common_with_round, places_by_round
from cagepose.kernels.circles.places import LEAST, Common, Place, angle_toward, on_circle, write_place
from cagepose.kernels.native.kernel import kernel

SIDE_BY_SIDE = 1e-6
"""Sine between tangents: a lesser one is none."""


@kernel
def round_of(line: Feature) -> Round:
    """Return the endless surface that a line is the axis of."""
    return Round(vector_from(line.point), vector_from(line.direction), line.radius, line.taper)


@kernel
def is_sharp(circle: Feature, other: Feature) -> bool:
    """Whether a feature that a circle meets is a sharp edge."""
    if other.kind == FACE or other.kind == VERTEX:
        return False
    if other.kind == CIRCLE:
        return True
    return bool(other.taper == 0.0 and abs(other.radius) < SHARP * circle.length)


@kernel
def crosses_edge(circle: Feature, other: Feature) -> bool:
    """Whether both a circle and a feature that it meets are sharp edges, which cross where they touch."""
    return bool(is_sharp(circle, other) and circle.radius + other.radius < SHARP * circle.length)


@kernel
def meet_all_around(one: Feature, other: Feature) -> bool:
    """Whether two features, one of them a circle, touch where all of it is equally far: not so two sharp circles."""
    return bool(one.kind != other.kind or one.radius + other.radius > 0.0)


@kernel
def write_place_on(one: Feature, other: Feature, angle: float, out: Place) -> None:
    """Write the place at an angle of a circle, of two the first one, that is equally far all around."""
    if one.kind != CIRCLE or other.kind != CIRCLE:
        write_place(out, angle, 0.0, LEAST, True)
        return
    other_angle = angle_toward(circle_of(other), on_circle(circle_of(one), angle).point)
    if other.length < one.length:
        angle = angle_toward(circle_of(one), on_circle(circle_of(other), other_angle).point)
    write_place(out, angle, other_angle, LEAST, True)


@kernel
def is_core(circle: Feature, other: Feature) -> bool:
    """Whether `common_at` leads to the core of another feature, and not to its side."""
    return other.kind == FACE or other.kind == VERTEX or is_sharp(circle, other)


@kernel
def find_places(circle: Feature, other: Feature, flat_m: float, places: Rows[Place]) -> int:
    """Write all places where the distance of a circle from another feature is stationary; return how many there are,
    `WHOLE`: all of it is equally far, to a length. Of two circles those on the far side of one are left out.
    """
    if other.kind == FACE:
        return places_by_plane(circle_of(circle), vector_from(other.direction), flat_m, places)
    if other.kind == VERTEX:
        return places_by_point(circle_of(circle), vector_from(other.point), flat_m, places)
    if other.kind == CIRCLE:
        return near_places_by_circle(circle_of(circle), circle_of(other), flat_m, places)
    return places_by_round(circle_of(circle), round_of(other), flat_m, places)


@kernel
def common_at(circle: Feature, other: Feature, place: Place) -> Common:
    """Return the normal from a circle to the core of another feature, or to its round side, at a place."""
    if other.kind == FACE:
        point, direction = vector_from(other.point), vector_from(other.direction)
        return common_with_plane(circle_of(circle), point, direction, place.angle)
    if other.kind == VERTEX:
        return common_with_point(circle_of(circle), vector_from(other.point), place.angle)
    if other.kind == CIRCLE:
        return common_with_circle(circle_of(circle), circle_of(other), place.angle, place.other_angle)
    if is_sharp(circle, other):
        return common_with_line(circle_of(circle), round_of(other), place.angle)
    return common_with_round(circle_of(circle), round_of(other), place.angle)


@kernel
def circle_meeting(a: PlacedBoundary, i: int, b: PlacedBoundary, j: int, place: Place) -> Meeting:
    """Return how a circle of the first body, seen as the object, meets a feature of the second one at a place."""
    circle, other = a.features[i], b.features[j]
    common = common_at(circle, other, place)
    gap, normal = common.gap, common.normal
    if other.kind == VERTEX and other.radius + circle.radius == 0.0:
        return without_normal(gap)
    if is_sharp(circle, other):
        if crosses_edge(circle, other):
            if norm(cross(common.tangent, common.other_tangent)) < SIDE_BY_SIDE:
                return without_normal(abs(gap))
            is_back = is_turned(a, i, common.point, b, j, common.other_point, normal, gap < 0.0)
        else:
            is_back = gap < 0.0
        if is_back:
            normal, gap = scaled(normal, -1.0), -gap
    gap -= circle.radius + (other.radius if is_core(circle, other) else 0.0)
    return Meeting(True, gap, normal, plus(common.point, scaled(normal, circle.radius)))
