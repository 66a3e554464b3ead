"""Round rims: where on an arc another feature is nearest, equation (2.13).

A rim is a row of vertices without end: what meets it meets one of them, the foot. Of a face it is the lowest point, of
a vertex the point in its direction, both in closed form. Of an edge or another rim it is where the way to the nearest
point there has no part along the tangent: a root of one function of one angle.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, VERTEX, Feature

ARCS = 8
"""Of one rim."""
HALF_ARC = math.pi / ARCS
SEARCHED = 1.05 * HALF_ARC
"""To each side of an arc's middle: a little beyond its ends."""
FLAT = 1e-13
"""Sine: flatter, a face lies on all of a rim, and its vertices meet it."""
UPRIGHT = 1e-12
"""Sine: what is less along a rim's plane is across it."""
SECTIONS = 6
"""Of an arc, that are searched for a foot each: two rims in nearly the same plane have several."""
SECTION = 2.0 * SEARCHED / SECTIONS
COSINES = tuple(math.cos(-SEARCHED + section * SECTION) for section in range(SECTIONS + 1))
SINES = tuple(math.sin(-SEARCHED + section * SECTION) for section in range(SECTIONS + 1))
"""At their ends."""
EXTREME_STEPS = 12
"""Of the search for where the way to the nearest point has most of a part along the tangent."""
ITERATIONS, ROUNDING = 60, 2e-16
"""Of the search for a foot, radians."""
EQUALLY_FAR = 0.5
"""In touch tolerances: where distances along an arc differ by more, its vertices may not have the normal that it
has."""
REACH = 2.0 * math.sin(0.5 * SEARCHED)
"""Of an arc from its middle, in radii."""


class Foot(NamedTuple):
    """A point of an arc that another feature is nearest to.

    Attributes
    ----------
    is_within
        Whether it is nearest among its neighbours, too; else there is no such point.
    point
        In the world.
    tangent
        Unit vector along the rim there.
    """

    is_within: bool
    point: Vector
    tangent: Vector


class OnAxis(NamedTuple):
    """What of an edge is nearest to a point: a place on its axis, where it has a radius, and how far the point is from
    there, below zero in a hole.
    """

    place: Vector
    radius: float
    away: float


@kernel
def nearest_on_edge(edge: Feature, point: Vector) -> OnAxis:
    """Return what of an edge's line is nearest to a point."""
    along = vector_from(edge.direction)
    seen = minus(point, vector_from(edge.point))
    height = dot(along, seen)
    if edge.taper != 0.0:
        side = norm(minus(seen, scaled(along, height))) / math.sqrt(1.0 - edge.taper * edge.taper)
        height -= math.copysign(side, edge.radius) * edge.taper
    place = plus(vector_from(edge.point), scaled(along, height))
    radius = edge.radius - edge.taper * height
    return OnAxis(place, radius, math.copysign(norm(minus(point, place)), edge.radius))


@kernel
def outward_at(rim: Feature, point: Vector) -> Vector:
    """Return the outward normal along the flat end, at a point of a rim."""
    return scaled(minus(point, vector_from(rim.point)), 1.0 / rim.length)


@kernel
def on_rim(rim: Feature, angle: float, is_within: bool) -> Foot:
    """Return the point of a rim at an angle from its arc's middle."""
    return towards(rim, math.cos(angle), math.sin(angle), is_within)


@kernel
def towards(rim: Feature, cosine: float, sine: float, is_within: bool) -> Foot:
    """Return the point of a rim at an angle with this cosine and sine from its arc's middle."""
    toward, axis = vector_from(rim.toward), vector_from(rim.direction)
    outward = plus(scaled(toward, cosine), scaled(cross(axis, toward), sine))
    return Foot(is_within, plus(vector_from(rim.point), scaled(outward, rim.length)), cross(axis, outward))


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


@kernel
def nearest_on_rim(rim: Feature, point: Vector) -> Vector:
    """Return the point of a whole rim that is nearest to a point."""
    axis = vector_from(rim.direction)
    seen = minus(point, vector_from(rim.point))
    across = minus(seen, scaled(axis, dot(seen, axis)))
    size = norm(across)
    if size == 0.0:
        across, size = vector_from(rim.toward), 1.0
    return plus(vector_from(rim.point), scaled(across, abs(rim.length) / size))


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
def distance_at(other: Feature, point: Vector) -> float:
    """Return how far a point of a rim is from an edge's side or another rim."""
    if other.kind == EDGE:
        nearest = nearest_on_edge(other, point)
        return nearest.away - nearest.radius
    return norm(minus(point, nearest_on_rim(other, point)))


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
    low, before, section, split = -SEARCHED, rise(seen, other, COSINES[0], SINES[0]), 0, steepest_angle(seen)
    while section < SECTIONS:
        high = -SEARCHED + (section + 1) * SECTION
        if low < split < high:
            high, after = split, rise(seen, other, math.cos(split), math.sin(split))
        else:
            section += 1
            after = rise(seen, other, COSINES[section], SINES[section])
        since, at_since, until, at_until = low, before[0], high, after[0]
        if (at_since < 0.0) == (at_until < 0.0):
            between = beyond_zero(seen, other, low, high, before, after)
            if at_since < 0.0:
                until, at_until = between
            else:
                since, at_since = between
        if at_since < 0.0 <= at_until:
            foot = root_of_rise(seen, other, since, until, at_since, at_until)
            first, last = nearest_two(rim, other, n_feet, first, last, foot)
            n_feet += 1
        low, before = high, after
    return Feet(n_feet, first, last)


