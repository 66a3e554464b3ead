"""The stepwise method as seen from a scene: cast, call the compiled state machine, name what it did."""

from __future__ import annotations

import math
import time

import numpy as np

from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.collision.turn import key_of_angle
from cagepose.kernels.stepwise.run import RULE_NAMES, PhaseLoads, StepwiseRules, empty_workspace, stepwise_run
from cagepose.kernels.stepwise.slip import SlipRules
from cagepose.kernels.stepwise.support import SupportRules
from cagepose.kernels.trace import MOTION_NAMES, NONE, NOTE_NAMES, PLAIN, TRAVEL, VERDICT_NAMES, Trace
from cagepose.model.checks import FloatArray, unit_vector
from cagepose.model.methods import NO_SLIP_ANGLE_DEFAULT_RAD
from cagepose.model.scene import Scene
from cagepose.runs.frames import Frames, middle_of_boxes, touching_names
from cagepose.runs.judge import Judge
from cagepose.runs.remarks import edge_remarks, proof_remarks, seam_remarks
from cagepose.runs.run import Event, Motion, Note, PhaseRun, Run, Verdict

BLOCKED_ANGLE_RAD = math.pi / 10000.0
"""A turn that ends within 0.018 deg is blocked (R3)."""
LEAST_MOMENT = 1e-3
"""Least moment, as a fraction of force times distance, that drives a turn (R3)."""
EQUAL_DISTANCE_OF_SIZE = 1e-6
"""Distances closer than this fraction of the scene's size are equal (R3, R6)."""
PARALLEL_SINE = 1e-6
"""Normals closer than this angle (radians) are one direction."""
EVENT_LIMIT = 1000
"""Events in a phase after which a run is named "limit". A rail's push takes 9; 1 of 20,000 random scenes gets here."""
NOTES: dict[Note, str] = {
    "tie": "tie: the load has no moment about the axis through the two contacts, so the sense of turning was decided by"
    " convention (R2)",
    "balanced": "balanced: the load's line passes through the one contact that holds, so the least disturbance may move"
    " it (R1)",
    "small turn": "held, though the load could still turn the object by less than 0.018 deg: the method cannot tell"
    " play this small from none (R3)",
    "edge tie": "tie: a contact lies on an edge whose faces make the same angle with the push, so which face counts was"
    " decided by convention (R4)",
}
"""What the notes of events say as warnings."""
SMALL_POSE_RAD = math.radians(45.0)
"""Assumption E of the paper: the method is meant for smaller angles per axis (R11)."""


def run_stepwise(scene: Scene) -> Run:
    """Run a scene by the paper's rules (docs/theory)."""
    frames = Frames(scene, middle_of_boxes(scene))
    geometry, rules = frames.geometry(scene), rules_of_size(scene, scene.size_m)
    loads = phase_loads(scene, frames.middle_object)
    tolerances = kernel_tolerances(scene.size_m, scene.tolerances.touch)
    workspace = empty_workspace(geometry, len(scene.loads), rules)
    began = time.perf_counter()
    n_phases, n_events = stepwise_run(
        geometry,
        *frames.inward(scene.object.pose_world_object),
        loads,
        rules,
        scene.size_m,
        tolerances,
        workspace,
    )
    solve_s = time.perf_counter() - began

    friction = scene.friction_coefficient
    judge = Judge(scene, math.tan(NO_SLIP_ANGLE_DEFAULT_RAD) if friction is None else friction)
    trace, phases = workspace.trace, list[PhaseRun]()
    pose = scene.object.pose_world_object
    for phase in range(n_phases):
        places = [event for event in range(n_events) if trace.rows[event].phase == phase]
        events = tuple(_event(scene, trace, event, frames) for event in places)
        proof, contacts = judge.proof(events[-1].pose_world_object, phase)
        verdict: Verdict = VERDICT_NAMES[workspace.verdicts[phase]]
        phases.append(PhaseRun(scene.loads[phase].name, verdict, pose, events, contacts, proof))
        pose = events[-1].pose_world_object
    return Run(scene, "stepwise", tuple(phases), tuple(_warnings(scene, phases, judge.friction)), solve_s)


