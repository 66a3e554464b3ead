"""Places of a whole circle: what is known of one, and points, tangents and curvature there.

A circle has a common normal with another feature where the distance between them is stationary along it. All such
places are found: by `beside_flat` in closed form, by `beside_round` and `beside_circle` as the roots of one
equation (`equation`, `search`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled
from cagepose.kernels.native.kernel import kernel

LEAST, GREATEST, SADDLE, FLAT = 0, 1, 2, 3
"""What a stationary distance is there. Of two circles it is a function of both their angles, and may be a saddle. Flat:
to rounding it is stationary on a stretch of 1e-7 radians, as where a least and a greatest one are about to meet."""
WHOLE = -1
"""Instead of how many places there are: all of the circle is equally far."""


class Circle(NamedTuple):
    """A whole circle.

    Attributes
    ----------
    centre
        Metres.
    axis
        Unit vector.
    toward
        Unit vector across the axis, from which angles are measured, right-handed about the axis.
    radius
        Above zero, metres.
    """

    centre: Vector
    axis: Vector
    toward: Vector
    radius: float


class Place:
    """A place of a circle where it has a common normal with another feature; a record.

    Attributes
    ----------
    angle
        Along the circle, radians.
    other_angle
        Of the place on the other one, if that is a circle, too; else zero.
    kind
        See above.
    is_near
        Whether the place on the larger one of two circles is on its near side, seen from the place on the smaller one;
        else it is across the axis of the larger one. Not of two circles: True.
    """

    angle: float
    other_angle: float
    kind: int
    is_near: bool


class Kept:
    """A place that features may be in each other at, as they touch there now; a record.

    Attributes
    ----------
    angle, other_angle
        As in `Place`, where it is after a motion.
    depth_m
        So deep, until they have been farther apart than that and than they touch, metres; inf: any.
    is_held
        Whether the motion keeps them there: they are put back afterwards, however far they come apart or into each
        other on the way.
    is_grazing
        Whether the motion goes along it, or they touch there without reaching: it counts as soon as they do not touch
        any more, be it that they are deeper in each other.
    """

    angle: float
    other_angle: float
    depth_m: float
    is_held: bool
    is_grazing: bool


class CirclePoint(NamedTuple):
    """A place of a circle.

    Attributes
    ----------
    point
        Metres.
    outward
        Unit vector from the centre to it.
    tangent
        Unit vector along the circle, right-handed about its axis.
    """

    point: Vector
    outward: Vector
    tangent: Vector


class Common(NamedTuple):
    """A common normal of a circle and another feature.

    Attributes
    ----------
    gap
        Along the normal, metres.
    normal
        Unit vector, from the circle toward the other one. Of two sharp ones its sign is open: both it and its opposite,
        with the opposite gap, are right, and the outward normals of the two tell which one is meant.
    point, other_point
        Its ends on the circle and on the other one, metres.
    tangent, other_tangent
        Unit vectors along the circle and, if the other one is sharp, along that; else zero.
    """

    gap: float
    normal: Vector
    point: Vector
    other_point: Vector
    tangent: Vector
    other_tangent: Vector


@kernel
def on_circle(circle: Circle, angle: float) -> CirclePoint:
    """Return the place of a circle at an angle."""
    cosine, sine = math.cos(angle), math.sin(angle)
    aside = cross(circle.axis, circle.toward)
    outward = plus(scaled(circle.toward, cosine), scaled(aside, sine))
    tangent = minus(scaled(aside, cosine), scaled(circle.toward, sine))
    return CirclePoint(plus(circle.centre, scaled(outward, circle.radius)), outward, tangent)


@kernel
def angle_toward(circle: Circle, point: Vector) -> float:
    """Return the angle of the place of a circle that is nearest to a point; of one on the axis, some."""
    seen = minus(point, circle.centre)
    return math.atan2(dot(seen, cross(circle.axis, circle.toward)), dot(seen, circle.toward))


@kernel
def within_turn(angle: float) -> float:
    """Return an angle from -pi to pi, whole turns from a given one."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@kernel
def write_place(out: Place, angle: float, other_angle: float, kind: int, is_near: bool) -> None:
    out.angle, out.other_angle = within_turn(angle), within_turn(other_angle)
    out.kind, out.is_near = kind, is_near


@kernel
def common_of_sharp(here: CirclePoint, size: float, other_point: Vector, other_tangent: Vector) -> Common:
    """Return the common normal of a circle of a size and another sharp curve, at places where they have one.

    The normal is across both tangents; where those are parallel, along the way between the two places; and where there
    is no way between them either, out of the circle. Of the first two the one that rounding turns less is taken.
    """
    between, crossed = minus(other_point, here.point), cross(here.tangent, other_tangent)
    distance, sine = norm(between), norm(crossed)
    if sine * size >= distance and sine > 0.0:
        normal = scaled(crossed, 1.0 / sine)
    elif distance > 0.0:
        normal = scaled(between, 1.0 / distance)
    else:
        normal = here.outward
    return Common(dot(between, normal), normal, here.point, other_point, here.tangent, other_tangent)
