"""What a notebook shows of a scene and of a run: a small picture, and beside it what the terminal prints.

The picture is SVG, written by hand: it needs no extra.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from html import escape

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape
from cagepose.runs.driven_cage import CageAt, cage_at_end, cage_at_start
from cagepose.runs.run import Run
from cagepose.views.solids import cut_off, outer_points, solid_of

WIDTH, HEIGHT, MARGIN = 360.0, 240.0, 16.0
"""Pixels."""
AZIMUTH, ELEVATION = math.radians(-56.0), math.radians(24.0)
"""As in pictures of the viewer."""
INK = {"start": "#999999", "end": "#0072b2", "cage": "#5c4d33", "free": "#737373", "touching": "#e69f00"}
LONGEST_ARROW = 40.0
"""Length of the greatest force, pixels."""
PAGE = '<div style="display:flex;gap:1em;align-items:flex-start">{picture}<pre style="margin:0">{text}</pre></div>'


def run_html(run: Run) -> str:
    """Return a run as HTML: the start in grey, the end in blue, what touches in orange, forces as arrows."""
    start, end = cage_at_start(run.scene.cage), cage_at_end(run)
    picture = _Picture(run.scene, [run.scene.object.pose_world_object, run.pose], [start, end])
    picture.draw_object(run.scene.object.pose_world_object, INK["start"])
    picture.draw_cage(end, {contact.point for contact in run.contacts})
    picture.draw_object(run.pose, INK["end"])
    pressing = [contact for contact in run.contacts if contact.force_normal_n and contact.place_world is not None]
    greatest = max((contact.force_normal_n or 0.0 for contact in pressing), default=1.0)
    for contact in pressing:
        assert contact.place_world is not None
        assert contact.force_normal_n is not None
        length = LONGEST_ARROW * contact.force_normal_n / greatest
        picture.draw_arrow(contact.place_world, -contact.normal_world, length)
    return PAGE.format(picture=picture.svg(), text=escape(str(run)))


def scene_html(scene: Scene) -> str:
    """Return a scene as HTML: the object where it starts, and its cage."""
    start, cage = scene.object.pose_world_object, cage_at_start(scene.cage)
    picture = _Picture(scene, [start], [cage])
    picture.draw_cage(cage, set())
    picture.draw_object(start, INK["end"])
    return PAGE.format(picture=picture.svg(), text=escape(repr(scene)))


class _Picture:
    def __init__(self, scene: Scene, poses: Iterable[Pose], cages: Iterable[CageAt]) -> None:
        sin_a, cos_a, sin_e, cos_e = math.sin(AZIMUTH), math.cos(AZIMUTH), math.sin(ELEVATION), math.cos(ELEVATION)
        self.axes = np.array([[-sin_a, cos_a, 0.0], [-cos_a * sin_e, -sin_a * sin_e, cos_e]])
        self.scene, self.parts = scene, list[str]()
        outer = outer_points(scene.object)
        cages = list(cages)
        points = [cage.points_world for cage in cages]
        self.needed = np.concatenate([pose.transform(outer) for pose in poses] + points)
        of_cages = (vertices for cage in cages for _, _, vertices in self._shapes(cage))
        seen = np.concatenate([self.needed, *of_cages]) @ self.axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        room = np.array([WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN])
        self.scale = float((room / np.maximum(high - low, 1e-9 * scene.size_m)).min())
        self.middle = (low + high) / 2.0

    def svg(self) -> str:
        size = f'width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none">{"".join(self.parts)}</svg>'

    def draw_object(self, pose: Pose, ink: str) -> None:
        held: Object = self.scene.object
        for part in (*held.parts, *held.holes):
            placed = pose @ part.pose_body_shape
            self._draw_solid(part, placed.transform(solid_of(part).mesh.vertices_m), placed, ink)

    def draw_cage(self, cage: CageAt, touching: set[str]) -> None:
        for shape, placed, vertices in self._shapes(cage):
            ink = INK["touching"] if shape.name in touching else INK["cage"]
            self._draw_solid(shape, vertices, placed, ink)
        for name, (x, y) in zip(self.scene.cage.names, self._pixels(cage.points_world).tolist(), strict=True):
            ink, radius = (INK["touching"], 4) if name in touching else (INK["free"], 2.5)
            title = f"<title>{escape(name)}</title>"
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{ink}">{title}</circle>')

    def draw_arrow(self, tip_world: FloatArray, direction: FloatArray, length: float) -> None:
        """Draw a force on the object: its tip is where they touch."""
        tip = self._pixels(tip_world)
        way = (direction @ self.axes.T) * (1.0, -1.0)
        tail = tip - length * way
        (x, y), (u, v) = tip.tolist(), tail.tolist()
        self.parts.append(f'<path d="M{u:.1f} {v:.1f}L{x:.1f} {y:.1f}" stroke="#d55e00" stroke-width="2"/>')
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="#d55e00"/>')

    def _shapes(self, cage: CageAt) -> Iterator[tuple[Shape, Pose, FloatArray]]:
        """Yield each shape and each hole of the cage, where it is, and its vertices there, as far as they are shown."""
        for which, shape in enumerate((*cage.cage.shapes, *cage.cage.holes)):
            placed = cage.pose_of_shape(which)
            vertices = placed.transform(solid_of(shape).mesh.vertices_m)
            yield shape, placed, cut_off(vertices, self.needed, self.scene.object.reach_m)

    def _draw_solid(self, shape: Shape, vertices_world: FloatArray, pose: Pose, ink: str) -> None:
        """Draw the outline of a shape as the eye sees it."""
        solid = solid_of(shape)
        towards_eye = pose.rotation.T @ np.cross(self.axes[0], self.axes[1])
        lines = self._pixels(vertices_world)[solid.outline(solid.normals @ towards_eye > 0.0)]
        path = "".join(f"M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" for (x, y), (u, v) in lines.tolist())
        self.parts.append(f'<path d="{path}" stroke="{ink}"/>')

    def _pixels(self, places_world: FloatArray) -> FloatArray:
        seen = (places_world @ self.axes.T - self.middle) * self.scale * (1.0, -1.0)
        pixels: FloatArray = seen + np.array([WIDTH, HEIGHT]) / 2.0
        return pixels