def no_slip_angle_rad(scene: Scene) -> float:
    """Return the angle below which a contact does not slip (R4): the friction angle, or the paper's threshold."""
    friction = scene.friction_coefficient
    return NO_SLIP_ANGLE_DEFAULT_RAD if friction is None else math.atan(friction)


def rules_of_size(scene: Scene, size_m: float) -> StepwiseRules:
    """Return the numbers of the method for a scene that is so large."""
    equal_distance_m = EQUAL_DISTANCE_OF_SIZE * size_m
    return StepwiseRules(
        SupportRules(
            LEAST_MOMENT, key_of_angle(BLOCKED_ANGLE_RAD), key_of_angle(scene.tolerances.touch), equal_distance_m
        ),
        SlipRules(
            no_slip_angle_rad(scene),
            math.pi / 2.0 + scene.tolerances.grazing_band_rad,
            PARALLEL_SINE,
            equal_distance_m,
        ),
        EVENT_LIMIT,
    )


def phase_loads(scene: Scene, middle_object: FloatArray) -> PhaseLoads:
    """Gravity acts at the centre of gravity; beside a force it is ignored (R8b)."""
    directions, points = [], []
    for load in scene.loads:
        if load.force is not None:
            directions.append(load.force.direction_world)
            points.append(load.force.at_object_m)
        else:
            assert load.gravity_world is not None
            directions.append(unit_vector(load.gravity_world, "gravity"))
            points.append(scene.object.center_of_gravity_m)
    is_push = [load.force is not None for load in scene.loads]
    return PhaseLoads(np.array(directions), np.array(points) - middle_object, np.array(is_push))


def _event(scene: Scene, trace: Trace, event: int, frames: Frames) -> Event:
    return Event(
        rule=RULE_NAMES[trace.rows[event].rule],
        motion=_motion(trace, event, frames.origin_world),
        hit=touching_names(scene, trace.hit[event]),
        contacts=touching_names(scene, trace.touching[event]),
        pose_world_object=frames.outward(trace, event),
        note=None if trace.rows[event].note == PLAIN else NOTE_NAMES[trace.rows[event].note],
    )


def _motion(trace: Trace, event: int, origin: FloatArray) -> Motion | None:
    code = trace.rows[event].motion
    if code == NONE:
        return None
    is_travel = code == TRAVEL
    return Motion(
        kind=MOTION_NAMES[code],
        direction_world=trace.rows[event].along.copy() if is_travel else None,
        axis_world=None if is_travel else trace.rows[event].along.copy(),
        through_world=None if is_travel else trace.rows[event].through + origin,
        distance_m=float(trace.rows[event].distance),
        angle_rad=float(trace.rows[event].angle),
    )


def _warnings(scene: Scene, phases: list[PhaseRun], friction: float) -> list[str]:
    """What a careful reader should know: ties, conventions, poses beyond the method's range, contacts on edges, and
    where the mechanics contradicts the rules.
    """
    warnings = list(seam_remarks(scene))
    largest = 0.0
    start = scene.object.pose_world_object.inverse()
    for phase, load in zip(phases, scene.loads, strict=False):
        if load.force is not None and load.gravity_world is not None:
            warnings.append(f"{phase.name}: gravity is ignored beside a force (the paper's assumption C)")
        for number, event in enumerate(phase.events, start=1):
            largest = max(largest, *(abs(angle) for angle in (start @ event.pose_world_object).euler_zyx))
            if event.note is not None:
                warnings.append(f"{phase.name}, event {number} ({event.rule}): {NOTES[event.note]}")
        warnings.extend(edge_remarks(phase))
    if largest > SMALL_POSE_RAD:
        warnings.append(
            f"turned by {math.degrees(largest):.1f} deg about one axis from the start; the paper's rules are meant for"
            " at most 45 deg (assumption E)"
        )
    warnings.extend(proof_remarks(phases, friction))
    return warnings
