"""Play as a picture: bars for each freedom, and how far points go, seen along the cage's axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import ArrayLike

from cagepose.files.units import LengthUnit, from_metres
from cagepose.studies.play_outline import PointOutline, point_outlines
from cagepose.studies.play_result import Play, PlayEnd, PlayRange
from cagepose.views.style import BLUE, GREY, ORANGE, PAGE_WIDTH_IN, PALE, VERMILLION, Look, styled

BARS: dict[str, Look] = {
    "certified": {"facecolor": PALE, "edgecolor": GREY, "hatch": "////", "linewidth": 0.8},
    "exact": {"facecolor": BLUE, "edgecolor": BLUE, "linewidth": 0.8},
    "linear": {"facecolor": ORANGE, "edgecolor": ORANGE, "linewidth": 0.8},
}
"""Drawn over each other in this order, each slimmer than the one before."""
HEIGHTS = {"certified": 0.78, "exact": 0.5, "linear": 0.16}
LINES: dict[str, Look] = {
    "certified": {"color": GREY, "linestyle": (0, (4, 2)), "linewidth": 1.0},
    "linear": {"color": ORANGE, "linestyle": "-", "linewidth": 1.2},
}
ARROW: dict[str, Any] = {"arrowstyle": "-|>", "color": VERMILLION, "linewidth": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
ARROW_FROM, ARROW_TO = 0.78, 0.97
"""Shares of the way to the edge of a picture. Arrows between them point along which a point has no end."""
PERHAPS_FARTHER = "?: perhaps farther"
WORDS = {"certified": "certified: cannot be passed", "exact": "exact", "linear": "linear"}


def play_figure(play: Play, at: Sequence[ArrayLike] = (), length_unit: LengthUnit = "mm") -> Figure:
    """Draw the range of each freedom, and for each point ``at`` of the object (metres, in its frame) how far it goes.

    A bar that ends in an arrow has no end, and of one with a question mark none was found; so has the way of a point,
    which is seen along the three axes of the cage.
    """
    with styled():
        rows = 1 + len(at)
        figure = Figure(figsize=(PAGE_WIDTH_IN, 2.35 + 2.5 * len(at) + 0.75), layout="constrained")
        parts = figure.subfigures(rows, 1, height_ratios=[2.35] + [2.5] * len(at), squeeze=False)[:, 0]
        lengths, angles = parts[0].subplots(1, 2)
        known = [kind for kind in BARS if _is_known(play, kind)]
        _draw_bars(lengths, play, known, ("x", "y", "z"), float(from_metres(1.0, length_unit)))
        lengths.set_xlabel(f"displacement of the object's origin [{length_unit}]")
        _draw_bars(angles, play, known, ("roll", "pitch", "yaw"), math.degrees(1.0))
        angles.set_xlabel("ZYX angle [deg]")
        for part, point in zip(parts[1:], at, strict=True):
            place = ", ".join(f"{value:.6g}" for value in from_metres(np.asarray(point, dtype=float), length_unit))
            part.suptitle(f"the point ({place}) {length_unit} of the object, from where it starts", fontsize=9.5)
            for panel, outline in zip(part.subplots(1, 3), point_outlines(play.scene, point), strict=True):
                _draw_outline(panel, outline, length_unit)
        title = f"{play.scene.name}: play from the start pose ({play.verdict})"
        figure.suptitle(title, fontsize=11)
        handles = [Patch(label=WORDS[kind], **BARS[kind]) for kind in known]
        lines = [Line2D([], [], label=f"{kind}, of a point", **look) for kind, look in LINES.items()]
        figure.legend(handles=[*handles, *(lines if at else [])], loc="outside lower center", ncols=5, handlelength=2.0)
    return figure


def _draw_bars(panel: Axes, play: Play, known: Sequence[str], names: tuple[str, ...], unit: float) -> None:
    largest = max((abs(value) for name in names for value in _all_ends(play.freedoms[name])), default=0.0)
    reach = 1.12 * unit * (largest or 1.0)
    for row, name in enumerate(names):
        ends = play.freedoms[name]
        for kind in known:
            low, high = (_end(end, kind) for end in (ends.low, ends.high))
            if kind == "certified" and (low is None or high is None):
                continue
            left = -reach if low is None else unit * low
            right = reach if high is None else unit * high
            panel.barh(row, right - left, left=left, height=HEIGHTS[kind], **BARS[kind])
        for end, tip, marker in ((ends.low, -reach, "<"), (ends.high, reach, ">")):
            if end.is_open:
                panel.plot([tip], [row], marker=marker, color=VERMILLION, markersize=7.0, clip_on=False, zorder=5)
            elif end.exact is None and end.reached is not None:
                _draw_doubt(panel, unit * end.reached, row, "left" if tip > 0.0 else "right")
                panel.set_title(PERHAPS_FARTHER, fontsize=8.0, color=VERMILLION, pad=3.0)
    panel.axvline(0.0, color=GREY, linewidth=0.8)
    panel.set_xlim(-reach, reach)
    panel.set_yticks(range(len(names)), names)
    panel.invert_yaxis()
    panel.grid(axis="x", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)
    panel.locator_params(axis="x", nbins=6)


def _draw_doubt(panel: Axes, x: float, y: float, side: Literal["left", "center", "right"] = "center") -> None:
    panel.text(x, y, "?", color=VERMILLION, fontsize=9.0, fontweight="bold", ha=side, va="center", zorder=5)


def _is_known(play: Play, kind: str) -> bool:
    """Whether bars of this kind say something: of most shapes nothing is known to first order, and no bound."""
    ends = [end for one in play.freedoms.values() for end in (one.low, one.high)]
    is_open = kind != "certified" and all(end.is_open for end in ends)
    return is_open or any(_end(end, kind) is not None for end in ends)


def _end(end: PlayEnd, kind: str) -> float | None:
    """Return where a bar ends; None: nowhere."""
    value: float | None = end.reached if kind == "exact" else getattr(end, kind)
    return value


def _all_ends(ends: PlayRange) -> list[float]:
    values = [_end(end, kind) for end in (ends.low, ends.high) for kind in BARS]
    return [value for value in values if value is not None]


def _draw_outline(panel: Axes, outline: PointOutline, length_unit: LengthUnit) -> None:
    panel.fill(*from_metres(outline.exact, length_unit).T, facecolor=BLUE, edgecolor=BLUE, alpha=0.45, linewidth=1.2)
    for kind, look in LINES.items():
        if (polygon := getattr(outline, kind)) is not None:
            shown = from_metres(polygon, length_unit)
            panel.plot(*np.concatenate([shown, shown[:1]]).T, **look)
    panel.plot([0.0], [0.0], marker="+", color=GREY, markersize=6.0)
    told = []
    if outline.shown_m is not None:
        reach = float(from_metres(outline.shown_m, length_unit))
        panel.set_xlim(-reach, reach)
        panel.set_ylim(-reach, reach)
        for way in reach * outline.no_end:
            panel.annotate("", ARROW_TO * way, ARROW_FROM * way, arrowprops=ARROW)
        told.append("unlimited along the arrows" if len(outline.no_end) else "unlimited in some directions")
    if len(outline.not_converged):
        for x, y in from_metres(outline.not_converged, length_unit):
            _draw_doubt(panel, x, y)
        told.append(PERHAPS_FARTHER)
    panel.set_title("; ".join(told), fontsize=8.0, color=VERMILLION, pad=3.0)
    panel.set_xlabel(f"{outline.axes[0]} [{length_unit}]")
    panel.set_ylabel(f"{outline.axes[1]} [{length_unit}]", labelpad=1.0)
    panel.grid(color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)
