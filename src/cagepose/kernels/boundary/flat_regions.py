"""Triangles of a surface that hang together and lie in one plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.vector import dot, row
from cagepose.kernels.native.kernel import entry, kernel

NONE = -1
THIN = 4.0
"""In what is flat: a triangle of less height tells no plane. It lies in that of its neighbour, to as much."""


@entry
def find_flat_regions(
    order: IntArray,
    beside: IntArray,
    corners: FloatArray,
    areas: FloatArray,
    is_thin: NDArray[np.bool_],
    parts: IntArray,
    normals: FloatArray,
    offsets: FloatArray,
    flat_m: float,
    waiting: IntArray,
    regions: IntArray,
) -> int:
    """Write of each triangle the region that it is in; return how many there are.

    A region grows from its first triangle over all that hang together with it, are of the same part, and have their
    corners within ``flat_m`` of that triangle's plane: what bends a little from one to the next does not grow on.

    Parameters
    ----------
    order
        Triangles in the order in which they begin regions.
    beside
        Of each triangle those beyond its three sides, (n, 3).
    corners, areas
        Of each triangle, (n, 3, 3), metres; and its area along its normal, (n, 3).
    is_thin
        Which triangles tell no plane, see `THIN`.
    parts
        That each triangle belongs to.
    normals, offsets
        The plane that a region has if it begins at a triangle: a unit normal (n, 3), and normal . x on it, metres.
    waiting
        Memory for as many triangles.
    """
    n_regions = 0
    regions[:] = NONE
    for seed in order:
        if regions[seed] != NONE:
            continue
        regions[seed], waiting[0], n_waiting = n_regions, seed, 1
        while n_waiting > 0:
            n_waiting -= 1
            at = waiting[n_waiting]
            for k in range(3):
                other = beside[at, k]
                if regions[other] != NONE or parts[other] != parts[seed]:
                    continue
                if _lies_in(other, seed, corners, areas, is_thin, normals, offsets, flat_m):
                    regions[other], waiting[n_waiting] = n_regions, other
                    n_waiting += 1
        n_regions += 1
    return n_regions


@kernel
def _lies_in(
    triangle: int,
    seed: int,
    corners: FloatArray,
    areas: FloatArray,
    is_thin: NDArray[np.bool_],
    normals: FloatArray,
    offsets: FloatArray,
    flat_m: float,
) -> bool:
    """Whether a triangle lies in the plane of another one, and shows to the same side."""
    normal = row(normals, seed)
    if not is_thin[triangle] and dot(row(areas, triangle), normal) <= 0.0:
        return False
    farthest = 0.0
    for k in range(3):
        farthest = max(farthest, abs(dot(row(corners[triangle], k), normal) - offsets[seed]))
    return farthest <= (THIN * flat_m if is_thin[triangle] else flat_m)
