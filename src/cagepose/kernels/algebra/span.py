"""Spans in six dimensions, as orthonormal rows of ``PassiveSet.basis``: what lies in one, and what is free of it."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import WRENCH_ROWS, PassiveSet, inner, orthogonalise
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import ORTHOGONAL_SHARE
from cagepose.kernels.native.kernel import kernel


@kernel
def write_outside(basis: PassiveSet, vector: FloatArray, least: float, out: FloatArray) -> bool:
    """Write the part of a vector outside the span; False: it is at most the fraction ``least``, and zero is written."""
    if basis.used < WRENCH_ROWS:
        for k in range(WRENCH_ROWS):
            out[k] = vector[k]
        size = inner(vector, vector, WRENCH_ROWS)
        left = size
        for _ in range(2):
            before = left
            for place in range(basis.used):
                part = inner(basis.basis[place], out, WRENCH_ROWS)
                for k in range(WRENCH_ROWS):
                    out[k] -= part * basis.basis[place, k]
            left = inner(out, out, WRENCH_ROWS)
            if left > ORTHOGONAL_SHARE * before:
                break
        if left > least * least * size:
            return True
    for k in range(WRENCH_ROWS):
        out[k] = 0.0
    return False


@kernel
def extend(basis: PassiveSet, vector: FloatArray, least: float) -> None:
    """Add a vector to the span unless it lies in it, but for the fraction ``least``."""
    new = basis.basis[basis.used]
    if write_outside(basis, vector, least, new):
        size = math.sqrt(inner(new, new, WRENCH_ROWS))
        for k in range(WRENCH_ROWS):
            new[k] /= size
        basis.used += 1


@kernel
def write_complement(basis: PassiveSet, free: FloatArray) -> int:
    """Write a basis of all that is orthogonal to a span into the rows of ``free``, (6, 6); return their number."""
    n_held = int(basis.used)
    for place in range(n_held, WRENCH_ROWS):
        best, best_size = 0, -1.0
        for axis in range(WRENCH_ROWS):
            left = 1.0
            for k in range(place):
                left -= basis.basis[k, axis] * basis.basis[k, axis]
            if left > best_size:
                best, best_size = axis, left
        for k in range(WRENCH_ROWS):
            basis.basis[place, k] = 1.0 if k == best else 0.0
        orthogonalise(basis, place)
        for k in range(WRENCH_ROWS):
            free[place - n_held, k] = basis.basis[place, k]
    return WRENCH_ROWS - n_held


@kernel
def write_reduced(matrix: FloatArray, free: FloatArray, n_free: int, out: FloatArray) -> None:
    """Write a (6, 6) matrix as it is seen by the first ``n_free`` rows of ``free``: F M F'."""
    for i in range(n_free):
        for j in range(n_free):
            out[i, j] = 0.0
            for k in range(WRENCH_ROWS):
                out[i, j] += free[i, k] * inner(matrix[k], free[j], WRENCH_ROWS)
