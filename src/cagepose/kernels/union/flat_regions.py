"""Triangles of a surface that hang together and lie in one plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.vector import dot, row
from cagepose.kernels.native.kernel import entry, kernel

NONE = -1
THIN = 4.0
"""In what is flat: a triangle of less height tells no plane. It lies in that of the neighbour that it is nearest to."""


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
    seeds: IntArray,
    regions: IntArray,
) -> int:
    """Write of each triangle the region that it is in, and of each region its first triangle; return how many there
    are.

    A region grows from its first triangle over all that hang together with it, are of the same part, and have their
    corners within ``flat_m`` of that triangle's plane: what bends a little from one to the next does not grow on. Thin
    triangles begin regions only where they are in no other.

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
    for is_for_thin in (False, True):
        for seed in order:
            if regions[seed] != NONE or is_thin[seed] != is_for_thin:
                continue
            regions[seed], waiting[0], n_waiting = n_regions, seed, 1
            while n_waiting > 0:
                n_waiting -= 1
                at = waiting[n_waiting]
                for k in range(3):
                    other = beside[at, k]
                    if regions[other] != NONE or parts[other] != parts[seed]:
                        continue
                    is_along = is_thin[other] or dot(row(areas, other), row(normals, seed)) > 0.0
                    if is_along and _off_plane(other, seed, corners, normals, offsets) <= flat_m:
                        regions[other], waiting[n_waiting] = n_regions, other
                        n_waiting += 1
            seeds[n_regions] = seed
            n_regions += 1
        if not is_for_thin:
            _spread_to_thin(order, beside, corners, is_thin, parts, normals, offsets, flat_m, seeds, regions)
    return n_regions


@kernel
def _spread_to_thin(
    order: IntArray,
    beside: IntArray,
    corners: FloatArray,
    is_thin: NDArray[np.bool_],
    parts: IntArray,
    normals: FloatArray,
    offsets: FloatArray,
    flat_m: float,
    seeds: IntArray,
    regions: IntArray,
) -> None:
    """Write of thin triangles that are in no plane the region beside them whose plane is nearest, one after the other
    as long as there is one near enough.
    """
    is_more = True
    while is_more:
        is_more = False
        for at in order:
            if regions[at] != NONE or not is_thin[at]:
                continue
            best, least = NONE, THIN * flat_m
            for k in range(3):
                region = regions[beside[at, k]]
                if region != NONE and parts[seeds[region]] == parts[at]:
                    off = _off_plane(at, seeds[region], corners, normals, offsets)
                    if off <= least:
                        best, least = region, off
            if best != NONE:
                regions[at], is_more = best, True


@kernel
def _off_plane(triangle: int, seed: int, corners: FloatArray, normals: FloatArray, offsets: FloatArray) -> float:
    """Return how far the corners of a triangle are from the plane of a region at most."""
    normal, farthest = row(normals, seed), 0.0
    for k in range(3):
        farthest = max(farthest, abs(dot(row(corners[triangle], k), normal) - offsets[seed]))
    return farthest
