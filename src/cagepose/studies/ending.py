"""How a run ended, in words, and which kind of end that is."""

from __future__ import annotations

from typing import Literal

from cagepose.runs.run import AT_REST, FAILURES, Run

Kind = Literal["rest", "open", "failure", "elsewhere"]
"""What gives an end its colour, on the terminal, on pages and in pictures alike."""


def ending(run: Run) -> str:
    """Return the verdict; a rest that the least disturbance undoes is named so."""
    stability = run.phases[-1].proof.stability
    return f"{run.verdict}, unstable" if stability == "unstable" else run.verdict


def run_kind(run: Run) -> Kind:
    """Return `verdict_kind` of a run, which is "elsewhere" where the mechanics contradicts a rest."""
    return "elsewhere" if run.is_contradicted else verdict_kind(run.verdict)


def verdict_kind(verdict: str) -> Kind:
    """Return "rest" where it rests, "open" where it may rest, and "failure" or "elsewhere" where it does not."""
    if verdict == "may rest":
        return "open"
    if verdict in AT_REST:
        return "rest"
    return "failure" if verdict in FAILURES else "elsewhere"
