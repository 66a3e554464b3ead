"""Bodies in a picture: faces in their light, edges, holes cut out of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape
from cagepose.views.solids import Solid, solid_of
from cagepose.views.viewer.eye import Eye
from cagepose.views.viewer.look import ink, lit
from cagepose.views.viewer.raster import Keep, Raster

DEPTH_BEYOND = 1e-4
"""Fraction of a hole's depth. A hole is cut so far beyond the face that it is in."""


class ShownHole(NamedTuple):
    """A hole where it is shown: its pose in metres, and how many times as wide as it is."""

    hole: Hole
    pose: Pose
    widened: float


class Room(Protocol):
    """What places things in drawing coordinates, as a stage does.

    Attributes
    ----------
    middle_world, size_m
        Their origin, (3,), and their unit, metres.
    """

    @property
    def middle_world(self) -> FloatArray: ...

    @property
    def size_m(self) -> float: ...

    def place(self, points: FloatArray, /) -> FloatArray:
        """Return drawing coordinates of points (..., 3) in metres."""


class BodyPainter:
    """Paints shapes at poses, in metres, on a raster that has ``finer`` times the pixels of the eye's picture."""

    def __init__(self, stage: Room, eye: Eye, raster: Raster, finer: int) -> None:
        self.stage, self.eye, self.raster, self.finer = stage, eye, raster, finer

    def pixels(self, places: FloatArray) -> FloatArray:
        """Turn drawing coordinates into those of the raster."""
        return self.eye.pixels(places) * self.finer

    def paint(
        self, shape: Shape, pose: Pose, paint: str, holes: Sequence[ShownHole], *, is_glass: bool = False
    ) -> None:
        """Paint the faces that the eye sees; of glass, those behind."""
        solid, vertices, is_front = self._seen(shape, pose)
        self._triangles(solid, vertices, is_front != is_glass, pose, paint, self._outside(holes), 1.0)

    def glaze(self, shape: Shape, pose: Pose, paint: str, holes: Sequence[ShownHole], opacity: float) -> None:
        """Paint the faces in front so that what is behind them is seen."""
        solid, vertices, is_front = self._seen(shape, pose)
        self._triangles(solid, vertices, is_front, pose, paint, self._outside(holes), opacity)

    def wall(self, shown: ShownHole, paint: str, edge: str) -> None:
        """Paint the wall of a hole, and its rims."""
        solid = solid_of(shown.hole)
        local = solid.mesh.vertices_m * [shown.widened, shown.widened, 1.0]
        vertices = self.stage.place(shown.pose.transform(local))
        normals = solid.normals @ shown.pose.rotation.T
        middles = vertices[solid.mesh.triangles].mean(axis=1)
        is_inner = (normals * (self._eye_place - middles)).sum(axis=1) < 0.0
        across = solid.normals[:, 2]
        is_wall = is_inner & (across < 1.0 - 1e-9) & (across > -1.0 + 1e-9)
        self._triangles(solid, vertices, is_wall, shown.pose, paint, None, 1.0)
        self._lines(solid, vertices, edge)

    def edges(self, shape: Shape, pose: Pose, paint: str) -> None:
        """Draw the sharp edges of a shape."""
        solid = solid_of(shape)
        self._lines(solid, self.stage.place(pose.transform(solid.mesh.vertices_m)), paint)

    @property
    def _eye_place(self) -> FloatArray:
        place: FloatArray = self.eye.target + self.eye.distance * self.eye.axes[2]
        return place

    def _seen(self, shape: Shape, pose: Pose) -> tuple[Solid, FloatArray, NDArray[np.bool_]]:
        solid = solid_of(shape)
        vertices = self.stage.place(pose.transform(solid.mesh.vertices_m))
        first = vertices[solid.mesh.triangles[:, 0]]
        is_front = ((solid.normals @ pose.rotation.T) * (self._eye_place - first)).sum(axis=1) > 0.0
        return solid, vertices, is_front

    def _triangles(
        self,
        solid: Solid,
        vertices: FloatArray,
        chosen: NDArray[np.bool_],
        pose: Pose,
        paint: str,
        keep: Keep | None,
        opacity: float,
    ) -> None:
        if not chosen.any():
            return
        normals = solid.corner_normals[chosen].reshape(-1, 3) @ pose.rotation.T
        corners = vertices[solid.mesh.triangles[chosen]]
        towards = ((self._eye_place - corners.reshape(-1, 3)) * normals).sum(axis=1)
        sides = np.where(np.repeat(towards.reshape(-1, 3).sum(axis=1) < 0.0, 3), -1.0, 1.0)  # from inside
        colors = lit(paint, normals * sides[:, None], self.eye.axes).reshape(-1, 3, 3)
        self.raster.triangles(self.pixels(corners), colors, opacity, keep)

    def _lines(self, solid: Solid, vertices: FloatArray, paint: str) -> None:
        drawn = self.pixels(vertices)
        edges = solid.edges[solid.is_sharp]
        self.raster.lines(drawn[edges[:, 0]], drawn[edges[:, 1]], ink(paint))

    def _outside(self, holes: Sequence[ShownHole]) -> Keep | None:
        """Say which pixels are not in holes."""
        if not holes:
            return None

        def keep(pixels: FloatArray) -> NDArray[np.bool_]:
            places = self.eye.places(pixels / self.finer) * self.stage.size_m + self.stage.middle_world
            kept = np.ones(len(places), dtype=np.bool_)
            for hole, pose, widened in holes:
                inside = pose.inverse_transform(places)
                heights, radii = zip(*hole.rims, strict=True)
                slack = DEPTH_BEYOND * hole.depth_m
                across = np.hypot(inside[:, 0], inside[:, 1])
                in_depth = (inside[:, 2] > heights[0] - slack) & (inside[:, 2] < slack)
                kept &= ~(in_depth & (across < widened * np.interp(inside[:, 2], heights, radii)))
            return kept

        return keep
