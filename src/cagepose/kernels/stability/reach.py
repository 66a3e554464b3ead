"""How far something can grow along a direction before contacts do not balance it any more: `reach`, (5.24).

Forces in round cones that balance a load, and of which something is greatest: by duality, a linear function of a motion
that is greatest over all motions along which each contact opens, or stays, by so much at least. Each ray of a cone is a
row. Rays come in when a motion asks for them: the one that it violates most is known in closed form (5.5). Before the
last one is in, the rays span less than the cones, so that what they can balance the cones can too: a bound that comes
of it is certain.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.least_squares import WRENCH, inner, label_is_passive, length
from cagepose.kernels.algebra.linear_program import FAILED, OPTIMAL, UNBOUNDED, Program, solve_program
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.native.kernel import entry, kernel

NO_ROOM = 4
"""Beside the codes of `linear_program`: there is memory for no more rays."""
MOST_ROUNDS = 40
"""Rays come in so many times at most. Two is the median of 98 random blocks."""


class ConeRays(NamedTuple):
    """Contacts, a question, and memory for rays. Those that an answer leans on stay for the next question.

    Attributes
    ----------
    columns, friction
        Scaled wrenches of unit forces on the object along each contact's normal and two tangents, (n, 3, 6), and its
        coefficient, (n,).
    least
        How fast each contact is to open at least, (n,); -inf: it does not count.
    row
        One more row, (6,): row . x <= 1.
    projection, offset
        The motion is y = P x + offset, with a projection P, (6, 6), and (6,).
    used
        How many rays there are, and how many of them there were at first, which stay in any case, (2,).
    contacts, rays
        Of each the contact, (m,), and its wrench, (m, 6).
    rows, bounds
        Of the program, (m + 1, 6) and (m + 1,).
    motion, wrench
        y, and that of the forces which the answer leans on, (6,) each.
    """

    columns: FloatArray
    friction: FloatArray
    least: FloatArray
    row: FloatArray
    projection: FloatArray
    offset: FloatArray
    used: IntArray
    contacts: IntArray
    rays: FloatArray
    rows: FloatArray
    bounds: FloatArray
    motion: FloatArray
    wrench: FloatArray


def empty_cone_rays(columns: FloatArray, friction: FloatArray, n_rays: int) -> ConeRays:
    """Return contacts, see `ConeRays`, with memory for so many rays (plain Python)."""
    n = len(columns)
    return ConeRays(
        np.ascontiguousarray(columns),
        np.ascontiguousarray(friction),
        np.zeros(n),
        np.zeros(WRENCH),
        np.eye(WRENCH),
        np.zeros(WRENCH),
        np.zeros(2, np.int64),
        np.zeros(n_rays, np.int64),
        np.zeros((n_rays, WRENCH)),
        np.zeros((n_rays + 1, WRENCH)),
        np.zeros(n_rays + 1),
        np.zeros(WRENCH),
        np.zeros(WRENCH),
    )


@kernel
def write_rows(work: ConeRays) -> None:
    """Write the rows of the program: that of the question, and those of the rays."""
    work.bounds[0] = 1.0
    for j in range(WRENCH):
        work.rows[0, j] = work.row[j]
    for k in range(work.used[0]):
        ray = work.rays[k]
        work.bounds[k + 1] = inner(ray, work.offset, WRENCH) - work.least[work.contacts[k]]
        for j in range(WRENCH):
            work.rows[k + 1, j] = -inner(work.projection[j], ray, WRENCH)


@kernel
def add_ray(work: ConeRays, contact: int, one: float, two: float) -> bool:
    """Add the ray n + mu d of a contact, with a unit tangent d; False: there is no room."""
    at, mu, columns = work.used[0], work.friction[contact], work.columns[contact]
    if at == len(work.contacts):
        return False
    work.contacts[at] = contact
    for j in range(WRENCH):
        work.rays[at, j] = columns[0, j] + mu * (one * columns[1, j] + two * columns[2, j])
    work.used[0] = at + 1
    return True


@kernel
def add_violated(work: ConeRays, is_ray: bool, cut_from: float) -> tuple[bool, bool]:
    """Add the rays that the motion violates most, one of each contact; return (whether there are any, whether there was
    room).
    """
    n_before, size = work.used[0], length(work.motion, WRENCH)
    for contact in range(len(work.columns)):
        least, columns = work.least[contact], work.columns[contact]
        if least == -math.inf or work.friction[contact] == 0.0:
            continue
        one, two = inner(columns[1], work.motion, WRENCH), inner(columns[2], work.motion, WRENCH)
        slip = math.sqrt(one * one + two * two)
        opens = inner(columns[0], work.motion, WRENCH) - work.friction[contact] * slip
        is_violated = slip > 0.0 and (0.0 if is_ray else least) - opens > cut_from * size
        if is_violated and not add_ray(work, contact, -one / slip, -two / slip):
            return True, False
    return work.used[0] > n_before, True


@kernel
def keep_in_use(program: Program, work: ConeRays) -> None:
    """Write the wrench of the forces that a solution leans on, and drop the rays that came in and are not among them:
    of an arc of contacts each question would leave hundreds.
    """
    passive, kept = program.passive, work.used[1]
    for j in range(WRENCH):
        work.wrench[j] = 0.0
        for k in range(passive.used):
            if passive.labels[k] > 0:
                work.wrench[j] += passive.x[k] * work.rays[passive.labels[k] - 1, j]
    for k in range(kept, work.used[0]):
        if label_is_passive(passive, k + 1):
            work.contacts[kept] = work.contacts[k]
            for j in range(WRENCH):
                work.rays[kept, j] = work.rays[k, j]
            kept += 1
    work.used[0] = kept


@entry
def reach(program: Program, work: ConeRays, cut_from: float) -> int:
    """Maximise ``program.objective`` . x over x for which each contact that counts opens at y = P x + offset as fast as
    it is to, along all rays of its cone.

    Parameters
    ----------
    program
        Objective, and solution.
    work
        The question, and the rays that are known.
    cut_from
        In lengths of the motion: a cone that it violates by less is left as it is.

    Returns
    -------
    int
        OPTIMAL; UNBOUNDED, with a ray for y; INFEASIBLE; FAILED: rounding, or too many rounds; NO_ROOM.
    """
    outcome = FAILED
    program.passive.used = 0
    for _ in range(MOST_ROUNDS):
        write_rows(work)
        n_rows = work.used[0] + 1
        outcome = solve_program(work.rows[:n_rows], work.bounds[:n_rows], program)
        if outcome not in (OPTIMAL, UNBOUNDED):
            return outcome
        found = program.x if outcome == OPTIMAL else program.ray
        for j in range(WRENCH):
            work.motion[j] = inner(work.projection[j], found, WRENCH) + (work.offset[j] if outcome == OPTIMAL else 0.0)
        is_any, has_room = add_violated(work, outcome == UNBOUNDED, cut_from)
        if not has_room:
            return NO_ROOM
        if not is_any:
            break
    else:
        outcome = outcome if outcome == OPTIMAL else FAILED
    keep_in_use(program, work)
    return outcome
