"""The quasistatic method as seen from a scene: cast, call the compiled loop, name what it did."""

from __future__ import annotations

import time

import numpy as np

from cagepose.kernels.jit import is_loaded
from cagepose.kernels.metric import Body
from cagepose.kernels.quasistatic import (
    RULE_NAMES,
    QuasistaticRules,
    empty_quasistatic_workspace,
    quasistatic_run,
)
from cagepose.kernels.tolerances import kernel_tolerances
from cagepose.kernels.trace import NONE, VERDICT_NAMES, Trace
from cagepose.nouns.pose import Pose
from cagepose.nouns.scene import Metric, Scene
from cagepose.runs.frames import Frames, touching_names
from cagepose.runs.run import Event, PhaseRun, Run, Verdict
from cagepose.runs.screw_between import motion_between
from cagepose.runs.weights import dead_loads

METRIC_DEFAULT: Metric = "release"
TURN_STEP_RAD = 0.02
"""Longest turn in one step: the path is wrong by about this fraction of it (docs/theory/mechanics)."""
STEP_LIMIT = 3000
"""Steps in a phase after which a run is named "limit"."""


def run_quasistatic(scene: Scene, turn_step_rad: float = TURN_STEP_RAD) -> Run:
    """Run a scene by the mechanics (docs/theory/mechanics)."""
    frames = Frames(scene, scene.object.center_of_gravity_m)
    geometry = frames.geometry(scene)
    rules = QuasistaticRules(scene.friction_coefficient or 0.0, turn_step_rad, STEP_LIMIT)
    work = empty_quasistatic_workspace(
        len(geometry.half_sizes), len(geometry.points_world), len(scene.loads), STEP_LIMIT
    )
    start = frames.inward(scene.object.pose_world_object)
    tolerances = kernel_tolerances(scene.size_m, scene.tolerances.touch)
    arguments = (geometry, body_of(scene), *start, dead_loads(scene), rules, scene.size_m, tolerances, work)
    if not is_loaded(quasistatic_run):
        quasistatic_run(*arguments)  # so that the time measured is that of the run
    began = time.perf_counter()
    n_phases, n_steps = quasistatic_run(*arguments)
    solve_s = time.perf_counter() - began

    phases = list[PhaseRun]()
    pose = scene.object.pose_world_object
    for phase in range(n_phases):
        steps = [step for step in range(n_steps) if work.trace.phases[step] == phase]
        events = _events(scene, work.trace, steps, frames, pose)
        verdict: Verdict = VERDICT_NAMES[work.verdicts[phase]]
        phases.append(PhaseRun(scene.loads[phase].name, verdict, pose, events, ()))
        pose = events[-1].pose_world_object
    return Run(scene, "quasistatic", tuple(phases), (), solve_s)


def body_of(scene: Scene) -> Body:
    """Return the metric of a scene: its inertia about the centre of gravity, or the same about every axis ("drag")."""
    gyration = scene.object.gyration_m2
    corners = np.concatenate([box.corners_object() for box in scene.object.boxes])
    reach_m = float(np.linalg.norm(corners - scene.object.center_of_gravity_m, axis=1).max())
    if (scene.metric or METRIC_DEFAULT) == "drag":
        return Body(np.eye(3), np.full(3, np.sqrt(np.trace(gyration) / 3.0)), reach_m)
    squares, axes = np.linalg.eigh(gyration)
    return Body(np.ascontiguousarray(axes.T), np.sqrt(squares), reach_m)


def _events(scene: Scene, trace: Trace, steps: list[int], frames: Frames, start: Pose) -> tuple[Event, ...]:
    """Steps of one kind between two changes of the contacts are one event."""
    events = list[Event]()
    path = list[Pose]()
    before = start
    for place, step in enumerate(steps):
        pose = frames.outward(trace, step)
        path.append(pose)
        last = place + 1 == len(steps)
        if not last and _goes_on(trace, step, steps[place + 1]):
            continue
        events.append(
            Event(
                rule=RULE_NAMES[trace.rules[step]],
                motion=None if trace.motions[step] == NONE else motion_between(before, pose, frames.middle_object),
                hit=touching_names(scene, trace.hit[step]),
                contacts=touching_names(scene, trace.touching[step]),
                pose_world_object=pose,
                note=None,
                path=tuple(path),
            )
        )
        before, path = pose, []
    return tuple(events)


def _goes_on(trace: Trace, step: int, following: int) -> bool:
    return bool(
        trace.rules[step] == trace.rules[following]
        and not trace.hit[step].any()
        and (trace.touching[step] == trace.touching[following]).all()
    )
