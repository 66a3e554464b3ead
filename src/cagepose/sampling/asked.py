"""Answers to questions about each run of a study as its columns: `AskedColumns`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from cagepose.files.schema_study import Question
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.planar import held_freedoms
from cagepose.model.scene import Scene
from cagepose.questions.friction import friction_limits
from cagepose.questions.jam import jam
from cagepose.questions.no_motion import WITHIN
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import Run
from cagepose.studies.margin import margin
from cagepose.studies.play import play
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS
from cagepose.studies.play_result import PlayEnd

SAME_JAM, SAME_SHARE, SAME_ANGLE_DEG = 1e-5, 1e-6, 1e-6
"""Coefficients from which on a part jams, forces or moments as parts of one newton or load, and ends of angles in
degrees: what differs by less is the same."""


class AskedColumn(NamedTuple):
    """The name of a column, its unit (empty: none), and what differs by less than ``same`` is the same."""

    name: str
    unit: str
    same: float


class AskedColumns:
    """What a study asks of each of its runs.

    Parameters
    ----------
    questions
        By their names.
    scene, length_unit
        The nominal scene, and its file's unit.

    Attributes
    ----------
    columns
        In the order of the questions.
    """

    def __init__(self, questions: Iterable[Question], scene: Scene, length_unit: LengthUnit) -> None:
        self._questions, self._unit = tuple(questions), length_unit
        self.columns = tuple(column for name in self._questions for column in _columns(name, scene, length_unit))

    def __len__(self) -> int:
        return len(self.columns)

    def answers(self, run: Run) -> FloatArray:
        """Return the answers to all questions, (n_columns,), in the scene file's unit and degrees: those of
        `friction_limits`, `margin`, `jam` and `play`. NaN: the question has no answer for this run.
        """
        return np.array([number for name in self._questions for number in _ANSWERS[name](run, self._unit)])


def _columns(question: Question, scene: Scene, unit: LengthUnit) -> list[AskedColumn]:
    length = float(from_metres(scene.touch_m, unit))
    if question == "friction":
        return [AskedColumn(f"friction_{kind}", "", WITHIN) for kind in ("balance", "no_motion")]
    if question == "jam":
        return [AskedColumn("jam_friction", "", SAME_JAM)]
    if question == "margin":
        force = force_unit(scene, scene.loads[-1])
        same_moment = SAME_SHARE * float(from_metres(scene.size_m, unit))
        return [
            AskedColumn("margin_force", force, SAME_SHARE),
            AskedColumn("margin_moment", f"{force} {unit}", same_moment),
        ]
    held = held_freedoms(scene.planar)
    return [
        AskedColumn(f"play_{freedom}_{end}", unit, length)
        if place < N_LENGTHS
        else AskedColumn(f"play_{freedom}_deg_{end}", "deg", SAME_ANGLE_DEG)
        for place, freedom in enumerate(FREEDOMS)
        if held[place] == 0.0
        for end in ("low", "high")
    ]


def _friction(run: Run, _: LengthUnit) -> list[float]:
    found = friction_limits(run)
    if isinstance(found, Unanswered):
        return [math.nan, math.nan]
    return [found.balance, found.no_motion[0].shown_from if found.no_motion else math.nan]


def _margin(run: Run, unit: LengthUnit) -> list[float]:
    found = margin(run)
    return [math.nan, math.nan] if found is None else [found.force_n, float(from_metres(found.moment_nm, unit))]


def _jam(run: Run, _: LengthUnit) -> list[float]:
    found = jam(run)
    return [math.nan if isinstance(found, Unanswered) else found.friction]


def _play(run: Run, unit: LengthUnit) -> list[float]:
    """Without the search for a way out, which takes seconds and hangs on how fast the machine is."""
    return [
        float(from_metres(found, unit) if freedom in FREEDOMS[:N_LENGTHS] else np.degrees(found))
        for freedom, one in play(run.scene, search_s=0.0).freedoms.items()
        for found in (_end(one.low, -1.0), _end(one.high, 1.0))
    ]


def _end(end: PlayEnd, sign: float) -> float:
    if end.is_open:
        return sign * math.inf
    return math.nan if end.exact is None else end.exact


_ANSWERS: dict[Question, Callable[[Run, LengthUnit], list[float]]] = {
    "friction": _friction,
    "margin": _margin,
    "jam": _jam,
    "play": _play,
}
