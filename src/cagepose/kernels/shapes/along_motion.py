"""When two features touch first while the object moves at a constant twist.

What is asked of two features is a smooth function F of the amount, above zero where they are apart: the distance of a
vertex from the plane of a face, the squared distance of a vertex from another one or from a line, less that of touching,
or, of two edges, the volume that they span. With F, its slope and bounds on its second derivative over the rest of the
motion, steps are known that jump over no root; near one they become Newton's. Where F is zero it is asked whether both
features reach there; if not, the search goes on behind.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Shapes, write_feature, write_fence
from cagepose.kernels.shapes.meeting import PARALLEL, both_reach, meeting
from cagepose.kernels.shapes.motion import Motion, moved_point, turned, velocity_at

EVALUATIONS = 400
"""Of F, for one pair of features. A contact that grazes may need them all: then it counts where the search has come."""
LEAST_STEP = 1e-15
"""In amounts of the whole motion: a shorter step is no progress."""
BEHIND = 1e-9
"""In amounts of the whole motion: how far behind a root that is no contact the search goes on."""
NARROWER = 4.0
"""Bounds over the rest of the motion are too wide where only a small part of it is stepped over: they are asked again
over so many times that part."""


class Ahead(NamedTuple):
    """F at an amount, its slope, bounds on its second derivative over what comes, and whether the features are farther
    apart than they may be deep in each other.
    """

    value: float
    slope: float
    low: float
    high: float
    is_clear: bool


@kernel
def plane_ahead(motion: Motion, normal: Vector, height: float, way: Vector, level: float) -> Ahead:
    """A point that moves with ``way`` over a plane, so high: both as seen from what the plane belongs to."""
    turn = dot(normal, motion.axis) if motion.rate > 0.0 else 1.0
    bend = motion.rate * norm(cross(motion.axis, way)) * math.sqrt(max(0.0, 1.0 - turn * turn))
    return Ahead(height + level, dot(normal, way), -bend, bend, height > level)


@kernel
def distance_ahead(motion: Motion, between: Vector, way: Vector, radius: float, level: float, span: float) -> Ahead:
    """A point at ``between`` from another one or from a line, that moves with ``way``, over a length of the motion."""
    speed, far, least = norm(way), norm(between), allowed_radius(radius, level)
    bend = 2.0 * (far + speed * span) * motion.rate * norm(cross(motion.axis, way))
    return Ahead(
        dot(between, between) - least * least,
        2.0 * dot(between, way),
        -bend,
        2.0 * speed * speed + bend,
        far > radius + level,
    )


@kernel
def allowed_radius(radius: float, level: float) -> float:
    """Return how near the cores of two features may come that may be ``level`` deep in each other."""
    return max(radius - level, 0.5 * radius)


@kernel
def across_line(between: Vector, along: Vector) -> Vector:
    return minus(between, scaled(along, dot(between, along)))


@kernel
def edges_ahead(
    motion: Motion, p: Vector, u: Vector, q: Vector, w: Vector, radius: float, level: float, side: float, span: float
) -> Ahead:
    """An edge through p along u that moves, and one through q along w; with ``radius`` zero, ``side`` is the sign of the
    volume with which they are apart.
    """
    crossed = cross(u, w)
    square = dot(crossed, crossed)
    between = minus(p, q)
    if square > PARALLEL * PARALLEL:  # from the nearest points of the two lines, so that bounds are tight
        p = plus(p, scaled(u, -dot(cross(between, w), crossed) / square))
        between = scaled(crossed, dot(between, crossed) / square)
    way, turning = velocity_at(motion, p), scaled(cross(motion.axis, u), motion.rate)
    volume = dot(between, crossed)
    slope = dot(way, crossed) + dot(between, cross(turning, w))
    speed = norm(way)
    far = norm(between) + speed * span
    sine = math.sqrt(square)
    steepest = min(1.0, sine + motion.rate * span)
    bend = motion.rate * (norm(cross(motion.axis, way)) * steepest + 2.0 * speed + far * motion.rate)
    if radius == 0.0:
        return Ahead(side * volume + level * sine, side * slope, -bend, bend, side * volume > level * sine)
    is_clear = volume * volume > (radius + level) * (radius + level) * square
    rounded = allowed_radius(radius, level) ** 2
    cosine = dot(u, w)
    value = volume * volume - rounded * square
    slope = 2.0 * (volume * slope + rounded * cosine * dot(turning, w))
    bend = 2.0 * far * bend + 4.0 * rounded * motion.rate * motion.rate
    fastest = speed * steepest + far * motion.rate
    return Ahead(value, slope, -bend, 2.0 * fastest * fastest + bend, is_clear)


@kernel
def ahead(
    a: Shapes, i: int, b: Shapes, j: int, motion: Motion, amount: float, level: float, side: float, span: float
) -> Ahead:
    """Return F for feature i of the object after an amount, and feature j of the cage; F is above zero until they are
    deeper in each other than ``level``.
    """
    one, other = a.features[i].kind, b.features[j].kind
    radius = a.features[i].radius + b.features[j].radius
    p = moved_point(motion, vector_from(a.features[i].point), amount)
    q = vector_from(b.features[j].point)
    if one == VERTEX and other == FACE:
        normal = vector_from(b.features[j].direction)
        return plane_ahead(motion, normal, dot(normal, minus(p, q)) - radius, velocity_at(motion, p), level)
    if one == VERTEX:
        between = minus(p, q)
        if other == EDGE:
            line = vector_from(b.features[j].direction)
            between = across_line(between, line)
        return distance_ahead(motion, between, velocity_at(motion, p), radius, level, span)
    along = turned(motion, vector_from(a.features[i].direction), amount)
    way = scaled(velocity_at(motion, q), -1.0)
    if one == FACE:
        return plane_ahead(motion, along, dot(along, minus(q, p)) - radius, way, level)
    if other == VERTEX:
        return distance_ahead(motion, across_line(minus(q, p), along), way, radius, level, span)
    return edges_ahead(motion, p, along, q, vector_from(b.features[j].direction), radius, level, side, span)


@kernel
def safe_step(now: Ahead) -> float:
    """Return how far F stays on its side of zero: to the first root of the parabola that bends there most; inf: none."""
    value, slope, bend = now.value, now.slope, now.low
    if value < 0.0:
        value, slope, bend = -value, -slope, -now.high
    down = math.sqrt(slope * slope - 2.0 * bend * value) - slope
    return math.inf if down <= 0.0 else 2.0 * value / down


@kernel
def can_touch(a: Shapes, i: int, b: Shapes, j: int) -> bool:
    """Whether features of these kinds can touch: faces and edges meet at vertices and crossings."""
    one, other = a.features[i].kind, b.features[j].kind
    if one == FACE or other == FACE:
        return one == VERTEX or other == VERTEX
    if one == EDGE and other == EDGE:
        return True
    return a.features[i].radius + b.features[j].radius > 0.0


@kernel
def are_sharp_edges(a: Shapes, i: int, b: Shapes, j: int) -> bool:
    """Whether two features are edges without a radius, which are apart on either side of each other."""
    one, other = a.features[i], b.features[j]
    return one.kind == EDGE and other.kind == EDGE and one.radius + other.radius == 0.0


@kernel
def distance_from(shapes: Shapes, i: int, point: Vector) -> float:
    """Return how far a point is from a feature's core as far as it reaches; of a face, or less."""
    feature = shapes.features[i]
    seen, direction = minus(point, vector_from(feature.point)), vector_from(feature.direction)
    if feature.kind == EDGE:
        along = min(max(dot(direction, seen), 0.0), feature.length)
        return norm(minus(seen, scaled(direction, along)))
    if feature.kind == FACE:
        beyond = 0.0
        for f in range(feature.first_fence, feature.last_fence):
            beyond = max(beyond, dot(vector_from(shapes.fences[f].direction), seen) - shapes.fences[f].bound)
        return math.hypot(dot(direction, seen), beyond)
    return norm(seen)


