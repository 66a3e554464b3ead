"""Circles along which two features touch: of each contact that is of one, how far to either side it could be."""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import outward_at
from cagepose.kernels.boundary.features import CIRCLE, FACE, VERTEX, Feature, PlacedBoundary
from cagepose.kernels.boundary.tapered import nearest_on_axis
from cagepose.kernels.boundary.touching import Touching, is_around
from cagepose.kernels.native.kernel import kernel

ALONG_AXIS = 1e-9
"""Sine between a normal and a circle's axis: with less the circle lies there as on a face."""


class OnCircle:
    """The circle that a place which touches is of; a record.

    Attributes
    ----------
    length, axis, outward
        Its radius, zero: it is of none; its axis, and the direction from its centre to the place.
    is_of_cage
        Whose it is; of two, along which tubes touch, the one whose normals lead away from the axis.
    before, after
        How far to either side along it, about its axis, it touches as it does at the place, radians.
    is_on_ball, ball
        Whether the circle lies on a ball, and its centre as seen from the centre of gravity; else, on a face. The side
        of a cone, or the tube around another circle, that all of it lies on is there like a ball about the place on its
        axis that the normals lead through; and a ball in a hole's slanted wall touches it along a circle of its own.
    """

    length: float
    axis: Annotated[FloatArray, 3]
    outward: Annotated[FloatArray, 3]
    is_of_cage: bool
    before: float
    after: float
    is_on_ball: bool
    ball: Annotated[FloatArray, 3]


@kernel
def write_on_circle(
    a: PlacedBoundary, i: int, b: PlacedBoundary, j: int, row: Touching, center: Vector, out: OnCircle
) -> None:
    """Write of which circle feature i of the object and feature j of the cage touch at a place, as its row tells."""
    out.length, out.before, out.after = 0.0, row.before, row.after
    if not is_around(row):
        return
    one, other, place = a.features[i], b.features[j], vector_from(row.place)
    there = plus(place, scaled(vector_from(row.normal), row.gap))
    if one.kind == CIRCLE:
        out.is_of_cage = False
        write_along(one, place, vector_from(row.normal), other, center, out)
        if other.kind == CIRCLE:
            out.is_of_cage = dot(vector_from(row.normal), outward_at(one, place)) < 0.0
    elif other.kind == CIRCLE:
        out.is_of_cage = True
        write_along(other, there, vector_from(row.normal), one, center, out)
    elif one.kind == VERTEX:
        out.is_of_cage = True
        write_around_ball(one, other, there, center, out)
    else:
        out.is_of_cage = False
        write_around_ball(other, one, place, center, out)


@kernel
def write_along(circle: Feature, place: Vector, normal: Vector, other: Feature, center: Vector, out: OnCircle) -> None:
    """Write a circle that lies on another feature at a place, or along which the tube around it does."""
    outward, axis, ball = outward_at(circle, place), vector_from(circle.direction), center
    out.length, out.is_on_ball = circle.length, other.kind != FACE
    if circle.radius > 0.0:
        out.length = dot(outward, minus(place, vector_from(circle.point)))
    if other.kind == CIRCLE:
        slope = dot(outward, normal)
        out.is_on_ball = abs(slope) > ALONG_AXIS
        if out.is_on_ball:
            ball = minus(place, scaled(normal, out.length / slope))
    elif out.is_on_ball:
        ball = vector_from(other.point) if other.kind == VERTEX else nearest_on_axis(other, place).place
    for k in range(3):
        out.axis[k], out.outward[k], out.ball[k] = axis[k], outward[k], ball[k] - center[k]


@kernel
def write_around_ball(ball: Feature, wall: Feature, place: Vector, center: Vector, out: OnCircle) -> None:
    """Write the circle along which a ball touches a hole's slanted wall all around."""
    middle, axis = vector_from(ball.point), vector_from(wall.direction)
    away = minus(place, middle)
    outward = minus(away, scaled(axis, dot(axis, away)))
    out.length, out.is_on_ball = norm(outward), True
    for k in range(3):
        out.axis[k], out.outward[k], out.ball[k] = axis[k], outward[k] / out.length, middle[k] - center[k]
