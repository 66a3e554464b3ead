"""Convex vertices of a union: what holds them has them as a vertex, and the normal cones there share an interior.

The cone of outward normals at a place is the polar of all directions that lead into material from there, which the
edges of the pieces span that hold it. So a place inside a piece, on its face or on its edge is no convex vertex.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, row, scaled
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.union.pieces import Piece, Pieces, Plane, height_over, outward

NO_CORNER = 0
WITHIN = 1e-9
"""Sine within which directions are the same, or lie in one plane."""
NARROW = 1e-8
"""A cone of normals none of which is farther within than this (a sine) has no interior."""


@entry
def find_corners(
    places: IntArray,
    nodes: IntArray,
    touch_m: float,
    pieces: Pieces,
    planes: Rows[Plane],
    parts: IntArray,
    n_tangents: IntArray,
    tangents: FloatArray,
    at_place: FloatArray,
    is_outer: NDArray[np.bool_],
) -> int:
    """Write the tangents that bound the cone of normals at each place; return how many there are of all together.

    Parameters
    ----------
    places
        Indices of vertices of the pieces, one for each place.
    nodes
        Of each vertex of the pieces, that of its place.
    touch_m
        What is closer to a piece is held by it.
    parts, n_tangents
        Of each place, the first part that it belongs to, and how many tangents it has; `NO_CORNER`: it is none.
    tangents
        Unit vectors, (n, 3), those of one place after those of another; twice as many as there are edges. A normal n
        of the cone has n . tangent <= 0.
    at_place, is_outer
        Memory for the tangents at one place, as many.
    """
    n_all = 0
    for i in range(len(places)):
        n_tangents[i], parts[i] = _find_corner(places[i], nodes, touch_m, pieces, planes, at_place, is_outer)
        for t in range(n_tangents[i]):
            for k in range(3):
                tangents[n_all, k] = at_place[t, k]
            n_all += 1
    return n_all


@kernel
def _find_corner(
    node: int,
    nodes: IntArray,
    touch_m: float,
    pieces: Pieces,
    planes: Rows[Plane],
    tangents: FloatArray,
    is_outer: NDArray[np.bool_],
) -> tuple[int, int]:
    """Write the tangents of one place; return how many, or `NO_CORNER`, and the part."""
    place = row(pieces.vertices, node)
    n_tangents, n_holding, part = 0, 0, -1
    for k in range(len(pieces.pieces)):
        piece, at = pieces.pieces[k], -1
        if not _is_near(piece, place, 2.0 * touch_m):
            continue
        for v in range(piece.first_vertex, piece.last_vertex):
            if nodes[v] == node:
                at = v
        if at < 0:
            if _holds(piece, place, touch_m, pieces, planes):
                return NO_CORNER, part
            continue
        n_holding += 1
        part = piece.part if part < 0 else min(part, piece.part)
        n_tangents = _add_tangents(piece, at, pieces, planes, tangents, n_tangents)
    if n_holding > 1:
        n_tangents = _bounding(tangents, n_tangents, is_outer)
    return n_tangents, part


@kernel
def _is_near(piece: Piece, place: Vector, touch_m: float) -> bool:
    is_near = True
    for k in range(3):
        is_near = is_near and piece.low[k] - touch_m <= place[k] <= piece.high[k] + touch_m
    return is_near


@kernel
def _holds(piece: Piece, place: Vector, touch_m: float, pieces: Pieces, planes: Rows[Plane]) -> bool:
    is_held = True
    for f in range(piece.first_face, piece.last_face):
        is_held = is_held and height_over(pieces.faces[f], place, planes) <= touch_m
    return is_held


@kernel
def _add_tangents(
    piece: Piece, at: int, pieces: Pieces, planes: Rows[Plane], tangents: FloatArray, n_tangents: int
) -> int:
    """Add those of a piece's edges at a vertex that are not among the tangents yet; return how many there are then."""
    for e in range(piece.first_edge, piece.last_edge):
        edge = pieces.edges[e]
        if at not in (edge.start, edge.end):
            continue
        way = cross(outward(pieces.faces[edge.left], planes), outward(pieces.faces[edge.right], planes))
        away = minus(row(pieces.vertices, edge.end), row(pieces.vertices, edge.start))
        sign = 1.0 if (edge.start == at) == (dot(way, away) > 0.0) else -1.0
        tangent = scaled(way, sign / norm(way))
        is_new = True
        for t in range(n_tangents):
            is_new = is_new and norm(minus(row(tangents, t), tangent)) > WITHIN
        if is_new:
            tangents[n_tangents, 0], tangents[n_tangents, 1], tangents[n_tangents, 2] = tangent
            n_tangents += 1
    return n_tangents


@kernel
def _bounding(tangents: FloatArray, n_tangents: int, is_outer: NDArray[np.bool_]) -> int:
    """Keep the tangents that bound the cone of normals, each in two of its edges; return how many, or `NO_CORNER`.

    An edge of the cone is across two tangents and makes no acute angle with any.
    """
    inside = (0.0, 0.0, 0.0)
    for i in range(n_tangents):
        n_edges, edge = 0, (0.0, 0.0, 0.0)
        for j in range(n_tangents):
            across = cross(row(tangents, i), row(tangents, j))
            length = norm(across)
            if length < WITHIN:
                if i != j and dot(row(tangents, i), row(tangents, j)) < 0.0:
                    return NO_CORNER  # material along both senses of a line
                continue
            for sign in (1.0, -1.0):
                normal = scaled(across, sign / length)
                if _is_normal(normal, tangents, n_tangents) and (
                    n_edges == 0 or (n_edges == 1 and norm(minus(normal, edge)) > NARROW)
                ):
                    n_edges, edge, inside = n_edges + 1, normal, plus(inside, normal)
        is_outer[i] = n_edges > 1
    size, n_outer = norm(inside), 0
    if size == 0.0:
        return NO_CORNER
    for i in range(n_tangents):
        if dot(row(tangents, i), inside) > -NARROW * size:
            return NO_CORNER
    for i in range(n_tangents):
        if is_outer[i]:
            for k in range(3):
                tangents[n_outer, k] = tangents[i, k]
            n_outer += 1
    return n_outer


@kernel
def _is_normal(normal: Vector, tangents: FloatArray, n_tangents: int) -> bool:
    is_normal = True
    for t in range(n_tangents):
        is_normal = is_normal and dot(normal, row(tangents, t)) <= WITHIN
    return is_normal