@kernel
def steepest_angle(seen: Seen) -> float:
    """Return the angle from an arc's middle, a quarter turn at most, at which the rim is farthest along the other one's
    direction, or the least far; inf: nowhere. Feet lie to both sides of it.
    """
    square = seen.tilt_ahead * seen.tilt_ahead + seen.tilt_aside * seen.tilt_aside
    if seen.tilt_ahead == 0.0 or square <= UPRIGHT * UPRIGHT:
        return math.inf
    return math.atan(seen.tilt_aside / seen.tilt_ahead)


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
    angle, at = low, before
    for _ in range(EXTREME_STEPS):
        angle = low - slope_low * (high - low) / (slope_high - slope_low)
        if not low < angle < high:
            break
        at = rise(seen, other, math.cos(angle), math.sin(angle))
        if sign * at[0] <= 0.0:
            break
        if (at[1] < 0.0) == (slope_low < 0.0):
            low, slope_low = angle, at[1]
        else:
            high, slope_high = angle, at[1]
    return angle, at[0]


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
def end_of_search(rim: Feature, side: float) -> Vector:
    """Return a little beyond the end of an arc before (side -1) or after its middle."""
    return towards(rim, COSINES[0], side * SINES[SECTIONS], False).point


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
def is_on_arc(rim: Feature, point: Vector, slack_m: float) -> bool:
    """Whether a point of a rim is on its arc, to a length beyond its ends."""
    return dot(outward_at(rim, point), vector_from(rim.toward)) >= math.cos(HALF_ARC) - slack_m / abs(rim.length)


@kernel
def is_near_arc(rim: Feature, point: Vector) -> bool:
    """Whether a point of a rim is on an arc or on the half that is nearer of one next to it."""
    return dot(outward_at(rim, point), vector_from(rim.toward)) >= math.cos(2.0 * HALF_ARC)


@kernel
def beyond_normals(rim: Feature, point: Vector, normal: Vector) -> float:
    """Return how far a direction across the tangent is beyond the outward normals of a rim at one of its points, a
    sine.
    """
    out, along = dot(outward_at(rim, point), normal), dot(vector_from(rim.direction), normal)
    below = rim.taper * out - math.sqrt(1.0 - rim.taper * rim.taper) * along
    return max(below, math.sqrt(1.0 - rim.end_taper * rim.end_taper) * along - rim.end_taper * out)


@kernel
def middle_of_arc(rim: Feature) -> Vector:
    return plus(vector_from(rim.point), scaled(vector_from(rim.toward), rim.length))


@kernel
def end_of_arc(rim: Feature, side: float) -> Vector:
    """Return the end of an arc before (side -1) or after its middle."""
    return on_rim(rim, side * HALF_ARC, True).point


@kernel
def reach_of_arc(rim: Feature) -> float:
    return REACH * abs(rim.length)


@kernel
def lie_flat(one: Feature, other: Feature, touch_m: float) -> bool:
    """Whether a face, a ball or a round side lies on all of an arc of a rim, to the touch tolerance: then the rim's
    vertices tell all.
    """
    rim, on_rim = (one, other) if one.kind == RIM else (other, one)
    if rim.kind != RIM or on_rim.kind == RIM:
        return False
    if on_rim.kind == EDGE:
        return lies_along(rim, on_rim, touch_m)
    axis, way, away = vector_from(rim.direction), vector_from(on_rim.direction), 1.0
    if on_rim.kind == VERTEX:
        way = minus(vector_from(on_rim.point), vector_from(rim.point))
        away = math.hypot(rim.length, norm(way))
    return abs(rim.length) * norm(cross(axis, way)) <= touch_m * away


@kernel
def lies_along(rim: Feature, side: Feature, touch_m: float) -> bool:
    """Whether a round side lies on all of an arc: at its ends and in its middle they are equally far apart."""
    first, middle = distance_at(side, end_of_arc(rim, -1.0)), distance_at(side, middle_of_arc(rim))
    last = distance_at(side, end_of_arc(rim, 1.0))
    least, most = min(first, middle, last), max(first, middle, last)
    return most - least <= EQUALLY_FAR * touch_m and max(most, -least) <= touch_m
