"""Newton's method on Coulomb's law once it is known which contacts open, stick and slip: equation (5.8).

Sweeps over the contacts find the modes soon and the digits late; with the modes known, the law is a smooth system of
equations in the motion y and the forces, and a few steps solve it to rounding.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.contact.cone import steepest_tangent
from cagepose.kernels.contact.contact_set import ContactRow
from cagepose.kernels.native.kernel import kernel

CONTACT_LIMIT = 12
"""More contacts than this that carry: left to the sweeps."""
UNKNOWNS = 6 + 3 * CONTACT_LIMIT
NEWTON_STEPS = 8
STILL = 1e-14
"""In lengths of the load: after so small a change the next one is rounding, since the digits double."""
SINGULAR = 1e-11
"""Pivots below this fraction of the greatest are zero: forces of several sticking contacts need not be unique."""


OPENS, STICKS, SLIPS = 0, 1, 2
"""Codes of what a contact does."""


class NewtonRoom:
    """Room for one system of n equations; a record.

    Attributes
    ----------
    matrix
        The system, right side last.
    order
        Which unknown each column holds.
    """

    matrix: Annotated[FloatArray, UNKNOWNS, UNKNOWNS + 1]
    order: Annotated[IntArray, UNKNOWNS]


@kernel
def eliminate(room: NewtonRoom, n: int) -> None:
    """Solve the system in place by elimination with complete pivoting; undetermined unknowns are zero.

    The solution stands in the last column, in the order of ``room.order``.
    """
    m, order = room.matrix, room.order
    for k in range(n):
        order[k] = k
    rank, greatest = 0, 0.0
    for k in range(n):
        at_row, at_column, pivot = k, k, 0.0
        for i in range(k, n):
            for j in range(k, n):
                if abs(m[i, j]) > pivot:
                    at_row, at_column, pivot = i, j, abs(m[i, j])
        greatest = max(greatest, pivot)
        if pivot <= SINGULAR * greatest:
            break
        for j in range(n + 1):
            m[k, j], m[at_row, j] = m[at_row, j], m[k, j]
        for i in range(n):
            m[i, k], m[i, at_column] = m[i, at_column], m[i, k]
        order[k], order[at_column] = order[at_column], order[k]
        for i in range(k + 1, n):
            factor = m[i, k] / m[k, k]
            if factor != 0.0:
                for j in range(k, n + 1):
                    m[i, j] -= factor * m[k, j]
        rank = k + 1
    for k in range(rank, n):
        m[k, n] = 0.0
    for k in range(rank - 1, -1, -1):
        for j in range(k + 1, rank):
            m[k, n] -= m[k, j] * m[j, n]
        m[k, n] /= m[k, k]


@kernel
def number_unknowns(rows: Rows[ContactRow], n_contacts: int, y: FloatArray) -> int:
    """Number the unknowns: six of the motion, one or three forces of each contact; return how many, -1: too many."""
    n = 6
    for i in range(n_contacts):
        contact = rows[i]
        if contact.mode == SLIPS and steepest_tangent(contact, y)[0] == 0.0:
            contact.mode = STICKS  # a slip without direction
        contact.first_unknown = n
        if contact.mode != OPENS:
            n += 1 if contact.mode == SLIPS else 3
        if n > UNKNOWNS:
            return -1
    return n


@kernel
def write_system(
    rows: Rows[ContactRow], n_contacts: int, friction: float, b: FloatArray, y: FloatArray, n: int, room: NewtonRoom
) -> None:
    """Write the linear system of one step: balance of y, then one row for each velocity that is zero."""
    m = room.matrix
    for i in range(n):
        for j in range(n + 1):
            m[i, j] = 0.0
    for k in range(6):
        m[k, k] = 1.0
        m[k, n] = b[k] - y[k]
    for i in range(n_contacts):
        contact = rows[i]
        columns, forces, first = contact.columns, contact.forces, contact.first_unknown
        if contact.mode == STICKS:
            for j in range(3):
                for k in range(6):
                    m[k, first + j] = m[first + j, k] = columns[j, k]
                    m[k, n] -= columns[j, k] * forces[j]
                m[first + j, n] = -inner(columns[j], y, 6)
        elif contact.mode == SLIPS:
            slip, one, two = steepest_tangent(contact, y)
            turning = forces[0] * friction / slip
            for k in range(6):
                generator = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])
                m[first, k] = columns[0, k]
                m[k, first] = generator
                m[k, n] -= generator * forces[0]
                across = two * columns[1, k] - one * columns[2, k]
                for j in range(6):
                    m[k, j] += turning * across * (two * columns[1, j] - one * columns[2, j])
            m[first, n] = -inner(columns[0], y, 6)


@kernel
def newton_on_modes(
    rows: Rows[ContactRow], n_contacts: int, friction: float, b: FloatArray, y: FloatArray, room: NewtonRoom
) -> None:
    """Move forces and motion to the solution with the present modes, if there is one near; the caller checks it."""
    n = number_unknowns(rows, n_contacts, y)
    if n < 0:
        return
    still = STILL * length(b, 6)
    for _ in range(NEWTON_STEPS):
        write_system(rows, n_contacts, friction, b, y, n, room)
        eliminate(room, n)
        greatest = 0.0
        for place in range(n):
            change, unknown = room.matrix[place, n], room.order[place]
            greatest = max(greatest, abs(change))
            if unknown < 6:
                y[unknown] += change
        for i in range(n_contacts):
            if rows[i].mode != OPENS:
                add_changes(room, n, rows[i])
        if greatest <= still:
            break
    for i in range(n_contacts):
        contact = rows[i]
        if contact.mode == OPENS:
            for j in range(3):
                contact.forces[j] = 0.0
        elif contact.mode == SLIPS:
            slip, one, two = steepest_tangent(contact, y)
            if slip > 0.0:
                contact.forces[1] = friction * contact.forces[0] * one
                contact.forces[2] = friction * contact.forces[0] * two


@kernel
def add_changes(room: NewtonRoom, n: int, contact: ContactRow) -> None:
    """Add what the last step found to the forces of one contact."""
    for place in range(n):
        j = room.order[place] - contact.first_unknown
        if 0 <= j < (1 if contact.mode == SLIPS else 3):
            contact.forces[j] += room.matrix[place, n]
