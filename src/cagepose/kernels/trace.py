"""What a compiled run writes down: events in preallocated arrays, and the codes that stand for names."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.pose import Quaternion, moved_pose
from cagepose.kernels.turn import angle_of_key
from cagepose.kernels.vector import Vector

TRAVEL, TURN, SCREW, NONE = 0, 1, 2, 3
"""Codes of motions: the index into `MOTION_NAMES`; NONE has no name."""
MOTION_NAMES: tuple[Literal["travel", "turn", "screw"], ...] = ("travel", "turn", "screw")

STABLE, ESCAPES, SPINS, CYCLING, LIMIT, RESTS, STALLED = 0, 1, 2, 3, 4, 5, 6
"""Codes of how a phase ended: the index into `VERDICT_NAMES`."""
VERDICT_NAMES: tuple[Literal["stable", "escapes", "spins", "cycling", "limit", "rests", "stalled"], ...] = (
    "stable",
    "escapes",
    "spins",
    "cycling",
    "limit",
    "rests",
    "stalled",
)


TIE, BALANCED, SMALL_TURN, EDGE_TIE, PLAIN, LET_GO = 0, 1, 2, 3, 4, 5
"""Codes of notes: the index into `NOTE_NAMES`; PLAIN and LET_GO (a contact was lost) have no name."""
NOTE_NAMES: tuple[Literal["tie", "balanced", "small turn", "edge tie"], ...] = (
    "tie",
    "balanced",
    "small turn",
    "edge tie",
)


class Step(NamedTuple):
    """What a rule decides to do next.

    Attributes
    ----------
    rule
        Code of the rule; each method has its own.
    motion
        Code of the motion; NONE: the object is held.
    along, through
        Direction of a travel, or axis of a turn and a point on it.
    amount
        Travel: distance in metres. Turn: key of the angle, see `cagepose.kernels.turn`. Inf: nothing is hit.
    hit_point
        Index of the cage point that ends the motion; -1: none.
    note
        Code of what a careful reader should know of this decision: the index into `NOTE_NAMES`, or PLAIN.
    """

    rule: int
    motion: int
    along: Vector
    through: Vector
    amount: float
    hit_point: int
    note: int


class Trace(NamedTuple):
    """Events, one row each, of all phases one after the other.

    Attributes
    ----------
    phases, rules, motions
        Phase index, rule code, motion code, (n_events,).
    along, through
        As in `Step`, (n_events, 3).
    distances, angles
        Metres and radians, (n_events,).
    positions, quaternions
        Pose of the object after the event, (n_events, 3) metres and (n_events, 4).
    notes
        As in `Step`, (n_events,).
    touching, hit
        Which points touch after the event, and which of them the motion reached, (n_events, n_points).
    """

    phases: NDArray[np.int64]
    rules: NDArray[np.int64]
    motions: NDArray[np.int64]
    along: FloatArray
    through: FloatArray
    distances: FloatArray
    angles: FloatArray
    positions: FloatArray
    quaternions: FloatArray
    notes: NDArray[np.int64]
    touching: NDArray[np.bool_]
    hit: NDArray[np.bool_]


def empty_trace(n_events: int, n_points: int) -> Trace:
    """Return room for the events of a run (plain Python)."""
    return Trace(
        np.empty(n_events, np.int64),
        np.empty(n_events, np.int64),
        np.empty(n_events, np.int64),
        np.empty((n_events, 3)),
        np.empty((n_events, 3)),
        np.empty(n_events),
        np.empty(n_events),
        np.empty((n_events, 3)),
        np.empty((n_events, 4)),
        np.empty(n_events, np.int64),
        np.zeros((n_events, n_points), np.bool_),
        np.zeros((n_events, n_points), np.bool_),
    )


@kernel
def step_amounts(step: Step) -> tuple[float, float]:
    """Return (distance in metres, angle in radians) of a step."""
    if step.motion == TRAVEL:
        return step.amount, 0.0
    if step.motion == TURN:
        return 0.0, angle_of_key(step.amount)
    return 0.0, 0.0


@kernel
def pose_during(step: Step, position: Vector, quaternion: Quaternion, fraction: float) -> tuple[Vector, Quaternion]:
    """Return the pose when ``fraction`` of a step is done.

    A step that hits nothing (a full turn, an endless travel) ends where it began.
    """
    if step.amount == np.inf or step.motion == NONE:
        return position, quaternion
    distance, angle = step_amounts(step)
    return moved_pose(position, quaternion, step.along, step.through, fraction * distance, fraction * angle)


@kernel
def write_event(trace: Trace, event: int, phase: int, step: Step, position: Vector, quaternion: Quaternion) -> None:
    """Write everything of an event but its contacts."""
    trace.phases[event] = phase
    trace.rules[event] = step.rule
    trace.motions[event] = step.motion
    trace.distances[event], trace.angles[event] = step_amounts(step)
    trace.notes[event] = step.note
    for k in range(3):
        trace.along[event, k] = step.along[k]
        trace.through[event, k] = step.through[k]
        trace.positions[event, k] = position[k]
    for k in range(4):
        trace.quaternions[event, k] = quaternion[k]
