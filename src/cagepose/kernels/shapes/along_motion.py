"""When two features touch first while the object moves at a constant twist.

What is asked of two features is a smooth function F of the amount, above zero where they are apart: the distance of a
vertex from the plane of a face, the squared distance of a vertex from another one or from a line less that of touching,
or, of two edges, the volume that they span. With F, its slope and bounds on its second derivative over the rest of the
motion, steps are known that jump over no root; near one they become Newton's. Where F is zero it is asked whether both
features reach there; if not, the search goes on behind.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, moved_point, turned, turned_by_amount, velocity_at
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import (
    EDGE,
    FACE,
    RIM,
    VERTEX,
    Feature,
    Shapes,
    beyond_fence,
    is_bar,
    is_end,
    write_feature,
    write_fence,
)
from cagepose.kernels.shapes.meeting import PARALLEL, both_reach, meeting
from cagepose.kernels.shapes.rims import middle_of_arc, reach_of_arc

EVALUATIONS = 400
"""F is evaluated at most so many times for one pair of features. A contact that grazes may need them all. Then it
counts where the search has come, if the features reach there."""
LEAST_STEP = 1e-15
"""In amounts of the whole motion: a shorter step is no progress."""
BEHIND, FARTHER = 1e-9, 8.0
"""In amounts of the whole motion: how far behind a root that is no contact the search goes on, and how many times that
if it is still at one."""
NEAR_ROOT = 1e-12
"""In amounts of the whole motion: features that stay apart for longer are at no contact, though F has changed sides in
a step by how far apart they are, as where the lines of edges that were parallel cross.
"""
GRAZING = 1e-14
"""Fraction of the square of the slope. A smaller discriminant may be rounding, as where a small radius makes two roots
one. The step then ends before them."""
NARROWER = 4.0
"""Bounds over the rest of the motion are too wide where only a small part of it is stepped over: they are asked again
over so many times that part, and over ever more while all of it is stepped over."""


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
    """A point at ``between`` from another one, over a length of the motion; it moves with ``way``."""
    speed, far, least = norm(way), norm(between), allowed_radius(radius, level)
    turning = motion.rate * norm(cross(motion.axis, way))
    bend, slowest = 2.0 * (far + speed * span) * turning, max(0.0, speed - turning * span)
    return Ahead(
        dot(between, between) - least * least,
        2.0 * dot(between, way),
        2.0 * slowest * slowest - bend,
        2.0 * speed * speed + bend,
        far > radius + level,
    )


@kernel
def side_ahead(
    motion: Motion, edge: Feature, along: Vector, between: Vector, way: Vector, radius: float, level: float, span: float
) -> Ahead:
    """A point at ``between`` from the end of an edge's axis ``along``, over a length of the motion; it moves with
    ``way``, both as seen from the edge. The sum of radii shrinks along a cone and is below zero in a hole.
    """
    sense, taper = math.copysign(1.0, edge.radius), edge.taper
    height, rising, speed = dot(between, along), dot(way, along), norm(way)
    across, sliding = minus(between, scaled(along, height)), minus(way, scaled(along, rising))
    turning = motion.rate * norm(cross(motion.axis, way))
    wide = radius - taper * height
    wanted = sense * (allowed_radius(wide, level) if sense > 0.0 and taper == 0.0 else wide - level)
    share = 1.0 - taper * taper  # of the squares, on a cone
    slowest, fastest = max(0.0, norm(sliding) - turning * span), min(speed, norm(sliding) + turning * span)
    flattest, steepest = max(0.0, abs(rising) - turning * span), min(speed, abs(rising) + turning * span)
    far, shrinking = norm(across) + fastest * span, abs(taper) * steepest
    bend = 2.0 * turning * (share * far + abs(taper) * (abs(wanted) + shrinking * span))
    value = share * dot(across, across) - wanted * abs(wanted)  # beyond its tip a cone is nowhere
    slope = 2.0 * (share * dot(across, way) + sense * taper * abs(wanted) * rising)
    widening = -((taper * flattest) ** 2) if wanted >= shrinking * span else shrinking * shrinking
    low = 2.0 * (share * slowest * slowest - shrinking * shrinking) - bend
    high = 2.0 * (share * fastest * fastest + widening) + bend
    is_clear = sense * math.sqrt(share) * norm(across) > wide + level
    if sense > 0.0:
        return Ahead(value, slope, low, high, is_clear)
    return Ahead(-value, -slope, -high, -low, is_clear)


@kernel
def allowed_radius(radius: float, level: float) -> float:
    """Return how near the cores of two features may come that may be ``level`` deep in each other."""
    return max(radius - level, 0.5 * radius)


@kernel
def edges_ahead(
    motion: Motion, p: Vector, u: Vector, q: Vector, w: Vector, radius: float, level: float, side: float, span: float
) -> Ahead:
    """An edge through p along u that moves, and one through q along w; with ``radius`` zero, ``side`` is the sign of
    the volume with which they are apart.
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
    slowest = max(0.0, abs(slope) - bend * span)
    slope = 2.0 * (volume * slope + rounded * cosine * dot(turning, w))
    bend = 2.0 * far * bend + 4.0 * rounded * motion.rate * motion.rate
    fastest = speed * steepest + far * motion.rate
    return Ahead(value, slope, 2.0 * slowest * slowest - bend, 2.0 * fastest * fastest + bend, is_clear)


