"""Solids of a file as it has them, and the shapes that they became, from the same places: `pictures_of`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cagepose.exchange.imported_part import ImportedPart
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.views.solids import CREASE
from cagepose.views.viewer.eye import AZIMUTH, ELEVATION, Eye
from cagepose.views.viewer.look import PAINT, ink, lit
from cagepose.views.viewer.paint_bodies import BodyPainter, ShownHole
from cagepose.views.viewer.picture import FINER_PIXELS
from cagepose.views.viewer.raster import Raster

SIZE = (600, 450)
"""Pixels across and down."""
SIDES = ((AZIMUTH, ELEVATION), (AZIMUTH + math.pi, -ELEVATION))
"""From where a body is seen, radians: from above, and from below on the other side, so that no side stays hidden."""


class Pair(NamedTuple):
    """A body as its file has it, and as it is in the scene."""

    source: Image.Image
    ours: Image.Image


class Room(NamedTuple):
    """Where a body is drawn: its middle is the origin, half of its greatest side the unit.

    Attributes
    ----------
    middle_world, size_m
        In the frame of the body, (3,) and metres.
    """

    middle_world: FloatArray
    size_m: float

    def place(self, points: FloatArray) -> FloatArray:
        """Return drawing coordinates of points (..., 3) in metres."""
        found: FloatArray = (points - self.middle_world) / self.size_m
        return found


def pictures_of(parts: Sequence[ImportedPart]) -> list[Pair]:
    """Return pictures of the solids of one body, one at least, from each of `SIDES`."""
    return [_pair(parts, *side) for side in SIDES]


def _pair(parts: Sequence[ImportedPart], azimuth: float, elevation: float) -> Pair:
    corners = np.concatenate([part.surface.vertices for part in parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = Room((low + high) / 2.0, float((high - low).max()) / 2.0)
    eye = Eye(SIZE, azimuth=azimuth, elevation=elevation)
    placed = room.place(corners)
    eye.fit(1.0, lambda: placed)
    is_object = parts[0].body == "object"
    body, edge, wall = ("object", "objectEdge", "objectWall") if is_object else ("cage", "cageEdge", "cageWall")
    raster = _raster()
    for part in parts:
        _paint_surface(part.surface, room, eye, raster, PAINT[body], PAINT[edge])
    source = raster.shrunk(FINER_PIXELS)
    raster = _raster()
    painter = BodyPainter(room, eye, raster, FINER_PIXELS)
    for part in parts:
        holes = [ShownHole(shape, shape.pose_body_shape, 1.0) for shape in part.shapes if isinstance(shape, Hole)]
        for shape in part.shapes:
            if not isinstance(shape, Hole):
                painter.paint(shape, shape.pose_body_shape, PAINT[body], holes)
                painter.edges(shape, shape.pose_body_shape, PAINT[edge])
        for hole in holes:
            painter.wall(hole, PAINT[wall], PAINT[edge])
    return Pair(source, raster.shrunk(FINER_PIXELS))


def _raster() -> Raster:
    return Raster(SIZE[0] * FINER_PIXELS, SIZE[1] * FINER_PIXELS)


def _paint_surface(surface: Triangles, room: Room, eye: Eye, raster: Raster, paint: str, edge: str) -> None:
    """Paint triangles as they are, each in one colour, and the edges that no two of them pass over smoothly."""
    corners = room.place(surface.vertices)[surface.faces]
    away = eye.target + eye.distance * eye.axes[2] - corners[:, 0]
    is_front = np.einsum("ij,ij->i", surface.normals, away) > 0.0
    normals = np.repeat(surface.normals[is_front], 3, axis=0)
    colors = lit(paint, normals, eye.axes).reshape(-1, 3, 3)
    raster.triangles(eye.pixels(corners[is_front]) * FINER_PIXELS, colors)
    places = eye.pixels(room.place(surface.vertices)) * FINER_PIXELS
    sharp = _sharp_sides(surface)
    raster.lines(places[sharp[:, 0]], places[sharp[:, 1]], ink(edge))


def _sharp_sides(surface: Triangles) -> NDArray[np.int64]:
    """Return the corners at both ends of sides, (n, 2), at which triangles meet at an edge, or do not meet."""
    sides = np.stack([surface.faces, np.roll(surface.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    distinct, which, counts = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    owners = np.argsort(which.ravel(), kind="stable") // 3
    firsts = np.cumsum(counts) - counts
    is_sharp = counts != 2
    pairs = firsts[~is_sharp]
    between = np.einsum("ij,ij->i", surface.normals[owners[pairs]], surface.normals[owners[pairs + 1]])
    is_sharp[~is_sharp] = between < CREASE
    found: NDArray[np.int64] = distinct[is_sharp]
    return found
