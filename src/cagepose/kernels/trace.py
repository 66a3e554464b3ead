"""What a compiled run writes down: events in preallocated arrays, and the codes that stand for names."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, moved_pose
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.turn import angle_of_key
from cagepose.kernels.native.kernel import kernel

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
        Travel: distance in metres. Turn: key of the angle, see `cagepose.kernels.collision.turn`. Inf: nothing is hit.
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


class Happening:
    """One event of a run; a record.

    Attributes
    ----------
    phase, rule, motion
        Phase index, rule code, motion code.
    along, through
        As in `Step`.
    distance, angle
        Metres and radians.
    position, quaternion
        Pose of the object after the event, metres.
    note
        As in `Step`.
    """

    phase: int
    rule: int
    motion: int
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    distance: float
    angle: float
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    note: int


class Trace(NamedTuple):
    """Events of all phases one after the other; and which points touch after each, and which of them the motion
    reached, (n_events, n_points).
    """

    rows: Rows[Happening]
    touching: NDArray[np.bool_]
    hit: NDArray[np.bool_]


def empty_trace(n_events: int, n_points: int) -> Trace:
    """Return room for the events of a run (plain Python)."""
    return Trace(
        empty_rows(Happening, n_events),
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
def write_pose(happening: Happening, position: Vector, quaternion: Quaternion) -> None:
    for k in range(3):
        happening.position[k] = position[k]
    for k in range(4):
        happening.quaternion[k] = quaternion[k]


@kernel
def write_event(trace: Trace, event: int, phase: int, step: Step, position: Vector, quaternion: Quaternion) -> None:
    """Write everything of an event but its contacts."""
    happening = trace.rows[event]
    happening.phase, happening.rule, happening.motion, happening.note = phase, step.rule, step.motion, step.note
    happening.distance, happening.angle = step_amounts(step)
    for k in range(3):
        happening.along[k] = step.along[k]
        happening.through[k] = step.through[k]
    write_pose(happening, position, quaternion)
