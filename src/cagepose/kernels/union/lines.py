"""A line in which two planes cross: which pieces hold it along which of its spans, and where that changes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.union.pieces import Piece, Pieces, Plane, height_over, outward

LEAST_SINE = 1e-9
"""Planes at a smaller angle cross in no line."""
PARALLEL = 1e-12
"""A plane that a line makes a smaller sine with is not crossed by it."""
LEAST_LEVER = 1e-3
"""Where planes cross at a smaller sine, places are not looked for any farther away than at this one."""


class Line(NamedTuple):
    """A line in which two planes cross.

    Attributes
    ----------
    point, direction
        A place on it, metres, and its unit direction.
    first, second
        Unit vectors across it, right-handed with the direction as the third: angles are measured from the first of
        them to the second.
    sine
        Of the angle between the planes.
    """

    point: Vector
    direction: Vector
    first: Vector
    second: Vector
    sine: float


class Span:
    """Where a piece holds a line; a record.

    Attributes
    ----------
    start, end
        From the line's place along its direction, metres.
    start_slack, end_slack
        How far these may be off, as planes may be off by what touches, metres.
    piece
        Which one.
    first_active, last_active
        Rows of `FanWork.active`: its faces on whose planes the line lies. None: the line is inside the piece.
    """

    start: float
    end: float
    start_slack: float
    end_slack: float
    piece: int
    first_active: int
    last_active: int


class Ray:
    """A half-plane that begins at a line and lies in a plane; a record.

    Attributes
    ----------
    plane
        Which one.
    sense
        1.0 or -1.0: whether it leads along the cross product of the plane's normal and the line's direction.
    angle
        Around the line, radians.
    is_solid
        Whether there is material between it and the next one.
    """

    plane: int
    sense: float
    angle: float
    is_solid: bool


class FanWork(NamedTuple):
    """Memory for one line at a time.

    Attributes
    ----------
    holds_line
        Of each plane, whether the line lies in it.
    spans, active
        See `Span`.
    cuts, slacks
        Where spans begin and end, in order, and how far these places may be off, metres.
    rays
        Around the line, in order.
    """

    holds_line: NDArray[np.bool_]
    spans: Rows[Span]
    active: IntArray
    cuts: FloatArray
    slacks: FloatArray
    rays: Rows[Ray]


def empty_fan_work(n_pieces: int, n_faces: int) -> FanWork:
    """Return memory for a union of pieces with so many faces (plain Python)."""
    return FanWork(
        np.zeros(n_faces, np.bool_),
        empty_rows(Span, n_pieces),
        np.zeros(n_faces, np.int64),
        np.zeros(2 * n_pieces),
        np.zeros(2 * n_pieces),
        empty_rows(Ray, 2 * n_faces),
    )


@kernel
def line_of(a: Plane, b: Plane, near: Vector) -> Line:
    """Return the line of two planes, its place the one nearest to ``near``; they must not be parallel."""
    first, normal = vector_from(a.normal), vector_from(b.normal)
    way = cross(first, normal)
    sine = norm(way)
    direction = scaled(way, 1.0 / sine)
    height = a.offset - dot(first, near)
    other = b.offset - dot(normal, near)
    foot = plus(scaled(cross(normal, direction), height / sine), scaled(cross(direction, first), other / sine))
    return Line(plus(near, foot), direction, first, cross(direction, first), sine)


@kernel
def note_planes(line: Line, reach_m: float, touch_m: float, planes: Rows[Plane], n_planes: int, work: FanWork) -> None:
    """Note the planes that are within ``touch_m`` of a line, as far as ``reach_m`` from its place."""
    for p in range(n_planes):
        normal = vector_from(planes[p].normal)
        height = abs(dot(normal, line.point) - planes[p].offset)
        work.holds_line[p] = height + abs(dot(normal, line.direction)) * reach_m <= touch_m


@kernel
def find_spans(line: Line, touch_m: float, pieces: Pieces, planes: Rows[Plane], work: FanWork) -> int:
    """Write where pieces hold a line over more than a place; return how many do."""
    n_spans, n_active = 0, 0
    for k in range(len(pieces.pieces)):
        piece = pieces.pieces[k]
        if _passes_by(line, piece, touch_m):
            continue
        start, end, last_active = -math.inf, math.inf, n_active
        slope_in, slope_out = 1.0, 1.0
        for f in range(piece.first_face, piece.last_face):
            face = pieces.faces[f]
            if work.holds_line[face.plane]:
                work.active[last_active] = f
                last_active += 1
                continue
            height, slope = height_over(face, line.point, planes), dot(outward(face, planes), line.direction)
            if abs(slope) <= PARALLEL:
                if height > 0.0:
                    end = -math.inf
            elif slope > 0.0 and -height / slope < end:
                end, slope_out = -height / slope, slope
            elif slope < 0.0 and -height / slope > start:
                start, slope_in = -height / slope, -slope
        span = work.spans[n_spans]
        span.start, span.end, span.piece = start, end, k
        span.start_slack = touch_m / max(min(line.sine, slope_in), LEAST_LEVER)
        span.end_slack = touch_m / max(min(line.sine, slope_out), LEAST_LEVER)
        if end - start > max(span.start_slack, span.end_slack):
            span.first_active, span.last_active = n_active, last_active
            n_spans, n_active = n_spans + 1, last_active
    return n_spans


@kernel
def _passes_by(line: Line, piece: Piece, touch_m: float) -> bool:
    """Whether a line does not reach the ball around a piece's bounds."""
    low, high = vector_from(piece.low), vector_from(piece.high)
    arm = minus(scaled(plus(low, high), 0.5), line.point)
    return norm(cross(arm, line.direction)) > 0.5 * norm(minus(high, low)) + touch_m


@kernel
def find_cuts(n_spans: int, work: FanWork) -> int:
    """Write where spans begin and end, those at one place as the one that is known best; return how many places."""
    n_ends = 0
    for s in range(n_spans):
        span = work.spans[s]
        _put_in_order(span.start, span.start_slack, n_ends, work)
        _put_in_order(span.end, span.end_slack, n_ends + 1, work)
        n_ends += 2
    n_cuts, last = 0, -math.inf
    for k in range(n_ends):
        cut, slack = work.cuts[k], work.slacks[k]
        if n_cuts > 0 and cut - last <= max(slack, work.slacks[n_cuts - 1]):
            if slack < work.slacks[n_cuts - 1]:
                work.cuts[n_cuts - 1], work.slacks[n_cuts - 1] = cut, slack
        else:
            work.cuts[n_cuts], work.slacks[n_cuts] = cut, slack
            n_cuts += 1
        last = cut
    return n_cuts


@kernel
def _put_in_order(cut: float, slack: float, n_cuts: int, work: FanWork) -> None:
    k = n_cuts
    while k > 0 and work.cuts[k - 1] > cut:
        work.cuts[k], work.slacks[k] = work.cuts[k - 1], work.slacks[k - 1]
        k -= 1
    work.cuts[k], work.slacks[k] = cut, slack
