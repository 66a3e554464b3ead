"""Linear systems that may be singular: elimination with complete pivoting."""

from __future__ import annotations

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.native.kernel import kernel

SINGULAR = 1e-11
"""Pivots below this fraction of the greatest are zero."""


@kernel
def eliminate(m: FloatArray, order: IntArray, n: int) -> None:
    """Solve n equations in place; unknowns that they leave undetermined are zero.

    Parameters
    ----------
    m
        The matrix, right side last, at least (n, n + 1). Filled: the solution in the last column ...
    order
        ... in this order: which unknown each row holds, (n,).
    """
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
