"""Where on an arc of a rim another feature is nearest: its feet, equation (2.13).

Of a face it is the lowest point, of a vertex the point in its direction, both in closed form. Of an edge or another rim
it is where the way to the nearest point there has no part along the tangent: a root of one function of one angle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Feature
from cagepose.kernels.shapes.rims import SEARCHED, Foot, distance_at, on_rim, towards

FLAT = 1e-13
"""Sine: flatter, a face lies on all of a rim, and its vertices meet it."""
UPRIGHT = 1e-12
"""Sine: what is less along a rim's plane is across it."""
SECTIONS = 6
"""So many sections of an arc are searched for a nearest point each. Two circles in nearly the same plane have several.
"""
ASIDE = 1e-3
"""Fraction of a section. A section ends so far beside an arc's middle, and beside what is farthest between two nearest
points. In the place itself the distance would not change, but for rounding, as in parts that are drawn in line."""
ENDS = tuple(
    SEARCHED * (2.0 * (section - (ASIDE if 0 < section < SECTIONS else 0.0)) / SECTIONS - 1.0)
    for section in range(SECTIONS + 1)
)
BESIDE = ASIDE * 2.0 * SEARCHED / SECTIONS
COSINES = tuple(math.cos(end) for end in ENDS)
SINES = tuple(math.sin(end) for end in ENDS)
EXTREME_STEPS = 12
"""Steps of the search for where the way to the nearest point has most of a part along the tangent."""
ITERATIONS, ROUNDING = 60, 2e-16
"""The search for a nearest point takes at most so many steps, and a step of fewer radians ends it."""


@kernel
def foot_on(rim: Feature, other: Feature) -> Foot:
    """Return where another feature, both in the world, is nearest to an arc of a rim."""
    if other.kind == FACE:
        return farthest_along(rim, scaled(vector_from(other.direction), -1.0))
    if other.kind == VERTEX:
        way = minus(vector_from(other.point), vector_from(rim.point))
        return farthest_along(rim, scaled(way, math.copysign(1.0, rim.length)))
    feet = feet_on(rim, other)
    if rim.is_second:
        return on_rim(rim, feet.last, feet.n_feet > 1)
    return on_rim(rim, feet.first, feet.n_feet > 0)


@kernel
def farthest_along(rim: Feature, way: Vector) -> Foot:
    """Return the point of an arc whose outward normal is nearest to a direction."""
    toward, axis = vector_from(rim.toward), vector_from(rim.direction)
    ahead, aside = dot(way, toward), dot(way, cross(axis, toward))
    size = math.sqrt(ahead * ahead + aside * aside)
    if size <= FLAT * norm(way):
        return on_rim(rim, 0.0, False)
    if ahead < size * COSINES[0]:
        return towards(rim, COSINES[0], math.copysign(SINES[SECTIONS], aside), False)
    return towards(rim, ahead / size, aside / size, True)


class Feet(NamedTuple):
    """Where on an arc an edge or another rim is nearest.

    Attributes
    ----------
    n_feet
        How many places were found.
    first, last
        Their least and greatest angle from the arc's middle, of more than two those of the nearest; the middle: there
        is none.
    """

    n_feet: int
    first: float
    last: float


