"""Onset of motion with Coulomb friction as a linear complementarity problem, by Lemke's method: where sweeps go round.

Each round cone is replaced by a pyramid with four sides, one of them along the slip. That is the problem of Stewart and
Trinkle (1996), for which Lemke's method ends in a solution but for degenerate ones; with the sides turned to the slip
that came out, and Newton's method on the modes that show, the cones are round again. What it finds is checked by the
caller; that it finds nothing proves nothing.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.cone import steepest_tangent
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.native.kernel import kernel

PIVOTED_LIMIT = 16
"""More contacts than this are left to the sweeps."""
SIDES = 4
"""Of a pyramid; a contact with friction has a normal force, that many tangential ones and a slip speed."""
UNKNOWNS = (2 + SIDES) * PIVOTED_LIMIT
LEAST_PIVOT = 1e-11
"""In lengths of the columns squared. A smaller number is rounding."""
APART = 1e-10
"""In lengths of the load: the right sides are changed by up to so much, each by another share, so that no two
unknowns reach zero at once."""
GOLDEN = 0.6180339887498949
"""Its multiples, without their whole part, are spread evenly."""


class PivotWorkspace:
    """Memory for one problem; a record.

    Attributes
    ----------
    dictionary
        The basic unknowns as functions of the others, of which the last but one is Lemke's, and of the right side.
    basic, other
        Which unknown each row and each column is: 0 to n - 1 are the left sides of the inequalities, n to 2 n - 1 what
        is complementary to them, and 2 n is Lemke's.
    firsts
        The first unknown of each contact; -1: it does not count.
    turned_to, sides
        The motion to whose slip pyramids are turned, and a side of each contact's, in its tangents: along that slip.
    """

    dictionary: Annotated[FloatArray, UNKNOWNS, UNKNOWNS + 2]
    basic: Annotated[IntArray, UNKNOWNS]
    other: Annotated[IntArray, UNKNOWNS + 1]
    firsts: Annotated[IntArray, PIVOTED_LIMIT]
    turned_to: ScaledVector
    sides: Annotated[FloatArray, PIVOTED_LIMIT, 2]


@kernel
def number_pivoted(contacts: ContactSet, work: PivotWorkspace) -> int:
    """Number the unknowns, and turn each pyramid; return how many, -1: too many."""
    n = 0
    if contacts.used[0] > PIVOTED_LIMIT:
        return -1
    for i in range(contacts.used[0]):
        work.firsts[i] = n if contacts.states[i].counts else -1
        _, work.sides[i, 0], work.sides[i, 1] = steepest_tangent(contacts, i, work.turned_to)
        if contacts.states[i].counts:
            n += 1 if is_smooth(contacts, i) else 2 + SIDES
    return n


@kernel
def n_generators(contacts: ContactSet, i: int) -> int:
    """Return how many forces a contact has: along its normal, and along the sides of its pyramid."""
    return 1 if is_smooth(contacts, i) else 1 + SIDES


@kernel
def side_of(i: int, which: int, work: PivotWorkspace) -> tuple[float, float]:
    """Return a side of a contact's pyramid in its tangents: ``which`` from 1 to `SIDES`, opposite ones in pairs."""
    one, two, sign = work.sides[i, 0], work.sides[i, 1], 1.0 if which % 2 == 1 else -1.0
    return (sign * one, sign * two) if which <= 2 else (-sign * two, sign * one)


@kernel
def generator_at(contacts: ContactSet, i: int, which: int, k: int, work: PivotWorkspace) -> float:
    """Return one number of a contact's force: the normal one, or one along a side of its pyramid."""
    columns = contacts.rows[i].columns
    if which == 0:
        return float(columns[0, k])
    one, two = side_of(i, which, work)
    return float(one * columns[1, k] + two * columns[2, k])


@kernel
def drift_at(contacts: ContactSet, i: int, which: int, work: PivotWorkspace) -> float:
    """Return the drift of a contact along one of its forces."""
    drift = contacts.rows[i].drift
    if which == 0:
        return float(drift[0])
    one, two = side_of(i, which, work)
    return float(one * drift[1] + two * drift[2])


