"""Which pieces are near each other, which ends of edges are at one place, and vertices brought onto their planes."""

from __future__ import annotations

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, row, scaled, vector_from
from cagepose.kernels.boundary.pieces import NO_PLANE, Pieces, Plane, are_within_reach, height_over, outward
from cagepose.kernels.native.kernel import entry, kernel

NO_NODE = -1
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
def merge_places(
    first: IntArray,
    order: IntArray,
    keys: FloatArray,
    slacks: FloatArray,
    touch_m: float,
    places: FloatArray,
    crossing: IntArray,
    planes: Rows[Plane],
    nodes: IntArray,
) -> None:
    """Write for each place the one that it is at, itself or another.

    Parameters
    ----------
    first
        Places in the order of their slacks: those that are known best are taken first.
    order, keys
        Heights of the places along some unit vector, (n,), and what sorts them.
    slacks
        How far away it may be what a place is at, metres.
    places
        (n, 3), metres.
    crossing
        Three planes that cross at each, (n, 3): it is at the nearest place that is within ``touch_m`` of all three.
        `NO_PLANE`: it is at a place within ``touch_m``.
    """
    for k in range(len(order)):
        nodes[k] = NO_NODE
    for i in range(len(order)):
        k = first[i]
        at, least = _place_in_order(keys[k] - slacks[k], order, keys), slacks[k]
        found = k
        while at < len(order) and keys[order[at]] <= keys[k] + slacks[k]:
            other = order[at]
            apart = norm(minus(row(places, other), row(places, k)))
            if nodes[other] == other and apart <= least and _is_at(k, row(places, other), touch_m, crossing, planes):
                found, least = other, apart
            at += 1
        nodes[k] = found


@kernel
def _is_at(k: int, place: Vector, touch_m: float, crossing: IntArray, planes: Rows[Plane]) -> bool:
    for j in range(3):
        p = crossing[k, j]
        if p != NO_PLANE and abs(dot(vector_from(planes[p].normal), place) - planes[p].offset) > touch_m:
            return False
    return True


@kernel
def _place_in_order(key: float, order: IntArray, keys: FloatArray) -> int:
    """Return the first index of ``order`` from which on keys are not below one."""
    low, high = 0, len(order)
    while low < high:
        half = (low + high) // 2
        if keys[order[half]] < key:
            low = half + 1
        else:
            high = half
    return low


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
    """Return where three faces of piece ``k`` cross that meet at a vertex: those that make the greatest angle."""
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