@kernel
def ahead(
    a: Shapes, i: int, b: Shapes, j: int, motion: Motion, amount: float, level: float, side: float, span: float
) -> Ahead:
    """Return F for feature i of the object after an amount, and feature j of the cage; F is above zero until they are
    deeper in each other than ``level``.
    """
    one, other = a.features[i].kind, b.features[j].kind
    radius = a.features[i].radius + b.features[j].radius
    so_far = turned_by_amount(motion, amount)
    p = moved_point(motion, vector_from(a.features[i].point), so_far)
    q = vector_from(b.features[j].point)
    if one == VERTEX and other == FACE:
        normal = vector_from(b.features[j].direction)
        return plane_ahead(motion, normal, dot(normal, minus(p, q)) - radius, velocity_at(motion, p), level)
    if one == VERTEX:
        between, way = minus(p, q), velocity_at(motion, p)
        if other == EDGE:
            line = vector_from(b.features[j].direction)
            return side_ahead(motion, b.features[j], line, between, way, radius, level, span)
        return distance_ahead(motion, between, way, radius, level, span)
    along = turned(motion, vector_from(a.features[i].direction), so_far)
    way = scaled(velocity_at(motion, q), -1.0)
    if one == FACE:
        return plane_ahead(motion, along, dot(along, minus(q, p)) - radius, way, level)
    if other == VERTEX:
        return side_ahead(motion, a.features[i], along, minus(q, p), way, radius, level, span)
    return edges_ahead(motion, p, along, q, vector_from(b.features[j].direction), radius, level, side, span)


@kernel
def safe_step(now: Ahead) -> float:
    """Return how far F stays on its side of zero: to the root of the parabola that bends to it most (2.12)."""
    value, slope, bend = now.value, now.slope, now.low
    if value < 0.0:
        value, slope, bend = -value, -slope, -now.high
    discriminant = slope * slope - 2.0 * bend * value
    if discriminant < -GRAZING * slope * slope:
        return math.inf
    root = math.sqrt(max(discriminant, GRAZING * slope * slope))
    if slope > 0.0:  # it grows first, and at zero begins there
        return math.inf if bend >= 0.0 else (root + slope) / -bend
    return math.inf if root == slope else 2.0 * value / (root - slope)


