"""cagepose as an engine, measured three ways that must not be confused.

- ``cagepose-METHOD``: solve and proof, the compiled work of a run: the method's state machine from the start pose, as
  `cagepose.run_many` calls it, and the proof of each phase's end. This is what peers are compared with: their models
  are built beforehand too.
- ``cagepose-METHOD-solve``: the state machine alone.
- ``cagepose-METHOD-call``: the whole of `cagepose.run` from a scene to a `Run`, named events and contacts included.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from bench.rail_case import Answer
from bench.timing import median_cpu_s, median_s
from cagepose import Scene, Variation, run
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.stability.proof import empty_proof_room, prove
from cagepose.model.methods import DEFAULT_FRICTION
from cagepose.model.pose import Pose
from cagepose.runs.judge import Judge
from cagepose.runs.methods import REGISTRY

PARTS = ("", "-solve", "-call")


def engine_name(method: str, part: str = "") -> str:
    return f"cagepose-{method}{part}"


def measure(scene: Scene, method: str, budget_s: float) -> tuple[dict[str, tuple[float, float]], Answer]:
    """Return (median wall, median CPU) seconds of each of `PARTS`, and the answer."""
    found = run(scene, method)
    batch = REGISTRY[method].batch(scene, Variation())
    prepared = partial(batch.room(), 0, 1)
    proofs = [proof_call(scene, method, phase.pose, index) for index, phase in enumerate(found.phases)]
    whole = partial(run, scene, method)
    run_s = np.array([median_s(prepared, budget_s / 4.0), median_cpu_s(prepared, budget_s / 4.0)])
    proof_s = np.sum([[f(once, budget_s / 8.0) for f in (median_s, median_cpu_s)] for once in proofs], axis=0)
    call_s = np.array([median_s(whole, budget_s / 4.0), median_cpu_s(whole, budget_s / 4.0)])
    # A prepared quasistatic run proves where it ends, a stepwise one does not.
    solve_s = run_s if method == "stepwise" else run_s - proof_s
    times_s = {"": solve_s + proof_s, "-solve": solve_s, "-call": call_s}
    answer = Answer(tuple(phase.pose.rotation for phase in found.phases))
    return {part: (float(found_s[0]), float(found_s[1])) for part, found_s in times_s.items()}, answer


def proof_call(scene: Scene, method: str, pose: Pose, phase: int) -> Callable[[], object]:
    """Return the compiled proof of a pose, ready to be called, as `cagepose.run` calls it."""
    judge = Judge(scene, DEFAULT_FRICTION[method] if scene.friction_coefficient is None else scene.friction_coefficient)
    room = empty_proof_room(judge.geometry)
    position, quaternion = judge.frames.inward(pose)
    arguments = (
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
    return partial(prove, *[Slots(argument) for argument in arguments])
