"""Questions that a live page asks about its run, and their answers in the words of ``cagepose ask``."""

from __future__ import annotations

from typing import Any

from cagepose.files.units import LengthUnit
from cagepose.files.words import LengthWords
from cagepose.runs.run import Run

N_MOTIONS, N_STARTS = 4_000, 60
"""Of searches: fewer than the command tries, as somebody waits."""
QUESTIONS = {
    "friction": "How much friction does it need?",
    "jam": "From which friction on does it jam?",
    "resting": "Where else may it come to rest?",
    "escape": "How much work gets it out?",
}
"""What may be asked of the phase on screen, as buttons say it."""


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
    from cagepose.files.answers import told

    if not isinstance(name, str) or name not in QUESTIONS:
        raise ValueError("that cannot be asked here")
    if not isinstance(phase, int) or not 0 <= phase < len(run.phases):
        raise ValueError("the question is about a phase that was not run")
    lines, table = told(*_answer(name, run, run.phases[phase].name), LengthWords(unit, run.scene.size_m))
    return {"lines": [list(line) for line in lines], "table": table}


def _answer(name: str, run: Run, phase: str) -> tuple[Any, Any]:
    """Return the answer to a question, and the module that tells it. Each loads what it needs: a viewer need not wait
    for what nobody asks.
    """
    if name == "friction":
        from cagepose.files.answers import friction as of_friction
        from cagepose.questions.friction import friction_limits

        return friction_limits(run, phase), of_friction
    if name == "jam":
        from cagepose.files.answers import jam as of_jam
        from cagepose.questions.jam import jam

        return jam(run, phase), of_jam
    if name == "escape":
        from cagepose.files.answers import escape as of_escape
        from cagepose.questions.escape import escape_energy

        return escape_energy(run, phase, n_motions=N_MOTIONS), of_escape

    from cagepose.files.answers import cage_rests as of_cage
    from cagepose.files.answers import resting as of_resting
    from cagepose.questions.cage_rests import cage_rests
    from cagepose.questions.resting import is_on_floor_alone, resting_poses

    if phase == run.scene.loads[0].name and is_on_floor_alone(run.scene):
        return resting_poses(run.scene.object), of_resting
    return cage_rests(run.scene, phase, n_starts=N_STARTS), of_cage
