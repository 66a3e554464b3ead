"""Small linear programs: max f.x subject to A x <= b, with six unknowns, by the dual simplex method.

Six rows make a basis: x is where they meet, and f a combination of them with multipliers that are not negative. Each
step takes in a row that x violates and drops one, until none is violated.

It starts from the corner of a box |x_k| <= M with M beyond all numbers. So every x is M x_far + x_near, two sixes of
numbers that are compared one after the other. Where f.x_far > 0 at the end, the program is unbounded, and x_far is a
ray along which it grows: no large number stands in for M, so none costs digits.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.native.kernel import entry, kernel

N_UNKNOWNS = 6
OPTIMAL, UNBOUNDED, INFEASIBLE, FAILED = range(4)

FAR_ROUNDING = 1e-11
"""A row with coefficients about one is violated at infinity if it grows by more along x_far."""
NEAR_ROUNDING = 1e-13
"""Of the terms that x is the sum of: violated by less is rounding."""
PIVOT_ROUNDING = 1e-11
"""A row of the basis that the entering row depends on by less cannot be dropped for it."""
MOST_EXCHANGES = 10
"""So many rows are exchanged before the inverse is made anew: each adds its rounding."""
SMALL_PIVOT = 1e-3
"""A smaller one would add more rounding than most."""
STEEP_PIVOTS = 40
"""So many steps take in the row that is violated most; then it is the first one (Bland), which cannot cycle."""
MOST_PIVOTS = 400
"""The method is finite; programs of some hundred rows take about a dozen steps."""


class ProgramRoom:
    """The state of one program; a record.

    Attributes
    ----------
    basis
        Which rows meet at x: 0 to n - 1, then x_k <= M, then -x_k <= M. -1 in the first: start from the corner of the
        box.
    matrix, inverse
        The rows of the basis, and its inverse.
    objective, multipliers
        f, and its coefficients over the rows of the basis: what the maximum gains for each unit of b.
    x_near, x_far, step
        The corner, a ray where the program is unbounded (else what the program leaves open), and coefficients of the
        row that enters.
    reach
        Size of the terms that x_near is the sum of: its rounding is about 1e-16 of this.
    n_pivots, n_exchanges
        Steps of the last call, and since the inverse was made anew.
    """

    basis: Annotated[IntArray, N_UNKNOWNS]
    matrix: Annotated[FloatArray, N_UNKNOWNS, N_UNKNOWNS]
    inverse: Annotated[FloatArray, N_UNKNOWNS, N_UNKNOWNS]
    objective: Annotated[FloatArray, N_UNKNOWNS]
    multipliers: Annotated[FloatArray, N_UNKNOWNS]
    x_near: Annotated[FloatArray, N_UNKNOWNS]
    x_far: Annotated[FloatArray, N_UNKNOWNS]
    step: Annotated[FloatArray, N_UNKNOWNS]
    reach: float
    n_pivots: int
    n_exchanges: int


@kernel
def coefficient(rows: FloatArray, row_index: int, k: int) -> float:
    """Return coefficient ``k`` of a row, those of the box among them."""
    beyond = row_index - len(rows)
    if beyond < 0:
        inside: float = rows[row_index, k]
        return inside
    if beyond == k:
        return 1.0
    return -1.0 if beyond == k + N_UNKNOWNS else 0.0


@kernel
def invert(room: ProgramRoom) -> bool:
    """Write the inverse of the basis (Gauss and Jordan, with row exchanges); False: its rows depend on each other."""
    work, inverse = room.matrix, room.inverse
    for i in range(N_UNKNOWNS):
        for k in range(N_UNKNOWNS):
            inverse[i, k] = 1.0 if i == k else 0.0
    for column in range(N_UNKNOWNS):
        best = column
        for i in range(column + 1, N_UNKNOWNS):
            if abs(work[i, column]) > abs(work[best, column]):
                best = i
        if abs(work[best, column]) < 1e-14:
            return False
        if best != column:
            for k in range(N_UNKNOWNS):
                work[best, k], work[column, k] = work[column, k], work[best, k]
                inverse[best, k], inverse[column, k] = inverse[column, k], inverse[best, k]
        scale = 1.0 / work[column, column]
        for k in range(N_UNKNOWNS):
            work[column, k] *= scale
            inverse[column, k] *= scale
        for i in range(N_UNKNOWNS):
            part = work[i, column]
            if i != column and part != 0.0:
                for k in range(N_UNKNOWNS):
                    work[i, k] -= part * work[column, k]
                    inverse[i, k] -= part * inverse[column, k]
    return True


@kernel
def factorise(rows: FloatArray, bounds: FloatArray, room: ProgramRoom) -> bool:
    """Invert the basis and find its corner; False: its rows depend on each other."""
    for i in range(N_UNKNOWNS):
        for k in range(N_UNKNOWNS):
            room.matrix[i, k] = coefficient(rows, room.basis[i], k)
    room.n_exchanges = 0
    if not invert(room):
        return False
    find_corner(len(rows), bounds, room)
    return True


@kernel
def find_corner(n_rows: int, bounds: FloatArray, room: ProgramRoom) -> None:
    """Write x and the multipliers that belong to the inverse of the basis."""
    room.reach = 0.0
    for k in range(N_UNKNOWNS):
        near, far, multiplier, reach = 0.0, 0.0, 0.0, 0.0
        for i in range(N_UNKNOWNS):
            if room.basis[i] >= n_rows:
                far += room.inverse[k, i]
            else:
                part = room.inverse[k, i] * bounds[room.basis[i]]
                near += part
                reach += abs(part)
            multiplier += room.objective[i] * room.inverse[i, k]
        room.x_near[k], room.x_far[k], room.multipliers[k] = near, far, multiplier
        room.reach = max(room.reach, reach)


@kernel
def exchange(rows: FloatArray, bounds: FloatArray, room: ProgramRoom, enters: int, leaves: int) -> bool:
    """Take a row into the basis in the place of another; ``room.step`` holds its coefficients over the basis.

    The inverse is only brought up to date; False: it was made anew, and the rows depend on each other.
    """
    room.basis[leaves] = enters
    if room.n_exchanges >= MOST_EXCHANGES or abs(room.step[leaves]) < SMALL_PIVOT:
        return factorise(rows, bounds, room)
    room.n_exchanges += 1
    for k in range(N_UNKNOWNS):
        room.inverse[k, leaves] /= room.step[leaves]
        for i in range(N_UNKNOWNS):
            if i != leaves:
                room.inverse[k, i] -= room.step[i] * room.inverse[k, leaves]
    find_corner(len(rows), bounds, room)
    return True


@kernel
def start_at_corner(n_rows: int, room: ProgramRoom) -> None:
    for k in range(N_UNKNOWNS):
        room.basis[k] = n_rows + k if room.objective[k] >= 0.0 else n_rows + N_UNKNOWNS + k


@kernel
def is_a_start(rows: FloatArray, bounds: FloatArray, room: ProgramRoom) -> bool:
    """Whether the basis of the last program serves this one: f is still a combination of its rows."""
    if room.basis[0] < 0 or not factorise(rows, bounds, room):
        return False
    least = 0.0
    for i in range(N_UNKNOWNS):
        least = min(least, room.multipliers[i])
    return least >= -PIVOT_ROUNDING


@kernel
def is_open(n_rows: int, room: ProgramRoom) -> bool:
    """Whether x lies at infinity: a row of the box is in the basis."""
    last = 0
    for i in range(N_UNKNOWNS):
        last = max(last, room.basis[i])
    return last >= n_rows


@kernel
def violated_row(rows: FloatArray, bounds: FloatArray, room: ProgramRoom, takes_first: bool) -> int:
    """Return the row that x violates most, at infinity before nearby; or the first one; -1: none."""
    n_rows = len(rows)
    x = room.x_near
    open_end = is_open(n_rows, room)
    worst, worst_far, worst_near = -1, 0.0, 0.0
    for i in range(n_rows):
        near, far = -bounds[i], 0.0
        for k in range(N_UNKNOWNS):
            near += rows[i, k] * x[k]
        if open_end:
            for k in range(N_UNKNOWNS):
                far += rows[i, k] * room.x_far[k]
            if bounds[i] == math.inf or far < -FAR_ROUNDING:
                continue
            far = far if far > FAR_ROUNDING else 0.0
        if far == 0.0 and near <= NEAR_ROUNDING * room.reach:
            continue
        if worst < 0 or far > worst_far or (far == worst_far and near > worst_near):
            worst, worst_far, worst_near = i, far, near
            if takes_first:
                return worst
    if not open_end:
        return worst
    for k in range(N_UNKNOWNS):
        for side in range(2):
            sign = 1.0 - 2.0 * side
            far, near = sign * room.x_far[k] - 1.0, sign * x[k]
            if far < -FAR_ROUNDING or (far <= FAR_ROUNDING and near <= NEAR_ROUNDING * room.reach):
                continue
            far = far if far > FAR_ROUNDING else 0.0
            if worst < 0 or far > worst_far or (far == worst_far and near > worst_near):
                worst, worst_far, worst_near = n_rows + k + N_UNKNOWNS * side, far, near
                if takes_first:
                    return worst
    return worst


@kernel
def leaving_place(rows: FloatArray, room: ProgramRoom, enters: int, takes_first: bool) -> int:
    """Return the place in the basis whose multiplier comes to zero first as the entering row's grows; -1: none."""
    least = math.inf
    for i in range(N_UNKNOWNS):
        part = 0.0
        for k in range(N_UNKNOWNS):
            part += coefficient(rows, enters, k) * room.inverse[k, i]
        room.step[i] = part
        if part > PIVOT_ROUNDING:
            least = min(least, max(room.multipliers[i], 0.0) / part)
    leaves = -1
    for i in range(N_UNKNOWNS):
        if room.step[i] <= PIVOT_ROUNDING or max(room.multipliers[i], 0.0) / room.step[i] > least + PIVOT_ROUNDING:
            continue
        if (
            leaves < 0
            or (takes_first and room.basis[i] < room.basis[leaves])
            or (not takes_first and room.step[i] > room.step[leaves])
        ):
            leaves = i
    return leaves


