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


def cut(hull: Hull, n_cuts: int, rng: Rng) -> list[Hull]:
    """Cut a hull, or one of its pieces, by a random plane, so many times: no plane is close to a corner."""
    pieces = [hull]
    while len(pieces) <= n_cuts:
        piece = pieces.pop(int(rng.integers(len(pieces))))
        normal = rng.standard_normal(3)
        normal /= np.linalg.norm(normal)
        corners = piece.vertices_m
        heights = (corners - rng.dirichlet(np.ones(len(corners))) @ corners) @ normal
        if np.abs(heights).min() < 1e-3 * np.ptp(heights):
            pieces.append(piece)
            continue
        start, end = piece.edges[heights[piece.edges].prod(axis=1) < 0.0].T
        share = (heights[start] / (heights[start] - heights[end]))[:, None]
        on_plane = corners[start] + share * (corners[end] - corners[start])
        pieces += [hull_of(np.concatenate([corners[side], on_plane])) for side in (heights > 0.0, heights < 0.0)]
    return pieces
