"""A run as curves: the object's angles and the way of its centre of gravity against the step, and who touched when.

A step is one frame of `Run.frames`: ten for each turn or screw and one for each travel, as in the paper's figures; ten
for each event in which a drive goes on, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.runs.changes import mode_of
from cagepose.runs.run import Event, Frame, Run
from cagepose.studies.ending import ending
from cagepose.views.style import BLACK, GREEN, GREY, PAGE_WIDTH_IN, PALE, PURPLE, SERIES, VERMILLION, Look, styled
from cagepose.views.tolerances import LEAST_ANGLE_DEG, LEAST_LENGTH_OF_SIZE

STEPS_PER_TURN = 10
"""As in the paper's figures."""
BANDS: Mapping[str, Look] = {
    "Slp-1": {"facecolor": PURPLE, "hatch": "////"},
    "Slp-2": {"facecolor": GREEN, "hatch": "...."},
}
"""The slides that the paper shades, by rule; all other rules get no band."""
MOST_POINTS = 40
"""Points in the lowest panel; a run with more of them that touch shows those that touched first."""
LABEL_WIDTH_IN = 0.15
"""Rules are named above the picture, unless two names would be nearer than this."""


@dataclass(frozen=True, eq=False)
class _Steps:
    """The frames of a run as arrays: angles in degrees (n, 3), the CoG's way from the start in metres (n, 3)."""

    angles_deg: FloatArray
    way_m: FloatArray
    spans: list[tuple[int, int, int, Event]]  # phase index, first and last step, event


