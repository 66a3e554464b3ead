"""Shapes in a 3-D panel of matplotlib: the shaded sides that face the reader, and their outline."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from matplotlib.colors import to_rgb
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape
from cagepose.views.solids import solid_of
from cagepose.views.style import Look

DIM = 0.62
"""How bright a face is that is seen from its edge."""
N_TINTS, LEAST_TINT, TINT = 8, 0.02, 0.09
"""Steps from the darkest to the brightest place of what is round, the least difference that has steps, and how much
lighter each is.
"""

PlacedShapes = Iterable[tuple[Shape, Pose]]
"""Shapes, each with the pose of its body in the world."""


class SolidDrawing:
    """Draws shapes into one panel, which has its limits and its view already."""

    def __init__(self, panel: Axes3D, low: FloatArray, high: FloatArray, length_unit: LengthUnit) -> None:
        """``low`` and ``high``, (3,) in the unit: nothing is drawn beyond, as a 3-D panel cuts nothing off."""
        self.panel, self.low, self.high = panel, low, high
        self.unit: LengthUnit = length_unit
        azimuth, elevation = math.radians(panel.azim), math.radians(panel.elev)
        flat = math.cos(elevation)
        self.to_reader = np.array([flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation)])

    def draw(self, shapes: PlacedShapes, face_color: str, edge_color: str, opacity: float) -> None:
        """Draw shaded faces and outlines.

        Triangles that can be seen through would show their borders. So each smooth part of a surface is one polygon,
        and those of its brighter regions, one on the other, tint it: with so few, files are small, too.
        """
        faces, colors, color = list[FloatArray](), list[FloatArray](), np.array(to_rgb(face_color))
        outlines = list[FloatArray]()
        for shape, pose in shapes:
            vertices, is_front, outline = self._seen(shape, pose)
            outlines += outline
            solid, rotation = solid_of(shape), (pose @ shape.pose_body_shape).rotation
            lit = DIM + (1.0 - DIM) * np.abs(solid.normals @ rotation.T @ self.to_reader)
            for patch in np.unique(solid.patches[is_front]).tolist():
                is_patch = is_front & (solid.patches == patch)
                low, high = float(lit[is_patch].min()), float(lit[is_patch].max())
                levels = np.linspace(low, high, N_TINTS if high - low > LEAST_TINT else 1)
                for number, level in enumerate(levels.tolist()):
                    tint = np.append(low * color, opacity) if number == 0 else np.append(0.5 + 0.5 * color, TINT)
                    for loop in solid.loops(is_patch & (lit >= level)):
                        if len(face := _cut_face(vertices[loop], self.low, self.high)):
                            faces.append(face)
                            colors.append(tint)
        if faces:
            self.panel.add_collection3d(Poly3DCollection(faces, facecolors=colors, edgecolors="none"))
        self._add_lines(outlines, {"colors": edge_color, "linewidths": 0.5})

    def draw_outline(self, shapes: PlacedShapes, look: Look) -> None:
        """Draw outlines alone, with matplotlib's keywords for lines."""
        self._add_lines([line for shape, pose in shapes for line in self._seen(shape, pose)[2]], look)

    def _add_lines(self, lines: list[FloatArray], look: Look) -> None:
        if lines:
            self.panel.add_collection3d(Line3DCollection(lines, **look))

    def _seen(self, shape: Shape, pose: Pose) -> tuple[FloatArray, np.ndarray, list[FloatArray]]:
        """Return a shape's vertices in the unit (n, 3), which triangles face the reader, (m,), and its outline."""
        solid = solid_of(shape)
        vertices = from_metres((pose @ shape.pose_body_shape).transform(solid.mesh.vertices_m), self.unit)
        flat = np.column_stack([vertices, np.ones(len(vertices))]) @ self.panel.get_proj().T
        corners = (flat[:, :2] / flat[:, 3:])[solid.mesh.triangles]  # as the picture shows them, stretched or not
        along, across = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        is_front = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0] > 0.0
        lines = (_cut_line(vertices[edge], self.low, self.high) for edge in solid.outline(is_front))
        return vertices, is_front, [line for line in lines if len(line)]


def _cut_face(corners: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return what of a flat face, corners (n, 3), lies within a block (Sutherland and Hodgman); none: (0, 3)."""
    if (corners >= low).all() and (corners <= high).all():
        return corners
    for axis in range(3):
        for inward, bound in ((1.0, low[axis]), (-1.0, high[axis])):
            depths = inward * (corners[:, axis] - bound)
            kept = list[FloatArray]()
            for place, depth in enumerate(depths.tolist()):
                before = float(depths[place - 1])
                if (depth < 0.0) != (before < 0.0):
                    share = before / (before - depth)
                    kept.append(corners[place - 1] + share * (corners[place] - corners[place - 1]))
                if depth >= 0.0:
                    kept.append(corners[place])
            corners = np.array(kept).reshape(-1, 3)
            if len(corners) < 3:
                return np.zeros((0, 3))
    return corners


def _cut_line(ends: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return what of a straight line, (2, 3), lies within a block; none: (0, 3)."""
    way = ends[1] - ends[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = np.sort(np.stack([(low - ends[0]) / way, (high - ends[0]) / way]), axis=0)
    is_within = (ends[0] >= low) & (ends[0] <= high)
    cuts[:, way == 0.0] = np.where(is_within, [[-np.inf], [np.inf]], [[np.inf], [-np.inf]])[:, way == 0.0]
    first, last = max(0.0, float(cuts[0].max())), min(1.0, float(cuts[1].min()))
    return ends[0] + np.array([[first], [last]]) * way if first < last else np.zeros((0, 3))
