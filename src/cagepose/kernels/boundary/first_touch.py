"""When two features touch first while the object moves at a constant twist.

A smooth function F of the amount says so, with bounds on its second derivative: see `along_motion`. Where it is zero it
is asked whether both features reach there; if not, the search goes on behind.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import Motion, moved_point, turned, turned_by_amount, velocity_at
from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.along_motion import (
    BEHIND,
    LEAST_STEP,
    Ahead,
    ahead,
    between_segments,
    gone_on,
    safe_step,
)
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    position_of,
    rotation_of,
    write_placed,
)
from cagepose.kernels.boundary.hollow_end import reach_in_hollow
from cagepose.kernels.boundary.meeting import meeting
from cagepose.kernels.boundary.met import PARALLEL
from cagepose.kernels.boundary.reach import beyond_face
from cagepose.kernels.native.kernel import kernel

EVALUATIONS = 400
"""F is evaluated at most so many times for one pair of features. A contact that grazes may need them all. Then it
counts where the search has come, if the features reach there."""
NEAR_ROOT = 1e-12
"""In amounts of the whole motion: features that stay apart for longer are at no contact, though F has changed sides in
a step by how far apart they are, as where the lines of edges that were parallel cross.
"""
NARROWER = 4.0
"""Bounds over the rest of the motion are too wide where only a small part of it is stepped over: they are asked again
over so many times that part, and over ever more while all of it is stepped over."""


@kernel
def place_after(body: PlacedBoundary, i: int, motion: Motion, amount: float, moved: PlacedBoundary) -> None:
    """Write one feature, and the pose of its body, as they are after an amount of a motion."""
    so_far, r = turned_by_amount(motion, amount), rotation_of(body)
    position = moved_point(motion, position_of(body), so_far)
    for k in range(3):
        column = turned(motion, (r[0][k], r[1][k], r[2][k]), so_far)
        moved.pose[0, k] = position[k]
        moved.pose[1, k], moved.pose[2, k], moved.pose[3, k] = column
    moved.features[i] = body.own.features[i]  # type: ignore[index]
    write_placed(body.own.features[i], position_of(moved), rotation_of(moved), moved.features[i])


@kernel
def keeps_radius(feature: Feature) -> bool:
    """Whether a feature is its core and no more than its radius around it: not so a hole, or the side of a cone."""
    return feature.radius >= 0.0 and (feature.kind != LINE or feature.taper == 0.0)


@kernel
def distance_from(body: PlacedBoundary, i: int, point: Vector) -> float:
    """Return how far a point is from a feature's core as far as it reaches; of a face or a circle, or less."""
    feature = body.features[i]
    seen, direction = minus(point, vector_from(feature.point)), vector_from(feature.direction)
    if feature.kind == LINE:
        along = min(max(dot(direction, seen), 0.0), feature.length)
        return norm(minus(seen, scaled(direction, along)))
    if feature.kind == FACE:
        height = dot(direction, seen)
        beyond = max(0.0, beyond_face(body, i, minus(point, scaled(direction, height))))
        return math.sqrt(height * height + beyond * beyond)
    if feature.kind == CIRCLE:
        height = dot(direction, seen)
        across = norm(minus(seen, scaled(direction, height)))
        return math.hypot(height, across - feature.length)
    return norm(seen)


@kernel
def clear_step(moved: PlacedBoundary, i: int, b: PlacedBoundary, j: int, motion: Motion, slack_m: float) -> float:
    """Return how much farther the motion surely leads without a contact of two features, which count so far beyond
    their ends, by how far apart they are where they are placed.

    What functions of planes and lines say where no feature is, needs no search then.
    """
    one, other = moved.features[i], b.features[j]
    if not (keeps_radius(one) and keeps_radius(other)):
        return 0.0
    if one.kind == LINE and other.kind == LINE:
        p, u = vector_from(one.point), vector_from(one.direction)
        away = between_segments(p, u, one.length, vector_from(other.point), vector_from(other.direction), other.length)
        speed = max(norm(velocity_at(motion, p)), norm(velocity_at(motion, plus(p, scaled(u, one.length)))))
    elif one.kind == VERTEX:
        point = vector_from(one.point)
        away, speed = distance_from(b, j, point), norm(velocity_at(motion, point))
    else:
        point = vector_from(other.point)
        away, speed = distance_from(moved, i, point), norm(velocity_at(motion, point))
    away -= one.radius + other.radius + slack_m
    if away <= 0.0:
        return 0.0
    return away / speed if speed > 0.0 else math.inf


