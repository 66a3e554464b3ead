"""The quasistatic method as seen from a scene: cast, call the compiled loop, name what it did."""

from __future__ import annotations

import time

from cagepose.kernels.quasistatic.run import (
    RULE_NAMES,
    QuasistaticRules,
    empty_quasistatic_workspace,
    quasistatic_run,
)
from cagepose.kernels.trace import LET_GO, NONE, VERDICT_NAMES, Trace
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.frames import Frames, touching_names
from cagepose.runs.judge import Judge
from cagepose.runs.remarks import edge_remarks, proof_remarks, seam_remarks, weight_remarks
from cagepose.runs.run import Event, PhaseRun, Run, Verdict
from cagepose.runs.screw_between import motion_between

TURN_STEP_RAD = 0.02
"""Longest turn in one step: the path is wrong by about this fraction of it (docs/theory/mechanics)."""
STEP_LIMIT = 3000
"""Steps in a phase after which a run is named "limit"."""


def run_quasistatic(scene: Scene, turn_step_rad: float = TURN_STEP_RAD) -> Run:
    """Run a scene by the mechanics (docs/theory/mechanics)."""
    friction = scene.friction_coefficient or 0.0
    judge = Judge(scene, friction)
    frames = judge.frames
    rules = QuasistaticRules(friction, turn_step_rad, STEP_LIMIT)
    work = empty_quasistatic_workspace(judge.geometry, len(scene.loads), STEP_LIMIT)
    start = frames.inward(scene.object.pose_world_object)
    began = time.perf_counter()
    n_phases, n_steps = quasistatic_run(
        judge.geometry,
        judge.body,
        *start,
        judge.loads,
        rules,
        scene.size_m,
        judge.tolerances,
        work,
    )
    solve_s = time.perf_counter() - began

    phases = list[PhaseRun]()
    pose = scene.object.pose_world_object
    for phase in range(n_phases):
        steps = [step for step in range(n_steps) if work.trace.rows[step].phase == phase]
        events = _events(scene, work.trace, steps, frames, pose)
        proof, contacts = judge.proof(events[-1].pose_world_object, phase)
        verdict: Verdict = VERDICT_NAMES[work.verdicts[phase]]
        if verdict == "rests":
            # A pose that the last correction has taken out of balance is not shown as rest.
            verdict = "stalled" if proof.verdict == "moves" else proof.verdict
        phases.append(PhaseRun(scene.loads[phase].name, verdict, pose, events, contacts, proof))
        pose = events[-1].pose_world_object
        if verdict == "stalled":
            break
    return Run(scene, "quasistatic", tuple(phases), tuple(_warnings(scene, phases, friction)), solve_s)


def _warnings(scene: Scene, phases: list[PhaseRun], friction: float) -> list[str]:
    """What a careful reader should know: seams, weights, contacts on edges, and what is less than a proven rest."""
    warnings = [*seam_remarks(scene), *weight_remarks(scene, len(phases))]
    for phase in phases:
        warnings.extend(edge_remarks(phase))
    warnings.extend(proof_remarks(phases, friction))
    return warnings


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
                rule=RULE_NAMES[trace.rows[step].rule],
                motion=None
                if trace.rows[step].motion == NONE
                else motion_between(before, pose, frames.middle_object, scene.size_m),
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
        trace.rows[step].rule == trace.rows[following].rule
        and not trace.hit[step].any()
        and trace.rows[step].note != LET_GO
    )
