"""What is known after a run: `Outcome`, in the world's frame, metres, radians and the load's unit of force."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.boundary.geometry import Geometry, most_elements, most_rows
from cagepose.kernels.outcome.trace import StepRecord


class PhaseRecord:
    """One phase; a record.

    Attributes
    ----------
    verdict, proof, stability
        Codes of how it ended, of the proof of its end, and of how stable it is.
    residual
        What the contact forces leave of the load, in lengths of the terms.
    wedged
        Whether the contacts can press against each other without a load.
    is_second_order, is_chained, is_clamped
        Whether contacts without play carry a part of the load, whether some are held by what others stop, and whether a
        rest is marginal because it hangs on contacts that press against each other.
    n_undetermined, undetermined
        Scaled twists along which the load does not tell poses apart, rows.
    motion, along, through, pitch
        The motion that begins, if the object moves or may move.
    share, driving, greatest, greatest_at
        How much of its drive is done; the sum of the drivers' forces along their ways at the end, and where it is
        greatest, after which share.
    work, rubbed, lost
        Work of the drivers, what friction took of it, and what was lost where the object snapped.
    least_jam
        The least coefficient of friction with which the object could jam somewhere along the drive; inf: none.
    n_events, n_steps, n_contacts
        How many rows of the outcome are written after this phase.
    """

    verdict: int
    proof: int
    stability: int
    residual: float
    wedged: bool
    is_second_order: bool
    is_chained: bool
    is_clamped: bool
    n_undetermined: int
    undetermined: Annotated[FloatArray, WRENCH, WRENCH]
    motion: int
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    pitch: float
    share: float
    driving: float
    greatest: float
    greatest_at: float
    work: float
    rubbed: float
    lost: float
    least_jam: float
    n_events: int
    n_steps: int
    n_contacts: int


class EventRecord:
    """One event; a record.

    Attributes
    ----------
    rule, motion, note
        Codes.
    along, through
        Direction of a travel, or axis of a turn or screw and a point on it.
    distance, angle
        Metres and radians.
    position, quaternion
        Pose of the object after it, w >= 0.
    n_steps
        Of which it is made.
    """

    rule: int
    motion: int
    note: int
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    distance: float
    angle: float
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    n_steps: int


class ContactRecord:
    """One place where the object and the cage touch at the end of a phase; a record.

    Attributes
    ----------
    part, cage_part
        Indices of the parts of the object and of the cage.
    place, normal, gap
        Where in the world, outward unit normal of the object, and the distance, below zero inside.
    near_edge
        Whether a point lies within the touch tolerance of where a face ends.
    group
        Which of the phase's contacts, counted from 0, is the first of those of which one counts at a time.
    force_normal, force_tangential
        Force on the object: its part along -n, and the rest.
    is_shared
        Whether its normal force could be another.
    """

    part: int
    cage_part: int
    place: Annotated[FloatArray, 3]
    normal: Annotated[FloatArray, 3]
    gap: float
    near_edge: bool
    group: int
    force_normal: float
    force_tangential: Annotated[FloatArray, 3]
    is_shared: bool


class Outcome(NamedTuple):
    """Everything that a run gives.

    Attributes
    ----------
    counts
        How many phases, events, steps and contacts are written, (4,).
    phases, events, contacts
        One after the other, in the order of the phases.
    touching, hit
        Which of the cage's points and shapes touch after each event, and which of them it reached, (n_events,
        n_elements).
    path
        Position and quaternion of the object after each step, (n_steps, 7).
    drivers, displaced
        What the driver of each body of the cage does at the end of each phase, and how the body is displaced then, in
        the cage's frame, (n_phases, n_bodies, 7); see `cagepose.kernels.driven.bodies`.
    steps, order
        Every step as the method has noted it, from which it can be made again; see `Trace`.
    """

    counts: NDArray[np.int64]
    phases: Rows[PhaseRecord]
    events: Rows[EventRecord]
    contacts: Rows[ContactRecord]
    touching: NDArray[np.bool_]
    hit: NDArray[np.bool_]
    path: FloatArray
    drivers: FloatArray
    displaced: FloatArray
    steps: Rows[StepRecord]
    order: NDArray[np.int64]


def empty_outcome(geometry: Geometry, n_phases: int, n_steps: int, n_ordered: int) -> Outcome:
    """Return an outcome for at most ``n_steps`` steps in a phase (plain Python); ``n_ordered``: points whose order of
    touching the method keeps, all or none.
    """
    n_events, n_elements = n_phases * n_steps, most_elements(geometry)
    n_bodies = len(geometry.cage.first_nodes) - 1
    return Outcome(
        np.zeros(4, np.int64),
        empty_rows(PhaseRecord, n_phases),
        empty_rows(EventRecord, n_events),
        empty_rows(ContactRecord, n_phases * most_rows(geometry)),
        np.zeros((n_events, n_elements), np.bool_),
        np.zeros((n_events, n_elements), np.bool_),
        np.zeros((n_events, 7)),
        np.zeros((n_phases, n_bodies, 7)),
        np.zeros((n_phases, n_bodies, 7)),
        empty_rows(StepRecord, n_events),
        np.zeros((n_events, n_ordered), np.int64),
    )