def pose_figure(run: Run, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the object's pose against the step, as the paper's Figs. 11 and 13 do.

    Dashed lines stand at the end of each phase, bands where the object slides by Slp-1 or Slp-2. A dot in the lowest
    panel is a contact after an event; a full one was reached by that event's motion.
    """
    steps = _steps(run)
    names = _touched(steps)
    with styled():
        contacts_in = 0.55 + 0.155 * max(len(names), 1)
        heights = [2.3, 1.5, contacts_in]
        figure = Figure(figsize=(PAGE_WIDTH_IN, sum(heights) + 1.45), layout="constrained")
        angles, way, contacts = figure.subplots(3, sharex=True, height_ratios=heights)
        _draw_series(angles, steps.angles_deg, ("yaw", "pitch", "roll"), LEAST_ANGLE_DEG)
        angles.set_ylabel("ZYX Euler angle [deg]")
        least = float(from_metres(LEAST_LENGTH_OF_SIZE * run.scene.size_m, length_unit))
        _draw_series(way, from_metres(steps.way_m, length_unit), ("x", "y", "z"), least)
        way.set_ylabel(f"way of the CoG [{length_unit}]")
        _draw_contacts(contacts, steps, names)
        for panel in (angles, way, contacts):
            _draw_phases(panel, run, steps)
        _name_rules(angles, steps)
        many = "turn, screw or drive" if any(phase.drive for phase in run.phases) else "turn or screw"
        contacts.set_xlabel(f"step ({STEPS_PER_TURN} for each {many}, 1 for each travel)")
        contacts.set_xlim(-0.5, max(len(steps.angles_deg) - 0.5, 1.0))
        contacts.xaxis.set_major_locator(MaxNLocator(integer=True))
        figure.suptitle(f"{run.scene.name}: {ending(run)} ({run.method})", fontsize=11)
        _draw_legend(figure, run, steps)
    return figure


def _steps(run: Run) -> _Steps:
    frames = list(run.frames(STEPS_PER_TURN))
    angles = np.degrees(np.unwrap([frame.pose_world_object.euler_zyx for frame in frames], axis=0))
    center = run.scene.object.center_of_gravity_m
    places = np.array([frame.pose_world_object.transform(center) for frame in frames])
    return _Steps(angles, places - places[0], list(_spans(run, frames)))


def _spans(run: Run, frames: Sequence[Frame]) -> Iterator[tuple[int, int, int, Event]]:
    """Yield phase index, first and last step of each event; one without frames counts where none has led."""
    last_steps = {(frame.phase_index, frame.event_index): step for step, frame in enumerate(frames)}
    step = 0
    marked = -1
    for phase_index, phase in enumerate(run.phases):
        for event_index, event in enumerate(phase.events):
            first = step
            step = last_steps.get((phase_index, event_index), step)
            if step > marked:
                yield phase_index, first, step, event
                marked = step


def _touched(steps: _Steps) -> list[str]:
    names = dict.fromkeys(name for *_, event in steps.spans for name in (*event.hit, *event.contacts))
    return list(names)[:MOST_POINTS]


def _draw_series(panel: Axes, values: FloatArray, names: tuple[str, ...], least_span: float) -> None:
    steps = np.arange(len(values))
    many = len(values) > 150
    for column, (name, look) in enumerate(zip(names, SERIES, strict=True)):
        panel.plot(steps, values[:, column], label=name, markevery=max(len(values) // 60, 1), **look)
        if many:
            panel.lines[-1].set_marker("none")
    low, high = float(values.min()), float(values.max())
    pad = 0.06 * max(high - low, least_span)
    panel.set_ylim(low - pad, max(high, low + least_span) + pad)
    panel.grid(axis="y", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=2.6)


def _draw_contacts(panel: Axes, steps: _Steps, names: list[str]) -> None:
    dots: dict[bool, list[tuple[int, int]]] = {False: [], True: []}  # by whether the motion reached the point
    stays: list[list[tuple[int, int]]] = []
    for row, name in enumerate(names):
        ends = [(last, name in event.contacts, name in event.hit) for _, _, last, event in steps.spans]
        stays += [
            [(start, row), (end, row)] for (start, before, _), (end, after, _) in pairwise(ends) if before and after
        ]
        for step, touches, is_hit in ends:
            if touches:
                dots[is_hit].append((step, row))
    panel.add_collection(LineCollection(stays, colors=BLACK, linewidths=2.2, capstyle="butt"))
    for is_hit, places in dots.items():
        xs, ys = np.array(places).reshape(-1, 2).T
        face = BLACK if is_hit else "white"
        panel.plot(xs, ys, "o", color=BLACK, markersize=5.0, markerfacecolor=face, zorder=3.0)
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(max(len(names), 1) - 0.4, -0.6)
    panel.set_ylabel("contacts")
    panel.grid(axis="y", color=PALE, linewidth=0.6)
    panel.set_axisbelow(True)


def _draw_phases(panel: Axes, run: Run, steps: _Steps) -> None:
    for _, first, last, event in steps.spans:
        if event.rule in BANDS:
            panel.axvspan(first, last, alpha=0.28, edgecolor=GREY, linewidth=0.0, zorder=0.0, **BANDS[event.rule])
    for step in _phase_ends(run, steps):
        panel.axvline(step, color=VERMILLION, linestyle=(0, (5, 3)), linewidth=1.3)


def _phase_ends(run: Run, steps: _Steps) -> Iterator[int]:
    """Yield the last step of each phase but the last."""
    last_steps = {phase_index: last for phase_index, _, last, _ in steps.spans}
    step = 0
    for phase_index in range(len(run.phases) - 1):
        step = last_steps.get(phase_index, step)
        yield step


def _name_rules(panel: Axes, steps: _Steps) -> None:
    """Write each event's rule above the picture, as far as there is room."""
    n_steps = len(steps.angles_deg)
    room = LABEL_WIDTH_IN / (PAGE_WIDTH_IN - 1.6) * n_steps
    last_place = -math.inf
    for _, first, last, event in steps.spans:
        place = (first + last) / 2.0
        if place - last_place >= room:
            panel.annotate(
                mode_of(event.rule),
                (place, 1.02),
                xycoords=("data", "axes fraction"),
                rotation=90.0,
                ha="center",
                va="bottom",
                fontsize=8.0,
            )
            last_place = place


def _draw_legend(figure: Figure, run: Run, steps: _Steps) -> None:
    rules = {event.rule for *_, event in steps.spans}
    handles: list[Line2D | Patch] = [
        Patch(label=f"{rule}, sliding", alpha=0.4, edgecolor=GREY, **BANDS[rule]) for rule in BANDS if rule in rules
    ]
    if len(run.phases) > 1:
        ends = " and ".join(phase.name for phase in run.phases[:-1])
        handles.append(Line2D([], [], color=VERMILLION, linestyle=(0, (5, 3)), label=f"end of phase {ends}"))
    dot: Look = {"color": BLACK, "marker": "o", "linestyle": "none", "markersize": 5.0}
    handles.append(Line2D([], [], label="new contact", **dot))
    handles.append(Line2D([], [], label="old contact", markerfacecolor="white", **dot))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, handlelength=2.6)