@kernel
def feet_on(rim: Feature, other: Feature) -> Feet:
    """Find where an edge or another rim, both in the world, is nearest to an arc of a rim."""
    seen = seen_from(rim, other)
    n_feet, first, last = 0, 0.0, 0.0
    low, before, section = -SEARCHED, rise(seen, other, COSINES[0], SINES[0]), 0
    one, two, three = angles_between_feet(seen, other)
    while section < SECTIONS:
        high = min(one if one > low else math.inf, two if two > low else math.inf, three if three > low else math.inf)
        if high < ENDS[section + 1]:
            after = rise(seen, other, math.cos(high), math.sin(high))
        else:
            section += 1
            high, after = ENDS[section], rise(seen, other, COSINES[section], SINES[section])
        starts_below, ends_below = before[0] < 0.0, after[0] < 0.0
        since, until = (low, before[0]), (high, after[0])
        if starts_below == ends_below:
            between = beyond_zero(seen, other, low, high, before, after)
            since, until = (since, between) if starts_below else (between, until)
        if since[1] < 0.0 <= until[1]:
            foot = root_of_rise(seen, other, since[0], until[0], since[1], until[1])
            one_side, other_side = foot, foot
            if starts_below != ends_below:
                one_side, other_side = feet_beside(seen, other, low, high, before, after, foot)
            first, last = nearest_two(rim, other, n_feet, first, last, one_side)
            n_feet += 1
            if other_side != one_side:
                first, last = nearest_two(rim, other, n_feet, first, last, other_side)
                n_feet += 1
        low, before = high, after
    return Feet(n_feet, first, last)


@kernel
def feet_beside(
    seen: Seen,
    other: Feature,
    low: float,
    high: float,
    before: tuple[float, float],
    after: tuple[float, float],
    root: float,
) -> tuple[float, float]:
    """Return the feet in a section at whose ends `rise` is below and not below zero, given where it is zero: this, if
    the distance is least there, and another one, or twice the same.
    """
    at_root = (0.0, rise(seen, other, math.cos(root), math.sin(root))[1])
    first, last = root, root
    ahead = beyond_zero(seen, other, low, root, before, at_root)
    if ahead[1] > 0.0:
        first = root_of_rise(seen, other, low, ahead[0], before[0], ahead[1])
    behind = beyond_zero(seen, other, root, high, at_root, after)
    if behind[1] < 0.0:
        last = root_of_rise(seen, other, behind[0], high, behind[1], after[0])
    return first, last


@kernel
def angles_between_feet(seen: Seen, other: Feature) -> tuple[float, float, float]:
    """Return three angles from an arc's middle, a quarter turn at most, to both sides of which feet lie; inf: nowhere.

    One is where the rim is farthest along the other one's direction, or the least far. The others are to both sides of
    where it leads along an edge, as it comes out from under there, or is nearest to the middle of another rim that lies
    almost flat, which may be a kink.
    """
    steepest = angle_toward(seen.tilt_ahead, seen.tilt_aside)
    if other.kind == EDGE:
        middle = angle_toward(seen.tilt_aside, -seen.tilt_ahead)
    else:
        middle = angle_toward(seen.ahead, seen.aside)
    return steepest, middle - BESIDE, middle + BESIDE


@kernel
def angle_toward(ahead: float, aside: float) -> float:
    """Return the angle from an arc's middle, a quarter turn at most, of a way along the rim's plane, or its opposite;
    inf: it is across that plane.
    """
    if ahead == 0.0 or ahead * ahead + aside * aside <= UPRIGHT * UPRIGHT:
        return math.inf
    return math.atan(aside / ahead)


@kernel
def nearest_two(
    rim: Feature, other: Feature, n_feet: int, first: float, last: float, foot: float
) -> tuple[float, float]:
    """Return the least and the greatest angle of one or two feet and another one, of three without the farthest."""
    if n_feet < 2:
        return (foot if n_feet == 0 else first), foot
    one = distance_at(other, on_rim(rim, first, True).point)
    two = distance_at(other, on_rim(rim, last, True).point)
    three = distance_at(other, on_rim(rim, foot, True).point)
    if three >= max(one, two):
        return first, last
    return (last, foot) if one >= two else (first, foot)


class Seen(NamedTuple):
    """An edge or another rim as seen from an arc, in numbers that an angle along it needs.

    Attributes
    ----------
    ahead, aside
        The way from its point to the rim's middle, along the arc's middle and across that in the rim's plane.
    tilt_ahead, tilt_aside
        Its direction, likewise.
    height, square
        The way along its direction, and its square.
    radius
        Of the rim, below zero in a hole.
    """

    ahead: float
    aside: float
    tilt_ahead: float
    tilt_aside: float
    height: float
    square: float
    radius: float


