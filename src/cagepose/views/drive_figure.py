"""The drives of a run as curves over their way: the drivers' force, what touches, and the object's pose.

Each phase that drives bodies of the cage has a column, whose way is that of its one body, or the share of the way where
it drives several. Where the object snaps, all stands above each other, and the force is not drawn: no body moves.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from cagepose.files.units import LengthUnit, from_metres, with_unit
from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import Run
from cagepose.studies.ending import ending
from cagepose.views.drive_curves import DriveCurves, drive_curves, shown_along
from cagepose.views.style import BLACK, BLUE, GREY, ORANGE, PAGE_WIDTH_IN, PALE, SERIES, SKY, VERMILLION, Look, styled
from cagepose.views.tolerances import LEAST_ANGLE_DEG, LEAST_FORCE, LEAST_LENGTH_OF_SIZE

MOST_NAMES = 30
"""Rows of contacts; a run with more shows those that touched first."""
HEIGHTS_IN = (2.3, 1.2, 1.2)
"""Of force, way and angles; contacts have a row each."""
TOUCHING: dict[bool, Look] = {
    True: {"facecolor": ORANGE, "edgecolor": VERMILLION, "hatch": "////"},
    False: {"facecolor": SKY, "edgecolor": BLUE},
}
"""Bars of contacts, by whether they are of a body that is driven."""
SNAP: Look = {"color": GREY, "linestyle": (0, (1, 2)), "linewidth": 1.2}


def drive_figure(run: Run, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the force of each drive of a run over its way, above what touches there and how the object moves.

    Raises
    ------
    ValueError
        No phase of the run has driven a body.
    """
    drives = [
        drive_curves(run.scene, phase, load, length_unit)
        for phase, load in zip(run.phases, run.scene.loads, strict=False)
        if phase.drive is not None
    ]
    if not drives:
        raise ValueError("no phase of this run has driven a body of the cage, so there is no force to draw")
    names = list(dict.fromkeys(name for drive in drives for name, *_ in drive.stays))[:MOST_NAMES]
    with styled():
        heights = [HEIGHTS_IN[0], 0.3 + 0.17 * max(len(names), 1), *HEIGHTS_IN[1:]]
        figure = Figure(figsize=(PAGE_WIDTH_IN, sum(heights) + 1.3), layout="constrained")
        columns = figure.subplots(4, len(drives), sharex="col", sharey="row", height_ratios=heights, squeeze=False).T
        for drive, (force, touching, way, angles) in zip(drives, columns, strict=True):
            draw_force(force, drive, length_unit)
            _draw_touching(touching, drive, names)
            _draw_series(way, drive.ways, drive.moved, ("x", "y", "z"))
            _draw_series(angles, drive.ways, drive.angles_deg, ("yaw", "pitch", "roll"))
            for panel in (force, touching, way, angles):
                _draw_marks(panel, drive)
            angles.set_xlabel(drive.label)
            angles.set_xlim(-0.01 * drive.whole, 1.01 * drive.whole)
            if len(run.phases) > 1:
                force.set_title(f"{drive.phase.name}: {drive.phase.verdict}")
        first, last = columns[0], columns[-1]
        least = float(from_metres(LEAST_LENGTH_OF_SIZE * run.scene.size_m, length_unit))
        _set_limits(first[2], [drive.moved for drive in drives], least)
        _set_limits(first[3], [drive.angles_deg for drive in drives], LEAST_ANGLE_DEG)
        set_force_limits(first[0], drives)
        first[0].set_ylabel(_force_label(drives, run.scene, length_unit))
        for panel, text in zip(first[1:], ("touching", f"CoG moved [{length_unit}]", "angle [deg]"), strict=True):
            panel.set_ylabel(text)
        for panel in last[2:]:
            panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=2.6)
        figure.align_ylabels(list(first))
        figure.suptitle(f"{run.scene.name}: {ending(run)}", fontsize=11)
        _draw_legend(figure, drives)
    return figure


def _force_label(drives: Sequence[DriveCurves], scene: Scene, unit: LengthUnit) -> str:
    units = {"N" if force_unit(scene, drive.load) == "N" else "load" for drive in drives}
    one = units.pop() if len(units) == 1 else "N or load"
    turns = {leg.is_turn for drive in drives for legs in drive.load.drive.values() for leg in legs}
    if turns == {True}:
        return with_unit("drive moment", f"{one} {unit}")
    return with_unit("drive force", one) + (f", moment [{one} {unit}]" if True in turns else "")


