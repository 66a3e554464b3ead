"""Small linear programs: max f.x subject to A x <= b, with six unknowns, on the columns of non-negative least squares.

A program has an end if f is a sum of rows with multipliers that are not negative. Non-negative least squares looks for
them; what the rows in use cannot give is a ray that no row stops and along which f grows: the program is unbounded.

Else x is the shortest of the points at which the rows in use hold as equations. A row that x violates comes in: beside
the others, if it says something new, or for the one whose multiplier comes to zero first (the dual simplex method). The
rows in use are never more than needed, so a program whose solutions are many ends with a small one of them.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from cagepose.kernels.algebra.least_squares import (
    PassiveSet,
    aim,
    aim_at,
    append_column,
    clear,
    exchange_column,
    keep_above,
    length,
    rounding_scale,
    settle,
)
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import RESIDUAL_OF_OBJECTIVE, VIOLATION_OF_ROW
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

N_UNKNOWNS = 6
OPTIMAL, UNBOUNDED, INFEASIBLE, FAILED = range(4)

MOST_PIVOTS = 100
"""Programs of some hundred rows take about a dozen steps. None of 300,000 degenerate ones (small whole numbers, bounds
of zero, rows given twice) took more than 28, so there is no rule against cycles here."""


class Program:
    """One program and its solution; a record.

    Attributes
    ----------
    objective
        f.
    passive
        The rows in use: ``labels`` says which, ``x`` what the maximum gains for each unit of their bounds. The next
        program starts from these rows; from none if ``used`` is zero.
    x
        The solution; where the program is unbounded, a point that all rows allow.
    ray
        Where the program is unbounded, a direction in which f grows and no row ends.
    target
        What of f the rows can give: all, or all but the ray.
    n_pivots
        Steps of the last call.
    """

    objective: Annotated[FloatArray, N_UNKNOWNS]
    passive: PassiveSet
    x: Annotated[FloatArray, N_UNKNOWNS]
    ray: Annotated[FloatArray, N_UNKNOWNS]
    target: Annotated[FloatArray, N_UNKNOWNS]
    n_pivots: int


@kernel
def renew_rows(rows: FloatArray, bounds: FloatArray, passive: PassiveSet) -> None:
    """Take the rows in use as they are now, but those that have come to depend on others or have no bound any more."""
    n_before = passive.used
    clear(passive, N_UNKNOWNS, 1.0)
    for k in range(n_before):
        label = passive.labels[k]
        if bounds[label] < math.inf:
            append_column(passive, rows[label], label, 0.0)


@kernel
def start_from_last(rows: FloatArray, bounds: FloatArray, program: Program) -> None:
    """Keep of the rows that the last program used those that f is a sum of."""
    renew_rows(rows, bounds, program.passive)
    program.passive.terms = length(program.objective, N_UNKNOWNS)
    for k in range(N_UNKNOWNS):
        program.target[k] = program.objective[k]
    keep_above(program.passive, program.target, -RESIDUAL_OF_OBJECTIVE)


@kernel
def farthest_row(rows: FloatArray, bounds: FloatArray, vector: FloatArray, weight: float, least: float) -> int:
    """Return the row with the greatest a . vector - weight * b above ``least``; -1: none."""
    farthest, most = -1, least
    for i in range(len(rows)):
        if bounds[i] == math.inf:
            continue
        excess = -weight * bounds[i]
        for k in range(N_UNKNOWNS):
            excess += rows[i, k] * vector[k]
        if excess > most:
            farthest, most = i, excess
    return farthest


@kernel
def write_corner(bounds: FloatArray, passive: PassiveSet, x: FloatArray) -> float:
    """Write the shortest x for which the rows in use are equations: Q R^-T b; return the size of its terms."""
    n, size = passive.used, 0.0
    for j in range(N_UNKNOWNS):
        x[j] = 0.0
    for k in range(n):
        value = bounds[passive.labels[k]]
        terms = abs(value)
        for earlier in range(k):
            part = passive.triangle[k, earlier] * passive.held[earlier]
            value -= part
            terms += abs(part)
        passive.held[k] = value * passive.triangle[k, k]
        size = max(size, terms * passive.triangle[k, k])
        for j in range(N_UNKNOWNS):
            x[j] += passive.held[k] * passive.basis[k, j]
    return size


@entry
def solve_program(rows: FloatArray, bounds: FloatArray, program: Program) -> int:
    """Maximise ``program.objective`` . x subject to rows x <= bounds.

    Parameters
    ----------
    rows, bounds
        A, (n, 6), with coefficients about one, and b, (n,); a row with an infinite bound does not count.
    program
        Objective, rows to start from, and solution.

    Returns
    -------
    int
        OPTIMAL, UNBOUNDED, INFEASIBLE, or FAILED: too many steps, as rounding turns them in a circle.
    """
    heed_interrupt()
    passive, x = program.passive, program.x
    start_from_last(rows, bounds, program)
    outcome = OPTIMAL
    for pivot in range(MOST_PIVOTS):
        program.n_pivots = pivot

        # The row that lies most along what the rows in use miss of f comes in. None does: that is a ray.
        missed, scale = length(passive.residual, N_UNKNOWNS), rounding_scale(passive)
        if missed > RESIDUAL_OF_OBJECTIVE * scale:
            enters = farthest_row(
                rows, bounds, passive.residual, 0.0, RESIDUAL_OF_OBJECTIVE * missed + VIOLATION_OF_ROW * scale
            )
            if enters < 0 or not append_column(passive, rows[enters], enters, 0.0):
                outcome = UNBOUNDED
                for k in range(N_UNKNOWNS):
                    program.ray[k] = passive.residual[k]
                    program.target[k] -= passive.residual[k]
                aim_at(passive, program.target)
            settle(passive)
            continue

        # The row that x violates most comes in, beside the others or for one of them.
        terms = write_corner(bounds, passive, x)
        enters = farthest_row(rows, bounds, x, 1.0, VIOLATION_OF_ROW * terms)
        if enters < 0:
            return outcome
        if not append_column(passive, rows[enters], enters, 0.0) and not exchange_column(
            passive, rows[enters], enters, 0.0
        ):
            return INFEASIBLE
        aim(passive)
        for k in range(passive.used):
            passive.x[k] = max(passive.target[k], 0.0)
    return FAILED


def program_rows(n_rows: int) -> tuple[FloatArray, FloatArray]:
    """Return a workspace for the rows of a program (plain Python)."""
    return np.zeros((n_rows, N_UNKNOWNS)), np.zeros(n_rows)
