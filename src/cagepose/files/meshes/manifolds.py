"""Bodies of manifold3d as arrays of triangles, and circles through their corners."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.extra import files_library
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH
from cagepose.model.checks import FloatArray

SHARE_LEFT = 0.99
"""Share of the triangles. A pass that leaves more of them was the last."""


def manifold3d() -> Any:
    """Return the module that cuts bodies of triangles.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return files_library("manifold3d", "meshes and parts with holes need manifold3d")


def without_rounding(body: Any) -> Any:
    """Return a body without corners within its faces and edges, but for rounding: one pass leaves a few of many."""
    tolerance, n_before = ROUNDING_OF_MESH * Triangles.of(body).size, math.inf
    while body.num_tri() < SHARE_LEFT * n_before:
        n_before, body = body.num_tri(), body.simplify(tolerance)
    return body


@dataclass(frozen=True, eq=False)
class Triangles:
    """A closed surface: corners (n, 3), and indices of the corners of each triangle (m, 3)."""

    vertices: FloatArray
    faces: NDArray[np.int64]

    @classmethod
    def of(cls, body: Any) -> Triangles:
        """Return the surface of a body."""
        mesh = body.to_mesh64()
        return cls(mesh.vert_properties[:, :3].copy(), mesh.tri_verts.astype(np.int64))

    def body(self) -> Any:
        """Return the body within."""
        library = manifold3d()
        return library.Manifold(library.Mesh64(self.vertices, self.faces.astype(np.uint64)))

    @cached_property
    def size(self) -> float:
        """The longest side of the box around it."""
        return float(np.ptp(self.vertices, axis=0).max())

    @cached_property
    def areas(self) -> FloatArray:
        """Twice the area of each triangle, along its normal, (m, 3)."""
        a, b, c = np.moveaxis(self.vertices[self.faces], 1, 0)
        found: FloatArray = np.cross(b - a, c - a)
        return found

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normals of the triangles, (m, 3)."""
        lengths = np.linalg.norm(self.areas, axis=1, keepdims=True)
        found: FloatArray = self.areas / np.maximum(lengths, np.finfo(float).tiny)
        return found

    def face_points(self) -> FloatArray:
        """Return the middles of triangles and of their sides: what is within a round surface is deepest there."""
        corners = self.vertices[self.faces]
        sides = (corners + np.roll(corners, 1, axis=1)) / 2.0
        return np.concatenate([corners.mean(axis=1), sides.reshape(-1, 3)])


class Circle(NamedTuple):
    """A circle through corners: how far they are off, of how many equal sides its longest is one, and how far that is
    within.
    """

    center: FloatArray
    radius: float
    off: float
    n_sides: float
    sagitta: float


def circle_through(points: FloatArray, axis: FloatArray) -> Circle | None:
    """Return the circle about a unit vector that is nearest to points (n, 3) of one plane; None: there are too few."""
    if len(points) < 3:
        return None
    first = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    middle = points.mean(axis=0)
    flat = (points - middle) @ np.stack([first, second], axis=1)
    x, y, z = np.linalg.lstsq(np.insert(2.0 * flat, 2, 1.0, axis=1), (flat**2).sum(axis=1), rcond=None)[0].tolist()
    arms = flat - (x, y)
    away = np.linalg.norm(arms, axis=1)
    radius = math.sqrt(max(z + x * x + y * y, 0.0))
    angles = np.sort(np.arctan2(arms[:, 1], arms[:, 0]))
    gap = float(np.diff(angles, append=angles[0] + 2.0 * math.pi).max())
    off = float(np.abs(away - radius).max())
    return Circle(
        middle + x * first + y * second,
        radius,
        off,
        2.0 * math.pi / gap,
        radius * (1.0 - math.cos(min(gap, 3.0) / 2.0)),
    )
