"""Newton's method on Coulomb's law once it is known which contacts open, stick and slip: equation (5.8).

Sweeps over the contacts find the modes soon and the digits late; with the modes known, the law is a smooth system of
equations in the motion y and the forces, and a few steps solve it to rounding.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.least_squares import inner

CONTACT_LIMIT = 12
"""More contacts than this that carry: left to the sweeps."""
UNKNOWNS = 6 + 3 * CONTACT_LIMIT
NEWTON_STEPS = 8
SINGULAR = 1e-11
"""Pivots below this fraction of the greatest are zero: forces of several sticking contacts need not be unique."""


OPENS, STICKS, SLIPS = 0, 1, 2
"""Codes of what a contact does."""


class NewtonRoom(NamedTuple):
    """Room for one system.

    Attributes
    ----------
    matrix
        The system, right side last, (n, n + 1).
    order
        Which unknown each column holds, (n,).
    modes
        What each contact does, (n_contacts,).
    first
        The first unknown of each contact, (n_contacts,).
    """

    matrix: FloatArray
    order: NDArray[np.int64]
    modes: NDArray[np.int64]
    first: NDArray[np.int64]


def empty_newton_room(n_contacts: int) -> NewtonRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return NewtonRoom(
        np.zeros((UNKNOWNS, UNKNOWNS + 1)),
        np.zeros(UNKNOWNS, np.int64),
        np.zeros(n_contacts, np.int64),
        np.zeros(n_contacts, np.int64),
    )


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
def number_unknowns(columns: FloatArray, n_contacts: int, y: FloatArray, room: NewtonRoom) -> int:
    """Number the unknowns: six of the motion, one or three forces of each contact; return how many, -1: too many."""
    n = 6
    for i in range(n_contacts):
        if room.modes[i] == SLIPS and inner(columns[i, 1], y, 6) == 0.0 and inner(columns[i, 2], y, 6) == 0.0:
            room.modes[i] = STICKS  # a slip without direction
        room.first[i] = n
        if room.modes[i] != OPENS:
            n += 1 if room.modes[i] == SLIPS else 3
        if n > UNKNOWNS:
            return -1
    return n


@kernel
def write_system(
    columns: FloatArray,
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
    n: int,
    room: NewtonRoom,
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
        first = room.first[i]
        if room.modes[i] == OPENS:
            continue
        if room.modes[i] == STICKS:
            for j in range(3):
                for k in range(6):
                    m[k, first + j] = m[first + j, k] = columns[i, j, k]
                    m[k, n] -= columns[i, j, k] * forces[i, j]
                m[first + j, n] = -inner(columns[i, j], y, 6)
            continue
        v1, v2 = inner(columns[i, 1], y, 6), inner(columns[i, 2], y, 6)
        slip = math.hypot(v1, v2)
        one, two = v1 / slip, v2 / slip
        turning = forces[i, 0] * friction / slip
        for k in range(6):
            generator = columns[i, 0, k] + friction * (one * columns[i, 1, k] + two * columns[i, 2, k])
            m[first, k] = columns[i, 0, k]
            m[k, first] = generator
            m[k, n] -= generator * forces[i, 0]
            across = two * columns[i, 1, k] - one * columns[i, 2, k]
            for j in range(6):
                m[k, j] += turning * across * (two * columns[i, 1, j] - one * columns[i, 2, j])
        m[first, n] = -inner(columns[i, 0], y, 6)


@kernel
def newton_on_modes(
    columns: FloatArray,
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
    room: NewtonRoom,
) -> None:
    """Move forces and motion to the solution with the present modes, if there is one near; the caller checks it."""
    n = number_unknowns(columns, n_contacts, y, room)
    if n < 0:
        return
    for _ in range(NEWTON_STEPS):
        write_system(columns, n_contacts, friction, b, forces, y, n, room)
        eliminate(room, n)
        for place in range(n):
            change, unknown = room.matrix[place, n], room.order[place]
            if unknown < 6:
                y[unknown] += change
        for i in range(n_contacts):
            if room.modes[i] != OPENS:
                add_changes(room, n, i, forces)
    for i in range(n_contacts):
        if room.modes[i] == OPENS:
            for j in range(3):
                forces[i, j] = 0.0
        elif room.modes[i] == SLIPS:
            v1, v2 = inner(columns[i, 1], y, 6), inner(columns[i, 2], y, 6)
            slip = math.hypot(v1, v2)
            if slip > 0.0:
                forces[i, 1] = friction * forces[i, 0] * v1 / slip
                forces[i, 2] = friction * forces[i, 0] * v2 / slip


@kernel
def add_changes(room: NewtonRoom, n: int, contact: int, forces: FloatArray) -> None:
    """Add what the last step found to the forces of one contact."""
    for place in range(n):
        j = room.order[place] - room.first[contact]
        if 0 <= j < (1 if room.modes[contact] == SLIPS else 3):
            forces[contact, j] += room.matrix[place, n]
