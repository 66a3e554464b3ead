"""cagepose as an engine, measured three ways that must not be confused.

- ``cagepose-METHOD``: solve and proof, the compiled work of a run: the method's state machine and the proof of each
  phase's end. This is what peers are compared with: their models are built beforehand too.
- ``cagepose-METHOD-solve``: the state machine alone.
- ``cagepose-METHOD-call``: the whole of `cagepose.run` from a scene to a `Run`, named events and contacts included.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable

from bench.rail_case import Answer
from bench.timing import collected, median_s, timed
from cagepose import Scene, run
from cagepose.kernels.proof import empty_proof_room, prove
from cagepose.nouns.pose import Pose
from cagepose.runs.judge import Judge

METHODS = ("stepwise", "quasistatic")
PARTS = ("", "-solve", "-call")
NO_SLIP_FRICTION = {"stepwise": 0.1003, "quasistatic": 0.0}
"""Coefficient of friction of the proof where the scene gives none; tan(0.1 rad) for stepwise."""


def engine_name(method: str, part: str = "") -> str:
    return f"cagepose-{method}{part}"


def measure(scene: Scene, method: str, budget_s: float) -> tuple[dict[str, float], Answer]:
    """Return the median seconds of each of `PARTS`, and the answer."""
    found = run(scene, method)
    whole_s = median_s(lambda: run(scene, method), budget_s / 3.0)
    solve_s = statistics.median(collected(lambda: run(scene, method).solve_s, budget_s / 3.0))
    proof_s = 0.0
    for phase in range(len(found.phases)):
        prove_once = proof_call(scene, method, found.phases[phase].pose, phase)
        prove_once()
        times = collected(lambda call=prove_once: timed(call)[0], budget_s / 6.0)  # type: ignore[misc]
        proof_s += statistics.median(times)
    answer = Answer(tuple(phase.pose.rotation for phase in found.phases))
    return {"": solve_s + proof_s, "-solve": solve_s, "-call": whole_s}, answer


def proof_call(scene: Scene, method: str, pose: Pose, phase: int) -> Callable[[], object]:
    """Return the compiled proof of a pose, ready to be called, as `cagepose.run` calls it."""
    friction = scene.friction_coefficient
    judge = Judge(scene, NO_SLIP_FRICTION[method] if friction is None else friction)
    room = empty_proof_room(judge.geometry)
    inside = judge.frames.inward(pose)
    arguments = (judge.loads[phase], judge.friction, scene.size_m, judge.tolerances, room)
    return lambda: prove(judge.geometry, judge.body, *inside, *arguments)
