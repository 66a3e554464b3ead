"""The poses that reach the ends of the play, one picture for each end of each freedom."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from cagepose.files.units import LengthUnit, from_metres
from cagepose.studies.play_result import Play, PlayEnd
from cagepose.views.style import PAGE_WIDTH_IN, styled
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import single_motion
from cagepose.views.viewer.stage import Stage

COLUMNS, PANEL_IN, PICTURE = 2, 2.7, (560, 384)
EXAGGERATED = "where motions are exaggerated, parts can look as if they were inside each other; they are not"


def extreme_figure(play: Play, length_unit: LengthUnit = "mm") -> Figure:
    """Draw the object at both ends of each freedom, as an outline where it starts, with what limits it marked.

    Small motions are drawn larger than they are; each picture says how many times.
    """
    ends = [
        (f"{word} {name}: {_amount(end, bound, name, length_unit)}", end)
        for name, ends in play.freedoms.items()
        for word, bound, end in (("least", "at most ", ends.low), ("greatest", "at least ", ends.high))
    ]
    rows = math.ceil(len(ends) / COLUMNS)
    with styled():
        figure = Figure(figsize=(PAGE_WIDTH_IN, rows * PANEL_IN), layout="constrained")
        figure.suptitle(f"{play.scene.name}: ends of the play", fontsize=11)
        figure.supxlabel(EXAGGERATED, fontsize=8.5)
        for panel, (title, end) in zip(figure.subplots(rows, COLUMNS).flat, ends, strict=True):
            panel.imshow(_picture(play, end, length_unit))
            panel.set_axis_off()
            panel.set_title(title, fontsize=8.5, pad=3.0)
    return figure


def _picture(play: Play, end: PlayEnd, length_unit: LengthUnit) -> np.ndarray:
    """Return the pixels of one end; of one that was not found, those of the start."""
    touching = tuple(clearance.point for clearance in end.clearances)
    pose = end.pose_world_object or play.scene.object.pose_world_object
    film = single_motion(play.scene, pose, touching, length_unit)
    return np.asarray(PictureMaker(Stage(film), size=PICTURE).picture(film.shots[-1]))


def _amount(end: PlayEnd, bound: str, name: str, length_unit: LengthUnit) -> str:
    if end.reached is None:
        return "unlimited"
    word = bound if end.exact is None else ""
    if name in ("x", "y", "z"):
        return f"{word}{float(from_metres(end.reached, length_unit)):.4g} {length_unit}"
    return f"{word}{math.degrees(end.reached):.4g} deg"