@kernel
def between_segments(p: Vector, u: Vector, length: float, q: Vector, w: Vector, other_length: float) -> float:
    """Return how far apart two segments are that begin at p and q."""
    between, cosine = minus(p, q), dot(u, w)
    crossed = cross(u, w)
    square = dot(crossed, crossed)  # 1 - cosine^2 would be rounding where they are nearly parallel
    along, other_along = dot(between, u), dot(between, w)
    s = 0.0
    if square > 0.0:
        s = min(max(dot(between, minus(scaled(w, cosine), u)) / square, 0.0), length)
    t = min(max(other_along + s * cosine, 0.0), other_length)
    s = min(max(t * cosine - along, 0.0), length)
    return norm(minus(plus(between, scaled(u, s)), scaled(w, t)))


@kernel
def can_touch(a: Shapes, i: int, b: Shapes, j: int) -> bool:
    """Whether features of these kinds can touch: faces and edges meet at vertices, rims and crossings."""
    one, other = a.features[i].kind, b.features[j].kind
    if one == FACE or other == FACE:
        return is_end(a.features[i]) or is_end(b.features[j])
    if one == EDGE and other == EDGE:
        return min(a.features[i].radius, b.features[j].radius) >= 0.0
    if one == RIM and b.features[j].is_second:  # the place on the first one's arc tells that on the other
        return False
    if one in (EDGE, RIM) and other in (EDGE, RIM):
        return is_bar(a.features[i]) or is_bar(b.features[j])
    is_second = a.features[i].is_second or b.features[j].is_second
    return a.features[i].radius + b.features[j].radius != 0.0 and not is_second


@kernel
def are_sharp_edges(a: Shapes, i: int, b: Shapes, j: int) -> bool:
    """Whether two features are edges without a radius, which are apart on either side of each other."""
    one, other = a.features[i], b.features[j]
    return one.kind == EDGE and other.kind == EDGE and one.radius + other.radius == 0.0


@kernel
def distance_from(shapes: Shapes, i: int, point: Vector) -> float:
    """Return how far a point is from a feature's core as far as it reaches; of a face or a rim, or less."""
    feature = shapes.features[i]
    seen, direction = minus(point, vector_from(feature.point)), vector_from(feature.direction)
    if feature.kind == EDGE:
        along = min(max(dot(direction, seen), 0.0), feature.length)
        return norm(minus(seen, scaled(direction, along)))
    if feature.kind == FACE:
        height, beyond = dot(direction, seen), 0.0
        in_plane = minus(seen, scaled(direction, height))
        for f in range(feature.first_fence, feature.last_fence):
            beyond = max(beyond, beyond_fence(shapes.fences[f], in_plane))
        return math.sqrt(height * height + beyond * beyond)
    if feature.kind == RIM:
        return max(0.0, norm(minus(point, middle_of_arc(feature))) - reach_of_arc(feature))
    return norm(seen)


@kernel
def clear_step(a: Shapes, i: int, b: Shapes, j: int, motion: Motion, amount: float, moved: Shapes) -> float:
    """Return how much farther the motion surely leads without a contact of two features, by how far apart they are.

    What F says of planes and lines where no feature is, needs no search then.
    """
    place_moved(a, i, motion, amount, moved)
    one, other = moved.features[i], b.features[j]
    if one.kind == EDGE and other.kind == EDGE:
        p, u = vector_from(one.point), vector_from(one.direction)
        away = between_segments(p, u, one.length, vector_from(other.point), vector_from(other.direction), other.length)
        end = plus(p, scaled(u, one.length))
        speed = max(norm(velocity_at(motion, p)), norm(velocity_at(motion, end)))
    elif one.kind == VERTEX:
        point = vector_from(one.point)
        away, speed = distance_from(b, j, point), norm(velocity_at(motion, point))
    else:
        point = vector_from(other.point)
        away, speed = distance_from(moved, i, point), norm(velocity_at(motion, point))
    away -= one.radius + other.radius
    if away <= 0.0 or not (keeps_radius(one) and keeps_radius(other)):
        return 0.0
    return away / speed if speed > 0.0 else math.inf


