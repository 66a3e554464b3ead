"""Shapes as they are drawn: meshes with the normals that shade them, and the lines that bound them for an eye."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.parts import Object
from cagepose.model.shapes import Shape
from cagepose.model.surface import Mesh, mesh_in_own_frame

CHORDS_OF_CIRCLE = 32
"""Chords of a full circle."""
CREASE = math.cos(math.radians(25.0))
"""Triangles whose normals are farther apart meet at a sharp edge; chords of what is round make half of that."""
REACHES_OF_VIEW = 1.0
"""In reaches of the object around all that must be seen. A picture holds what lies within this of the cage's bodies."""


@dataclass(frozen=True, eq=False)
class Solid:
    """The mesh of a shape, in the shape's own frame.

    Attributes
    ----------
    mesh
        Vertices (n, 3) in metres, and triangles (m, 3).
    normals
        Of each triangle, (m, 3), outward unit vectors.
    corner_normals
        Of each corner of each triangle, (m, 3, 3): the mean of the triangles there that pass into each other smoothly.
    edges
        Indices of the vertices at both ends, (e, 2).
    sides
        Indices of the two triangles beside each edge, (e, 2).
    is_sharp
        Whether an edge is one of the shape, not of the mesh, (e,).
    """

    mesh: Mesh
    normals: FloatArray
    corner_normals: FloatArray
    edges: NDArray[np.int64]
    sides: NDArray[np.int64]
    is_sharp: NDArray[np.bool_]

    def outline(self, is_front: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the edges, (n, 2), that an eye sees as lines: sharp ones, and those where the shape ends for it.

        ``is_front`` says which triangles turn their outer side to the eye, (m,).
        """
        one, other = is_front[self.sides].T
        seen: NDArray[np.int64] = self.edges[(one != other) | (self.is_sharp & (one | other))]
        return seen


def solid_of(shape: Shape) -> Solid:
    """Return the solid of a shape; shapes of the same kind and size share one."""
    return _shared(_Sized(shape.form, shape))


@dataclass(frozen=True)
class _Sized:
    """A shape that equals all others of its kind and size."""

    form: tuple[object, ...]
    shape: Shape = field(compare=False)


@lru_cache(maxsize=256)
def _shared(sized: _Sized) -> Solid:
    mesh = mesh_in_own_frame(sized.shape, CHORDS_OF_CIRCLE)
    corners = mesh.vertices_m[mesh.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = unit_rows(areas)
    edges, sides = _edges(mesh.triangles)
    is_sharp = np.einsum("ij,ij->i", normals[sides[:, 0]], normals[sides[:, 1]]) < CREASE
    return Solid(mesh, normals, _corner_normals(mesh, areas, normals), edges, sides, is_sharp)


def _edges(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return each side of a triangle once, with the triangle that has it and the one that has it the other way."""
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    owner = dict(zip(zip(starts.tolist(), ends.tolist(), strict=True), np.arange(len(starts)) // 3, strict=True))
    edges = np.stack([starts, ends], axis=1)[starts < ends]
    sides = [(owner[start, end], owner[end, start]) for start, end in edges.tolist()]
    return edges, np.array(sides, dtype=np.int64)


def _corner_normals(mesh: Mesh, areas: FloatArray, normals: FloatArray) -> FloatArray:
    around: list[list[int]] = [[] for _ in mesh.vertices_m]
    for triangle, corners in enumerate(mesh.triangles.tolist()):
        for corner in corners:
            around[corner].append(triangle)
    found = np.empty((len(normals), 3, 3))
    for triangle, corners in enumerate(mesh.triangles.tolist()):
        for place, corner in enumerate(corners):
            beside = np.array(around[corner])
            smooth = beside[normals[beside] @ normals[triangle] >= CREASE]
            found[triangle, place] = areas[smooth].sum(axis=0)
    return unit_rows(found.reshape(-1, 3)).reshape(-1, 3, 3)


def vertices_of(shapes: Iterable[Shape]) -> FloatArray:
    """Return the vertices of the meshes of shapes in their body's frame, (n, 3), metres; n may be zero."""
    placed = [shape.pose_body_shape.transform(solid_of(shape).mesh.vertices_m) for shape in shapes]
    return np.concatenate([np.zeros((0, 3)), *placed])


def outer_points(held: Object) -> FloatArray:
    """Return points (n, 3) of the object's surface, in its frame and in metres, whose hull is that of the object: the
    corners of its boxes, and the vertices of the meshes of its shapes.
    """
    corners = [box.corners_object() for box in held.boxes]
    return np.concatenate([*corners, vertices_of(held.shapes)])


def cut_off(bodies: FloatArray, needed: FloatArray, reach_m: float) -> FloatArray:
    """Return points of the cage's bodies, (n, 3), those far from all of ``needed`` (m, 3) moved near. ``reach_m``: that
    of the object.

    A picture need not show more of them: a ball on a large table would be a dot on a picture of the table.
    """
    low, high = needed.min(axis=0) - REACHES_OF_VIEW * reach_m, needed.max(axis=0) + REACHES_OF_VIEW * reach_m
    cut: FloatArray = np.clip(bodies, low, high)
    return cut
