"""What a step of a run begins from: a pose, and the motion that led there, which goes on if it can."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import StepRecord

STILL_STANDS = (0.0, 0.0, 0.0)
"""Velocity and spin of an object at rest."""


class State(NamedTuple):
    """What a step begins from.

    Attributes
    ----------
    position, quaternion
        Pose of the object, as seen from its centre of gravity.
    velocity, spin
        The motion that led there, of the centre of gravity and angular, in the units of a scaled load; both zero: the
        object was at rest.
    turn_step_rad
        How far this step may turn: less after one that did not get as far as it should.
    n_still
        Steps without progress before it.
    n_refined
        How often a rest has been put on its faces in this phase.
    """

    position: Vector
    quaternion: Quaternion
    velocity: Vector
    spin: Vector
    turn_step_rad: float
    n_still: int
    n_refined: int


@kernel
def at_rest(position: Vector, quaternion: Quaternion, turn_step_rad: float, n_still: int) -> State:
    """Return the state of an object that rests at a pose, as it does where a phase begins."""
    return State(position, quaternion, STILL_STANDS, STILL_STANDS, turn_step_rad, n_still, 0)


@kernel
def write_state(record: StepRecord, state: State) -> None:
    """Write what a step began from."""
    record.turn_step, record.n_still, record.n_refined = state.turn_step_rad, state.n_still, state.n_refined
    for k in range(3):
        record.start_position[k] = state.position[k]
        record.start_velocity[k], record.start_spin[k] = state.velocity[k], state.spin[k]
    for k in range(4):
        record.start_quaternion[k] = state.quaternion[k]


@kernel
def state_of(record: StepRecord) -> State:
    """Return what a step began from, as `write_state` has it."""
    q = record.start_quaternion
    return State(
        vector_from(record.start_position),
        (q[0], q[1], q[2], q[3]),
        vector_from(record.start_velocity),
        vector_from(record.start_spin),
        record.turn_step,
        record.n_still,
        record.n_refined,
    )
