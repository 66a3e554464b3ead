"""Random convex pieces, and hulls cut into pieces that lie flush."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose import Pose
from cagepose.model.boundary.convex_pieces import ConvexPiece, piece_of_hull
from cagepose.model.hull import Hull, hull_of
from cagepose.model.volume import BOX_SIGNS

FloatArray = NDArray[np.float64]
SIZE_M = 0.1
Rng = np.random.Generator


def drawn_hull(rng: Rng, size_m: float = SIZE_M) -> Hull:
    """A hull of points on a ball or in one, a prism, a double pyramid or a block."""
    kind = int(rng.integers(5))
    n = int(rng.integers(3, 9))
    angles = 2.0 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(n)], axis=1)
    up = np.array((0.0, 0.0, rng.uniform(0.3, 1.5)))
    if kind == 0:
        points = rng.standard_normal((int(rng.integers(5, 20)), 3))
        points /= np.linalg.norm(points, axis=1)[:, None]
    elif kind == 1:
        points = rng.uniform(-1.0, 1.0, (int(rng.integers(5, 16)), 3))
    elif kind == 2:
        points = np.concatenate([ring - up / 2.0, ring + up / 2.0])
    elif kind == 3:
        points = np.concatenate([ring, [up], [-rng.uniform(0.0, 1.0) * up]])
    else:
        points = BOX_SIGNS * rng.uniform(0.2, 1.0, 3)
    return hull_of(Pose((0.0, 0.0, 0.0), rng.standard_normal(4)).transform(size_m / 2.0 * points))


def drawn_pieces(rng: Rng, n: int) -> list[ConvexPiece]:
    """Pieces of two parts that overlap at random."""
    poses = [Pose(0.7 * SIZE_M * rng.uniform(-1.0, 1.0, 3), rng.standard_normal(4)) for _ in range(n)]
    return [
        piece_of_hull(drawn_hull(rng, SIZE_M * rng.uniform(0.4, 1.5)), pose, int(rng.integers(2))) for pose in poses
    ]


def cut(hull: Hull, n_cuts: int, rng: Rng) -> list[FloatArray]:
    """Cut a hull, or one of its pieces, by a random plane, so many times: no plane is close to a corner.

    Return the corners of each piece. Until then its edges are told from which corners are on which faces.
    """
    is_on = np.zeros((len(hull.vertices_m), len(hull.faces)), np.bool_)
    for face, loop in enumerate(hull.faces):
        is_on[list(loop), face] = True
    pieces = [(hull.vertices_m, is_on)]
    while len(pieces) <= n_cuts:
        corners, is_on = piece = pieces.pop(int(rng.integers(len(pieces))))
        normal = rng.standard_normal(3)
        normal /= np.linalg.norm(normal)
        heights = (corners - rng.dirichlet(np.ones(len(corners))) @ corners) @ normal
        if np.abs(heights).min() < 1e-3 * np.ptp(heights):
            pieces.append(piece)
            continue
        is_above = heights > 0.0
        n_shared = is_on.astype(np.int64) @ is_on.T
        start, end = np.nonzero(np.triu(n_shared >= 2, 1) & (is_above[:, None] != is_above))
        share = (heights[start] / (heights[start] - heights[end]))[:, None]
        on_plane = corners[start] + share * (corners[end] - corners[start])
        is_on_there = np.hstack([is_on[start] & is_on[end], np.ones((len(start), 1), np.bool_)])
        for side in (is_above, ~is_above):
            is_on_here = np.hstack([is_on[side], np.zeros((int(side.sum()), 1), np.bool_)])
            pieces.append((np.concatenate([corners[side], on_plane]), np.concatenate([is_on_here, is_on_there])))
    return [corners for corners, _ in pieces]
