"""Can contacts stand against a drive? Forces that do, or a motion that gives way to all of them: `could_stand`, (8.7).

Both answers are of one system of inequalities: a motion along which each contact, carried along by its body, opens at
least mu times as fast as it slips. Cones come in as rays, as a motion violates them; where the rays have no motion
left, the multipliers that show so are the forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import PassiveSet, empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.model.checks import FloatArray
from cagepose.studies.tolerances import MARGINS_OF_JAMS, SPEED_OF_GIVING_WAY

FIRST_RAYS = 8
"""Each cone starts with so many rays."""
MOST_ROUNDS = 60
"""Rays come in so many times at most."""


@dataclass(frozen=True, eq=False)
class GivesWay:
    """A motion that gives way.

    Attributes
    ----------
    twist
        Scaled, for a drift of one, (6,).
    margin
        That was asked for, in drifts: each contact opens by so much faster than it must, less rounding.
    """

    twist: FloatArray
    margin: float


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


def could_stand(
    columns: FloatArray, drifts: FloatArray, friction: FloatArray, growth: FloatArray, fastest: float
) -> GivesWay | Stands | None:
    """Return a motion that gives way, with the largest margin of a few, or forces that stand; None: rounding.

    Parameters
    ----------
    columns
        Scaled wrenches along each contact's normal and tangents, (n, 3, 6).
    drifts
        How fast each closes and slips where the object stands still, (n, 3); the fastest at most one.
    friction
        Coefficients, (n,).
    growth
        Scaled direction in which the load grows, (6,), a unit vector or zero.
    fastest
        A motion is to give way to the growth with this speed.
    """
    found: GivesWay | Stands | None = None
    for margin in MARGINS_OF_JAMS:
        found = _ask(columns, drifts, friction, growth, fastest, margin)
        if isinstance(found, GivesWay):
            return found
    return found


def _ask(
    columns: FloatArray, drifts: FloatArray, friction: FloatArray, growth: FloatArray, fastest: float, margin: float
) -> GivesWay | Stands | None:
    sizes = np.linalg.norm(columns[:, 0], axis=1)
    n, grows = len(columns), bool(growth.any())
    first = 2.0 * np.pi * np.arange(FIRST_RAYS) / FIRST_RAYS
    rays = [(contact, angle) for contact in range(n) for angle in (first if friction[contact] > 0.0 else first[:1])]
    passive = empty_record(PassiveSet)
    for _ in range(MOST_ROUNDS):
        contacts, angles = np.array([ray[0] for ray in rays], int), np.array([ray[1] for ray in rays])
        along = np.stack([np.ones(len(rays)), np.cos(angles), np.sin(angles)], axis=1)
        along[:, 1:] *= friction[contacts, None]
        rows = np.einsum("ij,ijk->ik", along, columns[contacts]) / sizes[contacts, None]
        bounds = -np.einsum("ij,ij->i", along, drifts[contacts]) / sizes[contacts] - margin
        if grows:
            rows, bounds = np.vstack([rows, -growth]), np.append(bounds, -fastest)
        twist = np.zeros(6)
        is_found = shortest_inside(rows, bounds, empty_system(len(rows)), passive, twist)
        if not is_found or not np.isfinite(twist).all():  # so long that there is none
            return _forces(passive, contacts, along, sizes, n, grows) if margin == 0.0 else None
        moving = columns @ twist + drifts
        slips = np.hypot(moving[:, 1], moving[:, 2])
        beyond = (moving[:, 0] + friction * slips) / sizes + margin
        allowed = max(0.5 * margin, 0.5 * SPEED_OF_GIVING_WAY)
        wrong = np.flatnonzero(beyond > allowed)
        if not wrong.size:
            return GivesWay(twist, margin)
        steepest = np.arctan2(moving[:, 2], moving[:, 1])
        rays += [(contact, float(steepest[contact])) for contact in wrong.tolist()]
    return None


def _forces(
    passive: PassiveSet, contacts: FloatArray, along: FloatArray, sizes: FloatArray, n: int, grows: bool
) -> Stands:
    """Return the forces whose multipliers the rays in use have."""
    forces, taken = np.zeros((n, 3)), 0.0
    for label, share in zip(passive.labels[: passive.used].tolist(), passive.x[: passive.used].tolist(), strict=True):
        if grows and label == len(contacts):
            taken += share
        else:
            forces[contacts[label]] += share * along[label] / sizes[contacts[label]]
    total = float(forces[:, 0] @ sizes) + taken
    return Stands(forces / total, taken / total)
