"""A run as snapshots: the scene after each event, and where each weight presses, seen from above."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.runs.changes import Seen, changes_of, mode_of
from cagepose.runs.driven_cage import cage_at_end
from cagepose.runs.on_the_way import DRIVEN
from cagepose.runs.run import Run
from cagepose.studies.ending import ending
from cagepose.studies.support import convex_hull, load_view
from cagepose.studies.support_region import SupportRegion, support_region
from cagepose.views.drive_words import share_words
from cagepose.views.solids import cut_off, outer_points, vertices_of
from cagepose.views.style import (
    BLACK,
    BLUE,
    BROWN,
    GREEN,
    GREY,
    PAGE_WIDTH_IN,
    POINT_LOOKS,
    PURPLE,
    SAND,
    SKY,
    Look,
    styled,
)
from cagepose.views.tolerances import DISTANCE_OF_EDGE
from cagepose.views.viewer.labels import laid_out
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage

N_COLUMNS = 2
PANEL_IN, PICTURE = 2.85, (560, 384)
"""Height of a panel, and the pixels of a snapshot in it."""
HEAD_IN, FOOT_IN = 0.55, 0.6
"""Room for the title and for the legend."""
MOST_SNAPSHOTS = 8
SHOTS_PER_MOTION = 2
"""A longer run shows its start, its first events and its last one, and says how many it leaves out."""

REACH_WITHOUT_END = 10.0
"""In sizes of the scene: a support region without end is drawn as far, which is out of the picture."""
MARGIN_OF_VIEW = 0.06
"""Share of the extent of a view that is left as room around it."""

LONGEST_NAME = 12
"""Characters of a phase's name in a title."""
LONGEST_TITLE = 60
"""Characters that fit above a panel; a longer title takes two lines."""


