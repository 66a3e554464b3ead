"""The smooth function of the amount of a motion whose root is a contact of two features that are no circles.

What is asked of two features is a function F of the amount, above zero where they are apart: the distance of a vertex
from the plane of a face, the squared distance of a vertex from another one or from a line less that of touching, or, of
two lines, the volume that they span. With F, its slope and bounds on its second derivative over the rest of the motion,
steps are known that jump over no root; near one they become Newton's.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, moved_point, turned, turned_by_amount, velocity_at
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import FACE, LINE, VERTEX, Feature
from cagepose.kernels.boundary.met import PARALLEL
from cagepose.kernels.native.kernel import kernel

LEAST_STEP = 1e-15
"""In amounts of the whole motion: a shorter step is no progress."""
BEHIND, FARTHER = 1e-9, 8.0
"""In amounts of the whole motion: how far behind a root that is no contact the search goes on, and how many times that
if it is still at one."""
GRAZING = 1e-14
"""Fraction of the square of the slope. A smaller discriminant may be rounding, as where a small radius makes two roots
one. The step then ends before them."""


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
    motion: Motion, line: Feature, along: Vector, between: Vector, way: Vector, radius: float, level: float, span: float
) -> Ahead:
    """A point at ``between`` from the end of a line's axis ``along``, over a length of the motion; it moves with
    ``way``, both as seen from the line. The sum of radii shrinks along a cone and is below zero in a hole.
    """
    sense, taper = math.copysign(1.0, line.radius), line.taper
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
def lines_ahead(
    motion: Motion, p: Vector, u: Vector, q: Vector, w: Vector, radius: float, level: float, side: float, span: float
) -> Ahead:
    """A line through p along u that moves, and one through q along w; with ``radius`` zero, ``side`` is the sign of
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
def ahead(held: Feature, cage: Feature, motion: Motion, amount: float, level: float, side: float, span: float) -> Ahead:
    """Return F for a feature of the object after an amount, and one of the cage; F is above zero until they are deeper
    in each other than ``level``.
    """
    one, other = held.kind, cage.kind
    radius = held.radius + cage.radius
    so_far = turned_by_amount(motion, amount)
    p = moved_point(motion, vector_from(held.point), so_far)
    q = vector_from(cage.point)
    if one == VERTEX and other == FACE:
        normal = vector_from(cage.direction)
        return plane_ahead(motion, normal, dot(normal, minus(p, q)) - radius, velocity_at(motion, p), level)
    if one == VERTEX:
        between, way = minus(p, q), velocity_at(motion, p)
        if other == LINE:
            along = vector_from(cage.direction)
            return side_ahead(motion, cage, along, between, way, radius, level, span)
        return distance_ahead(motion, between, way, radius, level, span)
    along = turned(motion, vector_from(held.direction), so_far)
    way = scaled(velocity_at(motion, q), -1.0)
    if one == FACE:
        return plane_ahead(motion, along, dot(along, minus(q, p)) - radius, way, level)
    if other == VERTEX:
        return side_ahead(motion, held, along, minus(q, p), way, radius, level, span)
    return lines_ahead(motion, p, along, q, vector_from(cage.direction), radius, level, side, span)


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
def gone_on(amount: float, step: float, end: float, behind: float) -> tuple[float, float]:
    """Return where a search for a contact goes on, and how far behind the next root: a step ahead; or, where that is no
    progress, behind a root that is no contact, farther each time.
    """
    if step > LEAST_STEP * end:
        return amount + step, BEHIND * end
    return amount + behind, FARTHER * behind