@kernel
def edge_end(shapes: Shapes, i: int) -> Vector:
    """Return the other end of an edge."""
    feature = shapes.features[i]
    return plus(vector_from(feature.point), scaled(vector_from(feature.direction), feature.length))


@kernel
def edges_apart(a: Shapes, i: int, b: Shapes, j: int) -> float:
    """Return how far apart the cores of two edges are; of parallel ones, or less."""
    one, other = a.features[i], b.features[j]
    p, q, u, w = (
        vector_from(one.point),
        vector_from(other.point),
        vector_from(one.direction),
        vector_from(other.direction),
    )
    least = min(
        min(distance_from(b, j, p), distance_from(b, j, edge_end(a, i))),
        min(distance_from(a, i, q), distance_from(a, i, edge_end(b, j))),
    )
    crossed, start = cross(u, w), minus(q, p)
    square = dot(crossed, crossed)
    if square < PARALLEL * PARALLEL:
        return least - PARALLEL * min(one.length, other.length)
    s, t = dot(cross(start, w), crossed) / square, dot(cross(start, u), crossed) / square
    if 0.0 <= s <= one.length and 0.0 <= t <= other.length:
        least = min(least, abs(dot(start, crossed)) / math.sqrt(square))
    return least


@kernel
def clear_step(a: Shapes, i: int, b: Shapes, j: int, motion: Motion, amount: float, moved: Shapes) -> float:
    """Return how much farther the motion surely leads without a contact of two features, by how far apart they are.

    What F says of planes and lines where no feature is, needs no search then.
    """
    place_moved(a, i, motion, amount, moved)
    one, other = a.features[i].kind, b.features[j].kind
    if one == EDGE and other == EDGE:
        away = edges_apart(moved, i, b, j)
        speed = max(
            norm(velocity_at(motion, vector_from(moved.features[i].point))),
            norm(velocity_at(motion, edge_end(moved, i))),
        )
    elif one == VERTEX:
        point = vector_from(moved.features[i].point)
        away, speed = distance_from(b, j, point), norm(velocity_at(motion, point))
    else:
        point = vector_from(b.features[j].point)
        away, speed = distance_from(moved, i, point), norm(velocity_at(motion, point))
    away -= a.features[i].radius + b.features[j].radius
    if away <= 0.0:
        return 0.0
    return away / speed if speed > 0.0 else math.inf


