"""What a rule of the stepwise method decides to do next: `Step`."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion, moved_pose
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.turn import angle_of_key
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import NONE, TRAVEL, TURN, StepRecord


class Step(NamedTuple):
    """What a rule decides to do next.

    Attributes
    ----------
    rule
        Code of the rule.
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
    if step.amount == math.inf or step.motion == NONE:
        return position, quaternion
    distance, angle = step_amounts(step)
    return moved_pose(position, quaternion, step.along, step.through, fraction * distance, fraction * angle)


@kernel
def write_step(record: StepRecord, step: Step, position: Vector, quaternion: Quaternion) -> None:
    """Write a step and the pose after it."""
    record.rule, record.motion, record.note = step.rule, step.motion, step.note
    record.distance, record.angle = step_amounts(step)
    for k in range(3):
        record.along[k] = step.along[k]
        record.through[k] = step.through[k]
        record.position[k] = position[k]
    for k in range(4):
        record.quaternion[k] = quaternion[k]
