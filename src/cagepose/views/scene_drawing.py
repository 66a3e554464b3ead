"""The object and its cage in three dimensions, as panels of a figure: boxes, shapes, points that touch."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.views.solid_drawing import SolidDrawing
from cagepose.views.solids import cut_off, outer_points, vertices_of
from cagepose.views.style import BLACK, BLUE, BROWN, GREY, ORANGE, SAND, SKY, VERMILLION, Look

SLIMMEST = 0.45
"""No edge of a picture is shorter than this fraction of its longest; a slimmer scene is stretched, and says so."""
MOST_NAMED_POINTS = 8
"""All points of a cage this small are named; of a larger one, those that touch."""
POINT_LOOKS: Mapping[str, Look] = {
    "free": {"color": GREY, "markerfacecolor": "white", "markersize": 3.0},
    "touching": {"color": VERMILLION, "markerfacecolor": ORANGE, "markersize": 5.0},
    "reached": {"color": VERMILLION, "markersize": 5.0},
}
"""Cage points, by what they do at the end of an event; drawn in this order."""
TOGETHER = 0.04
"""Points nearer than this fraction of the picture share one label."""
BODY_OPACITY, SHAPE_OPACITY = 0.5, 0.35
"""How far bodies of the cage, and shapes of the object, cover what is behind them."""
MARGIN = 0.04
"""Room around the scene, as a fraction of each edge."""
ZOOM, ZOOM_FLAT = 0.9, 1.15
"""Fills a panel with a scene as tall as wide, and a lower panel with a flat one."""
VIEW_FROM = {"elev": 24.0, "azim": -56.0}
_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_EDGES = ((0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7))


class SceneDrawing:
    """Draws a scene at some poses of the object into panels that all show the same part of the world."""

    def __init__(self, scene: Scene, poses: Iterable[Pose], length_unit: LengthUnit) -> None:
        self.scene = scene
        self.unit: LengthUnit = length_unit
        self.points = self._shown(scene.cage.points_world())
        held, cage = scene.object, scene.cage
        needed = np.concatenate([cage.points_world(), *(pose.transform(outer_points(held)) for pose in poses)])
        bodies = [cage.pose_world_cage.transform(vertices_of([shape])) for shape in cage.shapes]
        self.bodies = [self._shown(cut_off(body, needed, held.reach_m)) for body in bodies]
        holes = self._shown(cage.pose_world_cage.transform(vertices_of(cage.holes)))
        everything = np.concatenate([self._shown(needed), *self.bodies, holes])
        self.low, self.high = everything.min(axis=0), everything.max(axis=0)
        self.extents = np.maximum(self.high - self.low, 1e-9 * (self.high - self.low).max())
        self.aspect = np.maximum(self.extents, SLIMMEST * self.extents.max())
        self.stretch = self.aspect / self.extents
        self.is_flat = bool(self.aspect[2] < 0.6 * self.aspect.max())

    def scales(self) -> str:
        """Say how the picture's scales differ, such as "y stretched 3.2 times"; empty if they do not."""
        return ", ".join(
            f"{axis} stretched {factor:.2g} times"
            for axis, factor in zip("xyz", self.stretch.tolist(), strict=True)
            if factor > 1.01
        )

    def draw_pose(self, panel: Axes3D, pose: Pose, touching: tuple[str, ...], title: str) -> None:
        """Draw the object at ``pose``, dotted where it starts, and the points that touch."""
        solids = self._set_view(panel)
        self._draw_object(panel, solids, pose)
        self._draw_outline(panel, solids, self.scene.object.pose_world_object)
        self._draw_points(panel, touching)
        self._frame(panel, title)

    def _set_view(self, panel: Axes3D) -> SolidDrawing:
        panel.view_init(**VIEW_FROM)
        panel.set_box_aspect(tuple(self.aspect.tolist()), zoom=ZOOM_FLAT if self.is_flat else ZOOM)
        for axis, low, extent in zip("xyz", self.low.tolist(), self.extents.tolist(), strict=True):
            getattr(panel, f"set_{axis}lim")(low - MARGIN * extent, low + (1.0 + MARGIN) * extent)
        room = 1e-6 * self.extents.max()
        return SolidDrawing(panel, self.low - room, self.high + room, self.unit)

    def _frame(self, panel: Axes3D, title: str) -> None:
        for axis in "xyz":
            getattr(panel, f"set_{axis}label")(axis, fontsize=7.5, labelpad=-10.0)
            getattr(panel, f"{axis}axis").set_major_locator(MaxNLocator(4))
        panel.tick_params(labelsize=6.5, pad=-3.5)
        panel.set_title(title, fontsize=8.5, y=1.0, pad=2.0)
        for artist in (*panel.collections, *panel.lines, *panel.texts, *panel.patches):
            artist.set_clip_on(False)  # a zoomed scene reaches beyond its panel's square

    def _shown(self, points_m: FloatArray) -> FloatArray:
        return from_metres(points_m, self.unit)

    def _boxes(self, pose: Pose) -> FloatArray:
        """The corners of the object's boxes at a pose, (n, 8, 3)."""
        corners = [box.corners_object() for box in self.scene.object.boxes]
        return self._shown(pose.transform(np.concatenate([np.zeros((0, 3)), *corners]))).reshape(-1, 8, 3)

    def _draw_object(self, panel: Axes3D, solids: SolidDrawing, pose: Pose) -> None:
        """Draw the object at a pose, and the bodies of the cage; of holes the outlines."""
        held, cage = self.scene.object, self.scene.cage
        solids.draw(((shape, cage.pose_world_cage) for shape in cage.shapes), SAND, BROWN, BODY_OPACITY)
        faces = [corners[list(face)] for corners in self._boxes(pose) for face in _FACES]
        if faces:
            panel.add_collection3d(
                Poly3DCollection(faces, facecolors=SKY, edgecolors=BLUE, linewidths=0.5, alpha=0.22, zorder=1)
            )
        solids.draw(((shape, pose) for shape in held.shapes), SKY, BLUE, SHAPE_OPACITY)
        solids.draw_outline(((hole, cage.pose_world_cage) for hole in cage.holes), {"colors": BROWN, "linewidths": 0.5})
        solids.draw_outline(((hole, pose) for hole in held.holes), {"colors": BLUE, "linewidths": 0.5})
        center = self._shown(pose.transform(held.center_of_gravity_m))
        panel.plot(*center[:, None], marker="D", color=BLUE, markersize=4.0, linestyle="none", zorder=5)

    def _draw_outline(self, panel: Axes3D, solids: SolidDrawing, pose: Pose) -> None:
        edges = [corners[list(edge)] for corners in self._boxes(pose) for edge in _EDGES]
        look: Look = {"colors": GREY, "linewidths": 0.5, "linestyles": ":"}
        if edges:
            panel.add_collection3d(Line3DCollection(edges, **look))
        solids.draw_outline(((shape, pose) for shape in self.scene.object.shapes), look)

    def _draw_points(self, panel: Axes3D, touching: tuple[str, ...]) -> None:
        """Draw the cage's points, and the names of those and of its shapes that touch."""
        names = self.scene.cage.element_names
        cage = self.scene.cage
        mouths = [cage.pose_world_cage.transform(hole.pose_body_shape.position_m) for hole in cage.holes]
        middles = [body.mean(axis=0) for body in self.bodies] + [self._shown(mouth) for mouth in mouths]
        labels: list[tuple[FloatArray, list[str], bool]] = []
        chosen: dict[str, list[FloatArray]] = {look: [] for look in POINT_LOOKS}
        for name, place in zip(names, [*self.points, *middles], strict=True):
            touches = name in touching
            if name in cage.names:
                chosen["touching" if touches else "free"].append(place)
            if touches or len(names) <= MOST_NAMED_POINTS:
                self._add_label(labels, place, name, touches)
        for look, points in chosen.items():
            if points:
                panel.plot(*np.array(points).T, marker="o", linestyle="none", zorder=20, **POINT_LOOKS[look])
        for point, together, touches in labels:
            panel.text(*point, f" {' '.join(together)}", fontsize=7.0, color=BLACK if touches else GREY, zorder=21)

    def _add_label(
        self, labels: list[tuple[FloatArray, list[str], bool]], point: FloatArray, name: str, touches: bool
    ) -> None:
        """Name points that lie together in one label, so that no name covers another."""
        for place, together, does_touch in labels:
            apart = float(np.linalg.norm((place - point) * self.stretch))
            if apart < TOGETHER * float(self.aspect.max()) and does_touch == touches:
                together.append(name)
                return
        labels.append((point, [name], touches))