def draw_force(panel: Axes, drive: DriveCurves, unit: LengthUnit) -> None:
    """Draw the force of a drive over its way, with the greatest one and the limit at which it would stop."""
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    panel.fill_between(drive.ways, 0.0, drive.forces, color=PALE, linewidth=0.0)
    panel.plot(drive.ways, drive.forces, color=BLACK, linewidth=1.6)
    panel.grid(axis="y", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)
    found = drive.drive
    most, at = (
        shown_along(found.greatest_along, drive.load, found.greatest_share, unit),
        found.greatest_share * drive.whole,
    )
    if most > LEAST_FORCE:
        panel.plot([at], [most], "o", color=VERMILLION, markersize=5.0, clip_on=False, zorder=3.0)
        is_left = at < 0.6 * drive.whole
        offset, side = (6, "left") if is_left else (-6, "right")
        panel.annotate(
            f"{most:.4g}", (at, most), (offset, 4), textcoords="offset points", ha=side, va="bottom", color=VERMILLION
        )
    if drive.load.stop_at is not None:
        limit = shown_along(drive.load.stop_at, drive.load, found.share, unit)
        panel.axhline(limit, color=VERMILLION, linestyle=(0, (5, 3)), linewidth=1.0)
        panel.annotate("stop_at", (0.0, limit), (2, 2), textcoords="offset points", fontsize=8.0, color=VERMILLION)


def set_force_limits(panel: Axes, drives: Sequence[DriveCurves]) -> None:
    """Zero is always shown; where no drive needs a force the panel spans one unit."""
    forces = np.concatenate([drive.forces for drive in drives])
    low, high = float(np.nanmin(forces, initial=0.0)), float(np.nanmax(forces, initial=0.0))
    span = high - low if high - low > LEAST_FORCE else 1.0
    panel.set_ylim(low - 0.06 * span, low + 1.18 * span)


def _draw_touching(panel: Axes, drive: DriveCurves, names: Sequence[str]) -> None:
    rows = {name: row for row, name in enumerate(names)}
    for name, first, last in drive.stays:
        if name in rows:
            look = TOUCHING[name in drive.driven]
            panel.broken_barh([(first, last - first)], (rows[name] - 0.32, 0.64), alpha=0.75, linewidth=0.0, **look)
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(max(len(names), 1) - 0.4, -0.6)
    panel.tick_params(axis="y", length=0.0)


def _draw_series(panel: Axes, ways: FloatArray, values: FloatArray, names: Sequence[str]) -> None:
    for column, (name, look) in enumerate(zip(names, SERIES, strict=True)):
        panel.plot(ways, values[:, column], label=name, markevery=max(len(ways) // 20, 1), **look)
    panel.grid(axis="y", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)


def _set_limits(panel: Axes, values: Sequence[FloatArray], least_span: float) -> None:
    every = np.concatenate(values)
    low, high = float(every.min()), float(every.max())
    pad = 0.06 * (high - low) if high - low > least_span else least_span
    panel.set_ylim(low - pad, high + pad)


def _draw_marks(panel: Axes, drive: DriveCurves) -> None:
    """Where it snaps, and from where on the drive did not get."""
    for place in drive.snaps:
        panel.axvline(place, **SNAP)
    reached = drive.drive.share * drive.whole
    if drive.drive.share < 1.0:
        panel.axvline(reached, color=VERMILLION, linestyle=(0, (5, 3)), linewidth=1.3)
        panel.axvspan(reached, 1.01 * drive.whole, facecolor=PALE, alpha=0.35, linewidth=0.0, zorder=0.0)


def _draw_legend(figure: Figure, drives: Sequence[DriveCurves]) -> None:
    handles: list[Line2D | Patch] = [
        Patch(label="contact with a driven body", alpha=0.75, linewidth=0.0, **TOUCHING[True]),
        Patch(label="contact with the fixed cage", alpha=0.75, linewidth=0.0, **TOUCHING[False]),
    ]
    if any(drive.snaps for drive in drives):
        handles.append(Line2D([], [], label="snaps", **SNAP))
    stopped = [drive.phase.verdict for drive in drives if drive.drive.share < 1.0]
    if stopped:
        label = " and ".join(dict.fromkeys(stopped))
        handles.append(Line2D([], [], color=VERMILLION, linestyle=(0, (5, 3)), linewidth=1.3, label=label))
    figure.legend(handles=handles, loc="outside lower center", ncols=2, handlelength=2.6)
