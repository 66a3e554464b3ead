"""Shapes as closed meshes of triangles, for pictures and for volumes.

All vertices lie on the shape, so that a mesh of what is round lies within it. What is turned about an axis is made of
rings; a rounded hull, of its faces moved outwards, strips around its edges, and caps on its corners.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.facets import Facets
from cagepose.model.hull import Hull, hull_of
from cagepose.model.shapes import Convex, Rounded, Shape, Turned
from cagepose.model.volume import BOX_SIGNS

LEAST_SEGMENTS = 3


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed surface of triangles.

    Attributes
    ----------
    vertices_m
        (n, 3), metres.
    triangles
        Indices of vertices, (m, 3), counter-clockwise seen from outside. Each side of a triangle is, the other way
        round, a side of exactly one other.
    """

    vertices_m: FloatArray
    triangles: NDArray[np.int64]


def shape_mesh(shape: Shape, segments: int, *, halved: bool = False) -> Mesh:
    """Return the surface of a shape in its body's frame.

    Parameters
    ----------
    shape
        A box or another shape. A disc, which has no thickness, has two sides at one place.
    segments
        Into how many chords a full circle is divided, at least 3.
    halved
        Whether to divide every chord in two: the same mesh with a quarter of its error.

    Raises
    ------
    ValueError
        Fewer segments.
    """
    mesh = mesh_in_own_frame(shape, segments, halved=halved)
    return Mesh(shape.pose_body_shape.transform(mesh.vertices_m), mesh.triangles)


def mesh_in_own_frame(shape: Shape, segments: int, *, halved: bool = False) -> Mesh:
    """As `shape_mesh`, in the shape's own frame: shapes of the same kind and size have the same one."""
    if segments < LEAST_SEGMENTS:
        raise ValueError(f"segments is {segments}; give at least {LEAST_SEGMENTS}")
    finer = 2 if halved else 1
    if isinstance(shape, Box):
        return _hull_mesh(hull_of(BOX_SIGNS * shape.size_m / 2.0))
    if isinstance(shape, Facets):
        return Mesh(shape.vertices_m, shape.triangles)
    if isinstance(shape, Turned):
        return _turned_mesh([*shape.rims], segments * finer)
    if isinstance(shape, Convex) and shape.hull.dimension > 1:
        is_sharp = shape.radius_m == 0.0
        return _hull_mesh(shape.hull) if is_sharp else _RoundedMesh(shape.hull, shape.radius_m, segments, finer).mesh()
    if isinstance(shape, Rounded):
        return _capsule_mesh(shape.core(), shape.radius_m, segments, finer)
    raise TypeError(f"{type(shape).__name__} has no surface")


def _hull_mesh(hull: Hull) -> Mesh:
    return Mesh(hull.vertices_m, np.array([corners for face in hull.faces for corners in _fan(face)]))


def _fan(loop: tuple[int, ...] | list[int]) -> list[tuple[int, int, int]]:
    return [(loop[0], *pair) for pair in pairwise(loop[1:])]


def _turned_mesh(profile: list[tuple[float, float]], segments: int) -> Mesh:
    """Turn a line of points (height z, radius) about the z axis, and close its two ends."""
    angles = 2.0 * math.pi * np.arange(segments) / segments
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings: list[list[int]] = []
    points: list[FloatArray] = []
    for height, radius in profile:
        n = segments if radius > 0.0 else 1
        first = sum(len(ring) for ring in points)
        rings.append(list(range(first, first + n)) * (segments // n))
        points.append(np.insert(radius * around[:n], 2, height, axis=1))
    triangles = _fan(rings[0][::-1]) + _fan(rings[-1])
    for low, high in pairwise(rings):
        for side in range(segments):
            beside = (side + 1) % segments
            triangles += [(low[side], low[beside], high[beside]), (low[side], high[beside], high[side])]
    return Mesh(np.concatenate(points), _with_three_corners(triangles))


def _with_three_corners(triangles: list[tuple[int, int, int]]) -> NDArray[np.int64]:
    return np.array([triangle for triangle in triangles if len(set(triangle)) == 3], dtype=np.int64)


def _capsule_mesh(core: FloatArray, radius: float, segments: int, finer: int) -> Mesh:
    """A sphere about one point, or a capsule between two."""
    half = float(np.linalg.norm(core[-1] - core[0])) / 2.0
    n = math.ceil(segments / 4) * finer
    lower = [(-half - radius * math.cos(k * math.pi / 2 / n), radius * math.sin(k * math.pi / 2 / n)) for k in range(n)]
    lower[0] = (-half - radius, 0.0)
    middle = [(-half, radius), (half, radius)] if half > 0.0 else [(0.0, radius)]
    upper = [(-height, ring) for height, ring in reversed(lower)]
    mesh = _turned_mesh([*lower, *middle, *upper], segments * finer)
    axis = core[-1] - core[0] if half > 0.0 else np.array((0.0, 0.0, 1.0))
    return Mesh(mesh.vertices_m @ _frame_of(axis).T + core.mean(axis=0), mesh.triangles)


def _frame_of(axis: FloatArray) -> FloatArray:
    """Return a rotation matrix whose third column is the direction of ``axis``."""
    along = unit_rows(axis[None])[0]
    if along[2] == 1.0:
        return np.eye(3)
    across = unit_rows(np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])[None])[0]
    return np.stack([np.cross(across, along), across, along], axis=1)


