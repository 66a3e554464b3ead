"""What a notebook shows: of a run the page that plays it, of a scene a small picture, and what the terminal prints.

The picture is SVG, written by hand. Neither needs an extra, nor a network.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from html import escape
from importlib.resources import files

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape
from cagepose.runs.driven_cage import CageAt, cage_at_start
from cagepose.runs.run import Run
from cagepose.views.solids import cut_off, outer_points, solid_of
from cagepose.views.viewer.packed import packed_pages
from cagepose.views.viewer.playback import playback

WIDTH, HEIGHT, MARGIN = 360.0, 240.0, 16.0
"""Pixels."""
AZIMUTH, ELEVATION = math.radians(-56.0), math.radians(24.0)
"""As in pictures of the viewer."""
INK = {"object": "#0072b2", "cage": "#5c4d33", "points": "#737373"}
SCENE = '<div style="display:flex;gap:1em;align-items:flex-start">{picture}<pre style="margin:0">{text}</pre></div>'
RUN = (
    '<iframe title="The run of {name}, to be played" srcdoc="{page}"'
    ' style="display:block;width:100%;height:36rem;border:1px solid #d9d9d9"></iframe>'
    '<details><summary>{summary}</summary><pre style="margin:0">{text}</pre></details>'
)
"""Where frames are taken out, as on pages that show notebooks of strangers, the text is left."""


def run_html(run: Run) -> str:
    """Return a run as HTML: the page that plays it in a frame of its own, and what the terminal prints."""
    pages = files("cagepose.views") / "pages"
    parts = {
        "@PACKED@": packed_pages({"run": playback(run, "mm")}),
        "@SCRIPT@": (pages / "packed.js").read_text(encoding="utf-8"),
    }
    template = (pages / "cell.html").read_text(encoding="utf-8")
    cell = re.sub("@[A-Z]+@", lambda place: parts[place[0]], template)
    return RUN.format(page=escape(cell), name=escape(run.scene.name), summary=escape(repr(run)), text=escape(str(run)))


def scene_html(scene: Scene) -> str:
    """Return a scene as HTML: the object where it starts, and its cage."""
    start, cage = scene.object.pose_world_object, cage_at_start(scene.cage)
    picture = _Picture(scene, start, cage)
    picture.draw_cage(cage)
    picture.draw_object(start)
    return SCENE.format(picture=picture.svg(), text=escape(repr(scene)))


class _Picture:
    def __init__(self, scene: Scene, pose: Pose, cage: CageAt) -> None:
        sin_a, cos_a, sin_e, cos_e = math.sin(AZIMUTH), math.cos(AZIMUTH), math.sin(ELEVATION), math.cos(ELEVATION)
        self.axes = np.array([[-sin_a, cos_a, 0.0], [-cos_a * sin_e, -sin_a * sin_e, cos_e]])
        self.scene, self.parts = scene, list[str]()
        self.needed = np.concatenate([pose.transform(outer_points(scene.object)), cage.points_world])
        of_cage = (vertices for _, _, vertices in self._shapes(cage))
        seen = np.concatenate([self.needed, *of_cage]) @ self.axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        room = np.array([WIDTH - 2.0 * MARGIN, HEIGHT - 2.0 * MARGIN])
        self.scale = float((room / np.maximum(high - low, 1e-9 * scene.size_m)).min())
        self.middle = (low + high) / 2.0

    def svg(self) -> str:
        size = f'width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="none">{"".join(self.parts)}</svg>'

    def draw_object(self, pose: Pose) -> None:
        held: Object = self.scene.object
        for part in (*held.parts, *held.holes):
            placed = pose @ part.pose_body_shape
            self._draw_solid(part, placed.transform(solid_of(part).mesh.vertices_m), placed, INK["object"])

    def draw_cage(self, cage: CageAt) -> None:
        for shape, placed, vertices in self._shapes(cage):
            self._draw_solid(shape, vertices, placed, INK["cage"])
        for name, (x, y) in zip(self.scene.cage.names, self._pixels(cage.points_world).tolist(), strict=True):
            title = f"<title>{escape(name)}</title>"
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.5" fill="{INK["points"]}">{title}</circle>')

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
