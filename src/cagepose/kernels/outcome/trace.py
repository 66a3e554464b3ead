"""What a method writes down while it runs a phase: one record for each step, and the codes that stand for names."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.contact.pressing import MOST_PRESSING

TRAVEL, TURN, SCREW, NONE = 0, 1, 2, 3
"""Codes of motions: the index into `MOTION_NAMES`; NONE has no name."""
MOTION_NAMES: tuple[Literal["travel", "turn", "screw"], ...] = ("travel", "turn", "screw")

STABLE, ESCAPES, SPINS, CYCLING, LIMIT, RESTS, STALLED, BLOCKED, JAMS, STOPS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
"""Codes of how a phase ended: the index into `VERDICT_NAMES`."""
VERDICT_NAMES: tuple[
    Literal["stable", "escapes", "spins", "cycling", "limit", "rests", "stalled", "blocked", "jams", "stops"], ...
] = (
    "stable",
    "escapes",
    "spins",
    "cycling",
    "limit",
    "rests",
    "stalled",
    "blocked",
    "jams",
    "stops",
)


TIE, BALANCED, SMALL_TURN, EDGE_TIE, AT_EDGE, COULD_STAY, PLAIN, LET_GO = 0, 1, 2, 3, 4, 5, 6, 7
"""Codes of notes: the index into `NOTE_NAMES`; PLAIN and LET_GO (a contact was lost) have no name."""
NOTE_NAMES: tuple[Literal["tie", "balanced", "small turn", "edge tie", "edge", "could stay"], ...] = (
    "tie",
    "balanced",
    "small turn",
    "edge tie",
    "edge",
    "could stay",
)


class StepRecord:
    """One step of a run; a record.

    Attributes
    ----------
    rule, motion
        Codes of the rule and of the motion.
    along, through
        Direction of a travel, or axis of a turn and a point on it.
    distance, angle
        Metres and radians.
    position, quaternion
        Pose after the step: of the object as seen from its centre of gravity, in the frame of the cage's middle.
    note
        Code of what a careful reader should know.
    is_at_edge
        Whether it begins only because a contact is on an edge.
    could_stay
        Whether friction could hold the object where it begins, or on the way, and it goes on as it moves.
    start_position, start_quaternion, start_velocity, start_spin
        Pose before the step, and the motion that led there.
    share, driving
        How much of the phase's drive is done after it, and the sum of the drivers' forces along their ways there.
    pressed
        How far each body that presses has gone in the phase after it, metres, in the order of their freedoms.
    could_jam
        Whether forces could stand against the drive there, whatever they are.
    turn_step, n_still, n_refined
        What else a quasistatic step began from, see `cagepose.kernels.quasistatic.state.State`.
    """

    rule: int
    motion: int
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    distance: float
    angle: float
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    note: int
    is_at_edge: bool
    could_stay: bool
    start_position: Annotated[FloatArray, 3]
    start_quaternion: Annotated[FloatArray, 4]
    start_velocity: Annotated[FloatArray, 3]
    start_spin: Annotated[FloatArray, 3]
    share: float
    driving: float
    pressed: Annotated[FloatArray, MOST_PRESSING]
    could_jam: bool
    turn_step: float
    n_still: int
    n_refined: int


class Trace(NamedTuple):
    """The steps of one phase; which of the cage's points and shapes touch after each, and which of them it reached,
    (n_steps, n_elements); and the points that touched before it, longest first, then -1, where a method asks for that
    order.
    """

    rows: Rows[StepRecord]
    touching: NDArray[np.bool_]
    hit: NDArray[np.bool_]
    order: NDArray[np.int64]


def empty_trace(n_steps: int, n_elements: int, n_ordered: int) -> Trace:
    """Return memory for the steps of a phase (plain Python); ``n_ordered``: all points, or none if no order is kept."""
    return Trace(
        empty_rows(StepRecord, n_steps),
        np.zeros((n_steps, n_elements), np.bool_),
        np.zeros((n_steps, n_elements), np.bool_),
        np.zeros((n_steps, n_ordered), np.int64),
    )