def event_figure(run: Run, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the scene at the start and after each event, as the paper's Figs. 6 and 7 do.

    A snapshot shows what is near the cage. Each phase under a weight alone adds a view along it: the support region and
    the centre of gravity.
    """
    shots, n_left_out = _snapshots(run, length_unit)
    weights = [index for index in range(len(run.phases)) if run.scene.loads[index].is_weight_alone]
    n_panels = len(shots) + len(weights)
    rows = math.ceil(n_panels / N_COLUMNS)
    with styled():
        stage = Stage(playback(run, length_unit, SHOTS_PER_MOTION))
        grid = _Grid(rows)
        height = grid.height_in
        figure = Figure(figsize=(PAGE_WIDTH_IN, height))
        for place, (row, title) in enumerate(shots):
            panel = figure.add_axes(grid.cell(place, (0.01, 0.01, 0.98, 0.87)))
            panel.imshow(_snapshot(stage, row))
            panel.set_axis_off()
            panel.set_title(title, fontsize=8.5, pad=3.0)
        for place, phase_index in enumerate(weights, start=len(shots)):
            _draw_view(figure.add_axes(grid.cell(place, (0.2, 0.19, 0.72, 0.58))), run, phase_index, length_unit)
        title = f"{run.scene.name}: {ending(run)} ({run.method})"
        figure.text(0.5, 1.0 - 0.08 / height, title, ha="center", va="top", fontsize=11)
        if n_left_out:
            note = f"motions before the last that are left out: {n_left_out}"
            figure.text(0.5, 1.0 - 0.32 / height, note, ha="center", va="top", fontsize=8.5)
        _draw_legend(figure, run.scene)
    return figure


@dataclass(frozen=True)
class _Grid:
    """Where panels lie: laid out by hand, so that titles and snapshots keep their sizes."""

    n_rows: int

    @property
    def height_in(self) -> float:
        return HEAD_IN + self.n_rows * PANEL_IN + FOOT_IN

    def cell(self, place: int, part: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        """Return left, bottom, width and height in the figure; ``part`` gives them within the panel's cell."""
        row, column = divmod(place, N_COLUMNS)
        bottom_in = self.height_in - HEAD_IN - PANEL_IN * (row + 1 - part[1])
        height = part[3] * PANEL_IN / self.height_in
        return (column + part[0]) / N_COLUMNS, bottom_in / self.height_in, part[2] / N_COLUMNS, height


def _snapshots(run: Run, length_unit: LengthUnit) -> tuple[list[tuple[int, str]], int]:
    """Return (index of the event, -1: the start; title) of each snapshot, and how many motions have none."""
    shots = [(-1, "start")]
    for change in changes_of(run):
        share = change.event.share
        goes_on = change.event.rule == DRIVEN
        if change.seen is not None or goes_on:
            name = f"{change.number}. {_cut(change.phase.name)}, {mode_of(change.event.rule)}:"
            amounts = [_amount(change.seen, length_unit)] if change.seen is not None else []
            amount = "; ".join([*amounts, *([f"{share_words(share)} of the drive"] if goes_on else [])])
            gap = " " if len(name) + len(amount) < LONGEST_TITLE else "\n"
            shots.append((change.number - 1, f"{name}{gap}{amount}"))
    if len(shots) <= MOST_SNAPSHOTS:
        return shots, 0
    return [*shots[: MOST_SNAPSHOTS - 1], shots[-1]], len(shots) - MOST_SNAPSHOTS


def _snapshot(stage: Stage, row: int) -> FloatArray:
    """Return the pixels of one event's end, with the outline of where its motion began."""
    shown = stage.shown
    before, after = (0, 0) if row < 0 else (shown.rows[row].first_shot - 1, shown.rows[row].last_shot)
    maker = PictureMaker(stage, size=PICTURE, seen=(before, after))
    return np.asarray(maker.picture(shown.shots[after], is_captioned=False))


def _amount(motion: Seen, length_unit: LengthUnit) -> str:
    if not math.isfinite(motion.distance_m):
        return "travel, no contact ahead"
    parts = []
    if motion.distance_m:
        parts.append(f"{float(from_metres(motion.distance_m, length_unit)):.4g} {length_unit}")
    if motion.angle_rad:
        parts.append(f"{math.degrees(motion.angle_rad):.4g} deg")
    return f"{motion.kind} {', '.join(parts) or 'of nothing'}"


def _cut(name: str) -> str:
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"


def _draw_view(panel: Axes, run: Run, phase_index: int, length_unit: LengthUnit) -> None:
    phase, view = run.phases[phase_index], load_view(run, phase_index)
    held, cage = run.scene.object, run.scene.cage
    at = cage_at_end(run, phase_index)
    points, outer = at.points_world, phase.pose.transform(outer_points(held))
    bodies = [at.pose_of_cage(which).transform(vertices_of([shape])) for which, shape in enumerate(cage.shapes)]
    shown_bodies = [cut_off(body, np.concatenate([points, outer]), held.reach_m) for body in bodies]
    # the cage and the object, along the load
    for body in bodies:
        outline = from_metres(convex_hull(view.project(body)), length_unit)
        panel.fill(*outline.T, facecolor=SAND, edgecolor=BROWN, alpha=0.3, linewidth=0.6)
    for part in held.parts:
        corners = part.corners_object() if isinstance(part, Box) else vertices_of([part])
        outline = from_metres(convex_hull(view.project(phase.pose.transform(corners))), length_unit)
        panel.fill(*outline.T, facecolor=SKY, edgecolor=BLUE, alpha=0.22, linewidth=0.6)
    # the support region
    region = support_region(run, phase_index, view, REACH_WITHOUT_END * run.scene.size_m)
    extent = from_metres(view.project(np.concatenate([points, outer, *shown_bodies])), length_unit)
    if region is not None:
        corners = from_metres(region.corners, length_unit)
        panel.fill(*corners.T, facecolor="none", edgecolor=GREEN, hatch="//", linewidth=1.6)
    # points of the cage, and places where shapes touch
    touching = {contact.point for contact in phase.contacts}
    marks = [(name, point, name in touching) for name, point in zip(cage.names, extent[: len(points)], strict=True)]
    for contact in phase.contacts:
        if contact.point not in cage.names and contact.place_world is not None:
            place = from_metres(view.project(contact.place_world[None])[0], length_unit)
            marks.append((contact.point, place, True))
    for _, point, touches in marks:
        panel.plot(*point, "o", zorder=2.0 + touches, **POINT_LOOKS["touching" if touches else "free"])
    panel.plot(*from_metres(view.load_point, length_unit), marker="D", color=BLUE, markersize=5.0)
    # what is said, and room for all that is drawn
    title = f"end of {_cut(phase.name)}, seen along it:\n{_position(region, run.scene.size_m, length_unit)}"
    panel.set_title(title, fontsize=8.5, pad=8.0)
    low, high = extent.min(axis=0), extent.max(axis=0)
    if region is not None and len(corners) and np.abs(corners - 0.5 * (low + high)).max() < (high - low).max():
        low, high = np.minimum(low, corners.min(axis=0)), np.maximum(high, corners.max(axis=0))
    room = MARGIN_OF_VIEW * (high - low).max()
    panel.set_xlim(low[0] - room, high[0] + room)
    panel.set_ylim(low[1] - room, high[1] + room)
    if (high - low).min() > 0.3 * (high - low).max():
        panel.set_aspect("equal")
    horizontal, vertical = (_axis_name(axis) for axis in (view.right_world, view.up_world))
    panel.set_xlabel(f"{horizontal} [{length_unit}]", fontsize=7.5)
    panel.set_ylabel(f"{vertical} [{length_unit}]", fontsize=7.5)
    panel.tick_params(labelsize=7.0)
    _write_names(panel, {name: point for name, point, touches in reversed(marks) if touches})


def _write_names(panel: Axes, places: Mapping[str, FloatArray]) -> None:
    """Write names beside places of a panel, (2,) each in its units, so that none covers another."""
    panel.apply_aspect()  # else places move when the figure is drawn
    points_per_pixel = 72.0 / panel.figure.dpi
    area = panel.bbox
    drawn = panel.transData.transform(np.reshape(list(places.values()), (-1, 2)))
    pixels = [(x - area.x0, area.y1 - y) for x, y in drawn.tolist()]
    texts = [
        panel.annotate(name, (x, y), (0.0, 0.0), textcoords="offset points", fontsize=7.0)
        for name, (x, y) in places.items()
    ]
    extents = [text.get_window_extent() for text in texts]
    sizes = [(extent.width, extent.height) for extent in extents]
    corners = laid_out(pixels, sizes, (area.width, area.height), [False] * len(sizes))
    for text, extent, (x, y), corner in zip(texts, extents, pixels, corners, strict=True):
        text.set_visible(corner is not None)
        left, top = corner or (0.0, 0.0)
        text.set_position(((left - x) * points_per_pixel, (y - top - extent.height) * points_per_pixel))


def _position(region: SupportRegion | None, size_m: float, length_unit: LengthUnit) -> str:
    if region is None:
        return "support not known"
    if math.isinf(region.margin_m):
        return "no CoG is balanced" if region.margin_m < 0.0 else "any CoG is balanced"
    if abs(region.margin_m) < DISTANCE_OF_EDGE * size_m:
        return "CoG on the edge of support"
    margin = float(from_metres(abs(region.margin_m), length_unit))
    return f"CoG {margin:.3g} {length_unit} {'inside' if region.margin_m > 0.0 else 'outside'} support"


def _axis_name(axis_world: np.ndarray) -> str:
    """Return the world axis that a picture's axis lies along, or what it is."""
    for name, component in zip("xyz", axis_world.tolist(), strict=True):
        if abs(component) > 1.0 - 1e-9:
            return name if component > 0.0 else f"-{name}"
    return "across the load"


def _draw_legend(figure: Figure, scene: Scene) -> None:
    point: Look = {"marker": "o", "linestyle": "none"}
    support = Patch(facecolor="none", edgecolor=GREEN, hatch="//", label="support region: the weight is balanced")
    bodies = Patch(facecolor=SAND, edgecolor=BROWN, alpha=0.5, label="shape of the cage")
    patches = [*([bodies] if scene.cage.shapes else []), support]
    figure.legend(
        handles=[
            Line2D([], [], label="reached by this motion", **point, **POINT_LOOKS["reached"]),
            Line2D([], [], label="touches as well", **point, **POINT_LOOKS["touching"]),
            *([Line2D([], [], label="cage point", **point, **POINT_LOOKS["free"])] if scene.cage.names else []),
            Line2D([], [], color=BLUE, marker="D", linestyle="none", markersize=4.0, label="centre of gravity (CoG)"),
            Line2D([], [], color=PURPLE, label="axis of turning, or travel"),
            Line2D([], [], color=BLACK, label="load"),
            Line2D([], [], color=GREY, linewidth=0.7, label="before the motion"),
            *patches,
        ],
        loc="lower center",
        ncols=4,
        handlelength=2.2,
        columnspacing=1.2,
        fontsize=7.5,
    )
