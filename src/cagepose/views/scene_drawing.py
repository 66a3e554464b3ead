"""The object and its cage in three dimensions: boxes, points, contacts, axes of turning, loads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.patches import FancyArrowPatch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from mpl_toolkits.mplot3d.proj3d import proj_transform

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.run import Event, Motion
from cagepose.studies.acts import acts_of, coil
from cagepose.studies.touching import TouchFinder
from cagepose.views.solid_drawing import SolidDrawing
from cagepose.views.solids import cut_off, outer_points, vertices_of
from cagepose.views.style import BLACK, BLUE, BROWN, GREY, ORANGE, PURPLE, SAND, SKY, VERMILLION, Look

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
SECOND_HEAD, LONGEST_SPRING, COIL = 0.8, 0.5, 0.012
"""Where a moment's arrow has its other head; in lengths of the picture, the greatest length of a spring that is drawn,
and the radius of its coils."""
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
        self.finder = TouchFinder(scene) if scene.has_other_shapes else None
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

    def draw(self, panel: Axes3D, phase_index: int, event: Event | None, before: Pose, title: str) -> None:
        """Draw the object after ``event`` (None: at ``before``), and the motion that took it there."""
        pose = before if event is None else event.pose_world_object
        solids = self._set_view(panel)
        self._draw_object(panel, solids, pose)
        if event is not None and event.motion is not None:
            self._draw_outline(panel, solids, before)
            self._draw_motion(panel, event.motion, before)
        contacts, hit = ((), ()) if event is None else (event.contacts, event.hit)
        self._draw_points(panel, contacts, hit, self._marks(pose, contacts))
        self._draw_load(panel, phase_index, pose)
        self._frame(panel, title)

    def draw_pose(self, panel: Axes3D, pose: Pose, touching: tuple[str, ...], title: str) -> None:
        """Draw the object at ``pose``, dotted where it starts, and the points that touch."""
        solids = self._set_view(panel)
        self._draw_object(panel, solids, pose)
        self._draw_outline(panel, solids, self.scene.object.pose_world_object)
        self._draw_points(panel, touching, (), {})
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

    def _draw_motion(self, panel: Axes3D, motion: Motion, before: Pose) -> None:
        """An axis of turning as a line through the picture, a travel as an arrow from where the CoG was."""
        if motion.axis_world is not None and motion.through_world is not None:
            line = self._across(self._shown(motion.through_world), motion.axis_world)
            panel.plot(*line.T, color=PURPLE, linestyle="-.", linewidth=1.6, zorder=6)
        elif motion.direction_world is not None:
            start = self._shown(before.transform(self.scene.object.center_of_gravity_m))
            panel.add_artist(_Arrow(start, start + self._length(0.25, motion.direction_world), PURPLE))

    def _marks(self, pose: Pose, contacts: tuple[str, ...]) -> dict[str, FloatArray]:
        """Return where shapes of the cage touch the object at a pose, (n, 3) each, by name."""
        found = None if self.finder is None else self.finder.at(pose)
        marks: dict[str, FloatArray] = {}
        for index, name in enumerate(self.scene.cage.element_names):
            if found is not None and index >= len(self.points) and name in contacts:
                marks[name] = self._shown(found.places_world[found.elements == index])
        return marks

    def _draw_points(
        self, panel: Axes3D, contacts: tuple[str, ...], hit: tuple[str, ...], marks: dict[str, FloatArray]
    ) -> None:
        """Draw the cage's points, and the places where its shapes touch, with their names."""
        names = self.scene.cage.element_names
        cage = self.scene.cage
        mouths = [cage.pose_world_cage.transform(hole.pose_body_shape.position_m) for hole in cage.holes]
        middles = [body.mean(axis=0) for body in self.bodies] + [self._shown(mouth) for mouth in mouths]
        labels: list[tuple[FloatArray, list[str], bool]] = []
        chosen: dict[str, list[FloatArray]] = {look: [] for look in POINT_LOOKS}
        for name, place in zip(names, [*self.points, *middles], strict=True):
            touches, is_point = name in contacts, name in self.scene.cage.names
            places = place[None] if is_point else marks.get(name, np.zeros((0, 3)))
            chosen["reached" if name in hit else "touching" if touches else "free"].extend(places)
            if touches or len(names) <= MOST_NAMED_POINTS:
                self._add_label(labels, places[0] if len(places) else place, name, touches)
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

    def _draw_load(self, panel: Axes3D, phase_index: int, pose: Pose) -> None:
        """Draw what acts; a weight where nothing else does."""
        load = self.scene.loads[phase_index]
        acts = acts_of(self.scene, load)
        for act in [act for act in acts if act.kind != "weight"] or acts:
            at, direction = self._shown(pose.transform(act.at_object_m)), act.direction_at(pose)
            name = load.name if act.kind == "weight" else act.name
            if act.to_world_m is not None:
                whole = float(self.aspect.max())
                way = self._shown(act.to_world_m) - at
                far = at + way * min(
                    1.0, LONGEST_SPRING * whole / max(float(np.linalg.norm(way * self.stretch)), 1e-300)
                )
                line = coil(at * self.stretch, far * self.stretch, COIL * whole) / self.stretch
                panel.plot(*line.T, color=BLACK, linewidth=0.9, zorder=9)
                panel.text(*far, f" {name}", fontsize=7.0, color=BLACK, zorder=9)
                continue
            arrow = self._length(0.3, direction)
            start, end = (at, at + arrow) if act.kind == "moment" else (at - arrow, at)
            panel.add_artist(_Arrow(start, end, BLACK))
            if act.kind == "moment":  # two heads
                panel.add_artist(_Arrow(start, start + SECOND_HEAD * arrow, BLACK))
            panel.text(*start, f" {name}", fontsize=7.0, color=BLACK, zorder=9)

    def _length(self, fraction: float, direction: FloatArray) -> FloatArray:
        """Return a vector along ``direction`` that looks as long as a fraction of the picture, stretched as it is."""
        scaled: FloatArray = direction * fraction * self.aspect.max() / np.linalg.norm(direction * self.stretch)
        return scaled

    def _across(self, through: FloatArray, direction: FloatArray) -> FloatArray:
        """Return the two ends, (2, 3), of the part of a line that lies in the picture."""
        low, high = self.low - MARGIN * self.extents, self.high + MARGIN * self.extents
        with np.errstate(divide="ignore", invalid="ignore"):
            cuts = np.sort(np.stack([(low - through) / direction, (high - through) / direction]), axis=0)
        cuts[:, direction == 0.0] = [[-np.inf], [np.inf]]
        first, last = float(cuts[0].max()), float(cuts[1].min())
        ends = np.array([[first], [last]]) if first < last else np.zeros((2, 1))
        line: FloatArray = through + ends * direction
        return line


class _Arrow(FancyArrowPatch):
    """An arrow between two places of a 3-D panel; its head is drawn flat, so that no stretched scale bends it."""

    def __init__(self, tail: FloatArray, tip: FloatArray, color: str) -> None:
        super().__init__((0.0, 0.0), (1.0, 1.0), arrowstyle="-|>", mutation_scale=9.0, color=color, linewidth=1.5)
        self._ends = np.stack([tail, tip])
        self.set_zorder(9)

    def do_3d_projection(self, _renderer: RendererBase | None = None) -> float:
        assert isinstance(self.axes, Axes3D)
        xs, ys, zs = proj_transform(*self._ends.T, self.axes.get_proj())
        self.set_positions((xs[0], ys[0]), (xs[1], ys[1]))
        return float(min(zs))
