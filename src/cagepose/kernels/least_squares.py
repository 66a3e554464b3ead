"""Non-negative least squares by the active-set method of Lawson and Hanson: min 1/2 |A x - b|^2 + c.x, x >= 0.

Columns with x > 0 are "passive". Their orthonormal basis is kept by Gram-Schmidt, each column made orthogonal twice,
which leaves it orthogonal to rounding; normal equations would lose half of the digits. A column enters only if it
reduces the residual, so it has a part outside the span of the passive ones: dependent columns never meet in one basis,
and degenerate sets are safe. At most as many columns are passive as there are rows.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import entry_kernel, kernel

DEPENDENT = 1e-10
"""A column whose part outside the span of the others is smaller than this fraction of it depends on them."""
PRICE = 1e-14
"""In lengths of the terms of the residual: a column that points along the residual by less only meets rounding."""
ROUNDS_PER_COLUMN = 10
"""The method is finite; in exact arithmetic it takes about one round for each passive column."""


class PassiveSet(NamedTuple):
    """The passive columns and their orthonormal basis, A_p = Q R. Row k of an array belongs to column k.

    Attributes
    ----------
    used
        How many columns are passive, (1,).
    labels
        Which column each one is, (m + 1,).
    columns, basis
        A_p and Q, transposed, (m + 1, m).
    triangle
        R transposed, (m + 1, m + 1).
    costs
        Cost c of each column, (m + 1,); zero for plain least squares.
    x, target, held
        The present coefficients, those that the passive columns aim at, and room, (m + 1,).
    residual
        b - A x at the target, (m,).
    """

    used: NDArray[np.int64]
    labels: NDArray[np.int64]
    columns: FloatArray
    basis: FloatArray
    triangle: FloatArray
    costs: FloatArray
    x: FloatArray
    target: FloatArray
    held: FloatArray
    residual: FloatArray


def empty_passive_set(n_rows: int) -> PassiveSet:
    """Return a set without columns for vectors of length ``n_rows`` (plain Python)."""
    return PassiveSet(
        np.zeros(1, np.int64),
        np.zeros(n_rows + 1, np.int64),
        np.zeros((n_rows + 1, n_rows)),
        np.zeros((n_rows + 1, n_rows)),
        np.zeros((n_rows + 1, n_rows + 1)),
        np.zeros(n_rows + 1),
        np.zeros(n_rows + 1),
        np.zeros(n_rows + 1),
        np.zeros(n_rows + 1),
        np.zeros(n_rows),
    )


@kernel
def inner(a: FloatArray, b: FloatArray, n: int) -> float:
    """Return the inner product of the first ``n`` entries."""
    total = 0.0
    for k in range(n):
        total += a[k] * b[k]
    return total


@kernel
def length(a: FloatArray, n: int) -> float:
    return math.sqrt(inner(a, a, n))


@kernel
def orthogonalise(passive: PassiveSet, place: int, n_rows: int) -> bool:
    """Make basis vector ``place`` from its column and those before it; False: the column depends on them."""
    column, vector = passive.columns[place], passive.basis[place]
    for row in range(n_rows):
        vector[row] = column[row]
    for k in range(place):
        passive.triangle[place, k] = 0.0
    for _ in range(2):
        for k in range(place):
            part = inner(passive.basis[k], vector, n_rows)
            passive.triangle[place, k] += part
            for row in range(n_rows):
                vector[row] -= part * passive.basis[k, row]
    left = length(vector, n_rows)
    if left <= DEPENDENT * length(column, n_rows):
        return False
    passive.triangle[place, place] = left
    for row in range(n_rows):
        vector[row] /= left
    return True


@kernel
def append_column(passive: PassiveSet, column: FloatArray, label: int, cost: float, n_rows: int) -> bool:
    """Add a column with coefficient zero; False: it depends on the others, and nothing has changed."""
    place = passive.used[0]
    if place >= n_rows:
        return False
    for row in range(n_rows):
        passive.columns[place, row] = column[row]
    if not orthogonalise(passive, place, n_rows):
        return False
    passive.labels[place] = label
    passive.costs[place] = cost
    passive.x[place] = 0.0
    passive.used[0] = place + 1
    return True


@kernel
def remove_column(passive: PassiveSet, place: int, n_rows: int) -> None:
    """Take one column out; the basis behind it is made anew."""
    passive.used[0] -= 1
    for k in range(place, passive.used[0]):
        passive.labels[k] = passive.labels[k + 1]
        passive.costs[k] = passive.costs[k + 1]
        passive.x[k] = passive.x[k + 1]
        for row in range(n_rows):
            passive.columns[k, row] = passive.columns[k + 1, row]
    for k in range(place, passive.used[0]):
        orthogonalise(passive, k, n_rows)


@kernel
def aim(passive: PassiveSet, b: FloatArray, n_rows: int) -> None:
    """Write the unconstrained least squares solution over the passive columns into ``target``."""
    n = passive.used[0]
    for row in range(n_rows):
        passive.residual[row] = b[row]
    for k in range(n):  # one basis vector after the other, from what is left: rounding stays that of the residual
        part = inner(passive.basis[k], passive.residual, n_rows)
        passive.target[k] = part
        for row in range(n_rows):
            passive.residual[row] -= part * passive.basis[k, row]
    for k in range(n):  # costs hold the columns at a_k . residual = c_k: add Q R^-T c
        held = passive.costs[k]
        for earlier in range(k):
            held -= passive.triangle[k, earlier] * passive.held[earlier]
        passive.held[k] = held / passive.triangle[k, k]
        passive.target[k] -= passive.held[k]
        if passive.held[k] != 0.0:
            for row in range(n_rows):
                passive.residual[row] += passive.held[k] * passive.basis[k, row]
    solve_triangle(passive)


@kernel
def solve_triangle(passive: PassiveSet) -> None:
    """Replace ``target`` by R^-1 target."""
    for k in range(passive.used[0] - 1, -1, -1):
        for later in range(k + 1, passive.used[0]):
            passive.target[k] -= passive.triangle[later, k] * passive.target[later]
        passive.target[k] /= passive.triangle[k, k]


@kernel
def settle(passive: PassiveSet, b: FloatArray, n_rows: int) -> None:
    """Go from x towards the target until a coefficient reaches zero, drop its column, and so on."""
    while passive.used[0] > 0:
        aim(passive, b, n_rows)
        fraction = 1.0
        for k in range(passive.used[0]):
            if passive.target[k] <= 0.0:
                fraction = min(fraction, passive.x[k] / (passive.x[k] - passive.target[k] + 1e-300))
        if fraction == 1.0 and least_target(passive) > 0.0:
            for k in range(passive.used[0]):
                passive.x[k] = passive.target[k]
            return
        lowest, lowest_x = -1, math.inf
        for k in range(passive.used[0]):
            passive.x[k] += fraction * (passive.target[k] - passive.x[k])
            if passive.target[k] <= 0.0 and passive.x[k] < lowest_x:
                lowest, lowest_x = k, passive.x[k]
        remove_column(passive, lowest, n_rows)
    aim(passive, b, n_rows)


@kernel
def exchange_column(passive: PassiveSet, column: FloatArray, label: int, cost: float, n_rows: int) -> bool:
    """Let in a cheaper column that depends on the passive ones: it takes over from them until one is at zero.

    False: none of them gives way. Only columns with costs need this: without, a dependent column has nothing to offer.
    """
    n = passive.used[0]
    for k in range(n):
        passive.target[k] = inner(passive.basis[k], column, n_rows)
    solve_triangle(passive)
    leaves, share = -1, math.inf
    for k in range(n):
        if passive.target[k] > 0.0 and passive.x[k] < share * passive.target[k]:
            leaves, share = k, passive.x[k] / passive.target[k]
    if leaves < 0:
        return False
    for k in range(n):
        passive.x[k] = max(0.0, passive.x[k] - share * passive.target[k])
    remove_column(passive, leaves, n_rows)
    if append_column(passive, column, label, cost, n_rows):
        passive.x[passive.used[0] - 1] = share
    return True


@kernel
def least_target(passive: PassiveSet) -> float:
    least = math.inf
    for k in range(passive.used[0]):
        least = min(least, passive.target[k])
    return least


@kernel
def rounding_scale(passive: PassiveSet, b: FloatArray, n_rows: int) -> float:
    """Return the length of the terms that the residual is the sum of: its rounding is about 1e-16 of this."""
    scale = length(b, n_rows)
    for k in range(passive.used[0]):
        scale += passive.x[k] * length(passive.columns[k], n_rows)
    return scale


@kernel
def label_is_passive(passive: PassiveSet, label: int) -> bool:
    found = False
    for k in range(passive.used[0]):
        found = found or passive.labels[k] == label
    return found


@entry_kernel
def nonnegative_least_squares(
    columns: FloatArray, n_columns: int, n_rows: int, b: FloatArray, passive: PassiveSet, rejected: NDArray[np.bool_]
) -> float:
    """Return the least |b - sum x_j a_j| over x >= 0; the solution stays in ``passive``.

    Parameters
    ----------
    columns
        (at least n_columns, at least n_rows): row j is column a_j.
    n_columns, n_rows
        How much of the arrays is in use.
    b
        (at least n_rows,)
    passive
        Where to start from, and the solution: set ``used`` to 0 for a cold start; columns from an earlier call with
        the same ``columns`` and another ``b`` are a warm one.
    rejected
        Room, (at least n_columns,).
    """
    for k in range(passive.used[0]):  # a warm start is any set of columns; from zero, `settle` finds which may stay
        passive.x[k] = 0.0
    warm_start(passive, b, n_rows)
    for j in range(n_columns):
        rejected[j] = False
    for _ in range(ROUNDS_PER_COLUMN * (n_columns + n_rows)):
        least_price = PRICE * rounding_scale(passive, b, n_rows)
        best, best_price = -1, 0.0
        for j in range(n_columns):
            if rejected[j] or label_is_passive(passive, j):
                continue
            size = length(columns[j], n_rows)
            if size == 0.0:
                continue
            price = inner(columns[j], passive.residual, n_rows) / size
            if price > least_price and price > best_price:
                best, best_price = j, price
        if best < 0:
            break
        if append_column(passive, columns[best], best, 0.0, n_rows):
            settle(passive, b, n_rows)
        if label_is_passive(passive, best):
            for j in range(n_columns):
                rejected[j] = False
        else:  # it depends on the others, or rounding had made its price: it cannot help before something else changes
            rejected[best] = True
    return length(passive.residual, n_rows)


@kernel
def warm_start(passive: PassiveSet, b: FloatArray, n_rows: int) -> None:
    """Keep of the passive columns a set that has positive coefficients for the new ``b``."""
    aim(passive, b, n_rows)
    while passive.used[0] > 0 and least_target(passive) <= 0.0:
        lowest = 0
        for k in range(passive.used[0]):
            if passive.target[k] < passive.target[lowest]:
                lowest = k
        remove_column(passive, lowest, n_rows)
        aim(passive, b, n_rows)
    for k in range(passive.used[0]):
        passive.x[k] = passive.target[k]
