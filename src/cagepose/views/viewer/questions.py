"""Questions that a live page asks about its run, and their answers in the words of ``cagepose ask``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from cagepose.files.answers import cage_rests as of_cage
from cagepose.files.answers import escape as of_escape
from cagepose.files.answers import friction as of_friction
from cagepose.files.answers import jam as of_jam
from cagepose.files.answers import resting as of_resting
from cagepose.files.answers import told
from cagepose.files.units import LengthUnit
from cagepose.files.words import LengthWords
from cagepose.questions.cage_rests import cage_rests
from cagepose.questions.escape import escape_energy
from cagepose.questions.friction import friction_limits
from cagepose.questions.jam import jam
from cagepose.questions.resting import is_on_floor_alone, resting_poses
from cagepose.runs.run import Run

N_MOTIONS, N_STARTS = 4_000, 60
"""Of searches: fewer than the command tries, as somebody waits."""


@dataclass(frozen=True)
class Question:
    """What may be asked of the phase on screen.

    Attributes
    ----------
    words
        As a button says it.
    ask
        What answers it, of a run and the name of a phase, and how the answer is told.
    """

    words: str
    ask: Callable[[Run, str], tuple[Any, Any]]


def _resting(run: Run, phase: str) -> tuple[Any, Any]:
    if phase == run.scene.loads[0].name and is_on_floor_alone(run.scene):
        return resting_poses(run.scene.object), of_resting
    return cage_rests(run.scene, phase, n_starts=N_STARTS), of_cage


QUESTIONS = {
    "friction": Question(
        "How much friction does it need?", lambda run, phase: (friction_limits(run, phase), of_friction)
    ),
    "jam": Question("From which friction on does it jam?", lambda run, phase: (jam(run, phase), of_jam)),
    "resting": Question("Where else may it come to rest?", _resting),
    "escape": Question(
        "How much work gets it out?",
        lambda run, phase: (escape_energy(run, phase, n_motions=N_MOTIONS), of_escape),
    ),
}


def answered(run: Run, name: object, phase: object, unit: LengthUnit) -> dict[str, Any]:
    """Return the answer to a question about a phase: ``lines`` of a name and a text, and rows of a ``table``, the head
    first.

    Raises
    ------
    ValueError
        There is no such question, or no such phase.
    SceneError
        As the question.
    """
    if not isinstance(name, str) or name not in QUESTIONS:
        raise ValueError("that cannot be asked here")
    if not isinstance(phase, int) or not 0 <= phase < len(run.phases):
        raise ValueError("the question is about a phase that was not run")
    answer, module = QUESTIONS[name].ask(run, run.phases[phase].name)
    lines, table = told(answer, module, LengthWords(unit, run.scene.size_m))
    return {"lines": [list(line) for line in lines], "table": table}
