"""Symmetric matrices, the leading (n, n) part of larger arrays: Cholesky's factor, and a matrix confined to what some
directions leave free.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import PassiveSet, inner
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.native.kernel import kernel


@kernel
def frobenius_norm(matrix: FloatArray, n: int) -> float:
    """Return a bound on all eigenvalues of a symmetric matrix."""
    total = 0.0
    for j in range(n):
        total += inner(matrix[j], matrix[j], n)
    return math.sqrt(total)


@kernel
def cholesky(matrix: FloatArray, least_pivot: float, n: int) -> bool:
    """Factor a symmetric matrix in place (lower half); False: a pivot is not above ``least_pivot``."""
    for j in range(n):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > least_pivot:
            return False
        matrix[j, j] = math.sqrt(pivot)
        for i in range(j + 1, n):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    return True


@kernel
def solve_lower(factor: FloatArray, vector: FloatArray, out: FloatArray, n: int) -> None:
    """Write L^-1 vector; ``out`` may be the vector."""
    for j in range(n):
        value = vector[j]
        for k in range(j):
            value -= factor[j, k] * out[k]
        out[j] = value / factor[j, j]


@kernel
def solve_upper(factor: FloatArray, vector: FloatArray, n: int) -> None:
    """Replace a vector by L^-T vector."""
    for j in range(n - 1, -1, -1):
        for k in range(j + 1, n):
            vector[j] -= factor[k, j] * vector[k]
        vector[j] /= factor[j, j]


@kernel
def remove_span(vector: FloatArray, held: PassiveSet) -> None:
    """Take the part of a vector away that lies in the span of the columns: (1 - Q Q') v."""
    for place in range(held.used):
        part = inner(held.basis[place], vector, held.n_rows)
        for k in range(held.n_rows):
            vector[k] -= part * held.basis[place, k]


@kernel
def confine(matrix: FloatArray, held: PassiveSet) -> float:
    """Replace a symmetric M by what it has along the free directions, P M P with P = 1 - Q Q'; return its size."""
    for _ in range(2):  # the rows; then, transposed, the columns
        for j in range(held.n_rows):
            remove_span(matrix[j], held)
        for j in range(held.n_rows):
            for k in range(j):
                matrix[j, k], matrix[k, j] = matrix[k, j], matrix[j, k]
    return frobenius_norm(matrix, held.n_rows)


@kernel
def add_across(matrix: FloatArray, held: PassiveSet, amount: float) -> None:
    """Add amount Q Q'. To a confined matrix: its systems are regular, and their solutions stay in the span of P."""
    for place in range(held.used):
        vector = held.basis[place]
        for j in range(held.n_rows):
            for k in range(held.n_rows):
                matrix[j, k] += amount * vector[j] * vector[k]
