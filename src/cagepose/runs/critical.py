"""How much friction a rest needs: `with_critical_friction`."""

from __future__ import annotations

from dataclasses import replace

from cagepose.model.checks import expect
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import critical_friction_at
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, STOPPED, PhaseRun, Run


def with_critical_friction(run: Run) -> Run:
    """Return the run with the least coefficient of friction at which each held pose is a balance (5.17).

    It stands in each phase's ``proof.critical_friction``: 0 if the contacts hold without friction, infinite if no
    friction is enough; None for a phase that did not end held. Bodies of the cage stand where they were driven to.
    """
    expect(run, Run, "run")
    friction = chosen_method(run.scene, run.method).friction(run.scene)
    phases = list[PhaseRun]()
    for number, phase in enumerate(run.phases):
        least = None
        if phase.verdict in AT_REST | STOPPED:
            displaced = displaced_after(run, number)
            least = critical_friction_at(run.scene, phase.pose, number, friction, displaced)
        phases.append(replace(phase, proof=replace(phase.proof, critical_friction=least)))
    return replace(run, phases=tuple(phases))
