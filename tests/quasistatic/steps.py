"""Quasistatic runs with steps of another length."""

from __future__ import annotations

from cagepose import Run, Scene
from cagepose.runs.methods import REGISTRY
from cagepose.runs.quasistatic import TURN_STEP_RAD
from cagepose.runs.solve import run_with


def run_with_steps(scene: Scene, turn_step_rad: float = TURN_STEP_RAD) -> Run:
    """Run a scene with steps that turn by ``turn_step_rad`` at most."""
    method = REGISTRY["quasistatic"]
    return run_with(scene, method, method.rules(scene)._replace(turn_step_rad=turn_step_rad))
