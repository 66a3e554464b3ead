"""A circle that lies flat on a face: the arcs of it that the face goes on under.

Angles where a bound of the face crosses the circle are found in closed form, to all digits. Between two of them it is
either over the face or not: a place in the middle tells, to the slack that places of faces have. So a circle that leads
out of a face by less than the slack does not leave it. A half-space is crossed where ahead cos + aside sin = -base, and
a bound that is a circle at (x - m)^2 = R^2, which is no less a line through the places where they cross.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, scaled, vector_from
from cagepose.kernels.boundary.circle import WHOLE_TURN, circle_of
from cagepose.kernels.boundary.features import (
    HALF_SPACE,
    SEGMENT,
    Bound,
    Feature,
    PlacedBoundary,
    in_body,
    seen_from_feature,
)
from cagepose.kernels.boundary.reach import beyond_face, bulge_at, center_of
from cagepose.kernels.circles.places import Circle, angle_toward, on_circle
from cagepose.kernels.native.kernel import kernel

SAME_ANGLE = 1e-12
"""Radians: crossings that are nearer to each other are one."""
TURN = 2.0 * math.pi


class Arc(NamedTuple):
    """A stretch of a circle, radians: from one angle to another, which may be the same; from inf: none."""

    first: float
    last: float


@kernel
def circle_from_face(circle: Feature, body: PlacedBoundary, j: int) -> Circle:
    """Return a circle as seen from a face's own point, in the frame of its body."""
    axis, toward = in_body(body, vector_from(circle.direction)), in_body(body, vector_from(circle.toward))
    return Circle(seen_from_feature(body, j, vector_from(circle.point)), axis, toward, circle.length)


@kernel
def is_over(circle: Circle, body: PlacedBoundary, j: int, angle: float, slack_m: float) -> bool:
    """Whether a place of a circle in the world is over a face."""
    return beyond_face(body, j, on_circle(circle, angle).point) <= slack_m


@kernel
def to_angle(angle: float, at: float) -> float:
    """Return how far on an angle is from another one, up to a turn; a turn: it is the same."""
    ahead = angle - at - TURN * math.floor((angle - at) / TURN)
    return ahead if ahead > SAME_ANGLE else TURN


@kernel
def to_crossing(seen: Circle, body: PlacedBoundary, j: int, at: float, slack_m: float) -> float:
    """Return how far on from an angle of a circle, radians, the next bound of a face crosses it; inf: none does."""
    feature, least = body.own.features[j], math.inf
    for k in range(feature.first_bound, feature.last_bound):
        bound = body.own.bounds[k]
        if bound.kind == SEGMENT:
            least = min(least, to_segment(seen, bound, vector_from(feature.direction), at, slack_m))
            continue
        way = vector_from(bound.direction)
        if bound.kind == HALF_SPACE:
            crossing = crossing_of(seen, way, dot(way, seen.centre) - bound.limit, slack_m)
        else:
            crossing = crossing_of_circle(seen, way, bound.limit, slack_m)
        for side in range(2):
            if crossing.first < math.inf:
                least = min(least, to_angle(crossing.first if side == 0 else crossing.last, at))
    return least


@kernel
def crossing_of(seen: Circle, way: Vector, base: float, slack: float) -> Arc:
    """Return the two angles where base + way . (x - centre) is zero on a circle; where it is not, to a slack, the one
    where it is nearest to zero, twice.
    """
    ahead = seen.radius * dot(way, seen.toward)
    aside = seen.radius * dot(way, cross(seen.axis, seen.toward))
    widest = math.hypot(ahead, aside)
    if widest == 0.0 or abs(base) > widest + slack:
        return Arc(math.inf, math.inf)
    middle, half = math.atan2(aside, ahead), math.acos(min(max(-base / widest, -1.0), 1.0))
    return Arc(middle - half, middle + half)


@kernel
def crossing_of_circle(seen: Circle, center: Vector, radius: float, slack_m: float) -> Arc:
    """As `crossing_of`, of another circle in the same plane."""
    way = minus(seen.centre, center)
    base = 0.5 * (dot(way, way) + (seen.radius - radius) * (seen.radius + radius))
    return crossing_of(seen, way, base, slack_m * radius)


@kernel
def to_segment(seen: Circle, segment: Bound, normal: Vector, at: float, slack_m: float) -> float:
    """Return how far on from an angle of a circle a segment crosses it or, to a slack, starts on it; inf: nowhere."""
    start, least = vector_from(segment.direction), math.inf
    along = minus(vector_from(segment.end), start)
    size = norm(along)
    if abs(norm(minus(start, seen.centre)) - seen.radius) <= slack_m:
        least = to_angle(angle_toward(seen, start), at)
    across = scaled(cross(normal, along), 1.0 / size)
    crossing = crossing_of(seen, across, dot(across, minus(seen.centre, start)), slack_m)
    if segment.limit != 0.0:
        crossing = crossing_of_circle(seen, center_of(segment, normal), 1.0 / abs(segment.limit), slack_m)
    for side in range(2):
        angle = crossing.first if side == 0 else crossing.last
        if angle < math.inf:
            place = on_circle(seen, angle).point
            share = dot(along, minus(place, start)) / size
            is_on_arc = segment.limit != 0.0 and bulge_at(segment, place, normal) >= -slack_m
            if is_on_arc or (segment.limit == 0.0 and -slack_m <= share <= size + slack_m):
                least = min(least, to_angle(angle, at))
    return least


@kernel
def part_to_ask(circle: Feature, body: PlacedBoundary, j: int, slack_m: float) -> Arc:
    """Return the stretch of a circle that its arcs over a face are in: of a whole circle that leaves the face, one that
    it has left the face before and after; a whole turn: it does not leave it; from inf: no place of it is over it.
    """
    if circle.width < WHOLE_TURN:
        return Arc(circle.start, circle.start + circle.width)
    whole, seen = circle_of(circle), circle_from_face(circle, body, j)
    begin = to_crossing(seen, body, j, 0.0, slack_m)
    if begin == math.inf:
        return Arc(0.0, TURN) if is_over(whole, body, j, 0.0, slack_m) else Arc(math.inf, math.inf)
    at = begin
    while at < begin + TURN - SAME_ANGLE:
        ahead = to_crossing(seen, body, j, at, slack_m)
        if not is_over(whole, body, j, at + 0.5 * ahead, slack_m):
            return Arc(at + ahead, at + TURN)
        at += ahead
    return Arc(0.0, TURN)


@kernel
def next_arc(circle: Feature, body: PlacedBoundary, j: int, at: float, end: float, counts: bool, slack_m: float) -> Arc:
    """Return the next arc of a circle over a face from an angle on; from inf: there is none up to the end.

    ``counts``: whether the place at that angle is asked for by itself; it is not if an arc has ended there.
    """
    whole, seen = circle_of(circle), circle_from_face(circle, body, j)
    first = math.inf
    while at < end - SAME_ANGLE:
        last = min(at + to_crossing(seen, body, j, at, slack_m), end)
        if is_over(whole, body, j, 0.5 * (at + last), slack_m):
            first = min(first, at)
        elif first < math.inf:
            return Arc(first, at)
        elif counts and is_over(whole, body, j, at, slack_m):
            return Arc(at, at)
        counts, at = True, last
    if first < math.inf:
        return Arc(first, end)
    if counts and is_over(whole, body, j, end, slack_m):
        return Arc(end, end)
    return Arc(math.inf, math.inf)
