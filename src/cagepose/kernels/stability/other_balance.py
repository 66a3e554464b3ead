"""Whether another balance of the same contacts may stop a motion to second order: `may_be_stopped`, equation (5.38).

Where contacts share the load in many ways, each way has a curvature of its own along a motion, and one that is positive
stops it. So a rest is unstable along a motion if the greatest of them is negative,

    max over f >= 0, A f = b of  sum f_i k_i   =   min over z with A^T z >= k of  b . z .
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import inner
from cagepose.kernels.algebra.linear_program import N_UNKNOWNS, OPTIMAL, Program, solve_program
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import vector_from
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth
from cagepose.kernels.contact.curvature import (
    add_face_curvature,
    add_sticking_curvature,
    clear_matrix,
    curvature_along,
)
from cagepose.kernels.contact.metric import Frame, ScaledVector
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.contact_status import ContactStatus
from cagepose.kernels.stability.tolerances import RESIDUAL_OF_ROW

MOST_FORCES = 96
"""One program has at most so many forces. A contact that sticks has three: its normal force, and those along its face.
"""


class OtherBalance:
    """Memory for one question; a record.

    Attributes
    ----------
    rows, bounds
        -A^T and -k of the forces that may act, k times the size of the scene.
    curvature
        What one force adds to S.
    twist, least
        The motion, of length one, and the curvature along it with the forces that the contacts have.
    program
        The linear program in z.
    """

    rows: Annotated[FloatArray, MOST_FORCES, N_UNKNOWNS]
    bounds: Annotated[FloatArray, MOST_FORCES]
    curvature: Annotated[FloatArray, N_UNKNOWNS, N_UNKNOWNS]
    twist: ScaledVector
    least: float
    program: Program


@kernel
def n_forces(contacts: ContactSet, i: int, friction: float) -> int:
    """Return how many forces a contact may have: one that slips at its limit only its normal one is asked for; one that
    carries nothing now may stick where it does.
    """
    state = contacts.states[i]
    sticks = state.is_sticking or (state.forces[0] == 0.0 and friction > 0.0 and not is_smooth(contacts, i))
    return 3 if sticks else 1


@kernel
def curvature_of(
    contacts: ContactSet,
    i: int,
    which: int,
    friction: float,
    frame: Frame,
    curved: bool,
    size_m: float,
    work: OtherBalance,
) -> float:
    """Return k of the normal (``which`` 0) or of a tangential force of a contact, times the size."""
    clear_matrix(work.curvature, contacts.n_freedoms)
    if n_forces(contacts, i, friction) == 3:
        force = vector_from(contacts.rows[i].directions[which])
        add_sticking_curvature(contacts, i, force, frame, curved, work.curvature)
    else:
        add_face_curvature(contacts, i, 1.0, frame, curved, work.curvature)
    return curvature_along(work.curvature, work.twist, contacts.n_freedoms) * size_m


@kernel
def add_row(contacts: ContactSet, i: int, which: int, sign: float, k: float, n: int, work: OtherBalance) -> None:
    """Write row n for one force, along its direction or (``sign`` -1) against it."""
    for axis in range(N_UNKNOWNS):
        work.rows[n, axis] = -sign * contacts.rows[i].columns[which, axis]
    work.bounds[n] = -sign * k


@kernel
def add_lacking(
    contacts: ContactSet,
    statuses: Rows[ContactStatus],
    friction: float,
    frame: Frame,
    curved: bool,
    size_m: float,
    n: int,
    work: OtherBalance,
) -> int:
    """Add the row that the program's z violates most; return how many there are then, the same number if none does."""
    worst, contact, force, way = RESIDUAL_OF_ROW, -1, 0, 1.0
    for i in range(contacts.used[0]):
        if not statuses[i].is_equality:
            continue
        for which in range(n_forces(contacts, i, friction)):
            bend = curvature_of(contacts, i, which, friction, frame, curved, size_m, work)
            lacks = bend - inner(contacts.rows[i].columns[which], work.program.x, N_UNKNOWNS)
            sign = -1.0 if which > 0 and lacks < 0.0 else 1.0
            if sign * lacks > worst * (1.0 + abs(bend)):
                worst, contact, force, way = sign * lacks / (1.0 + abs(bend)), i, which, sign
    if contact < 0:
        return n
    bend = curvature_of(contacts, contact, force, friction, frame, curved, size_m, work)
    add_row(contacts, contact, force, way, bend, n, work)
    return n + 1


@kernel
def may_be_stopped(
    contacts: ContactSet,
    statuses: Rows[ContactStatus],
    friction: float,
    flat: float,
    frame: Frame,
    curved: bool,
    size_m: float,
    work: OtherBalance,
) -> bool:
    """Whether some balance stops the motion ``work.twist``, or it is not known; a curvature of ``flat`` is rounding.

    What friction may be is not asked: with more than there is, more is stopped. The program begins with the forces that
    the contacts have; others come in as its solution violates what they ask.
    """
    if contacts.n_freedoms != N_UNKNOWNS:
        return True  # the programs are of one body
    n, now = 0, 0.0
    for axis in range(N_UNKNOWNS):
        work.program.objective[axis] = 0.0
    for place in range(MOST_FORCES):
        work.bounds[place] = math.inf
    for i in range(contacts.used[0]):
        forces = contacts.states[i].forces
        if not statuses[i].is_equality or forces[0] == 0.0:
            continue
        if n + 3 > MOST_FORCES:
            return True
        for which in range(n_forces(contacts, i, friction)):
            bend = curvature_of(contacts, i, which, friction, frame, curved, size_m, work)
            now += forces[which] * bend
            add_row(contacts, i, which, math.copysign(1.0, forces[which]), bend, n, work)
            n += 1
            for axis in range(N_UNKNOWNS):
                work.program.objective[axis] -= contacts.rows[i].columns[which, axis] * forces[which]
    work.program.passive.used = 0
    while n < MOST_FORCES:
        if solve_program(work.rows, work.bounds, work.program) != OPTIMAL:
            return True  # contacts that press against each other without a load
        greatest = -inner(work.program.objective, work.program.x, N_UNKNOWNS)
        if (greatest - now) / size_m + work.least >= -flat:
            return True  # more rows make it greater
        more = add_lacking(contacts, statuses, friction, frame, curved, size_m, n, work)
        if more == n:
            return False
        n = more
    return True
