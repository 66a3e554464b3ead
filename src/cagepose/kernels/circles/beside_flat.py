"""A circle and a point or a plane: its near and its far place, in closed form."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, scaled
from cagepose.kernels.circles.places import (
    GREATEST,
    LEAST,
    WHOLE,
    Circle,
    Common,
    Place,
    on_circle,
    write_place,
)
from cagepose.kernels.native.kernel import kernel

NONE = (0.0, 0.0, 0.0)


@kernel
def write_extremes(circle: Circle, way: Vector, places: Rows[Place]) -> int:
    """Write the places that lie farthest along a direction and against it, of which the first is the least far from
    what lies that way.
    """
    aside = cross(circle.axis, circle.toward)
    angle = math.atan2(dot(way, aside), dot(way, circle.toward))
    write_place(places[0], angle, 0.0, LEAST, True)
    write_place(places[1], angle + math.pi, 0.0, GREATEST, True)
    return 2


@kernel
def places_by_point(circle: Circle, point: Vector, flat_m: float, places: Rows[Place]) -> int:
    """Write the nearest and the farthest place of a circle, seen from a point, and return 2; `WHOLE`: they differ in
    distance by a length at most.
    """
    seen = minus(point, circle.centre)
    height = dot(seen, circle.axis)
    side = norm(minus(seen, scaled(circle.axis, height)))
    near, far = math.hypot(side - circle.radius, height), math.hypot(side + circle.radius, height)
    if 4.0 * side * circle.radius <= flat_m * (near + far):  # the difference of the squares
        return WHOLE
    return write_extremes(circle, seen, places)


@kernel
def places_by_plane(circle: Circle, normal: Vector, flat_m: float, places: Rows[Place]) -> int:
    """Write the lowest and the highest place of a circle above a plane with an outward unit normal, and return 2;
    `WHOLE`: they differ in height by a length at most.
    """
    if 2.0 * circle.radius * norm(cross(circle.axis, normal)) <= flat_m:
        return WHOLE
    return write_extremes(circle, scaled(normal, -1.0), places)


@kernel
def common_with_point(circle: Circle, point: Vector, angle: float) -> Common:
    """Return the common normal of a circle at an angle and a point; of the point on the circle, out of the circle."""
    here = on_circle(circle, angle)
    between = minus(point, here.point)
    gap = norm(between)
    normal = scaled(between, 1.0 / gap) if gap > 0.0 else here.outward
    return Common(gap, normal, here.point, point, here.tangent, NONE)


@kernel
def common_with_plane(circle: Circle, point: Vector, outward: Vector, angle: float) -> Common:
    """Return the common normal of a circle at an angle and a plane through a point, with its outward unit normal."""
    here = on_circle(circle, angle)
    gap = dot(outward, minus(here.point, point))
    foot = minus(here.point, scaled(outward, gap))
    return Common(gap, scaled(outward, -1.0), here.point, foot, here.tangent, NONE)