@kernel
def seen_from(rim: Feature, other: Feature) -> Seen:
    toward, direction = vector_from(rim.toward), vector_from(other.direction)
    aside = cross(vector_from(rim.direction), toward)
    way = minus(vector_from(rim.point), vector_from(other.point))
    return Seen(
        dot(way, toward),
        dot(way, aside),
        dot(direction, toward),
        dot(direction, aside),
        dot(direction, way),
        dot(way, way),
        rim.length,
    )


@kernel
def rise(seen: Seen, other: Feature, cosine: float, sine: float) -> tuple[float, float]:
    """Return how the distance from an edge or another rim grows along a rim, at an angle from its arc's middle, times
    something above zero; and how that changes with the angle.
    """
    along = seen.aside * cosine - seen.ahead * sine  # of the way to the place on the rim, along the tangent there
    outward = seen.ahead * cosine + seen.aside * sine
    tilt = seen.tilt_aside * cosine - seen.tilt_ahead * sine
    lean = seen.tilt_ahead * cosine + seen.tilt_aside * sine
    height = seen.height + seen.radius * lean
    level = along - height * tilt  # along, of what is across the direction
    level_slope = -outward - seen.radius * tilt * tilt + height * lean
    square = seen.square + seen.radius * (seen.radius + 2.0 * outward) - height * height
    across = math.sqrt(max(square, 0.0))
    sense = math.copysign(1.0, seen.radius)
    if other.kind == EDGE:
        side = sense * math.copysign(1.0, other.radius)
        if other.taper != 0.0 and across > 0.0:  # nearest on a cone's axis is higher or lower than the foot on it
            shift = math.copysign(1.0, other.radius) * other.taper / math.sqrt(1.0 - other.taper * other.taper)
            level += shift * across * tilt
            level_slope += shift * (seen.radius * (along - height * tilt) / across * tilt - across * lean)
        return side * level, side * level_slope
    if across == 0.0:
        return sense * along, -sense * outward
    share = abs(other.length) / across
    return (
        sense * (along - share * level),
        sense * (share * (seen.radius * level * level / square - level_slope) - outward),
    )


@kernel
def beyond_zero(
    seen: Seen, other: Feature, low: float, high: float, before: tuple[float, float], after: tuple[float, float]
) -> tuple[float, float]:
    """Return an angle of a section, at both ends of which `rise` has one sign, where it may have the other, and `rise`
    there; its low end: there is none.
    """
    if may_cross_twice(before, after, high - low):
        return farthest_rise(seen, other, low, high, before, after)
    dip = way_to_dip(before, after, high - low)
    if dip == math.inf:
        return low, before[0]
    return low + dip, rise(seen, other, math.cos(low + dip), math.sin(low + dip))[0]


@kernel
def may_cross_twice(before: tuple[float, float], after: tuple[float, float], width: float) -> bool:
    """Whether `rise`, of one sign at both ends of a section so wide, bends toward zero so much that its tangents cross
    there beyond zero.
    """
    sign = -1.0 if before[0] < 0.0 else 1.0
    if sign * before[1] >= 0.0 or sign * after[1] <= 0.0:
        return False
    way = (after[0] - before[0] - after[1] * width) / (before[1] - after[1])
    return sign * (before[0] + before[1] * way) <= 0.0


@kernel
def way_to_dip(before: tuple[float, float], after: tuple[float, float], width: float) -> float:
    """Return where in a section `rise`, which has one sign and leads one way at both ends, dips beyond zero as a cubic
    through them does; inf: nowhere. So it is beside two feet that are about to be one.
    """
    sign = -1.0 if before[0] < 0.0 else 1.0
    first, last = sign * before[0], sign * after[0]
    starts, ends = sign * before[1] * width, sign * after[1] * width
    if not ((starts >= 0.0 and ends > last) or (ends <= 0.0 and -starts > first)):
        return math.inf  # a tangent does not reach zero
    cube, square = starts + ends - 2.0 * (last - first), 3.0 * (last - first) - 2.0 * starts - ends
    root = square * square - 3.0 * cube * starts
    if root <= 0.0 or cube == 0.0:
        return math.inf
    share = (math.sqrt(root) - square) / (3.0 * cube)
    at = first + share * (starts + share * (square + share * cube))
    return share * width if 0.0 < share < 1.0 and at <= 0.0 else math.inf