class _RoundedMesh:
    """Collects the mesh of a volume or a polygon that is blown up; its pieces share the points about each corner."""

    def __init__(self, hull: Hull, radius: float, segments: int, finer: int) -> None:
        self.hull, self.radius, self.segments, self.finer = hull, radius, segments, finer
        self.points: list[FloatArray] = []
        self.triangles: list[tuple[int, int, int]] = []
        self.face_of = {
            side: face for face, loop in enumerate(hull.faces) for side in zip(loop, (*loop[1:], loop[0]), strict=True)
        }
        self.at_face = {
            (corner, face): self._point(corner, hull.normals[face])
            for face, loop in enumerate(hull.faces)
            for corner in loop
        }

    def mesh(self) -> Mesh:
        for face, loop in enumerate(self.hull.faces):
            self.triangles += _fan([self.at_face[corner, face] for corner in loop])
        arcs: dict[int, dict[int, list[int]]] = {}  # of each corner, by the face at which they begin
        for start, end in self.hull.edges.tolist():
            face, beside = self.face_of[start, end], self.face_of[end, start]
            directions = self._arc(start, end, face, beside)
            lines = []
            for corner in (start, end):
                between = [self._point(corner, direction) for direction in directions]
                lines.append([self.at_face[corner, face], *between, self.at_face[corner, beside]])
            for (one, other), (one_on, other_on) in zip(pairwise(lines[0]), pairwise(lines[1]), strict=True):
                self.triangles += [(one, other, other_on), (one, other_on, one_on)]
            arcs.setdefault(start, {})[face] = lines[0]
            arcs.setdefault(end, {})[beside] = lines[1][::-1]
        for corner, lines_at in arcs.items():
            self._cap(corner, lines_at)
        return Mesh(np.array(self.points), np.array(self.triangles, dtype=np.int64))

    def _steps(self, angle_rad: float) -> int:
        """Into how many chords to divide an arc."""
        return max(1, math.ceil(angle_rad * self.segments / (2.0 * math.pi))) * self.finer

    def _point(self, corner: int, direction: FloatArray) -> int:
        self.points.append(self.hull.vertices_m[corner] + self.radius * direction)
        return len(self.points) - 1

    def _arc(self, start: int, end: int, face: int, beside: int) -> list[FloatArray]:
        """Directions between the normals of two faces, around their common edge."""
        normal, other = self.hull.normals[face], self.hull.normals[beside]
        along = unit_rows((self.hull.vertices_m[end] - self.hull.vertices_m[start])[None])[0]
        outwards = np.cross(along, normal)
        angle = abs(math.atan2(float(other @ outwards), float(other @ normal)))  # of the two sides of a polygon: +-pi
        n = self._steps(angle)
        return [math.cos(k * angle / n) * normal + math.sin(k * angle / n) * outwards for k in range(1, n)]

    def _cap(self, corner: int, arcs: dict[int, list[int]]) -> None:
        """Close the hole at a corner with rings around its middle."""
        outline: list[int] = []
        face = next(iter(arcs))
        face_at_point = {self.at_face[corner, face]: face for face in arcs}
        for _ in arcs:
            outline += arcs[face][:-1]
            face = face_at_point[arcs[face][-1]]
        center = self.hull.vertices_m[corner]
        directions = (np.array([self.points[point] for point in outline]) - center) / self.radius
        middle = unit_rows(directions.mean(axis=0)[None])[0]
        widest = math.acos(max(-1.0, min(1.0, float((directions @ middle).min()))))
        n = self._steps(widest)
        ring = outline
        for k in range(1, n):
            between = unit_rows((1.0 - k / n) * directions + k / n * middle)
            inner = [self._point(corner, direction) for direction in between]
            for place in range(len(ring)):
                beside = (place + 1) % len(ring)
                self.triangles += [
                    (ring[place], inner[place], inner[beside]),
                    (ring[place], inner[beside], ring[beside]),
                ]
            ring = inner
        top = self._point(corner, middle)
        self.triangles += [(ring[place], top, ring[(place + 1) % len(ring)]) for place in range(len(ring))]
