"""Linear programs over all forces in round friction cones: `ContactCones`, by cuts (5.24).

A linear function of forces that balance a load is greatest where its dual, over the six numbers of a motion, is least;
each ray of a cone is a row there. Rays are made when a motion asks for them, as in `kernels.contact.cone`: the one that
it violates most is known in closed form (5.5). Before the last one is in, the rays span less than the cones, so that
what they can balance the cones can too: a bound that comes of it is certain.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.linear_program import N_UNKNOWNS, OPTIMAL, UNBOUNDED, Program, solve_program
from cagepose.kernels.algebra.record import empty_record
from cagepose.model.checks import FloatArray
from cagepose.studies.arcs import Arcs

Contacts = int | NDArray[np.int64]
FIRST_RAYS = 8
"""Each cone starts with so many rays, evenly spread, and cuts bring the others."""
MOST_ROUNDS = 40
"""One program has so many rounds of cuts at most. Two is the median of 98 random blocks. After the last the rays lie in
the cones, too."""


class ContactCones(NamedTuple):
    """Contacts as cones of wrenches, in which lengths are divided by ``length_m``.

    Attributes
    ----------
    columns
        Wrenches of unit forces on the object along each contact's normal and two tangents, (n, 3, 6).
    friction
        Coefficient of each, (n,).
    length_m
        Metres.
    """

    columns: FloatArray
    friction: FloatArray
    length_m: float

    def some(self, which: NDArray[np.bool_ | np.int64]) -> ContactCones:
        """Return the cones of some of the contacts: which of all, (n,), or their indices."""
        return self._replace(columns=self.columns[which], friction=self.friction[which])

    def wrench(self, forces: FloatArray) -> FloatArray:
        """Return the wrench of forces (n, 3), (6,)."""
        return np.asarray(np.einsum("ij,ijk->k", forces, self.columns))


def contact_cones(
    normals: FloatArray, arms_m: FloatArray, friction: FloatArray, length_m: float | None = None
) -> ContactCones:
    """Return the cones of n contacts.

    Parameters
    ----------
    normals
        Directions in which the contacts push the object, unit vectors (n, 3).
    arms_m
        Where, as seen from the centre of gravity, (n, 3), metres.
    friction
        Coefficients, (n,).
    length_m
        That lengths are divided by; the longest arm.
    """
    if length_m is None:
        length_m = float(np.linalg.norm(arms_m, axis=1).max(initial=0.0)) or 1.0
    axes = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, axes)
    first /= np.linalg.norm(first, axis=1)[:, None]
    forces = np.stack([normals, first, np.cross(normals, first)], axis=1)
    return ContactCones(
        np.concatenate([forces, np.cross(arms_m[:, None], forces) / length_m], axis=2), friction, length_m
    )


class Rays:
    """Rays n + mu d of contacts' cones, and of those all along arcs, as rows of wrenches: they are made as motions ask
    for them.

    Attributes
    ----------
    wrenches
        Of unit normal forces with their friction, (m, 6), as `ContactCones.columns`.
    contacts
        Whose they are, (m,): indices of the cones; those of arcs have the one behind.
    """

    def __init__(self, cones: ContactCones, arcs: Arcs | None, cut_from: float) -> None:
        self.cones, self.arcs, self.cut_from = cones, arcs, cut_from
        self.contacts, self.wrenches = np.zeros(0, np.int64), np.zeros((0, N_UNKNOWNS))
        every = np.arange(len(cones.columns))
        angles = 2.0 * np.pi * np.arange(FIRST_RAYS if cones.friction.any() else 1) / FIRST_RAYS
        for angle in angles:
            self._add(every, cones, np.tile((np.cos(angle), np.sin(angle)), (len(every), 1)))

    def _add(self, contacts: NDArray[np.int64], cones: ContactCones, tangents: FloatArray) -> None:
        """Add the rays n + mu d of contacts with these cones and unit tangents d, (n, 2)."""
        rays = cones.columns[:, 0] + cones.friction[:, None] * np.einsum("ij,ijk->ik", tangents, cones.columns[:, 1:])
        self.contacts, self.wrenches = np.append(self.contacts, contacts), np.concatenate([self.wrenches, rays])

    def cut(self, motion: FloatArray, least: FloatArray) -> bool:
        """Add the rays along which a motion does the least work, one of each contact or arc, where it is less than
        ``least``, (n,), zero of arcs; False: it is nowhere less, but by ``cut_from`` of the motion.
        """
        n_before = len(self.contacts)
        if self.cones.friction.any():
            self._cut(np.arange(len(least)), self.cones, motion, least)
        if self.arcs is not None:
            there = self.arcs.deepest(motion[:3], motion[3:] / self.cones.length_m)
            cones = contact_cones(-there.normals, there.arms, there.friction, self.cones.length_m)
            self._cut(np.full(len(there.arms), len(least)), cones, motion, np.zeros(len(there.arms)))
        return len(self.contacts) > n_before

    def _cut(self, contacts: NDArray[np.int64], cones: ContactCones, motion: FloatArray, least: FloatArray) -> None:
        along = cones.columns @ motion
        slips = np.linalg.norm(along[:, 1:], axis=1)
        is_less = least + cones.friction * slips - along[:, 0] > self.cut_from * np.linalg.norm(motion)
        tangents = -along[:, 1:] / np.where(slips > 0.0, slips, 1.0)[:, None]
        self._add(contacts[is_less], cones.some(is_less), tangents[is_less])


class ConeProgram:
    """max objective . y over motions y with (ray of contact i) . y >= least_i for all of its rays n + mu d.

    Rays stay from one program to the next. A cone that a motion violates by less than ``cut_from`` of its length is
    left as it is. Contacts along ``arcs`` count in all programs, with a least of zero.
    """

    def __init__(self, cones: ContactCones, cut_from: float, arcs: Arcs | None = None) -> None:
        self.rays, self.program = Rays(cones, arcs, cut_from), empty_record(Program)

    def greatest(self, objective: FloatArray, least: FloatArray, row: FloatArray) -> tuple[int, FloatArray]:
        """Return how the program ended, and y.

        Parameters
        ----------
        objective
            (6,).
        least
            Of each contact's rays, (n,); -inf: the contact does not count.
        row
            One more row: row . y <= 1, (6,).

        Returns
        -------
        int
            OPTIMAL; UNBOUNDED, with a ray for y; INFEASIBLE; FAILED: rounding, or too many rounds.
        """
        self.program.objective[:] = objective
        self.program.passive.used = 0
        for _ in range(MOST_ROUNDS):
            rows = np.concatenate([row[None], -self.rays.wrenches])
            bounds = np.append(1.0, -np.append(least, 0.0)[self.rays.contacts])
            outcome = solve_program(rows, bounds, self.program)
            if outcome not in (OPTIMAL, UNBOUNDED):
                return outcome, np.zeros(N_UNKNOWNS)
            motion = np.array(self.program.ray if outcome == UNBOUNDED else self.program.x)
            if not self.rays.cut(motion, least if outcome == OPTIMAL else np.where(np.isfinite(least), 0.0, least)):
                break
        return outcome, motion


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
    outcome, motion = program.greatest(-load, least, np.zeros(N_UNKNOWNS))
    return float(load @ motion) if outcome == OPTIMAL else np.inf