@entry
def solve_program(rows: FloatArray, bounds: FloatArray, room: ProgramRoom) -> int:
    """Maximise ``room.objective`` . x subject to rows x <= bounds; the solution is ``room.x_near``.

    Parameters
    ----------
    rows, bounds
        A, (n, 6), with coefficients about one, and b, (n,); a row with an infinite bound does not count.
    room
        Objective, first basis and solution. Where x_far is not zero, x_near is only the end of a ray: see
        `come_near`.

    Returns
    -------
    int
        OPTIMAL, UNBOUNDED, INFEASIBLE, or FAILED: too many steps, or a basis that rounding made singular.
    """
    room.n_pivots = 0
    if not is_a_start(rows, bounds, room):
        start_at_corner(len(rows), room)
        factorise(rows, bounds, room)
    for pivot in range(MOST_PIVOTS):
        room.n_pivots = pivot
        takes_first = pivot >= STEEP_PIVOTS
        enters = violated_row(rows, bounds, room, takes_first)
        if enters < 0 and room.n_exchanges > 0:  # look again, without the rounding of the exchanges
            if not factorise(rows, bounds, room):
                return FAILED
            enters = violated_row(rows, bounds, room, takes_first)
        if enters < 0:
            growth = 0.0
            for k in range(N_UNKNOWNS):
                growth += room.objective[k] * room.x_far[k]
            return UNBOUNDED if growth > FAR_ROUNDING else OPTIMAL
        leaves = leaving_place(rows, room, enters, takes_first)
        if leaves < 0:
            return INFEASIBLE
        if not exchange(rows, bounds, room, enters, leaves):
            return FAILED
    return FAILED


