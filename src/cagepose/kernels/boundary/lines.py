"""A line in which two planes cross: which pieces hold it along which of its spans, and where that changes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.pieces import Piece, Pieces, Plane, height_over, outward
from cagepose.kernels.native.kernel import kernel

LEAST_SINE = 1e-9
"""Planes at a smaller angle cross in no line."""
PARALLEL = 1e-12
"""A plane that a line makes a smaller sine with is not crossed by it."""


class Line(NamedTuple):
    """A line in which two planes cross.

    Attributes
    ----------
    point, direction
        A place on it, metres, and its unit direction.
    first, second
        Unit vectors across it, right-handed with the direction as the third: angles are measured from the first of
        them to the second.
    a, b
        These planes.
    sine
        Of the angle between them.
    """

    point: Vector
    direction: Vector
    first: Vector
    second: Vector
    a: int
    b: int
    sine: float


class Span:
    """Where a piece holds a line; a record.

    Attributes
    ----------
    start, end
        From the line's place along its direction, metres.
    start_plane, end_plane
        The plane in which the piece ends there.
    piece
        Which one.
    first_active, last_active
        Rows of `FanWork.active`: its faces on whose planes the line lies. None: the line is inside the piece.
    """

    start: float
    end: float
    start_plane: int
    end_plane: int
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
    cuts, cut_planes
        Where spans begin and end, in order, metres, and a plane that crosses the line there.
    slacks, ends
        Of each end of a span how far it may be off, metres, and which it is: 2 * span, or 2 * span + 1.
    rays
        Around the line, in order.
    """

    holds_line: NDArray[np.bool_]
    spans: Rows[Span]
    active: IntArray
    cuts: FloatArray
    cut_planes: IntArray
    slacks: FloatArray
    ends: IntArray
    rays: Rows[Ray]


def empty_fan_work(n_pieces: int, n_faces: int) -> FanWork:
    """Return memory for a union of pieces with so many faces (plain Python)."""
    return FanWork(
        np.zeros(n_faces, np.bool_),
        empty_rows(Span, n_pieces),
        np.zeros(n_faces, np.int64),
        np.zeros(2 * n_pieces),
        np.zeros(2 * n_pieces, np.int64),
        np.zeros(2 * n_pieces),
        np.zeros(2 * n_pieces, np.int64),
        empty_rows(Ray, 2 * n_faces),
    )


@kernel
def line_of(a: int, b: int, near: Vector, planes: Rows[Plane]) -> Line:
    """Return the line of two planes, its place the one nearest to ``near``; they must not be parallel."""
    first, normal = vector_from(planes[a].normal), vector_from(planes[b].normal)
    way = cross(first, normal)
    sine = norm(way)
    direction = scaled(way, 1.0 / sine)
    height = planes[a].offset - dot(first, near)
    other = planes[b].offset - dot(normal, near)
    foot = plus(scaled(cross(normal, direction), height / sine), scaled(cross(direction, first), other / sine))
    return Line(plus(near, foot), direction, first, cross(direction, first), a, b, sine)


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
        span = work.spans[n_spans]
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
                end, span.end_plane = -height / slope, face.plane
            elif slope < 0.0 and -height / slope > start:
                start, span.start_plane = -height / slope, face.plane
        if end - start > touch_m:
            span.start, span.end, span.piece = start, end, k
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
def find_cuts(line: Line, n_spans: int, touch_m: float, planes: Rows[Plane], work: FanWork) -> int:
    """Write where spans begin and end; return how many places.

    Planes may be off by what touches, and cuts by more: by much, where a plane is crossed at a small angle. So those
    are taken first that are known best, and others are at the nearest of them that is within what they may be off.
    """
    for s in range(n_spans):
        span = work.spans[s]
        _put_in_order(span.start, span.start_plane, 2 * s, _slack(line, span.start_plane, touch_m, planes), work)
        _put_in_order(span.end, span.end_plane, 2 * s + 1, _slack(line, span.end_plane, touch_m, planes), work)
    n_cuts = 0
    for k in range(2 * n_spans):
        cut, nearest = work.cuts[k], n_cuts
        for c in range(n_cuts):
            apart = abs(work.cuts[c] - cut)
            if apart <= work.slacks[k] and (nearest == n_cuts or apart < abs(work.cuts[nearest] - cut)):
                nearest = c
        if nearest == n_cuts:
            work.cuts[n_cuts], work.cut_planes[n_cuts] = cut, work.cut_planes[k]
            n_cuts += 1
        span = work.spans[work.ends[k] // 2]
        if work.ends[k] % 2 == 0:
            span.start = work.cuts[nearest]
        else:
            span.end = work.cuts[nearest]
    for k in range(n_cuts):
        cut, plane, c = work.cuts[k], work.cut_planes[k], k
        while c > 0 and work.cuts[c - 1] > cut:
            work.cuts[c], work.cut_planes[c] = work.cuts[c - 1], work.cut_planes[c - 1]
            c -= 1
        work.cuts[c], work.cut_planes[c] = cut, plane
    return n_cuts


@kernel
def _put_in_order(cut: float, plane: int, end: int, slack: float, work: FanWork) -> None:
    """Put an end of a span where it belongs in the order of what they may be off: ``end`` are there."""
    k = end
    while k > 0 and work.slacks[k - 1] > slack:
        work.cuts[k], work.cut_planes[k] = work.cuts[k - 1], work.cut_planes[k - 1]
        work.slacks[k], work.ends[k] = work.slacks[k - 1], work.ends[k - 1]
        k -= 1
    work.cuts[k], work.cut_planes[k], work.slacks[k], work.ends[k] = cut, plane, slack, end


@kernel
def _slack(line: Line, plane: int, touch_m: float, planes: Rows[Plane]) -> float:
    """Return how far a plane's cut may be off along a line if that plane and the line's own are off by ``touch_m``."""
    normal = vector_from(planes[plane].normal)
    a, b = vector_from(planes[line.a].normal), vector_from(planes[line.b].normal)
    by_line = abs(dot(cross(b, normal), line.direction)) + abs(dot(cross(a, normal), line.direction))
    return touch_m * (1.0 + by_line / line.sine) / abs(dot(normal, line.direction))
