"""How a run ended, in words."""

from __future__ import annotations

from cagepose.runs.run import Run


def ending(run: Run) -> str:
    """Return the verdict; a rest that the least disturbance undoes is named so."""
    stability = run.phases[-1].proof.stability
    return f"{run.verdict}, unstable" if stability == "unstable" else run.verdict