@kernel
def come_near(rows: FloatArray, bounds: FloatArray, room: ProgramRoom) -> None:
    """Where directions are left open, go along x_far only until every row holds."""
    amount = 0.0
    for row_index in range(len(rows)):
        if bounds[row_index] == math.inf:
            continue
        far, near = 0.0, -bounds[row_index]
        for k in range(N_UNKNOWNS):
            far += rows[row_index, k] * room.x_far[k]
            near += rows[row_index, k] * room.x_near[k]
        if far < -FAR_ROUNDING and near > 0.0:
            amount = max(amount, -near / far)
    for k in range(N_UNKNOWNS):
        room.x_near[k] += amount * room.x_far[k]


@entry
def extents(rows: FloatArray, bounds: FloatArray, room: ProgramRoom, least: FloatArray, greatest: FloatArray) -> int:
    """Write the least and greatest value of each unknown, (6,) each, -inf and inf where there is none.

    Returns OPTIMAL, or INFEASIBLE or FAILED of the first program that was.
    """
    for sense in range(2):
        sign = 1.0 - 2.0 * sense
        for k in range(N_UNKNOWNS):
            for other in range(N_UNKNOWNS):
                room.objective[other] = sign if other == k else 0.0
            room.basis[0] = -1
            outcome = solve_program(rows, bounds, room)
            if outcome != OPTIMAL and outcome != UNBOUNDED:
                return outcome
            value = sign * math.inf if outcome == UNBOUNDED else room.x_near[k]
            if sense == 0:
                greatest[k] = value
            else:
                least[k] = value
    return OPTIMAL


def program_rows(n_rows: int) -> tuple[FloatArray, FloatArray]:
    """Return room for the rows of a program (plain Python)."""
    return np.zeros((n_rows, N_UNKNOWNS)), np.zeros(n_rows)
