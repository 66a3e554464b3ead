"""How a run ended, in words, and which kind of end that is."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.wording import components
from cagepose.runs.run import AT_REST, FAILURES, PhaseRun, Run

TURN_TOLD_RAD = math.radians(30.0)
"""A part that turns farther in a phase no longer lies as its scene was drawn: that is told."""
ALONG_AN_AXIS = 0.9995
"""Cosine: an axis within two degrees of x, y or z is called so."""
ACROSS_GRAVITY = 0.5
"""Cosine: what turns about an axis farther than 60 degrees from gravity tips or rolls."""

Kind = Literal["rest", "open", "failure", "elsewhere"]
"""What gives an end its colour, on the terminal, on pages and in pictures alike."""


def ending(run: Run) -> str:
    """Return the verdict; a rest that the least disturbance undoes is named so."""
    stability = run.phases[-1].proof.stability
    return f"{run.verdict}, unstable" if stability == "unstable" else run.verdict


def turned_far(run: Run) -> tuple[str, ...]:
    """Return ``push: 90 deg about y, so it tipped or rolled`` for each phase that turned the object by more than 30 deg
    in all.
    """
    told = ((phase, load, _turn(phase)) for phase, load in zip(run.phases, run.scene.loads, strict=False))
    return tuple(
        f"{phase.name}: {math.degrees(angle):.0f} deg about {_axis(axis)}{_remark(axis, load)}"
        for phase, load, (angle, axis) in told
        if angle > TURN_TOLD_RAD
    )


def _turn(phase: PhaseRun) -> tuple[float, FloatArray]:
    """Return by which angle, and about which axis in the world, (3,), a phase has turned the object."""
    w, *vector = (phase.pose @ phase.start_pose.inverse()).quaternion_wxyz
    axis = math.copysign(1.0, w) * np.array(vector)
    sine = float(np.linalg.norm(axis))
    return 2.0 * math.atan2(sine, abs(w)), axis / (sine or 1.0)


def _axis(axis: FloatArray) -> str:
    names = [name for name, part in zip("xyz", axis.tolist(), strict=True) if part > ALONG_AN_AXIS]
    names += [f"-{name}" for name, part in zip("xyz", axis.tolist(), strict=True) if part < -ALONG_AN_AXIS]
    return names[0] if names else f"({components(axis)})"


def _remark(axis: FloatArray, load: Load) -> str:
    if load.gravity_world is None:
        return ""
    is_across = abs(float(axis @ load.gravity_world)) < ACROSS_GRAVITY * float(np.linalg.norm(load.gravity_world))
    return ", so it tipped or rolled" if is_across else ""


def run_kind(run: Run) -> Kind:
    """Return `phase_kind` of the last phase."""
    return phase_kind(run.phases[-1])


def phase_kind(phase: PhaseRun) -> Kind:
    """Return `verdict_kind` of a phase, which is "elsewhere" where the mechanics contradicts a rest."""
    return "elsewhere" if phase.is_contradicted else verdict_kind(phase.verdict)


def verdict_kind(verdict: str) -> Kind:
    """Return "rest" where it rests, "open" where it may rest, and "failure" or "elsewhere" where it does not."""
    if verdict == "may rest":
        return "open"
    if verdict in AT_REST:
        return "rest"
    return "failure" if verdict in FAILURES else "elsewhere"
