"""cagepose as an engine, measured three ways that must not be confused.

- ``cagepose-METHOD``: solve and proof, the compiled work of a run: the method's state machine and the proof of each
  phase's end. This is what peers are compared with: their models are built beforehand too.
- ``cagepose-METHOD-solve``: the state machine alone.
- ``cagepose-METHOD-call``: the whole of `cagepose.run` from a scene to a `Run`, named events and contacts included.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from functools import partial

from bench.rail_case import Answer
from bench.timing import collected, median_cpu_s, median_s
from cagepose import Scene, run
from cagepose.kernels.proof import empty_proof_room, prove
from cagepose.nouns.pose import Pose
from cagepose.runs.judge import Judge
from cagepose.runs.stepwise import NO_SLIP_ANGLE_DEFAULT_RAD

METHODS = ("stepwise", "quasistatic")
PARTS = ("", "-solve", "-call")


def engine_name(method: str, part: str = "") -> str:
    return f"cagepose-{method}{part}"


def measure(scene: Scene, method: str, budget_s: float) -> tuple[dict[str, tuple[float, float]], Answer]:
    """Return (median wall, median CPU) seconds of each of `PARTS`, and the answer.

    The run itself is too short for a clock of CPU time to be read inside it, so its wall time counts as both.
    """
    found = run(scene, method)
    whole = partial(run, scene, method)
    call_s = median_s(whole, budget_s / 4.0), median_cpu_s(whole, budget_s / 4.0)
    solve_s = statistics.median(collected(lambda: run(scene, method).solve_s, budget_s / 4.0))
    proof_s = proof_cpu_s = 0.0
    for phase in range(len(found.phases)):
        prove_once = proof_call(scene, method, found.phases[phase].pose, phase)
        proof_s += median_s(prove_once, budget_s / 8.0)
        proof_cpu_s += median_cpu_s(prove_once, budget_s / 8.0)
    answer = Answer(tuple(phase.pose.rotation for phase in found.phases))
    times_s = {"": (solve_s + proof_s, solve_s + proof_cpu_s), "-solve": (solve_s, solve_s), "-call": call_s}
    return times_s, answer


def proof_call(scene: Scene, method: str, pose: Pose, phase: int) -> Callable[[], object]:
    """Return the compiled proof of a pose, ready to be called, as `cagepose.run` calls it."""
    default = math.tan(NO_SLIP_ANGLE_DEFAULT_RAD) if method == "stepwise" else 0.0
    judge = Judge(scene, default if scene.friction_coefficient is None else scene.friction_coefficient)
    room = empty_proof_room(judge.geometry)
    position, quaternion = judge.frames.inward(pose)
    return partial(
        prove,
        judge.geometry,
        judge.body,
        position,
        quaternion,
        judge.loads[phase],
        judge.friction,
        scene.size_m,
        judge.tolerances,
        room,
    )
