"""The large flat sides of a body, along which it is cut, and onto which corners of its parts are moved: `FlatSides`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import LAST_MOVE, SINGLE_PRECISION
from cagepose.model.checks import FloatArray

LARGE_SIDE = 1e-3
"""Fraction of the surface's area. What is less is no flat side that a part stands on."""
MOST_PROJECTIONS = 20
"""Onto all flat sides that a corner is near to; each halves at least what is left, where they are not nearly one."""


@dataclass(frozen=True)
class FlatSides:
    """Planes, and how near to one of them a point has to be to belong in it.

    Attributes
    ----------
    normals, heights
        Outward unit normals (n, 3), and how far from the origin (n,).
    size
        Of the body.
    """

    normals: FloatArray
    heights: FloatArray
    size: float

    @classmethod
    def of(cls, mesh: Triangles) -> Self:
        """Return those of a surface."""
        areas = np.linalg.norm(mesh.areas, axis=1)
        order = np.argsort(-areas, kind="stable")  # the largest triangle of a side tells its plane best
        normals, areas = mesh.normals[order], areas[order]
        heights = np.einsum("ij,ij->i", normals, mesh.vertices[mesh.faces[order, 0]])
        planes = np.column_stack([normals, heights / mesh.size]).round(6)
        _, first, which = np.unique(planes, axis=0, return_index=True, return_inverse=True)
        large = first[np.bincount(which.ravel(), areas) > LARGE_SIDE * areas.sum()]
        return cls(normals[large], heights[large], mesh.size)

    def taking(self, points: FloatArray) -> FloatArray:
        """Return points, (n, 3), moved onto the sides that they are near to: a part that stands on a table does so to
        the last digits, and not within it.
        """
        found = points.copy()
        for _ in range(MOST_PROJECTIONS):
            before = found.copy()
            for normal, height in zip(self.normals, self.heights, strict=True):
                off = found @ normal - height
                found -= np.outer(np.where(np.abs(off) <= SINGLE_PRECISION * self.size, off, 0.0), normal)
            if np.abs(found - before).max() <= LAST_MOVE * self.size:
                break
        return found

    def planes(self, mesh: Triangles, faces: NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
        """Return the planes, as normals (m, 3) and heights (m,), of triangles of a piece: that of the side in which all
        three corners are, as a small triangle tells it badly in single precision; else its own.
        """
        corners = mesh.vertices[mesh.faces[faces]]
        normals, heights = mesh.normals[faces], np.einsum("ij,ij->i", mesh.normals[faces], corners[:, 0])
        if len(self.heights) == 0:
            return normals, heights
        off = np.abs(corners @ self.normals.T - self.heights).max(axis=1)
        same = np.where(normals @ self.normals.T > 0.0, off, np.inf)
        side = same.argmin(axis=1)
        is_in = same.min(axis=1) <= SINGLE_PRECISION * self.size
        return np.where(is_in[:, None], self.normals[side], normals), np.where(is_in, self.heights[side], heights)
