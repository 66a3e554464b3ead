"""How hard bodies must press, and may: `press_limits`."""

from __future__ import annotations

import math

from cagepose.kernels.boundary.geometry import empty_cage
from cagepose.kernels.outcome import at_pose
from cagepose.kernels.stability.proof import empty_proof_workspace
from cagepose.model.checks import expect
from cagepose.runs.actions import body_numbers, load_size
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.drives import displaced_after, pressing_forces
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, Run
from cagepose.studies.tolerances import GREATEST_FORCE

SAME_FORCE = 1e-12
"""Of all that acts: two limits that are nearer to each other are one."""


def press_limits(run: Run, phase: int = -1) -> dict[str, tuple[float, float]]:
    """Say between which forces each body may press at the end of a phase, with all else as it is: from the least with
    which the contacts still balance everything, on to the greatest; newtons.

    The least is the grip that is needed. The greatest is infinite where pressing harder never frees the object. That
    forces balance it does not say that it must stay: see `Proof`. Empty where nothing presses, or the phase did not end
    at rest.

    Parameters
    ----------
    run
        Made or loaded.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    IndexError
        The run has no such phase.
    """
    expect(run, Run, "run")
    number = range(len(run.phases))[phase]
    if run.phases[number].verdict not in AT_REST:
        return {}
    asked = _Asked(run, number)
    return {name: asked.limits(name) for name in asked.forces} if asked.is_balanced() else {}


class _Asked:
    """Whether the end of a phase is balanced, with one body pressing harder or less."""

    def __init__(self, run: Run, phase: int) -> None:
        scene = run.scene
        displaced, friction = displaced_after(run, phase), chosen_method(scene, run.method).friction(scene)
        self.phase, self.part, self.cage = phase, part_of(scene), empty_cage(scene.geometry)
        self.cases = cases_of(scene, friction, run.phases[phase].pose, displaced)
        self.at, self.forces = empty_proof_workspace(scene.geometry), pressing_forces(scene, phase, displaced)
        forces = sum(map(abs, self.forces.values()))
        self.size = load_size(scene, phase, run.phases[phase].pose, displaced) + forces or 1.0
        self.rows = body_numbers(scene)

    def is_balanced(self) -> bool:
        """Whether it is, with all that presses as hard as it does."""
        return at_pose.is_balanced_at_start(self.phase, self.part, self.cases, self.cage, self.at)

    def holds(self, name: str, force_n: float) -> bool:
        press = self.cases.drives.presses[self.phase][self.rows[name]]
        kept = float(press.force)
        press.force = kept + force_n - self.forces[name]  # of a spring it is that at the start
        held = self.is_balanced()
        press.force = kept
        return held

    def limits(self, name: str) -> tuple[float, float]:
        """Return the least and the greatest force; those that are balanced are all between two."""
        own = self.forces[name]
        least, most = min(0.0, own), own + GREATEST_FORCE * self.size
        return (
            least if self.holds(name, least) else self._between(name, least, own),
            math.inf if self.holds(name, most) else self._between(name, most, own),
        )

    def _between(self, name: str, out: float, within: float) -> float:
        """Return the last force that is balanced on the way to one that is not; its digits are halved."""
        while abs(within - out) > SAME_FORCE * self.size:
            middle = 0.5 * (out + within)
            if self.holds(name, middle):
                within = middle
            else:
                out = middle
        return within
