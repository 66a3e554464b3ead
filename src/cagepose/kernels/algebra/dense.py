"""Symmetric (6, 6) matrices: Cholesky's factor, and a matrix confined to what some directions leave free."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import WRENCH_ROWS, PassiveSet, inner
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.native.kernel import kernel


@kernel
def frobenius_norm(matrix: FloatArray) -> float:
    """Return a bound on all eigenvalues of a symmetric matrix."""
    total = 0.0
    for j in range(WRENCH_ROWS):
        total += inner(matrix[j], matrix[j], WRENCH_ROWS)
    return math.sqrt(total)


@kernel
def cholesky(matrix: FloatArray, least_pivot: float) -> bool:
    """Factor a symmetric matrix in place (lower half); False: a pivot is not above ``least_pivot``."""
    for j in range(WRENCH_ROWS):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > least_pivot:
            return False
        matrix[j, j] = math.sqrt(pivot)
        for i in range(j + 1, WRENCH_ROWS):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    return True


@kernel
def solve_lower(factor: FloatArray, vector: FloatArray, out: FloatArray) -> None:
    """Write L^-1 vector; ``out`` may be the vector."""
    for j in range(WRENCH_ROWS):
        value = vector[j]
        for k in range(j):
            value -= factor[j, k] * out[k]
        out[j] = value / factor[j, j]


@kernel
def solve_upper(factor: FloatArray, vector: FloatArray) -> None:
    """Replace a vector by L^-T vector."""
    for j in range(WRENCH_ROWS - 1, -1, -1):
        for k in range(j + 1, WRENCH_ROWS):
            vector[j] -= factor[k, j] * vector[k]
        vector[j] /= factor[j, j]


@kernel
def remove_span(vector: FloatArray, held: PassiveSet) -> None:
    """Take the part of a vector away that lies in the span of the columns: (1 - Q Q') v."""
    for place in range(held.used):
        part = inner(held.basis[place], vector, WRENCH_ROWS)
        for k in range(WRENCH_ROWS):
            vector[k] -= part * held.basis[place, k]


@kernel
def confine(matrix: FloatArray, held: PassiveSet) -> float:
    """Replace a symmetric M by what it has along the free directions, P M P with P = 1 - Q Q'; return its size."""
    for _ in range(2):  # the rows; then, transposed, the columns
        for j in range(WRENCH_ROWS):
            remove_span(matrix[j], held)
        for j in range(WRENCH_ROWS):
            for k in range(j):
                matrix[j, k], matrix[k, j] = matrix[k, j], matrix[j, k]
    return frobenius_norm(matrix)


@kernel
def add_across(matrix: FloatArray, held: PassiveSet, amount: float) -> None:
    """Add amount Q Q'. To a confined matrix: its systems are regular, and their solutions stay in the span of P."""
    for place in range(held.used):
        vector = held.basis[place]
        for j in range(WRENCH_ROWS):
            for k in range(WRENCH_ROWS):
                matrix[j, k] += amount * vector[j] * vector[k]
