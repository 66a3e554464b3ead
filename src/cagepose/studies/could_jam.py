"""Could contacts stand against a drive, and from which friction on? `could_stand`, `jam_friction_along`.

The question, (8.7), has a dual, (8.9), which is one system of inequalities: a motion along which each contact, carried
along by its body, opens at least mu times as fast as it slips. Where there is one, no forces stand. Cones come in as
rays, as a motion violates them; where the rays have no motion left, the multipliers that show so are forces that do.

The kernels ask the same along a run, for the least coefficient of all places. The search here is another one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cagepose.errors import CertificateError
from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import WRENCH, PassiveSet, empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.model.checks import FloatArray
from cagepose.runs.cases import greatest_friction
from cagepose.runs.run import Run
from cagepose.studies.driven_contacts import DriveContacts, DrivenContacts
from cagepose.studies.tolerances import (
    JAM_FRICTION_WITHIN,
    LEAST_JAM_FRICTION,
    MARGINS_OF_JAMS,
    MOST_JAM_FRICTION,
    SPEED_OF_GIVING_WAY,
)

FIRST_RAYS = 8
"""Each cone starts with so many rays."""
MOST_ROUNDS = 60
"""Rays come in so many times at most."""
LESS_FRICTION = 0.1 * JAM_FRICTION_WITHIN
"""Of the friction. A motion that gives way with so much less of it counts where the least friction is looked for: where
all motions that do are long, rounding leaves none that does with all of it.
"""
LONG, LONGEST_MOTION = 10.0, 1e6
"""In drifts. A longer motion than the first is asked for in its own length, as rounding is of the square of it; in one
longer than the second it is as much as a contact may open too slowly.
"""


class JamQuestion(NamedTuple):
    """What touches at a place of a drive, scaled as in (5.3), with speeds in that of the fastest drift.

    Attributes
    ----------
    columns
        Wrenches along each contact's normal and tangents, (n, 3, 6).
    drifts
        How fast each closes and slips where the object stands still, (n, 3).
    friction
        Coefficients, (n,).
    growth
        Direction in which the load grows, (6,), a unit vector or zero.
    fastest
        How fast the fastest body goes: a motion is to give way to the growth as fast.
    """

    columns: FloatArray
    drifts: FloatArray
    friction: FloatArray
    growth: FloatArray
    fastest: float


@dataclass(frozen=True, eq=False)
class GivesWay:
    """A motion that gives way.

    Attributes
    ----------
    twist
        Scaled, for a drift of one, (6,).
    """

    twist: FloatArray


@dataclass(frozen=True, eq=False)
class Stands:
    """Forces that cancel, and stand against the drive.

    Attributes
    ----------
    forces
        Of each contact along normal and tangents, (n, 3); all normal ones and ``taken`` add up to one, each times the
        length of its scaled wrench.
    taken
        How much of the growth of the load they take up, in its length.
    """

    forces: FloatArray
    taken: float


def jam_question(contacts: DrivenContacts, choice: tuple[int, ...]) -> JamQuestion:
    """Return the question whether those of the contacts at a place that are chosen could stand against the drive."""
    at, problem, speed = list(choice), contacts.problem, contacts.speed
    return JamQuestion(
        problem.scaled(problem.wrenches[at]),
        contacts.drifts[at] / speed,
        problem.friction[at],
        problem.scaled(contacts.growth) / (contacts.growth_size or 1.0),
        contacts.fastest / speed,
    )


def could_stand(question: JamQuestion) -> GivesWay | Stands | None:
    """Return a motion that gives way, with the largest margin of a few, or forces that stand; None: rounding."""
    found: GivesWay | Stands | None = None
    for margin in MARGINS_OF_JAMS:
        found = _ask(question, margin)
        if isinstance(found, GivesWay):
            return found
    return found


def least_jam_friction(question: JamQuestion, up_to: float = MOST_JAM_FRICTION) -> float:
    """Return the least coefficient of friction with which forces could stand against the drive; inf: none up to one.

    It is that of contacts whose ``friction`` is one; all others have their part of it.
    """
    low, high = 0.0, up_to
    if gives_way(question, high):
        return math.inf
    while high - low > max(JAM_FRICTION_WITHIN * high, LEAST_JAM_FRICTION):
        middle = 0.5 * (low + high)
        if gives_way(question, middle):
            low = middle
        else:
            high = middle
    return high if high > LEAST_JAM_FRICTION else 0.0


def jam_friction_along(run: Run, phase: int) -> FloatArray:
    """Return the least coefficient of friction with which the object could jam at each place of a phase's curve, (n,);
    inf: none up to 10; nan: more touches there, or faces take turns in more ways, than is asked.

    It is the greatest coefficient of all contacts; the others keep their proportion to it. Where faces take turns at an
    edge all choices count.

    Parameters
    ----------
    run
        By the quasistatic method.
    phase
        Its number, from 0; it has driven something.
    """
    known = DriveContacts(run, phase)
    greatest, rows = greatest_friction(run.scene, known.friction), known.rows()
    found = [_least_at(known, row, greatest) for row in rows]
    return np.repeat(found, np.diff([*rows, len(known.curve.share)]))


def _least_at(known: DriveContacts, row: int, greatest: float) -> float:
    try:
        contacts = known.at_row(row)
    except CertificateError:
        return math.nan
    choices = contacts.choices()
    if choices is None:
        return math.nan
    return least_of_choices((jam_question(contacts, choice) for choice in choices), greatest)


def least_of_choices(questions: Iterable[JamQuestion], greatest: float) -> float:
    """Return the least coefficient of all choices of faces, as `least_jam_friction`: of the contact with the greatest
    one; with no friction yet, all are equal.
    """
    least = math.inf
    for question in questions:
        parts = question.friction / greatest if greatest > 0.0 else np.ones(len(question.friction))
        least = min(least, least_jam_friction(question._replace(friction=parts), min(least, MOST_JAM_FRICTION)))
    return least


def gives_way(question: JamQuestion, coefficient: float) -> bool:
    """Whether a motion gives way with so many times the friction of each contact, or with a little less of it."""
    asked = question._replace(friction=coefficient * question.friction)
    return isinstance(_ask(asked, 0.0, LESS_FRICTION), GivesWay)


def _first_rays(question: JamQuestion) -> list[tuple[int, float]]:
    """Return rays of all cones: of which contact, and at which angle from its first tangent, radians."""
    angles = (2.0 * np.pi * np.arange(FIRST_RAYS) / FIRST_RAYS).tolist()
    return [
        (contact, angle)
        for contact, friction in enumerate(question.friction.tolist())
        for angle in (angles if friction > 0.0 else angles[:1])
    ]


def _ask(question: JamQuestion, margin: float, less_friction: float = 0.0) -> GivesWay | Stands | None:
    """Return a motion that opens each contact by a margin faster than it must, or would with so much less friction (as
    a part of it); or, without a margin, forces that stand.
    """
    columns, drifts, friction, growth, fastest = question
    sizes = np.linalg.norm(columns[:, 0], axis=1)
    rays, passive, unit = _first_rays(question), empty_record(PassiveSet), 1.0
    for _ in range(MOST_ROUNDS):
        contacts, angles = np.array([ray[0] for ray in rays], int), np.array([ray[1] for ray in rays])
        along = np.stack([np.ones(len(rays)), np.cos(angles), np.sin(angles)], axis=1)
        along[:, 1:] *= friction[contacts, None]
        rows = np.einsum("ij,ijk->ik", along, columns[contacts]) / sizes[contacts, None]
        bounds = -np.einsum("ij,ij->i", along, drifts[contacts]) / sizes[contacts] - margin
        if growth.any():
            rows, bounds = np.vstack([rows, -growth]), np.append(bounds, -fastest)
        twist = np.zeros(WRENCH)
        is_found = shortest_inside(rows, bounds / unit, empty_system(len(rows)), passive, twist)
        if not is_found or not np.isfinite(twist).all():
            return _forces(passive, contacts, along, sizes) if margin == 0.0 else None
        twist = _to_rounding(rows, bounds, passive, unit * twist)
        length = min(float(np.linalg.norm(twist)), LONGEST_MOTION)
        if length > LONG * unit:
            unit = length
            continue
        moving = columns @ twist + drifts
        slips = np.hypot(moving[:, 1], moving[:, 2])
        beyond = (moving[:, 0] + friction * slips) / sizes + margin
        allowed = max(0.5 * margin, 0.5 * SPEED_OF_GIVING_WAY) + less_friction * friction * slips / sizes
        wrong = np.flatnonzero(beyond > allowed)
        if not wrong.size:
            return GivesWay(twist) if np.linalg.norm(twist) <= LONGEST_MOTION else None
        steepest = np.arctan2(moving[:, 2], moving[:, 1])
        rays += [(contact, float(steepest[contact])) for contact in wrong.tolist()]
    return None


def _to_rounding(rows: FloatArray, bounds: FloatArray, passive: PassiveSet, twist: FloatArray) -> FloatArray:
    """Return a motion with the inequalities that it is at, or violates, held to rounding: that of least squares is of
    the square of its length.
    """
    at = np.union1d(passive.labels[: passive.used], np.flatnonzero(rows @ twist > bounds))
    return twist + np.linalg.lstsq(rows[at], bounds[at] - rows[at] @ twist, rcond=None)[0]


def _forces(passive: PassiveSet, contacts: FloatArray, along: FloatArray, sizes: FloatArray) -> Stands:
    """Return the forces whose multipliers the rays in use have; what comes after the rays is the growth of the load."""
    forces, taken = np.zeros((len(sizes), 3)), 0.0
    for label, share in zip(passive.labels[: passive.used].tolist(), passive.x[: passive.used].tolist(), strict=True):
        if label == len(contacts):
            taken += share
        else:
            forces[contacts[label]] += share * along[label] / sizes[contacts[label]]
    total = float(forces[:, 0] @ sizes) + taken
    return Stands(forces / total, taken / total)