@kernel
def write_dictionary(contacts: ContactSet, friction: float, b: FloatArray, n: int, work: PivotWorkspace) -> None:
    """Write the problem: the left sides as functions of forces and slip speeds, with Lemke's unknown added to all."""
    m, size = work.dictionary, length(b, contacts.n_freedoms)
    for row in range(n):
        for column in range(n):
            m[row, column] = 0.0
        m[row, n] = 1.0
        m[row, n + 1] = APART * size * ((row + 1) * GOLDEN % 1.0)
        work.basic[row], work.other[row] = row, n + row
    work.other[n] = 2 * n
    for i in range(contacts.used[0]):
        first = work.firsts[i]
        for which in range(n_generators(contacts, i) if first >= 0 else 0):
            row = first + which
            m[row, n + 1] -= drift_at(contacts, i, which, work)
            # a contact does not close, and no side of its pyramid slips faster than its slip speed
            for k in range(contacts.n_freedoms):
                mine = generator_at(contacts, i, which, k, work)
                m[row, n + 1] -= mine * b[k]
                for j in range(contacts.used[0]):
                    for of_j in range(n_generators(contacts, j) if work.firsts[j] >= 0 else 0):
                        m[row, work.firsts[j] + of_j] += mine * generator_at(contacts, j, of_j, k, work)
            # friction stays within its pyramid
            if which > 0:
                speed = first + 1 + SIDES
                m[row, speed] += 1.0
                m[speed, row] -= 1.0
                m[speed, first] = friction


@kernel
def exchange(row: int, column: int, n: int, work: PivotWorkspace) -> None:
    """Exchange a basic unknown and another one."""
    m = work.dictionary
    inverse = 1.0 / m[row, column]
    for k in range(n + 2):
        if k != column:
            m[row, k] *= -inverse
    m[row, column] = inverse
    for i in range(n):
        share = m[i, column]
        if i == row or share == 0.0:
            continue
        m[i, column] = 0.0
        for k in range(n + 2):
            m[i, k] += share * m[row, k]
    work.basic[row], work.other[column] = work.other[column], work.basic[row]


@kernel
def first_to_vanish(column: int, n: int, work: PivotWorkspace) -> int:
    """Return the row whose unknown is the first to become zero as that of a column grows, Lemke's if it is among them;
    -1: none does.
    """
    m, found, least = work.dictionary, -1, 0.0
    for row in range(n):
        if m[row, column] >= -LEAST_PIVOT:
            continue
        amount = -m[row, n + 1] / m[row, column]
        if found < 0 or amount < least or (amount == least and work.basic[row] == 2 * n):
            found, least = row, amount
    return found


@kernel
def solves_by_pivots(n: int, work: PivotWorkspace) -> bool:
    """Whether Lemke's method ends in a solution of the problem in the dictionary."""
    m, row = work.dictionary, 0
    for k in range(1, n):
        if m[k, n + 1] < m[row, n + 1]:
            row = k
    if m[row, n + 1] >= 0.0:
        return True
    column = n
    for _ in range(8 * n):
        left = work.basic[row]
        exchange(row, column, n, work)
        if left == 2 * n:
            return True
        complement = left + n if left < n else left - n
        for k in range(n + 1):
            if work.other[k] == complement:
                column = k
        row = first_to_vanish(column, n, work)
        if row < 0:
            return False
    return False


@kernel
def pivot_to_forces(contacts: ContactSet, friction: float, b: FloatArray, work: PivotWorkspace) -> bool:
    """Write the forces of the problem with pyramids that are turned to the slip of ``work.turned_to``; False: none were
    found.
    """
    n = number_pivoted(contacts, work)
    if n <= 0:
        return False
    write_dictionary(contacts, friction, b, n, work)
    if not solves_by_pivots(n, work):
        return False
    for i in range(contacts.used[0]):
        for j in range(3):
            contacts.states[i].forces[j] = 0.0
    for row in range(n):
        unknown, force = work.basic[row] - n, max(work.dictionary[row, n + 1], 0.0)
        for i in range(contacts.used[0] if unknown >= 0 else 0):
            which, forces = unknown - work.firsts[i], contacts.states[i].forces
            if work.firsts[i] < 0 or not 0 <= which < n_generators(contacts, i):
                continue
            if which == 0:
                forces[0] = force
                continue
            one, two = side_of(i, which, work)
            forces[1] += force * one
            forces[2] += force * two
    return True
