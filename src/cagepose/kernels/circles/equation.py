"""Where the distance of a circle from something round is stationary: one equation of one angle, with bounds.

Seen along an axis, a circle is an ellipse. With lengths in radii of the circle, and the angle t measured from where its
tangent leads most along the axis, its places are

    (ahead + cos t, aside + cosine sin t) across the axis, height + sine sin t along it,

at a distance rho(t) from it; ``sine`` and ``cosine`` are those of the angle between the two axes. The distance from a
line, a cylinder, a cone or another circle about that axis is stationary where

    F(t) = p1 cos t + p2 sin t + p3 sin 2t + (q1 cos t + q2 sin t) (rho(t) - R) = 0,

and F has the sign of the distance's slope. `bend_within` bounds the second derivative of F around an angle, by those of
rho: rho rho' = A, rho rho'' = A' - rho'^2 and rho rho''' = A'' - 3 rho' rho'', where A is a trigonometric polynomial.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, plus, scaled
from cagepose.kernels.circles.places import Circle
from cagepose.kernels.native.kernel import kernel

SAMPLED = 8
"""Places of a circle that tell whether all of it is equally far. A distance that is the same at five of them is the
same everywhere: its square, or that of what it has of rho, is a trigonometric polynomial of degree two."""
COSINES = tuple(math.cos(2.0 * math.pi * k / SAMPLED) for k in range(SAMPLED))
SINES = tuple(math.sin(2.0 * math.pi * k / SAMPLED) for k in range(SAMPLED))
ROUNDING = 1e-14
"""Of the lengths of which a distance is the difference."""
EPSILON = 4e-16
"""Of the terms of F: their rounding together."""
LEAST_RHO = 1e-300
"""Radii of the circle: what crosses the axis has a kink there."""


class Ellipse(NamedTuple):
    """A circle as seen along an axis, lengths in its radii; see above.

    Attributes
    ----------
    start
        Where on the circle t is zero, radians.
    """

    start: float
    ahead: float
    aside: float
    height: float
    cosine: float
    sine: float


class Equation(NamedTuple):
    """The coefficients of F, see above.

    Attributes
    ----------
    square
        1 - R^2 + ahead^2 + aside^2, the constant part of rho^2 - R^2.
    reach
        1 + |R| and the way between the centres, of which rho - R keeps 16 digits.
    bend_slope, factor, sway
        Bounds of the third derivative of its polynomial, of the factor of rho - R and its derivatives, and of A''.
    """

    ellipse: Ellipse
    p1: float
    p2: float
    p3: float
    q1: float
    q2: float
    other_radius: float
    square: float
    reach: float
    bend_slope: float
    factor: float
    sway: float


class Expansion(NamedTuple):
    """F and its first two derivatives at an angle, the rounding of F, and what the bounds around the angle need: rho,
    rho - R, A, A', and the factor of rho - R.
    """

    value: float
    rounding: float
    slope: float
    bend: float
    rho: float
    beyond: float
    along: float
    along_slope: float
    factor: float


@kernel
def seen_along(circle: Circle, point: Vector, direction: Vector) -> Ellipse:
    """Return a circle as seen along an axis through a point."""
    aside = cross(circle.axis, circle.toward)
    one, other = dot(direction, circle.toward), dot(direction, aside)
    sine = math.hypot(one, other)
    level, start = circle.toward, 0.0  # across both axes
    if sine > 0.0:
        level = plus(scaled(circle.toward, other / sine), scaled(aside, -one / sine))
        start = math.atan2(-one, other)
    seen = scaled(minus(circle.centre, point), 1.0 / circle.radius)
    across = cross(direction, level)
    return Ellipse(start, dot(seen, level), dot(seen, across), dot(seen, direction), dot(direction, circle.axis), sine)


@kernel
def equation_of(
    ellipse: Ellipse, p1: float, p2: float, p3: float, q1: float, q2: float, other_radius: float, short: float
) -> Equation:
    """Return the equation with these coefficients; ``short`` is how far the other radius is below 1."""
    ahead, aside = ellipse.ahead, ellipse.aside
    square = short * (2.0 - short) + ahead * ahead + aside * aside
    reach = 1.0 + abs(other_radius) + math.hypot(ahead, aside)
    bend_slope, factor = math.hypot(p1, p2) + 8.0 * abs(p3), math.hypot(q1, q2)
    sway = math.hypot(ellipse.cosine * aside, ahead) + 2.0 * ellipse.sine * ellipse.sine
    return Equation(ellipse, p1, p2, p3, q1, q2, other_radius, square, reach, bend_slope, factor, sway)


@kernel
def distance_from_axis(ellipse: Ellipse, cosine: float, sine: float) -> float:
    x, y = ellipse.ahead + cosine, ellipse.aside + ellipse.cosine * sine
    return math.sqrt(x * x + y * y)


@kernel
def beyond_radius(equation: Equation, cosine: float, sine: float, rho: float) -> float:
    """Return rho - R. If R > 0 it is that of their squares over the sum: no digits are lost where they are close."""
    if equation.other_radius <= 0.0:
        return rho - equation.other_radius
    ellipse = equation.ellipse
    rise = ellipse.sine * sine
    offset = ellipse.ahead * cosine + ellipse.cosine * ellipse.aside * sine
    return (equation.square + 2.0 * offset - rise * rise) / (rho + equation.other_radius)


@kernel
def expanded(equation: Equation, angle: float) -> Expansion:
    """Return F and its derivatives at an angle t."""
    cosine, sine = math.cos(angle), math.sin(angle)
    product, difference = cosine * sine, (cosine - sine) * (cosine + sine)
    level = equation.p1 * cosine + equation.p2 * sine
    value = equation.p1 * cosine + (equation.p2 + 2.0 * equation.p3 * cosine) * sine  # exact where a tangent touches
    rounding = abs(equation.p1 * cosine) + (abs(equation.p2) + abs(2.0 * equation.p3)) * abs(sine)
    slope = equation.p2 * cosine - equation.p1 * sine + 2.0 * equation.p3 * difference
    bend = -level - 8.0 * equation.p3 * product
    if equation.factor == 0.0:
        return Expansion(value, EPSILON * rounding, slope, bend, 0.0, 0.0, 0.0, 0.0, 0.0)
    ellipse = equation.ellipse
    ahead, aside, square = ellipse.ahead, ellipse.cosine * ellipse.aside, ellipse.sine * ellipse.sine
    rho = max(distance_from_axis(ellipse, cosine, sine), LEAST_RHO)
    beyond = beyond_radius(equation, cosine, sine, rho)
    along = aside * cosine - ahead * sine - square * product
    along_slope = -aside * sine - ahead * cosine - square * difference
    rho_slope = min(max(along / rho, -1.0), 1.0)
    rho_bend = (along_slope - rho_slope * rho_slope) / rho
    factor, factor_slope = equation.q1 * cosine + equation.q2 * sine, equation.q2 * cosine - equation.q1 * sine
    value += factor * beyond
    rounding += abs(factor) * equation.reach + (abs(equation.q1 * cosine) + abs(equation.q2 * sine)) * abs(beyond)
    slope += factor_slope * beyond + factor * rho_slope
    bend += -factor * beyond + 2.0 * factor_slope * rho_slope + factor * rho_bend
    return Expansion(value, EPSILON * rounding, slope, bend, rho, beyond, along, along_slope, factor)


@kernel
def bend_within(equation: Equation, at: Expansion, half_width: float) -> float:
    """Return a bound of |F''| up to an angle to both sides; inf: the circle may cross the axis there."""
    if equation.factor == 0.0:
        return abs(at.bend) + equation.bend_slope * half_width
    along_slope = abs(at.along_slope) + equation.sway * half_width
    square = at.rho * at.rho - (2.0 * abs(at.along) + along_slope * half_width) * half_width
    rho = max(at.rho - half_width, math.sqrt(max(square, 0.0)))
    if rho <= 0.0:
        return math.inf
    first = min(1.0, (abs(at.along) + along_slope * half_width) / rho)
    second = (along_slope + first * first) / rho
    third = (equation.sway + 3.0 * first * second) / rho
    beyond, factor = (
        abs(at.beyond) + first * half_width,
        min(equation.factor, abs(at.factor) + equation.factor * half_width),
    )
    change = equation.bend_slope + equation.factor * (beyond + 3.0 * (first + second)) + factor * third
    return abs(at.bend) + change * half_width


@kernel
def slope_within(equation: Equation, at: Expansion, half_width: float) -> float:
    """Return a bound of |F'| up to an angle to both sides, also where the circle crosses the axis."""
    beyond, factor = abs(at.beyond) + half_width, min(equation.factor, abs(at.factor) + equation.factor * half_width)
    return equation.bend_slope + equation.factor * beyond + factor
