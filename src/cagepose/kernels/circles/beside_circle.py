"""Two circles: all pairs of places where they have a common normal.

Places are searched along the smaller circle. From each of its places, at a height and a distance rho from the axis of
the larger one of radius R, the distance has a near and a far extreme along the larger one: the square root of
height^2 + (rho - R)^2, and with -R for R. The slope of either, times itself and rho, is F of `equation`: with a
the way between the centres along the tangent, a (rho - R) + R height height'.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.circles.equation import (
    COSINES,
    ROUNDING,
    SAMPLED,
    SINES,
    Ellipse,
    Equation,
    beyond_radius,
    distance_from_axis,
    equation_of,
    seen_along,
)
from cagepose.kernels.circles.places import (
    GREATEST,
    LEAST,
    SADDLE,
    WHOLE,
    Circle,
    Common,
    Place,
    angle_toward,
    common_of_sharp,
    on_circle,
    within_turn,
    write_place,
)
from cagepose.kernels.circles.search import find_least_near, search
from cagepose.kernels.native.kernel import kernel

CLOSE_BY = 0.1
"""Radians: a place that is nearer to where another one was is the nearest one to it."""


@kernel
def circle_equation(small: Circle, large: Circle, ellipse: Ellipse, is_near: bool) -> Equation:
    """Return the equation of the places of the smaller circle from which the near or the far side of the larger one is
    stationary in distance.
    """
    radius = large.radius / small.radius if is_near else -large.radius / small.radius
    p1, p3 = radius * ellipse.height * ellipse.sine, 0.5 * radius * ellipse.sine * ellipse.sine  # R height height'
    q1, q2 = ellipse.cosine * ellipse.aside + ellipse.height * ellipse.sine, -ellipse.ahead
    short = (small.radius - large.radius) / small.radius
    return equation_of(ellipse, p1, 0.0, p3, q1, q2, radius, short)


@kernel
def is_whole_equally_near(near: Equation, flat: float) -> bool:
    """Whether all of the smaller circle is equally far from the near side of the larger one, to a length in its radii:
    as where their axes are one, and where it lies on a torus around the larger one.
    """
    ellipse = near.ellipse
    flat = max(flat, ROUNDING * (1.0 + math.hypot(ellipse.ahead, ellipse.aside) + abs(ellipse.height)))
    least, most = math.inf, -math.inf
    for k in range(SAMPLED):
        rho = distance_from_axis(ellipse, COSINES[k], SINES[k])
        beyond = beyond_radius(near, COSINES[k], SINES[k], rho)
        gap = math.hypot(ellipse.height + ellipse.sine * SINES[k], beyond)
        least, most = min(least, gap), max(most, gap)
        if most - least > flat:
            return False
    return True


@kernel
def places_by_circle(circle: Circle, other: Circle, flat_m: float, places: Rows[Place]) -> int:
    """Write all pairs of places where two circles have a common normal, at most eight, and return their number;
    `WHOLE`: all of the smaller one is equally far from the larger one, to a length.
    """
    n_near = near_places_by_circle(circle, other, flat_m, places)
    if n_near == WHOLE:
        return WHOLE
    is_small = circle.radius <= other.radius
    small, large = (circle, other) if is_small else (other, circle)
    far = circle_equation(small, large, seen_along(small, large.centre, large.axis), False)
    n_places = search(far, False, n_near, places)
    for k in range(n_near, n_places):
        complete(small, large, is_small, places[k])
    return n_places


@kernel
def near_places_by_circle(circle: Circle, other: Circle, flat_m: float, places: Rows[Place]) -> int:
    """As `places_by_circle`, but those on the near side of the larger circle alone: on its far side no distance is the
    least one nearby.
    """
    is_small = circle.radius <= other.radius
    small, large = (circle, other) if is_small else (other, circle)
    near = circle_equation(small, large, seen_along(small, large.centre, large.axis), True)
    if is_whole_equally_near(near, flat_m / small.radius):
        return WHOLE
    n_places = search(near, True, 0, places)
    for k in range(n_places):
        complete(small, large, is_small, places[k])
    return n_places


@kernel
def place_by_circle_near(circle: Circle, other: Circle, angle: float, flat_m: float, places: Rows[Place]) -> int:
    """As `near_places_by_circle`, but of the places where the distance is least the one that is nearest to an angle of
    the first circle, if that is told without the others.
    """
    is_small = circle.radius <= other.radius
    small, large = (circle, other) if is_small else (other, circle)
    near = circle_equation(small, large, seen_along(small, large.centre, large.axis), True)
    if is_whole_equally_near(near, flat_m / small.radius):
        return WHOLE
    start = angle if is_small else angle_toward(small, on_circle(large, angle).point)
    if find_least_near(near, start, places):
        complete(small, large, is_small, places[0])
        if abs(within_turn(places[0].angle - angle)) < CLOSE_BY:
            return 1
    return near_places_by_circle(circle, other, flat_m, places)


@kernel
def along_one_or_both(kind: int, is_near: bool) -> int:
    """Return what a distance that is stationary along the smaller circle is along both, or the other way round.

    Along the larger one alone it is least on the near side, and greatest on the far one.
    """
    mixed = GREATEST if is_near else LEAST
    if kind == mixed:
        return SADDLE
    return mixed if kind == SADDLE else kind


@kernel
def complete(small: Circle, large: Circle, is_small: bool, place: Place) -> None:
    """Complete a place that was found along the smaller of two circles, which may be the first one or the other."""
    angle = place.angle
    across = angle_toward(large, on_circle(small, angle).point)
    if not place.is_near:
        across += math.pi
    kind = along_one_or_both(place.kind, place.is_near)
    if is_small:
        write_place(place, angle, across, kind, place.is_near)
    else:
        write_place(place, across, angle, kind, place.is_near)


@kernel
def common_with_circle(circle: Circle, other: Circle, angle: float, other_angle: float) -> Common:
    """Return the common normal of two circles at an angle of each, both sharp."""
    there = on_circle(other, other_angle)
    return common_of_sharp(on_circle(circle, angle), circle.radius, there.point, there.tangent)
