"""cagepose as an engine, measured two ways that must not be confused.

- ``cagepose-METHOD``: the one call of machine code that a run is: the method's steps from the start pose, the proof of
  each phase's end, and all that a `Run` reads, written down. The scene is taken apart beforehand. This is what peers
  are compared with: their models are built beforehand too.
- ``cagepose-METHOD-call``: `cagepose.run` as users call it, from a scene to a `Run` of which verdict, pose, events,
  contacts and forces are read.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bench.rail_case import Answer
from bench.timing import median_cpu_s, median_s
from cagepose import Run, Scene, run
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.runs.cases import prepared
from cagepose.runs.methods import REGISTRY

PARTS = ("", "-call")


def engine_name(method: str, part: str = "") -> str:
    return f"cagepose-{method}{part}"


def measure(scene: Scene, method: str, budget_s: float) -> tuple[dict[str, tuple[float, float]], Answer]:
    """Return (median wall, median CPU) seconds of each of `PARTS`, and the answer."""
    calls: dict[str, Callable[[], object]] = {"": native_call(scene, method), "-call": partial(read_run, scene, method)}
    times_s = {
        part: (median_s(call, budget_s / 4.0), median_cpu_s(call, budget_s / 4.0)) for part, call in calls.items()
    }
    answer = Answer(tuple(phase.pose.rotation for phase in run(scene, method).phases))
    return times_s, answer


def native_call(scene: Scene, name: str) -> Callable[[], object]:
    """Return the machine code's part of a run, ready to be called."""
    method = REGISTRY[name]
    part, cases = prepared(scene, method.friction(scene))
    n_points = len(scene.cage.names)
    rules = method.rules(scene)
    outcome = empty_outcome(scene.geometry, len(scene.loads), rules.step_limit, 0 if method.joins_steps else n_points)
    work = method.workspace(scene, rules.step_limit)
    return partial(method.run, part, cases, Slots(rules), Slots(work), Slots(outcome))


def read_run(scene: Scene, method: str) -> tuple[Run, list[object]]:
    """Run a scene and read all of the result that people look at."""
    found = run(scene, method)
    read: list[object] = [found.verdict, found.pose.position_m, found.pose.quaternion_wxyz]
    for phase in found.phases:
        read += [(e.rule, e.motion, e.hit, e.contacts, e.pose_world_object.position_m) for e in phase.events]
        read += [(c.point, c.normal_world, c.gap_m, c.force_normal_n, c.force_tangential_n) for c in phase.contacts]
        read.append((phase.proof.verdict, phase.proof.reason, phase.proof.stability))
    return found, read
