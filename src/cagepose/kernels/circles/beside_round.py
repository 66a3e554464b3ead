"""A circle and a straight line, or the surface of a cylinder or a cone, from outside or inside.

The distance of a place from the surface along its normal is sense cos(taper) rho + sin(taper) height - radius, with rho
and height as in `equation`, and a sense of -1 in a hole; a line is a cylinder without a radius. Its slope times
rho is F.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled
from cagepose.kernels.circles.equation import (
    COSINES,
    ROUNDING,
    SAMPLED,
    SINES,
    Ellipse,
    Equation,
    distance_from_axis,
    equation_of,
    seen_along,
)
from cagepose.kernels.circles.places import (
    WHOLE,
    Circle,
    CirclePoint,
    Common,
    Place,
    common_of_sharp,
    on_circle,
)
from cagepose.kernels.circles.search import find_least_near, search
from cagepose.kernels.native.kernel import kernel


class Round(NamedTuple):
    """A straight line, or an endless surface of a cylinder or a cone.

    Attributes
    ----------
    point
        On the axis, metres.
    direction
        Unit vector along the axis.
    radius
        Along the normal whose line meets the axis in the point; below zero: a hole. Zero and without a taper: a line.
    taper
        Sine that outward normals make with the plane across the axis: the radius shrinks by as much a metre.
    """

    point: Vector
    direction: Vector
    radius: float
    taper: float


@kernel
def slant_of(other: Round) -> float:
    """Return sense cos(taper)."""
    return math.copysign(math.sqrt(1.0 - other.taper * other.taper), other.radius)


@kernel
def round_equation(circle: Circle, other: Round) -> Equation:
    """Return the equation of the places where a circle is stationary in distance from a round surface."""
    ellipse, slant = seen_along(circle, other.point, other.direction), slant_of(other)
    p1, p2, p3 = ellipse.cosine * ellipse.aside, -ellipse.ahead, -0.5 * ellipse.sine * ellipse.sine  # rho rho'
    return equation_of(ellipse, slant * p1, slant * p2, slant * p3, other.taper * ellipse.sine, 0.0, 0.0, 1.0)


@kernel
def is_whole_equally_far(ellipse: Ellipse, slant: float, taper: float, flat: float) -> bool:
    """Whether all of a circle is equally far from a round surface, to a length in its radii."""
    flat = max(flat, ROUNDING * (1.0 + math.hypot(ellipse.ahead, ellipse.aside)))
    least, most = math.inf, -math.inf
    for k in range(SAMPLED):
        gap = slant * distance_from_axis(ellipse, COSINES[k], SINES[k]) + taper * ellipse.sine * SINES[k]
        least, most = min(least, gap), max(most, gap)
        if most - least > flat:
            return False
    return True


@kernel
def places_by_round(circle: Circle, other: Round, flat_m: float, places: Rows[Place]) -> int:
    """Write all places of a circle where its distance from a line or a round surface is stationary, at most eight, and
    return their number; `WHOLE`: the distance changes by a length at most.
    """
    equation = round_equation(circle, other)
    if is_whole_equally_far(equation.ellipse, slant_of(other), other.taper, flat_m / circle.radius):
        return WHOLE
    return search(equation, True, 0, places)


@kernel
def place_by_round_near(circle: Circle, other: Round, angle: float, flat_m: float, places: Rows[Place]) -> int:
    """As `places_by_round`, but of the places where the distance is least the one nearest to an angle, if that is told
    without the others.
    """
    equation = round_equation(circle, other)
    if is_whole_equally_far(equation.ellipse, slant_of(other), other.taper, flat_m / circle.radius):
        return WHOLE
    return 1 if find_least_near(equation, angle, places) else search(equation, True, 0, places)


@kernel
def common_with_line(circle: Circle, other: Round, angle: float) -> Common:
    """Return the common normal of a circle at an angle and a line, both sharp."""
    here = on_circle(circle, angle)
    seen = minus(here.point, other.point)
    foot = plus(other.point, scaled(other.direction, dot(seen, other.direction)))
    return common_of_sharp(here, circle.radius, foot, other.direction)


@kernel
def common_with_round(circle: Circle, other: Round, angle: float) -> Common:
    """Return the common normal of a circle at an angle and a round surface."""
    here = on_circle(circle, angle)
    seen = minus(here.point, other.point)
    height = dot(seen, other.direction)
    across = minus(seen, scaled(other.direction, height))
    across = minus(across, scaled(other.direction, dot(across, other.direction)))  # near the axis rounding is left
    rho, slant = norm(across), slant_of(other)
    out = scaled(across, 1.0 / rho) if rho > 0.0 else some_across(here, other.direction)
    normal = plus(scaled(out, slant), scaled(other.direction, other.taper))
    gap = slant * rho + other.taper * height - other.radius
    foot = minus(here.point, scaled(normal, gap))
    return Common(gap, scaled(normal, -1.0), here.point, foot, here.tangent, (0.0, 0.0, 0.0))


@kernel
def some_across(here: CirclePoint, direction: Vector) -> Vector:
    """Return a unit vector across a direction, and across the tangent of a circle's place if that is not along it."""
    crossed = cross(here.tangent, direction)
    sine = norm(crossed)
    return scaled(crossed, 1.0 / sine) if sine > 0.0 else here.outward
