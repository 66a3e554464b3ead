"""The end of a phase that a question is about: `phase_asked`, `not_in_contact`."""

from __future__ import annotations

from cagepose.model.checks import expect, expect_choice
from cagepose.model.scene import Scene
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.run import AT_REST, STOPPED, Run


def phase_asked(run: Run, phase: str | None) -> int:
    """Return the number of a phase, from 0; None: the last that was run.

    Raises
    ------
    SceneError
        The run has no such phase.
    """
    expect(run, Run, "run")
    names = [ended.name for ended in run.phases]
    if phase is None:
        return len(names) - 1
    expect_choice(phase, names, "phase")
    return names.index(phase)


def moved_before(scene: Scene, phase: int) -> Unanswered | None:
    """Return why a question about the cage as it stands in the scene has no answer in a phase; None: it may have."""
    for load in scene.loads[:phase]:
        if load.drive or load.press:
            return Unanswered(
                f"{load.name} has moved bodies of the cage before, and the search knows the cage of the scene alone"
            )
    return None


def not_in_contact(run: Run, phase: int) -> Unanswered | None:
    """Return why a question about contact forces at the end of a phase has no answer; None: it may have one."""
    ended = run.phases[phase]
    if ended.verdict not in AT_REST | STOPPED:
        return Unanswered(f"nothing is at rest at the end of {ended.name}: it ends as {ended.verdict!r}")
    if not ended.contacts:
        return Unanswered(f"nothing touches the object at the end of {ended.name}")
    return None
