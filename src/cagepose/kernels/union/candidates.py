"""The lines on which edges of a union can lie: each that of two planes, whose faces meet or nearly so."""

from __future__ import annotations

from cagepose.kernels.algebra.record import IntArray, Rows
from cagepose.kernels.algebra.vector import row
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.union.pieces import PieceFace, Pieces, Plane, are_within_reach, height_over


@entry
def find_pairs(touch_m: float, pieces: Pieces, planes: Rows[Plane], n_planes: int, pairs: IntArray) -> int:
    """Write pairs of planes a < b as a * n_planes + b, some more than once; return how many there are.

    If these are more than ``pairs`` has room for, the rest is not written.
    """
    n_pairs = 0
    for e in range(len(pieces.edges)):
        left, right = pieces.faces[pieces.edges[e].left], pieces.faces[pieces.edges[e].right]
        n_pairs = _noted(left.plane, right.plane, n_planes, pairs, n_pairs)
    for k in range(len(pieces.pieces)):
        for m in range(k):
            if not are_within_reach(pieces.pieces[k], pieces.pieces[m], touch_m):
                continue
            one, other = pieces.pieces[k], pieces.pieces[m]
            for f in range(one.first_face, one.last_face):
                for g in range(other.first_face, other.last_face):
                    if _meet(pieces.faces[f], pieces.faces[g], touch_m, pieces, planes):
                        face, beside = pieces.faces[f], pieces.faces[g]
                        n_pairs = _noted(face.plane, beside.plane, n_planes, pairs, n_pairs)
    return n_pairs


@kernel
def _noted(a: int, b: int, n_planes: int, pairs: IntArray, n_pairs: int) -> int:
    if n_pairs < len(pairs):
        pairs[n_pairs] = min(a, b) * n_planes + max(a, b)
    return n_pairs + 1


@kernel
def _meet(one: PieceFace, other: PieceFace, touch_m: float, pieces: Pieces, planes: Rows[Plane]) -> bool:
    """Whether each of two faces reaches from one side of the other's plane to the other side, or touches it."""
    if one.plane == other.plane:
        return False
    return _straddles(one, other, touch_m, pieces, planes) and _straddles(other, one, touch_m, pieces, planes)


@kernel
def _straddles(face: PieceFace, other: PieceFace, touch_m: float, pieces: Pieces, planes: Rows[Plane]) -> bool:
    is_above, is_below = False, False
    for c in range(face.first_corner, face.last_corner):
        height = height_over(other, row(pieces.vertices, pieces.corners[c]), planes)
        is_above, is_below = is_above or height >= -touch_m, is_below or height <= touch_m
        if is_above and is_below:
            return True
    return False
