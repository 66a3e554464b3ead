"""Which edges and vertices of a body hang together: if no edge of those is cut, one place tells of all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import LINE, VERTEX, Boundary, features_of
from cagepose.kernels.boundary.tree import VERTICES
from cagepose.kernels.boundary.within import beyond_box
from cagepose.kernels.native.kernel import kernel

SAME_END = 1e-7
"""Of the length of an edge: a vertex that is nearer to its end is there."""


class Shells(NamedTuple):
    """Which features stand for those that they hang together with.

    Attributes
    ----------
    is_known
        Whether it has been found out, of each body, (n_bodies,).
    first
        Of each vertex and line the first one that it hangs together with: vertices come first, (n_features,).
    """

    is_known: NDArray[np.bool_]
    first: IntArray


def empty_shells(own: Boundary, n_bodies: int = 1) -> Shells:
    """Return memory for bodies (plain Python)."""
    return Shells(np.zeros(n_bodies, np.bool_), np.zeros(len(own.features), np.int64))


@kernel
def find_shells(own: Boundary, shells: Shells, waiting: IntArray) -> None:
    """Find what hangs together, unless it is known."""
    if shells.is_known[0]:
        return
    shells.is_known[0] = True
    first = shells.first
    begin, last = features_of(own)
    for i in range(begin, last):
        first[i] = i
    for i in range(begin, last):
        line = own.features[i]
        if line.kind == LINE and line.taper == 0.0:
            start, way = vector_from(line.point), vector_from(line.direction)
            for end in (0.0, line.length):
                v = vertex_at(own, plus(start, scaled(way, end)), SAME_END * line.length, waiting)
                if v >= 0:
                    one, other = first_of(first, i), first_of(first, v)
                    first[max(one, other)] = min(one, other)
    for i in range(begin, last):
        first[i] = first_of(first, i)


@kernel
def first_of(first: IntArray, i: int) -> int:
    while first[i] != i:
        first[i] = first[first[i]]
        i = first[i]
    return i


@kernel
def vertex_at(own: Boundary, place: Vector, within_m: float, waiting: IntArray) -> int:
    """Return a vertex that is at a place, to a length; -1: none is."""
    if own.nodes[VERTICES].first == own.nodes[VERTICES].last:
        return -1
    waiting[0], n_waiting = VERTICES, 1
    while n_waiting > 0:
        n_waiting -= 1
        node = own.nodes[waiting[n_waiting]]
        if beyond_box(node, place) > within_m:
            continue
        if node.left >= 0:
            waiting[n_waiting], waiting[n_waiting + 1] = node.left, node.right
            n_waiting += 2
            continue
        for i in range(node.first, node.last):
            feature = own.features[i]
            if feature.kind == VERTEX and norm(minus(vector_from(feature.point), place)) <= within_m:
                return i
    return -1
