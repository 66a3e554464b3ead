"""The friendly call: `run`. One call of machine code, whose outcome a `Run` reads when it is asked."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.records import Outcome, empty_outcome
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.cases import prepared, taken_apart
from cagepose.runs.methods import Method, chosen_method
from cagepose.runs.run import Run
from cagepose.runs.solved import Solution, written

WORKSPACES_KEPT = 8
"""For each thread: scenes of the same numbers of points, boxes, phases, actions and legs share one."""


def run(scene: Scene, method: str | None = None) -> Run:
    """Say where the object comes to rest, or how it gets away.

    Parameters
    ----------
    scene
        What to run.
    method
        "stepwise" or "quasistatic"; None: the scene's own choice, else "quasistatic".

    Raises
    ------
    SceneError
        An unknown method.
    """
    chosen = chosen_method(scene, method)
    return run_with(scene, chosen, chosen.rules(scene))


def run_with(
    scene: Scene,
    method: Method,
    rules: Any,
    begun: tuple[Pose, FloatArray] | None = None,
    stop: NDArray[np.int64] | None = None,
) -> Run:
    """Run a scene by a method with other numbers than its own.

    ``begun``: where the object and the bodies of the cage are instead of where the scene has them, the bodies displaced
    as for `cases_of`. Nobody asks whether they are apart there; the phases that are read from the run still tell of the
    scene's start. ``stop``: as for `Entry.until`.
    """
    friction = method.friction(scene)
    part, cases = prepared(scene, friction) if begun is None else taken_apart(scene, friction, *begun)
    work = _workspace(scene, method, rules.step_limit, cast(Cases, cases.value))
    began = time.perf_counter()
    try:
        method.run.until(stop, part, cases, rules, work.work, work.outcome_slots)
    except KeyboardInterrupt:
        _WORKSPACES.by_size.clear()  # half written
        raise
    solve_s = time.perf_counter() - began
    return Solution(scene, method, rules, friction, written(work.outcome)).run(solve_s)


class _Workspace(NamedTuple):
    """What one run at a time writes to: both for kernels, and the outcome to read."""

    work: Slots
    outcome_slots: Slots
    outcome: Outcome


class _Workspaces(threading.local):
    """The workspaces of one thread, with the one that was used last at the end."""

    def __init__(self) -> None:
        self.by_size: OrderedDict[tuple[object, ...], _Workspace] = OrderedDict()


_WORKSPACES = _Workspaces()


def _workspace(scene: Scene, method: Method, step_limit: int, cases: Cases) -> _Workspace:
    n_phases, n_points = len(scene.loads), len(scene.cage.names)
    size = (method.name, step_limit, *run_sizes(scene, cases))
    kept = _WORKSPACES.by_size
    if size in kept:
        kept.move_to_end(size)
        return kept[size]
    if len(kept) == WORKSPACES_KEPT:
        kept.popitem(last=False)
    outcome = empty_outcome(scene.geometry, n_phases, step_limit, 0 if method.joins_steps else n_points)
    kept[size] = _Workspace(Slots(method.workspace(scene, step_limit)), Slots(outcome), outcome)
    return kept[size]


def run_sizes(scene: Scene, cases: Cases) -> tuple[int, ...]:
    """Return what the memory that one run writes to hangs on: how many phases, points, boxes, actions and legs there
    are, how many parts, features and nodes the boundaries have, and how the cage's are divided into bodies.
    """
    held, cage = scene.geometry.held, scene.geometry.cage
    of_bodies = np.bincount(np.asarray(cage.own.parts)["body"], minlength=len(cage.first_nodes) - 1)
    sizes = [len(rows) for body in (held, cage.own) for rows in (body.parts, body.features, body.nodes)]
    acting = np.asarray(cases.actions).shape[2], np.asarray(cases.drives.legs).shape[2]
    counts = len(scene.loads), len(scene.cage.names), len(scene.boxes.half_sizes)
    return (*counts, *acting, *sizes, *cage.first_nodes.tolist(), *of_bodies.tolist())