@kernel
def stay_parallel(one: Feature, other: Feature, motion: Motion, span: float) -> bool:
    """Whether two lines stay side by side over a length of the motion: then they meet at their ends alone."""
    if one.kind != LINE or other.kind != LINE:
        return False
    sine = norm(cross(vector_from(one.direction), vector_from(other.direction)))
    return sine + motion.rate * span < PARALLEL


@kernel
def touches_after(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    amount: float,
    level: float,
    slack: float,
    touch_m: float,
    reach_m: float,
    moved: PlacedBoundary,
    waiting: IntArray,
) -> bool:
    """Whether two features reach where they meet after an amount, not on their far sides, and come nearer."""
    place_after(a, i, motion, amount, moved)
    met = meeting(moved, i, b, j)
    if met.gap < -level - reach_m or dot(met.normal, velocity_at(motion, met.place)) <= 0.0:
        return False
    return reach_in_hollow(moved, i, b, j, met, slack, touch_m, reach_m, waiting)


@kernel
def first_touch(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    motion: Motion,
    end: float,
    level: float,
    side: float,
    slack: float,
    touch_m: float,
    reach_m: float,
    moved: PlacedBoundary,
    waiting: IntArray,
) -> float:
    """Return the amount, up to ``end``, after which two features touch that are no circles; inf: they do not.

    Parameters
    ----------
    a, i, b, j
        The features, placed in the world.
    motion, end
        That of the object; the end is finite.
    level
        How deep they may be in each other until they have been well apart, metres: more than they are.
    side
        Of sharp lines that touch: see `lines_ahead`.
    slack, touch_m, reach_m
        How far beyond its end a feature still counts, the sine of an angle and metres; farther where this is hollow.
    moved, waiting
        Memory for the object, and for nodes of trees.
    """
    one, other = a.features[i], b.features[j]
    is_sharp = one.kind == LINE and other.kind == LINE and one.radius + other.radius == 0.0
    if is_sharp and side == 0.0:
        side = math.copysign(1.0, ahead(one, other, motion, 0.0, 0.0, 1.0, end).value)
    amount, was_apart, is_jump, behind = 0.0, False, False, BEHIND * end
    for _ in range(EVALUATIONS):
        rest = end - amount
        now = ahead(one, other, motion, amount, level, side, rest)
        if level > 0.0 and now.is_clear:
            level = 0.0
            continue
        # A root, to rounding: it counts if the features reach there.
        is_at_root = was_apart and now.value < 0.0
        if is_at_root and is_jump:
            place_after(a, i, motion, amount, moved)
            is_at_root = clear_step(moved, i, b, j, motion, reach_m) <= NEAR_ROOT * end
        if is_at_root and touches_after(a, i, b, j, motion, amount, level, slack, touch_m, reach_m, moved, waiting):
            return amount
        if is_sharp and level == 0.0 and now.value < 0.0:  # lines that have crossed, but not where both edges are
            side, now = -side, Ahead(-now.value, -now.slope, now.low, now.high, False)
        # How far no root can be.
        was_apart, is_jump = now.value >= 0.0, False
        step = safe_step(now)
        if NARROWER * step < rest:
            span, is_over = NARROWER * step, True
            while is_over and 0.0 < span < rest:
                narrow = safe_step(ahead(one, other, motion, amount, level, side, span))
                step, is_over = max(step, min(narrow, span)), narrow >= span
                span *= NARROWER
            place_after(a, i, motion, amount, moved)
            if level == 0.0:  # else it does not tell how deep they are
                clear = clear_step(moved, i, b, j, motion, reach_m)
                step, is_jump = max(step, clear), clear > step
            if stay_parallel(moved.features[i], other, motion, rest):
                return math.inf
        if step >= rest:
            return math.inf
        if step <= LEAST_STEP * end and touches_after(
            a, i, b, j, motion, amount, level, slack, touch_m, reach_m, moved, waiting
        ):
            return amount
        amount, behind = gone_on(amount, step, end, behind)
        if amount >= end:
            return math.inf
    reaches = touches_after(a, i, b, j, motion, amount, level, slack, touch_m, reach_m, moved, waiting)
    return amount if reaches else math.inf
