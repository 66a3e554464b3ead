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
from cagepose.kernels.algebra.linear_program import (
    FAILED,
    INFEASIBLE,
    OPTIMAL,
    UNBOUNDED,
    Program,
    solve_program,
)
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.cone import write_generator
from cagepose.kernels.native.kernel import entry, kernel

SAME_RAY = 1e-13
"""In lengths of a ray: one that is nearer to another says nothing new."""
MOST_KEPT = 3
"""Times as many rays as at first are kept."""
LITTLE = 1e3
"""In what is left as it is: by more than this no ray is violated that is there."""
NO_ROOM = 4
"""Beside the codes of `linear_program`: there is memory for no more rays."""
MOST_ROUNDS = 40
"""Rays come in so many times at most. Two is the median of 98 random blocks."""


class ConeRays(NamedTuple):
    """Contacts, a question, and memory for rays, which stay for the next questions, see `keep_in_use`.

    Attributes
    ----------
    columns, friction
        Scaled wrenches of unit forces on the object along each contact's normal and two tangents, (n, 3, 6), and its
        coefficient, (n,).
    least
        How fast each contact is to open at least, (n,); -inf: it does not count.
    row
        One more row, (6,): row . x <= 1.
    basis, offset
        The motion is y = sum x_j basis_j + offset, (6, 6) and (6,): rows of zeros leave their unknown out.
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
    basis: FloatArray
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
            work.rows[k + 1, j] = -inner(work.basis[j], ray, WRENCH)


@kernel
def is_known(work: ConeRays, contact: int, ray: FloatArray) -> bool:
    """Whether a contact has a ray already."""
    size = length(ray, WRENCH)
    for k in range(work.used[0]):
        if work.contacts[k] == contact:
            apart = 0.0
            for j in range(WRENCH):
                apart = max(apart, abs(work.rays[k, j] - ray[j]))
            if apart <= SAME_RAY * size:
                return True
    return False


@kernel
def add_violated(work: ConeRays, is_ray: bool, cut_from: float) -> tuple[bool, bool]:
    """Add the rays n + mu d that the motion violates most, one of each contact; return (whether there are any, whether
    there was room). What is violated by little may be a ray that is there, up to rounding.
    """
    n_before, size = work.used[0], length(work.motion, WRENCH)
    for contact in range(len(work.columns)):
        least, mu, columns = work.least[contact], work.friction[contact], work.columns[contact]
        if least == -math.inf or mu == 0.0:
            continue
        one, two = inner(columns[1], work.motion, WRENCH), inner(columns[2], work.motion, WRENCH)
        slip = math.sqrt(one * one + two * two)
        violated = (0.0 if is_ray else least) - inner(columns[0], work.motion, WRENCH) + mu * slip
        if slip == 0.0 or violated <= cut_from * size:
            continue
        at = work.used[0]
        if at == len(work.contacts):
            return True, False
        write_generator(columns, mu, -one / slip, -two / slip, WRENCH, work.rays[at])
        if violated > LITTLE * cut_from * size or not is_known(work, contact, work.rays[at]):
            work.contacts[at] = contact
            work.used[0] = at + 1
    return work.used[0] > n_before, True


@kernel
def write_answer(program: Program, work: ConeRays, is_ray: bool) -> None:
    """Write the motion of a solution, or of its ray, and the wrench of the forces that it leans on."""
    passive = program.passive
    for j in range(WRENCH):
        work.motion[j] = 0.0 if is_ray else work.offset[j]
        work.wrench[j] = 0.0
    for k in range(WRENCH):
        found = program.ray[k] if is_ray else program.x[k]
        for j in range(WRENCH):
            work.motion[j] += found * work.basis[k, j]
    for k in range(passive.used):
        if passive.labels[k] > 0:
            for j in range(WRENCH):
                work.wrench[j] += passive.x[k] * work.rays[passive.labels[k] - 1, j]


@kernel
def keep_in_use(program: Program, work: ConeRays) -> None:
    """Once there are many, drop the rays that came in and that the answer does not lean on: of an arc of contacts each
    question leaves hundreds. Those of the questions before are near what the next one needs.
    """
    kept = work.used[1]
    if work.used[0] <= MOST_KEPT * kept:
        return
    for k in range(kept, work.used[0]):
        if label_is_passive(program.passive, k + 1):
            work.contacts[kept] = work.contacts[k]
            for j in range(WRENCH):
                work.rays[kept, j] = work.rays[k, j]
            kept += 1
    work.used[0] = kept


@kernel
def solve_with_rays(program: Program, work: ConeRays, cut_from: float) -> int:
    """As `reach`, from the rays that are known."""
    outcome, has_answer = FAILED, False
    program.passive.used = 0
    work.motion[:] = 0.0
    work.wrench[:] = 0.0
    for _ in range(MOST_ROUNDS):
        write_rows(work)
        n_rows = work.used[0] + 1
        outcome = solve_program(work.rows[:n_rows], work.bounds[:n_rows], program)
        if outcome not in (OPTIMAL, UNBOUNDED):
            break
        write_answer(program, work, outcome == UNBOUNDED)
        has_answer = outcome == OPTIMAL
        is_any, has_room = add_violated(work, outcome == UNBOUNDED, cut_from)
        if not has_room:
            return NO_ROOM
        if not is_any:
            keep_in_use(program, work)
            return outcome
    keep_in_use(program, work)
    if outcome == INFEASIBLE:
        return INFEASIBLE
    return OPTIMAL if has_answer else FAILED


@entry
def reach(program: Program, work: ConeRays, cut_from: float) -> int:
    """Maximise ``program.objective`` . x over x for which each contact that counts opens at the motion of x as fast as
    it is to, along all rays of its cone.

    Parameters
    ----------
    program
        Objective, and solution.
    work
        The question, and the rays that are known. Filled: the motion and the wrench, of the last round that had an
        answer; zero: none had.
    cut_from
        In lengths of the motion: a cone that it violates by less is left as it is.

    Returns
    -------
    int
        OPTIMAL, be it with the rays that came in before rounding, or the number of rounds, ended it; UNBOUNDED, with a
        ray for the motion; INFEASIBLE; FAILED; NO_ROOM.
    """
    n_known = work.used[0]
    outcome = solve_with_rays(program, work, cut_from)
    if outcome == FAILED and n_known > work.used[1]:  # rays of other questions may all but depend on each other
        work.used[0] = work.used[1]
        outcome = solve_with_rays(program, work, cut_from)
    return outcome
