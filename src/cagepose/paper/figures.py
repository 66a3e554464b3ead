"""The pictures of the report: the paper's cases event by event and as curves, and the range of misalignments."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cagepose.paper.cases import CaseRuns, Progress
from cagepose.paper.rail import ANGLES, Angle
from cagepose.paper.range_study import RangeStudy
from cagepose.paper.reproduction import Reproduction
from cagepose.views.event_figure import event_figure
from cagepose.views.pose_figure import pose_figure
from cagepose.views.style import BLACK, BLUE, GREY, PAGE_WIDTH_IN, PALE, SKY, VERMILLION, Look, figure_bytes, styled

ORDER_OF_ANGLES: tuple[Angle, ...] = ("pitch", "yaw", "roll")
"""Order of pictures, rows and columns: the paper's."""
PIN_LOOKS: tuple[Look, ...] = (
    {"color": BLUE, "linestyle": "-", "marker": "o"},
    {"color": VERMILLION, "linestyle": "--", "marker": "s"},
)
HALF_HEIGHT_DEG = 0.9
"""All nine panels reach from minus to plus this: 0.5 deg of misalignment and 0.33 deg of play."""


@dataclass(frozen=True)
class Picture:
    """A figure as the content of two files: for the screen, and for print."""

    png: bytes
    svg: bytes


def _misaligned(angle: Angle) -> Callable[[CaseRuns], Figure]:
    return lambda runs: pose_figure(getattr(runs, angle))


CASE_FIGURES: dict[str, dict[str, Callable[[CaseRuns], Figure]]] = {
    "pictures of the sample": {
        "sample-events": lambda runs: event_figure(runs.sample),
        "sample-pose": lambda runs: pose_figure(runs.sample),
    },
    "pictures of the rail's events": {"rail-events": lambda runs: event_figure(runs.pitch)},
    **{
        f"picture of the rail out of line in {angle}": {f"rail-{angle}": _misaligned(angle)}
        for angle in ORDER_OF_ANGLES
    },
}
"""What begins, then the names of the figures and how they are drawn."""
FIGURES = (*(name for figures in CASE_FIGURES.values() for name in figures), "range")
"""The figures of each method. In the names of files, the method's name stands before them."""


def draw_pictures(reproduction: Reproduction, methods: Sequence[str], progress: Progress) -> dict[str, Picture]:
    """Return all pictures of some of its methods by name, such as "stepwise-rail-events"."""
    pictures = dict[str, Picture]()
    for method in methods:
        runs = reproduction.runs[method]
        for beginning, figures in CASE_FIGURES.items():
            progress(f"{method}: {beginning}")
            pictures |= {f"{method}-{name}": _picture(draw(runs)) for name, draw in figures.items()}
        progress(f"{method}: picture of the range of misalignments")
        pictures[f"{method}-range"] = _picture(range_figure(reproduction.ranges[method]))
    return pictures


def _picture(figure: Figure) -> Picture:
    return Picture(figure_bytes(figure, ".png"), figure_bytes(figure, ".svg"))


def range_figure(studies: Sequence[RangeStudy]) -> Figure:
    """Draw the rail's final yaw, pitch and roll (rows) against the misalignment in each angle (columns).

    The band is the range in which, by the planar theory, the rail can lie at zero; the dotted line is a rail that
    stands as its rollers do.
    """
    with styled():
        figure = Figure(figsize=(PAGE_WIDTH_IN, 6.9), layout="constrained")
        panels = figure.subplots(3, 3, sharex=True, sharey=True)
        for column, varied in enumerate(ORDER_OF_ANGLES):
            chosen = [study for study in studies if study.misaligned == varied]
            for row, shown in enumerate(ORDER_OF_ANGLES):
                panel = panels[row, column]
                _draw(panel, chosen, ANGLES.index(shown), is_varied=shown == varied)
                if row == 0:
                    panel.set_title(f"rollers out of line in {varied}")
                if row == 2:
                    panel.set_xlabel(f"misalignment in {varied} [deg]")
                if column == 0:
                    panel.set_ylabel(f"rail's {shown} [deg]")
        panels[0, 0].set_ylim(-HALF_HEIGHT_DEG, HALF_HEIGHT_DEG)
        panels[0, 0].set_xlim(*np.degrees(studies[0].misalignments_rad[[0, -1]]))
        figure.suptitle(f"Where the rail comes to rest ({studies[0].method})", fontsize=11)
        handles, labels = panels[1, 1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2, handlelength=2.6)
    return figure


def _draw(panel: Axes, studies: Sequence[RangeStudy], angle: int, *, is_varied: bool) -> None:
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    first = studies[0]
    misalignments = np.degrees(first.misalignments_rad)
    if is_varied and first.permitted_rad is not None:
        limit = float(np.degrees(first.permitted_rad))
        panel.axvspan(
            -limit, limit, facecolor=SKY, alpha=0.25, hatch="//", edgecolor=GREY, linewidth=0.0,
            label="theory: zero is within reach",
        )  # fmt: skip
        panel.annotate(
            f"±{limit:.3f} deg", (limit, -0.97 * HALF_HEIGHT_DEG), xytext=(-3.0, 3.0), textcoords="offset points",
            fontsize=8.0, ha="right",
        )  # fmt: skip
    if is_varied:
        panel.plot(misalignments, misalignments, color=BLACK, linestyle=":", linewidth=1.0, label="as the rollers")
    panel.plot(
        misalignments, np.degrees(first.after_weight_rad[:, angle]), color=GREY, linewidth=2.6, alpha=0.6,
        label="after the weight",
    )  # fmt: skip
    for study, look in zip(studies, PIN_LOOKS, strict=False):
        label = f"after the push, pin at y = {study.pin_y_m * 1000.0:+.0f} mm"
        panel.plot(misalignments, np.degrees(study.after_push_rad[:, angle]), markevery=2, label=label, **look)
    panel.grid(color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)
