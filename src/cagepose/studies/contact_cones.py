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
        self.cones, self.cut_from = cones, cut_from
        self.contacts = np.zeros(0, np.int64)
        self.rays = np.zeros((0, N_UNKNOWNS))
        self.program = empty_record(Program)
        indices = np.arange(len(cones.columns))
        angles = 2.0 * np.pi * np.arange(FIRST_RAYS if cones.friction.any() else 1) / FIRST_RAYS
        for angle in angles:
            self._add(indices, np.tile((np.cos(angle), np.sin(angle)), (len(indices), 1)))

    def _add(self, contacts: NDArray[np.int64], tangents: FloatArray) -> None:
        """Add the rays n + mu d of contacts, with unit tangents d, (n, 2)."""
        columns = self.cones.columns[contacts]
        rays = columns[:, 0] + self.cones.friction[contacts, None] * np.einsum("ij,ijk->ik", tangents, columns[:, 1:])
        self.contacts, self.rays = np.append(self.contacts, contacts), np.concatenate([self.rays, rays])

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
            rows, bounds = np.concatenate([row[None], -self.rays]), np.append(1.0, -least[self.contacts])
            outcome = solve_program(rows, bounds, self.program)
            if outcome not in (OPTIMAL, UNBOUNDED):
                return outcome, np.zeros(N_UNKNOWNS)
            motion = np.array(self.program.ray if outcome == UNBOUNDED else self.program.x)
            if not self._cut(motion, least if outcome == OPTIMAL else np.where(np.isfinite(least), 0.0, least)):
                break
        return outcome, motion

    def _cut(self, motion: FloatArray, least: FloatArray) -> bool:
        """Add the rays that a motion violates most, one of each contact; False: it violates none."""
        if not self.cones.friction.any():
            return False
        along = self.cones.columns @ motion
        slips = np.linalg.norm(along[:, 1:], axis=1)
        excess = least + self.cones.friction * slips - along[:, 0]
        cut = np.flatnonzero((excess > self.cut_from * np.linalg.norm(motion)) & (slips > 0.0))
        self._add(cut, -along[cut, 1:] / slips[cut, None])
        return len(cut) > 0


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
