"""How much friction a rest needs: `with_critical_friction`."""

from __future__ import annotations

from dataclasses import replace

from cagepose.runs.judge import Judge
from cagepose.runs.run import AT_REST, Run


def with_critical_friction(run: Run) -> Run:
    """Return the run with the least coefficient of friction at which each held pose is a balance (5.17).

    It stands in each phase's ``proof.critical_friction``: 0 if the contacts hold without friction, infinite if no
    friction is enough; None for a phase that did not end held.
    """
    judge = Judge(run.scene, 0.0)
    phases = tuple(
        replace(phase, proof=judge.with_critical_friction(phase.proof, phase.pose, number))
        if phase.verdict in AT_REST
        else phase
        for number, phase in enumerate(run.phases)
    )
    return replace(run, phases=phases)
