"""The stepwise method as seen from a scene: its numbers, and what a careful reader should know of its runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cagepose.kernels.collision.turn import key_of_angle
from cagepose.kernels.stepwise.run import StepwiseRules, StepwiseWorkspace, empty_stepwise_workspace
from cagepose.kernels.stepwise.slip import SlipRules
from cagepose.kernels.stepwise.support import SupportRules
from cagepose.model.remarks import remarks
from cagepose.model.scene import Scene
from cagepose.runs.run import Note, PhaseRun
from cagepose.runs.tolerances import EQUAL_DISTANCE_OF_SIZE, LEAST_MOMENT, PARALLEL_SINE
from cagepose.runs.warnings_of_runs import edge_warnings, proof_warnings, seam_warnings, unrun_warnings

BLOCKED_ANGLE_RAD = math.pi / 10000.0
"""A turn that ends within 0.018 deg is blocked (R3)."""
EVENT_LIMIT = 1000
"""Events in a phase after which a run is named "limit". A rail's push takes 9; 1 of 20,000 random scenes gets here."""
NOTES: dict[Note, str] = {
    "tie": "tie: the load has no moment about the axis through the two contacts, so the sense of turning was decided by"
    " convention (R2)",
    "balanced": "balanced: the load's line passes through its only contact, so the slightest disturbance may move it"
    " (R1)",
    "small turn": "held, though the load could still turn the object by less than 0.018 deg: the method cannot tell"
    " play this small from none (R3)",
    "edge tie": "tie: a contact lies on an edge whose faces make the same angle with the push, so which face counts was"
    " decided by convention (R4)",
}
"""What the notes of events say as warnings."""
SMALL_POSE_RAD = math.radians(45.0)
"""Assumption E of the paper: the method is meant for smaller angles per axis (R11)."""


def stepwise_rules(scene: Scene) -> StepwiseRules:
    """Return the numbers of the method for a scene of size 1; the angle of slip is that of each case's friction."""
    return StepwiseRules(
        SupportRules(
            LEAST_MOMENT,
            key_of_angle(BLOCKED_ANGLE_RAD),
            key_of_angle(scene.tolerances.touch),
            EQUAL_DISTANCE_OF_SIZE,
        ),
        SlipRules(
            0.0,
            math.pi / 2.0 + scene.tolerances.grazing_band_rad,
            PARALLEL_SINE,
            EQUAL_DISTANCE_OF_SIZE,
        ),
        EVENT_LIMIT,
    )


def stepwise_workspace(scene: Scene, step_limit: int) -> StepwiseWorkspace:
    """Return what one run of a scene at a time writes to."""
    return empty_stepwise_workspace(scene.geometry, scene.boxes, step_limit)


def stepwise_warnings(scene: Scene, phases: Sequence[PhaseRun], friction: float) -> Iterator[str]:
    """What a careful reader should know: ties, conventions, poses beyond the method's range, contacts on edges, and
    where the mechanics contradicts the rules.
    """
    yield from remarks(scene)
    yield from seam_warnings(scene)
    largest = 0.0
    start = scene.object.pose_world_object.inverse()
    for phase, load in zip(phases, scene.loads, strict=False):
        if load.pushes and load.gravity_world is not None:
            yield f"{phase.name}: gravity is ignored beside a force (the paper's assumption C)"
        for number, event in enumerate(phase.events, start=1):
            largest = max(largest, *(abs(angle) for angle in (start @ event.pose_world_object).euler_zyx))
            if event.note is not None:
                yield f"{phase.name}, event {number} ({event.rule}): {NOTES[event.note]}"
        yield from edge_warnings(phase)
    if largest > SMALL_POSE_RAD:
        yield (
            f"turned by {math.degrees(largest):.1f} deg about one axis from the start; the paper's rules are meant for"
            " at most 45 deg (assumption E)"
        )
    yield from unrun_warnings(scene, phases)
    yield from proof_warnings(phases, friction)
