"""The convex vertices of a union of pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.union.corners import find_corners
from cagepose.kernels.union.pieces import Pieces
from cagepose.model.boundary.trimmed import Vertices


def vertices_of(rows: Pieces, planes: NDArray[np.void], nodes: NDArray[np.int64], touch_m: float) -> Vertices:
    """Return the convex vertices of a union, given at which place each vertex of its pieces is; how long the edges are
    there is not known yet.
    """
    places = np.unique(nodes)
    parts, n_tangents = np.zeros((2, len(places)), np.int64)
    tangents, at_place = np.zeros((2, 2 * len(rows.edges), 3))
    is_outer = np.zeros(len(tangents), np.bool_)
    n_found = find_corners(places, nodes, touch_m, rows, planes, parts, n_tangents, tangents, at_place, is_outer)
    is_corner = n_tangents > 0
    of_corners = rows.vertices[places[is_corner]], parts[is_corner], n_tangents[is_corner], tangents[:n_found]
    return Vertices(*of_corners, np.full(int(is_corner.sum()), np.inf))
