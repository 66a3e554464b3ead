"""Spans of a few vectors, as orthonormal rows of ``PassiveSet.basis``: what lies in one, and what is free of it."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import PassiveSet, inner, orthogonalise
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import ORTHOGONAL_SHARE
from cagepose.kernels.native.kernel import kernel


@kernel
def write_outside(basis: PassiveSet, vector: FloatArray, least: float, out: FloatArray) -> bool:
    """Write the part of a vector outside the span; False: it is at most the fraction ``least``, and zero is written."""
    if basis.used < basis.n_rows:
        for k in range(basis.n_rows):
            out[k] = vector[k]
        size = inner(vector, vector, basis.n_rows)
        left = size
        for _ in range(2):
            before = left
            for place in range(basis.used):
                part = inner(basis.basis[place], out, basis.n_rows)
                for k in range(basis.n_rows):
                    out[k] -= part * basis.basis[place, k]
            left = inner(out, out, basis.n_rows)
            if left > ORTHOGONAL_SHARE * before:
                break
        if left > least * least * size:
            return True
    for k in range(basis.n_rows):
        out[k] = 0.0
    return False


@kernel
def extend(basis: PassiveSet, vector: FloatArray, least: float) -> None:
    """Add a vector to the span unless it lies in it, but for the fraction ``least``."""
    new = basis.basis[basis.used]
    if write_outside(basis, vector, least, new):
        size = math.sqrt(inner(new, new, basis.n_rows))
        for k in range(basis.n_rows):
            new[k] /= size
        basis.used += 1


@kernel
def write_complement(basis: PassiveSet, free: FloatArray) -> int:
    """Write a basis of all that is orthogonal to a span into the rows of ``free``, (n, n); return their number."""
    n_held = int(basis.used)
    for place in range(n_held, basis.n_rows):
        best, best_size = 0, -1.0
        for axis in range(basis.n_rows):
            left = 1.0
            for k in range(place):
                left -= basis.basis[k, axis] * basis.basis[k, axis]
            if left > best_size:
                best, best_size = axis, left
        for k in range(basis.n_rows):
            basis.basis[place, k] = 1.0 if k == best else 0.0
        orthogonalise(basis, place)
        for k in range(basis.n_rows):
            free[place - n_held, k] = basis.basis[place, k]
    return basis.n_rows - n_held


@kernel
def write_reduced(matrix: FloatArray, free: FloatArray, n_free: int, n: int, out: FloatArray) -> None:
    """Write an (n, n) matrix as it is seen by the first ``n_free`` rows of ``free``: F M F'."""
    for i in range(n_free):
        for j in range(n_free):
            out[i, j] = 0.0
            for k in range(n):
                out[i, j] += free[i, k] * inner(matrix[k], free[j], n)
