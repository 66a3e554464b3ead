"""Shapes as the features that kernels take: vertices, edges and faces with their fences."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Feature, Fence, ShapePart, Shapes, copied
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Rounded, Shape


def has_features(part: Shape) -> bool:
    """Whether a shape is one that kernels know."""
    return isinstance(part, Box | Rounded)


def shapes_of(parts: Iterable[Box | Shape | FloatArray]) -> Shapes:
    """Return the features of parts in the frame of their body; a single point (3,) is a part, too."""
    made = _Features()
    for part in parts:
        if isinstance(part, np.ndarray):
            made.add(hull_of(part[None]), Pose(), 0.0)
        elif isinstance(part, Box):
            made.add(hull_of(part.corners_object()), Pose(), 0.0)
        elif isinstance(part, Rounded):
            hull = part.hull if isinstance(part, Convex) else hull_of(part.core())
            made.add(hull, part.pose_body_shape, part.radius_m)
        else:
            raise TypeError(f"no features are known of a {part.kind}")
    return made.shapes()


def shifted(shapes: Shapes, by: FloatArray) -> Shapes:
    """Return shapes moved by a travel, metres."""
    if len(shapes.parts) == 0:
        return shapes
    moved: Any = copied(shapes)
    moved.features["point"] += by
    moved.parts["middle"] += by
    return Shapes(*moved)


class _Features:
    """Rows of records, as they are added."""

    def __init__(self) -> None:
        self.parts: list[tuple[object, ...]] = []
        self.features: list[tuple[object, ...]] = []
        self.fences: list[tuple[FloatArray, float]] = []

    def shapes(self) -> Shapes:
        return Shapes(
            np.array(self.parts, dtype_of(ShapePart)),
            np.array(self.features, dtype_of(Feature)),
            np.array(self.fences, dtype_of(Fence)),
        )

    def add(self, hull: Hull, pose: Pose, radius_m: float) -> None:
        """Add a hull, blown up by a radius."""
        first, vertices = len(self.features), pose.transform(hull.vertices_m)
        normals = hull.normals @ pose.rotation.T
        starts, ends = vertices[hull.edges[:, 0]], vertices[hull.edges[:, 1]]
        lengths = np.linalg.norm(ends - starts, axis=1)
        along = (ends - starts) / lengths[:, None]
        outward = self._outward_in_faces(hull, vertices, normals)
        for index, vertex in enumerate(vertices):
            away = [*along[hull.edges[:, 0] == index], *-along[hull.edges[:, 1] == index]]
            self._feature(VERTEX, vertex, np.zeros(3), 0.0, radius_m, [(direction, 0.0) for direction in away])
        for index, pair in enumerate(hull.edges.tolist()):
            inward = [(-direction, 0.0) for sides in outward for side, direction in sides if side == tuple(pair)]
            self._feature(EDGE, starts[index], along[index], float(lengths[index]), radius_m, inward)
        first_face = len(self.features)
        for face, normal, sides in zip(hull.faces, normals, outward, strict=True):
            middle = vertices[list(face)].mean(axis=0)
            bounds = [(direction, float(direction @ (vertices[side[0]] - middle))) for side, direction in sides]
            self._feature(FACE, middle, normal, 0.0, radius_m, bounds)
        middle = vertices.mean(axis=0)
        reach = float(np.linalg.norm(vertices - middle, axis=1).max()) + radius_m
        self.parts.append((first, first_face, len(self.features), middle, reach, float(lengths.min(initial=np.inf))))

    def _feature(
        self,
        kind: int,
        point: FloatArray,
        direction: FloatArray,
        length: float,
        radius: float,
        fences: list[tuple[FloatArray, float]],
    ) -> None:
        first = len(self.fences)
        self.fences.extend(fences)
        self.features.append((kind, point, direction, length, radius, first, len(self.fences)))

    @staticmethod
    def _outward_in_faces(
        hull: Hull, vertices: FloatArray, normals: FloatArray
    ) -> list[list[tuple[tuple[int, int], FloatArray]]]:
        """Return, of each face, its sides (lower index first), with the unit vectors out of the face across them."""
        found = []
        for face, normal in zip(hull.faces, normals, strict=True):
            loop = list(zip(face, (*face[1:], face[0]), strict=True))
            across = unit_rows(np.array([np.cross(vertices[end] - vertices[start], normal) for start, end in loop]))
            found.append([((min(pair), max(pair)), row) for pair, row in zip(loop, across, strict=True)])
        return found
