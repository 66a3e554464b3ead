"""Linear programs over all forces in round friction cones: `ContactCones`, by the kernels' `reach` (5.24)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.linear_program import OPTIMAL, Program
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.stability.reach import NO_ROOM, ConeRays, empty_cone_rays, reach
from cagepose.model.checks import FloatArray

Contacts = int | NDArray[np.int64]
FIRST_RAYS = 8
"""Each cone starts with so many rays, evenly spread, and cuts bring the others."""
ROOM = 4
"""There is memory for so many times more rays at first."""


class ContactCones(NamedTuple):
    """Contacts as cones of wrenches, in which lengths are divided by ``length_m``.

    Attributes
    ----------
    columns
        Wrenches of unit forces on the object along each contact's normal and two tangents, (n, 3, 6).
    friction
        Coefficient of each, (n,).
    length_m
        Metres: the longest arm.
    """

    columns: FloatArray
    friction: FloatArray
    length_m: float

    def some(self, which: NDArray[np.bool_]) -> ContactCones:
        """Return the cones of some of the contacts, (n,)."""
        return self._replace(columns=self.columns[which], friction=self.friction[which])

    def wrench(self, forces: FloatArray) -> FloatArray:
        """Return the wrench of forces (n, 3), (6,)."""
        return np.asarray(np.einsum("ij,ijk->k", forces, self.columns))


def contact_cones(normals: FloatArray, arms_m: FloatArray, friction: FloatArray) -> ContactCones:
    """Return the cones of n contacts.

    Parameters
    ----------
    normals
        Directions in which the contacts push the object, unit vectors (n, 3).
    arms_m
        Where, as seen from the centre of gravity, (n, 3), metres.
    friction
        Coefficients, (n,).
    """
    length_m = float(np.linalg.norm(arms_m, axis=1).max(initial=0.0)) or 1.0
    axes = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, axes)
    first /= np.linalg.norm(first, axis=1)[:, None]
    forces = np.stack([normals, first, np.cross(normals, first)], axis=1)
    return ContactCones(
        np.concatenate([forces, np.cross(arms_m[:, None], forces) / length_m], axis=2), friction, length_m
    )


class ConeProgram:
    """max objective . y over motions y with (ray of contact i) . y >= least_i for all of its rays n + mu d.

    Rays stay from one program to the next. A cone that a motion violates by less than ``cut_from`` of its length is
    left as it is.
    """

    def __init__(self, cones: ContactCones, cut_from: float) -> None:
        self.cut_from, self.program = cut_from, empty_record(Program)
        n, n_first = len(cones.columns), FIRST_RAYS if cones.friction.any() else 1
        self._take(empty_cone_rays(cones.columns, cones.friction, ROOM * n * n_first))
        angles = np.repeat(2.0 * np.pi * np.arange(n_first) / n_first, n)
        self.work.used[:], self.work.contacts[: len(angles)] = len(angles), np.tile(np.arange(n), n_first)
        tangents = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        across = np.einsum("ij,ijk->ik", tangents, np.tile(cones.columns[:, 1:], (n_first, 1, 1)))
        first = np.tile(cones.columns[:, 0], (n_first, 1)) + np.tile(cones.friction, n_first)[:, None] * across
        self.work.rays[: len(angles)] = first

    def _take(self, work: ConeRays) -> None:
        self.work, self._slots = work, (Slots(self.program), Slots(work))

    def greatest(
        self, objective: FloatArray, least: FloatArray, row: FloatArray | None = None, offset: FloatArray | None = None
    ) -> tuple[int, FloatArray]:
        """Return how the program ended, and y.

        Parameters
        ----------
        objective
            (6,).
        least
            Of each contact's rays, (n,); -inf: the contact does not count.
        row
            One more row, of motions without an offset: row . y <= 1, (6,).
        offset
            Of the motion beside what is free of it, see `ConeRays`, (6,).

        Returns
        -------
        int
            OPTIMAL; UNBOUNDED, with a ray for y; INFEASIBLE; FAILED: rounding, or too many rounds.
        """
        self.program.objective[:] = objective
        self.work.least[:] = least
        self.work.row[:] = 0.0 if row is None else row
        self.work.offset[:] = 0.0 if offset is None else offset
        outcome = reach(*self._slots, self.cut_from)
        while outcome == NO_ROOM:
            self._take(_with_room(self.work))
            outcome = reach(*self._slots, self.cut_from)
        return outcome, self.work.motion.copy()

    def confine(self, basis: FloatArray) -> None:
        """Let motions be sums of some only, (n, 6), n up to 6: ``objective`` and ``row`` are of their shares."""
        self.work.basis[:] = 0.0
        self.work.basis[: len(basis)] = basis

    def wrench(self) -> FloatArray:
        """Return the wrench of the forces that the last answer leans on, (6,)."""
        return self.work.wrench.copy()


def _with_room(work: ConeRays) -> ConeRays:
    """Return the same question and rays, with memory for twice as many."""
    wider, n = empty_cone_rays(work.columns, work.friction, 2 * len(work.contacts)), len(work.contacts)
    for name in ("least", "row", "basis", "offset", "used"):
        getattr(wider, name)[:] = getattr(work, name)
    wider.contacts[:n], wider.rays[:n] = work.contacts, work.rays
    return wider


def greatest_normal_force(program: ConeProgram, load: FloatArray, counts: FloatArray, contacts: Contacts) -> float:
    """Return the greatest normal force of a contact, or the greatest sum of those of several, over all forces that give
    the wrench ``load``; inf: no bound.

    ``counts``: 0 for contacts that count, -inf for others, (n,).
    """
    return _end_of_force(program, load, counts, contacts, 1.0)


def least_normal_force(program: ConeProgram, load: FloatArray, counts: FloatArray, contacts: Contacts) -> float:
    """As `greatest_normal_force`, the least one."""
    return -_end_of_force(program, load, counts, contacts, -1.0)


def _end_of_force(program: ConeProgram, load: FloatArray, counts: FloatArray, contacts: Contacts, sign: float) -> float:
    """max sign sum f_i is, by duality, the least load . y with every ray . y >= 0, and >= sign for those of the sum."""
    least = counts.copy()
    least[contacts] = sign
    outcome, motion = program.greatest(-load, least)
    return float(load @ motion) if outcome == OPTIMAL else np.inf