@kernel
def place_moved(a: Shapes, i: int, motion: Motion, amount: float, moved: Shapes) -> None:
    """Write a feature as it is after an amount."""
    feature = a.features[i]
    point = moved_point(motion, vector_from(feature.point), amount)
    write_feature(feature, point, turned(motion, vector_from(feature.direction), amount), moved.features[i])
    for f in range(feature.first_fence, feature.last_fence):
        fence = turned(motion, vector_from(a.fences[f].direction), amount)
        write_fence(fence, a.fences[f].bound, moved.fences[f])


@kernel
def touches_after(
    a: Shapes,
    i: int,
    b: Shapes,
    j: int,
    motion: Motion,
    amount: float,
    level: float,
    slack: float,
    slack_m: float,
    moved: Shapes,
) -> bool:
    """Whether two features reach where they meet after an amount, not on their far sides, and come nearer."""
    place_moved(a, i, motion, amount, moved)
    met = meeting(moved, i, b, j)
    if met.gap < -level - slack_m or not both_reach(moved, i, b, j, met, slack, slack_m):
        return False
    return dot(met.normal, velocity_at(motion, met.place)) > 0.0


@kernel
def first_touch(
    a: Shapes,
    i: int,
    b: Shapes,
    j: int,
    motion: Motion,
    end: float,
    level: float,
    side: float,
    slack: float,
    slack_m: float,
    moved: Shapes,
) -> float:
    """Return the amount, up to ``end``, after which two features touch; inf: they do not.

    Parameters
    ----------
    a, i, b, j
        The features, placed in the world.
    motion, end
        That of the object; the end is finite.
    level
        How deep they may be in each other until they have been well apart, metres: more than they are.
    side
        Of sharp edges that touch: see `edges_ahead`.
    slack, slack_m
        How far beyond its end a feature still counts, the sine of an angle and metres.
    moved
        Memory for the object's shapes.
    """
    is_sharp = are_sharp_edges(a, i, b, j)
    if is_sharp and side == 0.0:
        side = math.copysign(1.0, ahead(a, i, b, j, motion, 0.0, 0.0, 1.0, end).value)
    amount, was_apart = 0.0, False
    for _ in range(EVALUATIONS):
        rest = end - amount
        now = ahead(a, i, b, j, motion, amount, level, side, rest)
        if level > 0.0 and now.is_clear:
            level = 0.0
            continue
        is_at_root = was_apart and now.value < 0.0  # by rounding
        if is_at_root and touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved):
            return amount
        if is_sharp and level == 0.0 and now.value < 0.0:  # lines that have crossed, but not where both edges are
            side, now = -side, Ahead(-now.value, -now.slope, now.low, now.high, False)
        was_apart = now.value >= 0.0
        step = safe_step(now)
        if NARROWER * step < rest:
            narrow = ahead(a, i, b, j, motion, amount, level, side, NARROWER * step)
            step = max(step, min(safe_step(narrow), NARROWER * step))
            step = max(step, clear_step(a, i, b, j, motion, amount, moved))
        if step >= rest:
            return math.inf
        if step > LEAST_STEP * end:
            amount += step
        elif touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved):
            return amount
        else:
            amount += BEHIND * end
            if amount >= end:
                return math.inf
    return amount
