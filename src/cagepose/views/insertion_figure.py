"""An insertion in one picture: force and jam friction over the way, and how far all may be out of place."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from cagepose.files.units import LengthUnit, from_metres, with_unit
from cagepose.runs.load_scaling import force_unit
from cagepose.studies.insertion_result import Insertion
from cagepose.studies.misalignment import ANGLES, LENGTHS, MisalignmentEnd
from cagepose.views.drive_curves import DriveCurves, drive_curves
from cagepose.views.drive_figure import draw_force, set_force_limits
from cagepose.views.style import BLUE, GREY, ORANGE, PAGE_WIDTH_IN, PALE, SKY, VERMILLION, Look, styled

COULD_JAM: Look = {"facecolor": ORANGE, "alpha": 0.35, "hatch": "////", "edgecolor": VERMILLION, "linewidth": 0.6}
PERMITTED: Look = {"color": SKY, "edgecolor": BLUE, "height": 0.55}
MOST_SHOWN = 10.0
"""Up to this coefficient of friction it is asked."""
HEIGHTS_IN = (2.4, 1.7)
"""Of force and of jam friction; each freedom has a row besides."""


def insertion_figure(insertion: Insertion, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the force of an insertion's drive over its way, with where it could jam, and the least friction for that,
    above how far the drive may be out of place along each freedom that was asked.

    A bar that ends in an arrow goes on at least so far; what happens beyond an end stands beside it.
    """
    scene, load = insertion.run.scene, insertion.run.scene.loads[insertion.phase]
    names = [[name for name in insertion.misalignment if name in kind] for kind in (LENGTHS, ANGLES)]
    kinds = [(kind, unit) for kind, unit in zip(names, (length_unit, "deg"), strict=True) if kind]
    with styled():
        heights = [*HEIGHTS_IN, *(0.45 + 0.28 * len(kind) for kind, _ in kinds)]
        figure = Figure(figsize=(PAGE_WIDTH_IN, sum(heights) + 1.2), layout="constrained")
        force, friction, *bars = figure.subplots(len(heights), 1, height_ratios=heights)
        if insertion.ended is None or insertion.drive is None:
            for panel in (force, friction):
                panel.text(0.5, 0.5, "the drive did not start", ha="center", transform=panel.transAxes)
                panel.set_axis_off()
        else:
            curves = drive_curves(scene, insertion.ended, load, length_unit)
            draw_force(force, curves, length_unit)
            set_force_limits(force, [curves])
            force.set_ylabel(with_unit("drive force", "N" if force_unit(scene, load) == "N" else "load"))
            _draw_jam(friction, insertion, curves)
            for panel in (force, friction):
                for begins, ends in insertion.drive.jam_possible:
                    panel.axvspan(begins * curves.whole, ends * curves.whole, zorder=0.0, **COULD_JAM)
                panel.set_xlim(-0.01 * curves.whole, 1.01 * curves.whole)
            friction.set_xlabel(curves.label)
            if insertion.drive.jam_possible:
                figure.legend(handles=[Patch(label="could jam", **COULD_JAM)], loc="outside lower center")
        for panel, (kind, unit) in zip(bars, kinds, strict=True):
            _draw_permitted(panel, insertion, kind, unit, length_unit)
        figure.suptitle(f"{scene.name}, {load.name}: {insertion.verdict}", fontsize=11)
    return figure


def _draw_jam(panel: Axes, insertion: Insertion, curves: DriveCurves) -> None:
    """Draw the least friction that lets the object jam; where there is none the line is left out."""
    least = np.where(np.isfinite(insertion.jam_friction), insertion.jam_friction, np.nan)
    panel.plot(curves.ways, least, color=BLUE, marker="o", markersize=2.0)
    panel.axhline(insertion.friction, color=GREY, linestyle=(0, (5, 3)), linewidth=1.0)
    panel.annotate(
        f"friction {insertion.friction:.4g}",
        (0.0, insertion.friction),
        (2, 2),
        textcoords="offset points",
        fontsize=8.0,
    )
    if np.isnan(least).all():
        told = f"no friction up to {MOST_SHOWN:g} makes it jam"
        panel.text(0.5, 0.6, told, ha="center", transform=panel.transAxes, color=GREY)
        panel.set_ylim(0.0, max(1.0, 1.3 * insertion.friction))
    else:
        panel.set_ylim(0.0, 1.15 * max(float(np.nanmax(least)), insertion.friction, 0.1))
    panel.set_ylabel("least friction\nto jam")
    panel.grid(axis="y", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)


def _draw_permitted(
    panel: Axes, insertion: Insertion, names: Sequence[str], unit: str, length_unit: LengthUnit
) -> None:
    """Draw a bar for each freedom of one unit."""
    scale = math.degrees(1.0) if unit == "deg" else float(from_metres(1.0, length_unit))
    ends = [(insertion.misalignment[name].low, insertion.misalignment[name].high) for name in names]
    reach = scale * max(abs(end.permitted or 0.0) for pair in ends for end in pair) or 1.0
    for row, pair in enumerate(ends):
        low, high = (scale * (end.permitted or 0.0) for end in pair)
        panel.barh(row, high - low, left=low, **PERMITTED)
        for end, tip, sign in ((pair[0], low, -1.0), (pair[1], high, 1.0)):
            _draw_end(panel, end, row, tip, sign)
    panel.axvline(0.0, color=GREY, linewidth=0.8)
    panel.set_xlim(-1.75 * reach, 1.75 * reach)
    panel.set_ylim(len(names) - 0.5, -0.5)
    panel.set_yticks(range(len(names)), names)
    panel.set_xlabel(f"permitted misalignment [{unit}]")
    panel.grid(axis="x", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)


def _draw_end(panel: Axes, end: MisalignmentEnd, row: int, tip: float, sign: float) -> None:
    if end.fails_at is None:
        marker = ">" if sign > 0.0 else "<"
        panel.plot([tip], [row], marker=marker, color=BLUE, markersize=7.0, clip_on=False, zorder=5)
        return
    panel.annotate(
        f"{end.verdict} (a run that failed)" if end.is_failure else str(end.verdict),
        (tip, row),
        (5.0 * sign, 0),
        textcoords="offset points",
        ha="left" if sign > 0.0 else "right",
        va="center",
        fontsize=8.0,
        color=VERMILLION,
    )
