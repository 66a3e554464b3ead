"""Which pieces are near each other, which ends of edges are at one place, and vertices brought onto their planes."""

from __future__ import annotations

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, row, scaled
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.union.pieces import Pieces, Plane, are_within_reach, height_over, outward

SETTLED = 0.1
"""A vertex this close to its planes, as a share of what touches, stays where it is."""


@entry
def find_groups(order: IntArray, touch_m: float, pieces: Pieces, groups: IntArray) -> None:
    """Write for each piece the first one of its group: pieces whose bounds meet, and what they meet in turn.

    ``order`` sorts the pieces by the low end of their bounds along x: the sweep ends where bounds begin too far on.
    """
    for k in range(len(order)):
        groups[k] = k
    for i in range(len(order)):
        piece = pieces.pieces[order[i]]
        for j in range(i + 1, len(order)):
            other = pieces.pieces[order[j]]
            if other.low[0] > piece.high[0] + touch_m:
                break
            if are_within_reach(piece, other, touch_m):
                _unite(order[i], order[j], groups)
    for k in range(len(order)):
        groups[k] = _first_of(k, groups)


@entry
def merge_places(order: IntArray, keys: FloatArray, slacks: FloatArray, places: FloatArray, nodes: IntArray) -> None:
    """Write for each of the places (n, 3) the first one that it is at.

    Two are at one place, and what is there with either, if they are as close as the one may be off that is known less
    well: ``slacks``, (n,), metres. ``keys`` are heights along some unit vector, (n,), ``order`` sorts them.
    """
    greatest = 0.0
    for k in range(len(order)):
        nodes[k], greatest = k, max(greatest, slacks[k])
    for i in range(len(order)):
        for j in range(i + 1, len(order)):
            if keys[order[j]] > keys[order[i]] + greatest:
                break
            slack = max(slacks[order[i]], slacks[order[j]])
            if norm(minus(row(places, order[i]), row(places, order[j]))) <= slack:
                _unite(order[i], order[j], nodes)
    for k in range(len(order)):
        nodes[k] = _first_of(k, nodes)


@kernel
def _first_of(k: int, groups: IntArray) -> int:
    while groups[k] != k:
        groups[k] = groups[groups[k]]
        k = groups[k]
    return k


@kernel
def _unite(one: int, other: int, groups: IntArray) -> None:
    one, other = _first_of(one, groups), _first_of(other, groups)
    groups[max(one, other)] = min(one, other)


@entry
def settle_vertices(touch_m: float, pieces: Pieces, planes: Rows[Plane]) -> None:
    """Move vertices that are not on the planes of their faces, as these have been brought in line with others', and
    widen the bounds of their pieces.
    """
    for k in range(len(pieces.pieces)):
        piece = pieces.pieces[k]
        for v in range(piece.first_vertex, piece.last_vertex):
            place = row(pieces.vertices, v)
            if _farthest(k, v, place, pieces, planes) > SETTLED * touch_m:
                place = _crossing(k, v, place, pieces, planes)
            for j in range(3):
                pieces.vertices[v, j] = place[j]
                piece.low[j], piece.high[j] = min(piece.low[j], place[j]), max(piece.high[j], place[j])


@kernel
def _farthest(k: int, v: int, place: Vector, pieces: Pieces, planes: Rows[Plane]) -> float:
    """Return the greatest distance of a place from the faces of piece ``k`` that meet at a vertex, metres."""
    farthest = 0.0
    for e in range(pieces.pieces[k].first_edge, pieces.pieces[k].last_edge):
        edge = pieces.edges[e]
        if v in (edge.start, edge.end):
            for f in (edge.left, edge.right):
                farthest = max(farthest, abs(height_over(pieces.faces[f], place, planes)))
    return farthest


@kernel
def _crossing(k: int, v: int, place: Vector, pieces: Pieces, planes: Rows[Plane]) -> Vector:
    """Return where the planes of three faces of piece ``k`` cross that meet at a vertex, those of the widest angle."""
    greatest, best = 0.0, place
    for e in range(pieces.pieces[k].first_edge, pieces.pieces[k].last_edge):
        edge = pieces.edges[e]
        if v not in (edge.start, edge.end):
            continue
        one, other = pieces.faces[edge.left], pieces.faces[edge.right]
        a, b = outward(one, planes), outward(other, planes)
        for i in range(pieces.pieces[k].first_edge, pieces.pieces[k].last_edge):
            beside = pieces.edges[i]
            if v not in (beside.start, beside.end):
                continue
            third = pieces.faces[beside.left]
            c = outward(third, planes)
            volume = dot(cross(a, b), c)
            if abs(volume) > greatest:
                greatest = abs(volume)
                ha, hb = height_over(one, place, planes), height_over(other, place, planes)
                hc = height_over(third, place, planes)
                shift = plus(plus(scaled(cross(b, c), ha), scaled(cross(c, a), hb)), scaled(cross(a, b), hc))
                best = minus(place, scaled(shift, 1.0 / volume))
    return best