@kernel
def farthest_rise(
    seen: Seen, other: Feature, low: float, high: float, before: tuple[float, float], after: tuple[float, float]
) -> tuple[float, float]:
    """Return an angle of a section at which `rise` is beyond zero, if there is one, and `rise` there."""
    sign, slope_low, slope_high = (-1.0 if before[0] < 0.0 else 1.0), before[1], after[1]
    angle, at, last_side = low, before, 0.0
    for _ in range(EXTREME_STEPS):  # false position on the slope (Illinois)
        angle = low - slope_low * (high - low) / (slope_high - slope_low)
        if not low < angle < high:
            break
        at = rise(seen, other, math.cos(angle), math.sin(angle))
        if sign * at[0] <= 0.0:
            break
        if (at[1] < 0.0) == (slope_low < 0.0):
            low, slope_low = angle, at[1]
            slope_high *= 0.5 if last_side < 0.0 else 1.0
            last_side = -1.0
        else:
            high, slope_high = angle, at[1]
            slope_low *= 0.5 if last_side > 0.0 else 1.0
            last_side = 1.0
    return angle, at[0]


@kernel
def root_of_rise(seen: Seen, other: Feature, low: float, high: float, at_low: float, at_high: float) -> float:
    """Return the angle at which `rise` is zero, between two where it is below and not below zero."""
    angle, last_side = low, 0.0
    for _ in range(ITERATIONS):  # false position; where one end stays, its value is halved (Illinois)
        before, angle = angle, min(max(low - at_low * (high - low) / (at_high - at_low), low), high)
        at, _ = rise(seen, other, math.cos(angle), math.sin(angle))
        if at == 0.0 or abs(angle - before) <= ROUNDING:
            break
        if at < 0.0:
            low, at_low = angle, at
            at_high *= 0.5 if last_side < 0.0 else 1.0
        else:
            high, at_high = angle, at
            at_low *= 0.5 if last_side > 0.0 else 1.0
        last_side = at
    return angle


@kernel
def clearance_of_arc(rim: Feature, other: Feature) -> float:
    """Return how far an edge or another rim, both in the world, is from what of an arc it is nearest to, a place or an
    end: above zero, though they may be deep in each other.
    """
    feet = feet_on(rim, other)
    before, after = end_of_search(rim, -1.0), end_of_search(rim, 1.0)
    least = min(abs(distance_at(other, before)), abs(distance_at(other, after)))
    if feet.n_feet > 0:
        least = min(least, abs(distance_at(other, on_rim(rim, feet.first, True).point)))
    if feet.n_feet > 1:
        least = min(least, abs(distance_at(other, on_rim(rim, feet.last, True).point)))
    return least


@kernel
def distance_from_arc(rim: Feature, other: Feature) -> float:
    """Return how far an edge or another rim is from an arc on which it has no place of its own: an end or, where it
    would be the second one, the first place is nearest.
    """
    before, after = end_of_search(rim, -1.0), end_of_search(rim, 1.0)
    least = min(distance_at(other, before), distance_at(other, after))
    if rim.is_second:
        feet = feet_on(rim, other)
        if feet.n_feet > 0:
            least = min(least, distance_at(other, on_rim(rim, feet.first, True).point))
    return least


@kernel
def end_of_search(rim: Feature, side: float) -> Vector:
    """Return a little beyond the end of an arc before (side -1) or after its middle."""
    return towards(rim, COSINES[0], side * SINES[SECTIONS], False).point
