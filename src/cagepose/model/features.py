"""Shapes as the features that kernels take: vertices, rims, edges and faces with their fences."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.shapes.features import (
    EDGE,
    FACE,
    INSIDE,
    RIM,
    VERTEX,
    Feature,
    Fence,
    ShapePart,
    Shapes,
    copied,
)
from cagepose.kernels.shapes.rims import ARCS
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Disc, Rounded, Shape, Turned


def has_features(part: Shape) -> bool:
    """Whether a shape is one that kernels know."""
    return not isinstance(part, Hole)


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
        elif isinstance(part, Turned) and has_features(part):
            made.add_turned(part)
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


NO_DIRECTION = np.zeros(3)


class _Features:
    """Rows of records, as they are added."""

    def __init__(self) -> None:
        self.parts: list[tuple[object, ...]] = []
        self.features: list[tuple[object, ...]] = []
        self.fences: list[tuple[FloatArray, float, float]] = []

    def shapes(self) -> Shapes:
        return Shapes(
            np.array(self.parts, dtype_of(ShapePart)),
            np.array(self.features, dtype_of(Feature)),
            np.array(self.fences, dtype_of(Fence)),
        )

    def add(self, hull: Hull, pose: Pose, radius_m: float) -> None:
        """Add a hull, blown up by a radius."""
        first, vertices, placed = len(self.features), pose.transform(hull.vertices_m), Pose()
        normals = hull.normals @ pose.rotation.T
        starts, ends = vertices[hull.edges[:, 0]], vertices[hull.edges[:, 1]]
        lengths = np.linalg.norm(ends - starts, axis=1)
        along = (ends - starts) / lengths[:, None]
        outward = self._outward_in_faces(hull, vertices, normals)
        for index, vertex in enumerate(vertices):
            away = [*along[hull.edges[:, 0] == index], *-along[hull.edges[:, 1] == index]]
            fences = [(direction, 0.0, 0.0) for direction in away]
            self._feature(VERTEX, placed, vertex, radius=radius_m, fences=fences)
        for index, pair in enumerate(hull.edges.tolist()):
            inward = [(-direction, 0.0, 0.0) for sides in outward for side, direction in sides if side == tuple(pair)]
            self._feature(EDGE, placed, starts[index], along[index], float(lengths[index]), radius_m, fences=inward)
        first_face = len(self.features)
        for face, normal, sides in zip(hull.faces, normals, outward, strict=True):
            middle = vertices[list(face)].mean(axis=0)
            bounds = [(direction, float(direction @ (vertices[side[0]] - middle)), 0.0) for side, direction in sides]
            self._feature(FACE, placed, middle, normal, radius=radius_m, fences=bounds)
        middle = vertices.mean(axis=0)
        reach = float(np.linalg.norm(vertices - middle, axis=1).max()) + radius_m
        self.parts.append((first, first_face, len(self.features), middle, reach, float(lengths.min(initial=np.inf))))

    def add_turned(self, part: Turned) -> None:
        """Add what is turned about an axis: flat ends, their rims, and the side between them."""
        first, pose = len(self.features), part.pose_body_shape
        rims, up = part.rims, np.array((0.0, 0.0, 1.0))
        (low, wide), (high, narrow) = rims[0], rims[-1]
        angle = math.atan2(wide - narrow, high - low)
        sine, cosine = (-1.0, 0.0) if isinstance(part, Disc) else (math.sin(angle), math.cos(angle))
        ends = [(low, wide, -up, sine if isinstance(part, Disc) else -sine), (high, narrow, up, sine)]
        flat_ends = [end for end in ends if end[1] > 0.0]
        for height, radius, out, taper in ends[: len(rims)]:
            if radius == 0.0:
                self._feature(VERTEX, pose, height * up, fences=[(-out, -taper, 0.0)])
        for height, radius, out, taper in flat_ends[: len(rims)]:
            self._add_rim(pose, height * up, radius, out, taper)
        if not isinstance(part, Disc):
            start, end = low - wide * sine / cosine, high - narrow * sine / cosine
            if narrow > wide:  # from the wide end on, so that the radius there is that of something round
                start, end, wide = end, start, narrow
            along = math.copysign(1.0, end - start) * up
            self._feature(EDGE, pose, start * up, along, abs(end - start), wide / cosine, abs(sine))
        first_face = len(self.features)
        for height, radius, out, _ in flat_ends:
            self._feature(FACE, pose, height * up, out, fences=[(np.zeros(3), radius, INSIDE)])
        middle = pose.transform(0.5 * (low + high) * up)
        lengths = [radius for _, radius, *_ in flat_ends]
        lengths += [] if isinstance(part, Disc) else [math.hypot(high - low, wide - narrow)]
        self.parts.append((first, first_face, len(self.features), middle, part.farthest_m(middle), min(lengths)))

    def _add_rim(self, pose: Pose, center: FloatArray, radius: float, out: FloatArray, taper: float) -> None:
        """Add the rim of a flat end: the ends of its arcs, and the arcs."""
        angles = math.pi / ARCS * np.arange(2 * ARCS)
        outward = np.stack([np.cos(angles), np.sin(angles), np.zeros(2 * ARCS)], axis=1)
        for away in outward[1::2]:
            along, down = np.cross(out, away), taper * away - math.sqrt(1.0 - taper * taper) * out
            fences = [(direction, 0.0, 0.0) for direction in (along, -along, -away, down)]
            self._feature(VERTEX, pose, center + radius * away, fences=fences)
        for away in outward[::2]:
            self._feature(RIM, pose, center, out, radius, taper=taper, toward=away)

    def _feature(
        self,
        kind: int,
        pose: Pose,
        point: FloatArray,
        direction: FloatArray = NO_DIRECTION,
        length: float = 0.0,
        radius: float = 0.0,
        taper: float = 0.0,
        toward: FloatArray = NO_DIRECTION,
        fences: Iterable[tuple[FloatArray, float, float]] = (),
    ) -> None:
        """Add a feature that is given in the frame of its part."""
        turn, first = pose.rotation, len(self.fences)
        self.fences.extend((turn @ along, bound, circle) for along, bound, circle in fences)
        at = (pose.transform(point), turn @ direction, turn @ toward)
        self.features.append((kind, *at, length, radius, taper, first, len(self.fences)))

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
