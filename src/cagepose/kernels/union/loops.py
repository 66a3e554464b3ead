"""Borders of faces chained to loops, and which loops bound one region: an outer one, and the inner ones within it."""

from __future__ import annotations

import math
from typing import Annotated, Protocol

from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, plus, scaled, vector_from
from cagepose.kernels.native.kernel import entry, kernel

NONE = -1
STRAIGHT = 1e-12
"""A turn by a smaller sine is none."""


class Border:
    """A piece of a face's border, straight or the chord of an arc; a record.

    Attributes
    ----------
    start, end
        Metres. The face is to the left, as seen from outside.
    direction, inward
        Unit vectors along it, and from it into the face.
    start_node, end_node
        Indices of places.
    face
        Index of the face; borders of one face follow each other.
    following
        The border that goes on where it ends; `NONE`: none does.
    loop
        The first border of its loop.
    curvature
        Of an arc of less than half a turn, one over metres: above zero where it leads around the face; else zero.
    """

    start: Annotated[FloatArray, 3]
    end: Annotated[FloatArray, 3]
    direction: Annotated[FloatArray, 3]
    inward: Annotated[FloatArray, 3]
    start_node: int
    end_node: int
    face: int
    following: int
    loop: int
    curvature: float


class Loop:
    """A closed chain of borders; a record.

    Attributes
    ----------
    first
        Its first border.
    area
        Square metres, below zero: an inner loop.
    is_convex
        Whether it turns to the left alone.
    region
        The outer loop that bounds the same region; `NONE`: there is none.
    """

    first: int
    area: float
    is_convex: bool
    region: int


class Segment(Protocol):
    """What has a start and an end, metres."""

    start: FloatArray
    end: FloatArray


@kernel
def crossings_above(border: Segment, place: Vector, normal: Vector) -> int:
    """Return 1 if a segment crosses the way from a place along one axis of its plane, else 0.

    The plane is seen along the axis of space that its normal is closest to: that changes no crossing.
    """
    start, end = border.start, border.end
    size = (abs(normal[0]), abs(normal[1]), abs(normal[2]))
    if size[0] >= size[1] and size[0] >= size[2]:
        x, y, at_x, at_y = 1, 2, place[1], place[2]
    elif size[1] >= size[2]:
        x, y, at_x, at_y = 2, 0, place[2], place[0]
    else:
        x, y, at_x, at_y = 0, 1, place[0], place[1]
    if (start[x] > at_x) == (end[x] > at_x):
        return 0
    height = start[y] + (at_x - start[x]) / (end[x] - start[x]) * (end[y] - start[y])
    return 1 if height > at_y else 0


@entry
def find_loops(normals: FloatArray, borders: Rows[Border], loops: Rows[Loop]) -> tuple[int, int]:
    """Chain borders of faces with unit normals (n_faces, 3), and write loops; return how many there are, and how many
    borders have none that follows: of a closed surface, none.

    ``loops`` has room for one of each border.
    """
    n_open, n_loops = 0, 0
    for b in range(len(borders)):
        borders[b].loop = NONE
    for b in range(len(borders)):
        if borders[b].loop != NONE:
            continue
        normal = (normals[borders[b].face, 0], normals[borders[b].face, 1], normals[borders[b].face, 2])
        loop, turn, k = loops[n_loops], math.inf, b
        loop.first, loop.area, loop.region = b, 0.0, NONE
        while k != NONE and borders[k].loop == NONE:
            borders[k].loop = b
            borders[k].following = _following(k, normal, borders)
            k = borders[k].following
        if k != b:
            n_open += 1
        origin, k = vector_from(borders[b].start), b
        for _ in range(len(borders)):
            border = borders[k]
            arm, beyond = minus(vector_from(border.start), origin), minus(vector_from(border.end), origin)
            loop.area += 0.5 * dot(cross(arm, beyond), normal)
            k = border.following
            if k == NONE:
                break
            turn = min(turn, dot(cross(vector_from(border.direction), vector_from(borders[k].direction)), normal))
            if k == b:
                break
        loop.is_convex = loop.area > 0.0 and turn >= -STRAIGHT
        n_loops += 1
    for i in range(n_loops):
        loops[i].region = i if loops[i].area > 0.0 else _outer_loop(i, n_loops, normals, borders, loops)
    return n_loops, n_open


@kernel
def _following(b: int, normal: Vector, borders: Rows[Border]) -> int:
    """Return the free border, or the first of the loop, at the end of another that leaves least of the face between."""
    border, best, least = borders[b], NONE, math.inf
    back = scaled(vector_from(border.direction), -1.0)
    low, high = b, b
    while low > 0 and borders[low - 1].face == border.face:
        low -= 1
    while high + 1 < len(borders) and borders[high + 1].face == border.face:
        high += 1
    for k in range(low, high + 1):
        if borders[k].start_node != border.end_node or (borders[k].loop != NONE and k != border.loop):
            continue
        direction = vector_from(borders[k].direction)
        angle = -math.atan2(dot(cross(back, direction), normal), dot(back, direction))
        if angle <= STRAIGHT:
            angle += 2.0 * math.pi
        if angle < least:
            best, least = k, angle
    return best


@kernel
def _outer_loop(i: int, n_loops: int, normals: FloatArray, borders: Rows[Border], loops: Rows[Loop]) -> int:
    """Return the smallest outer loop around an inner one of the same face."""
    border = borders[loops[i].first]
    normal = (normals[border.face, 0], normals[border.face, 1], normals[border.face, 2])
    middle = scaled(plus(vector_from(border.start), vector_from(border.end)), 0.5)
    found = NONE
    for k in range(n_loops):
        if borders[loops[k].first].face != border.face or loops[k].area <= 0.0:
            continue
        if found != NONE and loops[k].area >= loops[found].area:
            continue
        n_crossings, b = 0, loops[k].first
        for _ in range(len(borders)):
            n_crossings += crossings_above(borders[b], middle, normal)
            b = borders[b].following
            if b == NONE or b == loops[k].first:
                break
        if n_crossings % 2 == 1:
            found = k
    return found
