"""Eigenvalues of small symmetric matrices by Jacobi's rotations: right to rounding, and no library to link."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import NEGLIGIBLE_ROTATION
from cagepose.kernels.native.kernel import kernel

MOST_SWEEPS = 30


@kernel
def symmetric_eigen(matrix: FloatArray, vectors: FloatArray, n: int) -> None:
    """Diagonalise the leading (n, n) block in place; column k of ``vectors`` belongs to ``matrix[k, k]``."""
    for i in range(n):
        for j in range(n):
            vectors[i, j] = 1.0 if i == j else 0.0
    for _ in range(MOST_SWEEPS):
        off = 0.0
        for p in range(n):
            for q in range(p + 1, n):
                if abs(matrix[p, q]) <= NEGLIGIBLE_ROTATION * (abs(matrix[p, p]) + abs(matrix[q, q])):
                    continue
                off += abs(matrix[p, q])
                rotate(matrix, vectors, n, p, q)
        if off == 0.0:
            break


@kernel
def rotate(matrix: FloatArray, vectors: FloatArray, n: int, p: int, q: int) -> None:
    """Make entry (p, q) zero."""
    half = 0.5 * (matrix[q, q] - matrix[p, p]) / matrix[p, q]
    tangent = math.copysign(1.0, half) / (abs(half) + math.sqrt(half * half + 1.0))
    cosine = 1.0 / math.sqrt(tangent * tangent + 1.0)
    sine = tangent * cosine
    for k in range(n):
        one, two = matrix[k, p], matrix[k, q]
        matrix[k, p], matrix[k, q] = cosine * one - sine * two, sine * one + cosine * two
    for k in range(n):
        one, two = matrix[p, k], matrix[q, k]
        matrix[p, k], matrix[q, k] = cosine * one - sine * two, sine * one + cosine * two
        one, two = vectors[k, p], vectors[k, q]
        vectors[k, p], vectors[k, q] = cosine * one - sine * two, sine * one + cosine * two
    matrix[p, q] = matrix[q, p] = 0.0