@kernel
def keeps_radius(feature: Feature) -> bool:
    """Whether a feature is its core and no more than its radius around it: not so a hole, or the side of a cone."""
    return feature.radius >= 0.0 and (feature.kind != EDGE or feature.taper == 0.0)


@kernel
def is_near_part(a: Shapes, i: int, b: Shapes, other: int, within_m: float) -> bool:
    """Whether a feature may be so near to a part."""
    if within_m == math.inf or not keeps_radius(a.features[i]):
        return True
    away = distance_from(a, i, vector_from(b.parts[other].middle)) - a.features[i].radius
    return away <= b.parts[other].reach + within_m


@kernel
def stay_parallel(moved: Shapes, i: int, b: Shapes, j: int, motion: Motion, span: float) -> bool:
    """Whether two edges stay side by side over a length of the motion: then they meet at their ends alone."""
    one, other = moved.features[i], b.features[j]
    if one.kind != EDGE or other.kind != EDGE:
        return False
    return norm(cross(vector_from(one.direction), vector_from(other.direction))) + motion.rate * span < PARALLEL


@kernel
def place_moved(a: Shapes, i: int, motion: Motion, amount: float, moved: Shapes) -> None:
    """Write a feature as it is after an amount."""
    feature, so_far = a.features[i], turned_by_amount(motion, amount)
    point, toward = moved_point(motion, vector_from(feature.point), so_far), vector_from(feature.toward)
    if feature.kind == RIM or feature.kind == EDGE:
        toward = turned(motion, toward, so_far)
    direction = turned(motion, vector_from(feature.direction), so_far)
    write_feature(feature, point, direction, toward, moved.features[i])
    for f in range(feature.first_fence, feature.last_fence):
        write_fence(a.fences[f], turned(motion, vector_from(a.fences[f].direction), so_far), moved.fences[f])


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
def gone_on(amount: float, step: float, end: float, behind: float) -> tuple[float, float]:
    """Return where a search for a contact goes on, and how far behind the next root: a step ahead; or, where that is no
    progress, behind a root that is no contact, farther each time.
    """
    if step > LEAST_STEP * end:
        return amount + step, BEHIND * end
    return amount + behind, FARTHER * behind


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
    amount, was_apart, is_jump, behind = 0.0, False, False, BEHIND * end
    for _ in range(EVALUATIONS):
        rest = end - amount
        now = ahead(a, i, b, j, motion, amount, level, side, rest)
        if level > 0.0 and now.is_clear:
            level = 0.0
            continue
        is_at_root = was_apart and now.value < 0.0  # by rounding
        if is_at_root and is_jump:
            is_at_root = clear_step(a, i, b, j, motion, amount, moved) <= NEAR_ROOT * end
        if is_at_root and touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved):
            return amount
        if is_sharp and level == 0.0 and now.value < 0.0:  # lines that have crossed, but not where both edges are
            side, now = -side, Ahead(-now.value, -now.slope, now.low, now.high, False)
        was_apart, is_jump = now.value >= 0.0, False
        step = safe_step(now)
        if NARROWER * step < rest:
            span, is_over = NARROWER * step, True
            while is_over and 0.0 < span < rest:
                narrow = safe_step(ahead(a, i, b, j, motion, amount, level, side, span))
                step, is_over = max(step, min(narrow, span)), narrow >= span
                span *= NARROWER
            clear = clear_step(a, i, b, j, motion, amount, moved)
            step, is_jump = max(step, clear), clear > step
            if stay_parallel(moved, i, b, j, motion, rest):
                return math.inf
        if step >= rest:
            return math.inf
        if step <= LEAST_STEP * end and touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved):
            return amount
        amount, behind = gone_on(amount, step, end, behind)
        if amount >= end:
            return math.inf
    return amount if touches_after(a, i, b, j, motion, amount, level, slack, slack_m, moved) else math.inf
