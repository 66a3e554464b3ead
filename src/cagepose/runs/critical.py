"""How much friction a rest needs: `with_critical_friction`."""

from __future__ import annotations

from dataclasses import replace

from cagepose.runs.judge import critical_friction_at
from cagepose.runs.run import AT_REST, PhaseRun, Run


def with_critical_friction(run: Run) -> Run:
    """Return the run with the least coefficient of friction at which each held pose is a balance (5.17).

    It stands in each phase's ``proof.critical_friction``: 0 if the contacts hold without friction, infinite if no
    friction is enough; None for a phase that did not end held.
    """
    phases = list[PhaseRun]()
    for number, phase in enumerate(run.phases):
        least = critical_friction_at(run.scene, phase.pose, number) if phase.verdict in AT_REST else None
        phases.append(replace(phase, proof=replace(phase.proof, critical_friction=least)))
    return replace(run, phases=tuple(phases))
