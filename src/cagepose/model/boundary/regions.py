"""The trimmed faces of a union: borders chained to loops, and loops to regions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.loops import NONE, Border, Loop, find_loops
from cagepose.model.boundary.trimmed import Faces

Rows = NDArray[np.void]


class FacePlanes(NamedTuple):
    """What faces on one side of a plane share, those of several such sides: see `Faces`."""

    normals: NDArray[np.float64]
    offsets: NDArray[np.float64]
    planes: NDArray[np.int64]
    parts: NDArray[np.int64]


def faces_of(planes: Rows, arcs: Rows, ends: NDArray[np.int64]) -> tuple[Faces, int]:
    """Return the faces on planes, and how many of their borders lead nowhere.

    Parameters
    ----------
    arcs
        Around all lines, see `kernels.union.arcs.Arc`.
    ends
        Of each, the places at which it starts and ends, (n, 2).
    """
    which, side = np.nonzero(arcs["is_border"])
    arc = arcs[which]
    normals, inward = arc["normals"][np.arange(len(arc)), side], arc["inward"][np.arange(len(arc)), side]
    oriented = 2 * arc["planes"][np.arange(len(arc)), side] + (arc["sides"][np.arange(len(arc)), side] < 0.0)
    parts = arc["parts"][np.arange(len(arc)), side]
    keys = oriented * (1 + parts.max(initial=0)) + parts
    _, first, face = np.unique(keys, return_index=True, return_inverse=True)
    is_along = np.einsum("ij,ij->i", np.cross(inward, normals), arc["direction"]) > 0.0
    forth, back = np.where(is_along, 0, 1), np.where(is_along, 1, 0)
    borders = np.zeros(len(arc), dtype_of(Border))
    borders["start"] = np.where(is_along[:, None], arc["start"], arc["end"])
    borders["end"] = np.where(is_along[:, None], arc["end"], arc["start"])
    borders["direction"] = np.where(is_along[:, None], arc["direction"], -arc["direction"])
    borders["start_node"], borders["end_node"] = ends[which, forth], ends[which, back]
    borders["inward"], borders["face"] = inward, face
    borders = borders[np.argsort(face, kind="stable")]
    loops = np.zeros(len(borders), dtype_of(Loop))
    n_loops, n_open = find_loops(normals[first], borders, loops)
    oriented, parts = oriented[first], parts[first]
    offsets = planes["offset"][oriented // 2] * np.where(oriented % 2, -1.0, 1.0)
    return regions_of(FacePlanes(normals[first], offsets, oriented, parts), borders, loops[:n_loops]), n_open


def regions_of(sides: FacePlanes, borders: Rows, loops: Rows) -> Faces:
    """Return one face for each outer loop, with the inner loops within it; slivers of two corners are none."""
    n_borders = np.bincount(np.searchsorted(loops["first"], borders["loop"]), minlength=len(loops))
    region = np.where(loops["region"] == NONE, np.arange(len(loops)), loops["region"])
    is_wide = (n_borders >= 3) & (n_borders[region] >= 3)
    outer, index, n_loops = np.unique(region[is_wide], return_inverse=True, return_counts=True)
    index = index.reshape(-1)
    face = borders["face"][loops["first"][outer]]
    order = _in_loops(borders, loops[is_wide], np.argsort(index, kind="stable"))
    n_curved = np.bincount(np.searchsorted(loops["first"], borders["loop"]), borders["curvature"] != 0.0, len(loops))
    is_convex = loops["is_convex"][outer] & (n_loops == 1) & (n_curved[outer] == 0)
    n_of_face = np.bincount(index, n_borders[is_wide], minlength=len(outer)).astype(np.int64)
    normals, offsets, planes, parts = (of[face] for of in sides)
    return Faces(normals, offsets, planes, parts, is_convex, n_of_face, borders[order])


def _in_loops(borders: Rows, loops: Rows, order: NDArray[np.int64]) -> list[int]:
    """Return the indices of borders along one loop after the other."""
    following, found = borders["following"].tolist(), []
    for first in loops["first"][order].tolist():
        k = first
        while k != NONE:
            found.append(k)
            k = following[k]
            if k == first:
                break
    return found
