"""For how long a curve, all of it, surely does not come to touch a surface: how its gaps close, and bounds on how they
bend. Without bounds on pieces it is equation (2.14).

A curve is a circle, or a line, as far as it reaches; the surface is what it meets. At each point of the curve the gap
is a function of the amount with a known value and slope. Its second derivative is that of the point's way along the
normal, and what the surface's own curvature adds: nothing to a gap from something convex that shrinks. A contact is at
a point whose gap is zero and stationary along the curve, so a point is clear while either is not so.

What something convex has a support plane of is no nearer than that plane. The one where they are nearest tells that a
rim that slides over an edge, each in a plane of its own, comes no nearer, though its points do.

The curve is divided until bounds over its pieces tell about as much as single points of them. So points count that are
nowhere near now, and no place of contact has to be followed.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm, scaled
from cagepose.kernels.boundary.circle_meeting import crosses_edge, is_sharp
from cagepose.kernels.boundary.curve_beside import (
    Beside,
    Piece,
    beside,
    facing_of,
    is_curve,
    over_support,
    piece_of,
)
from cagepose.kernels.boundary.features import CIRCLE, VERTEX, Feature
from cagepose.kernels.circles.places import Kept, Place, within_turn
from cagepose.kernels.native.kernel import kernel

PIECES = 8
"""Of a circle at first."""
DEEPEST, KEPT_DEEPEST = 40, 6
"""How often a piece is halved at most, and one that a kept place ends in."""
MOST_PIECES = 150
"""That are looked at; what more of them would tell is not worth it."""
AS_GOOD = 0.5
"""Of what the points of a curve tell: pieces that tell as much are not divided."""
GAIN = 2.0
"""Times as much as is known: less is not looked for."""
SAME_ANGLE = 0.3
"""Radians: a place that touches now is the one that is nearer to where it was, as the motion goes on."""


@kernel
def root_of_parabola(gap: float, closing: float, bend: float) -> float:
    """Return when a gap that closes and bends so is zero at the earliest."""
    if gap <= 0.0:
        return 0.0
    root = math.sqrt(closing * closing + 2.0 * bend * gap)
    if closing < 0.0:
        return (root - closing) / bend if bend > 0.0 else math.inf
    return 2.0 * gap / (root + closing) if root + closing > 0.0 else math.inf


@kernel
def clear_piece(
    piece: Piece, half: float, at: Beside, is_support: bool, motion: Motion, sense: float, depth_m: float
) -> float:
    """Return for how long the points of a piece nearer than ``half`` to its middle, which is ``at`` beside a surface,
    do not come to touch it, to a depth; ``sense`` is 1 where the curve moves, and -1 where the surface does.
    It may be a support plane, that what counts is behind.
    """
    way, n, w = velocity_at(motion, piece.point), at.normal, half
    gap = at.gap - piece.radius + depth_m
    if is_support and gap <= 0.0:
        return 0.0
    slope, lean, side = abs(dot(n, piece.tangent) + piece.taper), norm(cross(motion.axis, n)), math.copysign(1.0, gap)
    speed = norm(way) + motion.rate * w
    turning = motion.rate * (norm(cross(motion.axis, way)) + motion.rate * w)
    size = abs(gap)
    # As long as no point can go so far.
    clear = (size - (1.0 + abs(piece.taper)) * w) / speed if speed > 0.0 else math.inf
    smooth = math.inf if at.curvature == 0.0 else (0.5 * at.within - w) / speed if speed > 0.0 else math.inf
    # As long as the gap keeps its sign: the surface's curvature may bend it toward zero or only away.
    is_away = at.is_convex if gap > 0.0 else at.is_concave
    curvature = 0.0 if is_away or at.within == math.inf else 2.0 * at.curvature / at.within if at.within > 0.0 else 0.0
    until = math.inf if is_away else smooth
    if until > clear:
        curved = max(0.0, side * dot(n, piece.outward)) * piece.bend
        least = size - slope * w - (0.5 * curved + curvature) * w * w
        closing = -side * sense * dot(n, way) + motion.rate * lean * w
        bend = lean * turning + 2.0 * curvature * speed * speed
        clear = max(clear, min(until, root_of_parabola(least, closing, bend)))
    # As long as it is not stationary.
    if not is_support and smooth > clear:
        turns = 2.0 * at.curvature / at.within if at.curvature > 0.0 else 0.0
        left, rate = slope - (piece.bend + turns) * w, motion.rate + turns * speed
        if left > 0.0:
            clear = max(clear, min(smooth, left / rate if rate > 0.0 else math.inf))
    return max(0.0, clear)


@kernel
def kept_depth(kept: Rows[Kept], n_kept: int, of_other: bool, middle: float, half: float) -> float:
    """Return how deep a piece of a circle may be in what it meets, if all of it is near a place that is kept; zero:
    none of it is; below zero: some of it is.
    """
    depth = 0.0
    for k in range(n_kept):
        away = abs(within_turn((kept[k].other_angle if of_other else kept[k].angle) - middle))
        if away + half <= SAME_ANGLE:
            return kept[k].depth_m
        if away - half < SAME_ANGLE:
            depth = -1.0
    return depth


@kernel
def clear_beside(
    piece: Piece,
    half: float,
    surface: Feature,
    facing: Vector,
    sharp: bool,
    motion: Motion,
    sense: float,
    depth_m: float,
    enough: float,
) -> float:
    """Return for how long the points of a piece do not come to touch a surface, see `clear_piece`; or enough."""
    near = beside(surface, piece.point, sharp)
    clear = clear_piece(piece, half, near, False, motion, sense, depth_m)
    if clear < enough and dot(facing, facing) > 0.0:
        plane = over_support(surface, facing, piece.point)
        clear = max(clear, clear_piece(piece, half, plane, True, motion, sense, depth_m))
    return clear


@kernel
def clear_ahead(
    one: Feature,
    other: Feature,
    motion: Motion,
    slack_m: float,
    nearest: Place,
    normal: Vector,
    kept: Rows[Kept],
    n_kept: int,
    least: float,
    most: float,
) -> float:
    """Return for how long two curved features, one of the object and one of the cage, surely do not touch, as far as
    they reach and to a length beyond their ends, but for places that are kept.

    Parameters
    ----------
    one, other, motion, slack_m
        See there.
    nearest, normal
        Where they are nearest, and the normal there from the one to the other; zero: none is known.
    kept, n_kept
        Places that are kept.
    least, most
        What is known, and what is asked at most.
    """
    is_own = is_curve(one, other)
    curve, surface, sense = (one, other, 1.0) if is_own else (other, one, -1.0)
    of_circle = curve.kind == CIRCLE
    sharp = of_circle and is_sharp(curve, surface)
    crosses = of_circle and crosses_edge(curve, surface)
    of_other = of_circle and surface.kind == CIRCLE and not is_own
    facing = facing_of(surface, scaled(normal, -sense), sharp)
    start, span, n_first = -slack_m, curve.length + 2.0 * slack_m, 1
    points = most
    if curve.kind == VERTEX:
        start, span = 0.0, 0.0
    if of_circle:
        slack = slack_m / curve.length
        n_first = PIECES
        start, span = curve.start - slack, min(2.0 * math.pi, curve.width + 2.0 * slack)
        if n_kept == 0:
            angle = nearest.other_angle if of_other else nearest.angle
            piece = piece_of(curve, angle, angle)
            points = min(points, clear_beside(piece, 0.0, surface, facing, sharp, motion, sense, 0.0, most))
    at, level, n, found = 0, 0, n_first, most
    for _ in range(MOST_PIECES):
        if points <= GAIN * least:
            return least
        step = span / n
        first = start + at * step
        depth = 0.0
        if of_circle:
            depth = kept_depth(kept, n_kept, of_other, first + 0.5 * step, 0.5 * step)
        elif n_kept > 0:  # what has one place
            depth = kept[0].depth_m
        if crosses and depth > 0.0:  # which are apart on either side of each other: the distance does not tell how deep
            depth = math.inf
        divides = depth < 0.0 and level < KEPT_DEEPEST
        if not divides and depth < math.inf:
            deep = max(0.0, depth)
            piece = piece_of(curve, first, first + step)
            clear = clear_beside(piece, piece.half, surface, facing, sharp, motion, sense, deep, AS_GOOD * points)
            if clear < AS_GOOD * points and level < DEEPEST and span > 0.0:
                points = min(points, clear_beside(piece, 0.0, surface, facing, sharp, motion, sense, deep, points))
                divides = clear < AS_GOOD * points
            if not divides:
                found = min(found, clear)
        if divides:
            at, level, n = 2 * at, level + 1, 2 * n
            continue
        if found <= least:
            return least
        at += 1
        while level > 0 and at % 2 == 0:
            at, level, n = at // 2, level - 1, n // 2
        if at == n and level == 0:
            return found
    return least
