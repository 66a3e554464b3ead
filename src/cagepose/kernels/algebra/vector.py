"""Vectors as 3-tuples and matrices as tuples of rows: in compiled code they live in registers, an array does not."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.native.kernel import kernel

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]


@kernel
def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def plus(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def scaled(a: Vector, factor: float) -> Vector:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


@kernel
def norm(a: Vector) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def row(array: NDArray[np.float64], index: int) -> Vector:
    """Row ``index`` of an (n, 3) array."""
    return (array[index, 0], array[index, 1], array[index, 2])


@kernel
def matrix(array: NDArray[np.float64], index: int) -> Matrix:
    """Matrix ``index`` of an (n, 3, 3) array."""
    return (
        (array[index, 0, 0], array[index, 0, 1], array[index, 0, 2]),
        (array[index, 1, 0], array[index, 1, 1], array[index, 1, 2]),
        (array[index, 2, 0], array[index, 2, 1], array[index, 2, 2]),
    )


@kernel
def vector_from(array: NDArray[np.float64]) -> Vector:
    """The first three numbers of an array."""
    return (array[0], array[1], array[2])


@kernel
def matrix_from(array: NDArray[np.float64]) -> Matrix:
    """A (3, 3) array."""
    return (
        (array[0, 0], array[0, 1], array[0, 2]),
        (array[1, 0], array[1, 1], array[1, 2]),
        (array[2, 0], array[2, 1], array[2, 2]),
    )


@kernel
def times(m: Matrix, a: Vector) -> Vector:
    """m a."""
    return (dot(m[0], a), dot(m[1], a), dot(m[2], a))


@kernel
def transposed_times(m: Matrix, a: Vector) -> Vector:
    """m^T a: for a rotation, the way back."""
    return (
        m[0][0] * a[0] + m[1][0] * a[1] + m[2][0] * a[2],
        m[0][1] * a[0] + m[1][1] * a[1] + m[2][1] * a[2],
        m[0][2] * a[0] + m[1][2] * a[1] + m[2][2] * a[2],
    )


@kernel
def matrix_product(m: Matrix, n: Matrix) -> Matrix:
    """m n."""
    return (transposed_times(n, m[0]), transposed_times(n, m[1]), transposed_times(n, m[2]))
