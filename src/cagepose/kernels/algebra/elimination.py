"""Linear systems that may be singular: elimination with complete pivoting."""

from __future__ import annotations

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.tolerances import SINGULAR_PIVOT
from cagepose.kernels.native.kernel import kernel


@kernel
def greatest_in_row(m: FloatArray, i: int, first: int, n: int) -> float:
    """Return the greatest magnitude in one row, from one column up to, without, another."""
    most = 0.0
    for j in range(first, n):
        size = abs(m[i, j])
        if size > most:
            most = size
    return most


@kernel
def eliminate(m: FloatArray, order: IntArray, greatest_of: FloatArray, n: int) -> None:
    """Solve n equations in place; unknowns that they leave undetermined are zero.

    Parameters
    ----------
    m
        The matrix, right side last, at least (n, n + 1). Filled: the solution in the last column ...
    order
        ... in this order: which unknown each row holds, (n,).
    greatest_of
        Memory for the greatest magnitude in each row, of the columns that are left, (n,): a row that a pivot does not
        change keeps its own.
    """
    for k in range(n):
        order[k] = k
        greatest_of[k] = greatest_in_row(m, k, 0, n)
    rank, greatest = 0, 0.0
    for k in range(n):
        at_row, at_column, pivot = k, k, 0.0
        for i in range(k, n):
            if greatest_of[i] > pivot:
                at_row, pivot = i, greatest_of[i]
        greatest = max(greatest, pivot)
        if pivot <= SINGULAR_PIVOT * greatest:
            break
        while abs(m[at_row, at_column]) != pivot:
            at_column += 1
        if at_row != k:
            for j in range(n + 1):
                m[k, j], m[at_row, j] = m[at_row, j], m[k, j]
            greatest_of[at_row] = greatest_of[k]
        if at_column != k:
            for i in range(n):
                m[i, k], m[i, at_column] = m[i, at_column], m[i, k]
            order[k], order[at_column] = order[at_column], order[k]
        for i in range(k + 1, n):
            factor = m[i, k] / m[k, k]
            if factor != 0.0:
                for j in range(k, n + 1):
                    m[i, j] -= factor * m[k, j]
                greatest_of[i] = greatest_in_row(m, i, k + 1, n)
        rank = k + 1
    for k in range(rank, n):
        m[k, n] = 0.0
    for k in range(rank - 1, -1, -1):
        for j in range(k + 1, rank):
            m[k, n] -= m[k, j] * m[j, n]
        m[k, n] /= m[k, k]
