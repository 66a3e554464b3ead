"""Non-negative least squares by the active-set method of Lawson and Hanson: min 1/2 |A x - b|^2 + c.x, x >= 0.

Columns with x > 0 are "passive". Their orthonormal basis is kept by Gram-Schmidt, each column made orthogonal twice
where once leaves little of it, so that it is orthogonal to rounding, and by rotations when a column leaves; normal
equations would lose half of the digits. A column enters only if it reduces the residual, so it has a part outside the
span of the passive ones: dependent columns never meet in one basis, and degenerate sets are safe. At most as many
columns are passive as there are rows.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.tolerances import DEPENDENT_COLUMN, LEAST_COEFFICIENT, LEAST_PRICE, ORTHOGONAL_SHARE
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import kernel

MOST_FREEDOMS = 12
"""Freedoms that there is memory for: those of two free bodies, or of one and of six that move along a line."""
MOST_ROWS = MOST_FREEDOMS + 1
"""All systems that are solved with this have at most so many rows: one for each freedom, and one more."""
WRENCH = 6
"""Numbers of the wrench or twist of one body: most systems have so many rows."""
ROUNDS_PER_COLUMN = 10
"""The method is finite; in exact arithmetic it takes about one round for each passive column."""


class PassiveSet:
    """The passive columns and their orthonormal basis, A_p = Q R; a record. Row k of an array belongs to column k.

    Attributes
    ----------
    n_rows, used
        The length of the columns, and how many are passive.
    terms
        Length of the terms of b: where they cancel, b is shorter.
    dependent
        A column of which less than this part lies outside the span of the others depends on them.
    labels
        Which column each one is.
    sizes, basis
        The lengths of the columns, and Q, transposed.
    triangle
        R transposed, with the inverse of its diagonal.
    costs
        Cost c of each column; zero for plain least squares.
    x, target, held
        The present coefficients, those that the passive columns aim at, and scratch.
    n_aimed, left, parts
        Row k of ``left`` is what the first k basis vectors leave of b, and ``parts[k]`` is how much of b is along the
        next one: both are known of the first ``n_aimed``, so that a column that comes in last costs one step.
    residual
        b - A x at the target.
    """

    n_rows: int
    used: int
    terms: float
    dependent: float
    labels: Annotated[IntArray, MOST_ROWS + 1]
    sizes: Annotated[FloatArray, MOST_ROWS + 1]
    basis: Annotated[FloatArray, MOST_ROWS + 1, MOST_ROWS]
    triangle: Annotated[FloatArray, MOST_ROWS + 1, MOST_ROWS + 1]
    costs: Annotated[FloatArray, MOST_ROWS + 1]
    x: Annotated[FloatArray, MOST_ROWS + 1]
    target: Annotated[FloatArray, MOST_ROWS + 1]
    held: Annotated[FloatArray, MOST_ROWS + 1]
    n_aimed: int
    left: Annotated[FloatArray, MOST_ROWS + 1, MOST_ROWS]
    parts: Annotated[FloatArray, MOST_ROWS + 1]
    residual: Annotated[FloatArray, MOST_ROWS]


class System(NamedTuple):
    """Workspace for one problem: columns (n, rows), right side (rows,), the lengths of the columns (n,), and which did
    not help (n,).
    """

    columns: FloatArray
    right_side: FloatArray
    lengths: FloatArray
    is_rejected: NDArray[np.bool_]


def empty_system(n_columns: int, n_rows: int = WRENCH + 1) -> System:
    """Return a workspace for ``n_columns`` columns of so many rows (plain Python)."""
    columns, lengths = np.zeros((n_columns, n_rows)), np.zeros(n_columns)
    return System(columns, np.zeros(n_rows), lengths, np.zeros(n_columns, np.bool_))


@kernel
def inner(a: FloatArray, b: FloatArray, n: int) -> float:
    """Return the inner product of the first ``n`` entries."""
    if n == WRENCH:  # in pairs, of which three have to wait for each other, not six
        pairs: float = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]) + (a[4] * b[4] + a[5] * b[5])
        return pairs
    total = 0.0
    for k in range(n):
        total += a[k] * b[k]
    return total


@kernel
def length(a: FloatArray, n: int) -> float:
    return math.sqrt(inner(a, a, n))


@kernel
def clear(passive: PassiveSet, n_rows: int, terms: float) -> None:
    """Start from no columns."""
    passive.n_rows, passive.used, passive.terms, passive.dependent = n_rows, 0, terms, DEPENDENT_COLUMN
    passive.n_aimed = 0


@kernel
def orthogonalise(passive: PassiveSet, place: int) -> bool:
    """Make basis vector ``place``, which is a column, orthogonal to those before it; False: it depends on them."""
    if passive.n_rows == WRENCH:  # nearly always: loops of a length that is known are several times as fast
        return orthogonalise_rows(passive, place, WRENCH)
    return orthogonalise_rows(passive, place, passive.n_rows)


@kernel
def orthogonalise_rows(passive: PassiveSet, place: int, n_rows: int) -> bool:
    vector, basis, triangle = passive.basis[place], passive.basis, passive.triangle
    for k in range(place):
        triangle[place, k] = 0.0
    size = inner(vector, vector, n_rows)
    left = size
    for _ in range(2):
        before = left
        for k in range(place):
            part = inner(basis[k], vector, n_rows)
            triangle[place, k] += part
            for row in range(n_rows):
                vector[row] -= part * basis[k, row]
        left = inner(vector, vector, n_rows)
        if left > ORTHOGONAL_SHARE * before:
            break
    if left <= passive.dependent * passive.dependent * size:
        return False
    passive.sizes[place] = math.sqrt(size)
    triangle[place, place] = 1.0 / math.sqrt(left)
    for row in range(n_rows):
        vector[row] *= triangle[place, place]
    return True


@kernel
def append_column(passive: PassiveSet, column: FloatArray, label: int, cost: float) -> bool:
    """Add a column with coefficient zero; False: it depends on the others, and nothing has changed."""
    place = passive.used
    if place >= passive.n_rows:
        return False
    passive.n_aimed = min(passive.n_aimed, place)
    for row in range(passive.n_rows):
        passive.basis[place, row] = column[row]
    if not orthogonalise(passive, place):
        return False
    passive.labels[place] = label
    passive.costs[place] = cost
    passive.x[place] = 0.0
    passive.used = place + 1
    return True


@kernel
def remove_column(passive: PassiveSet, place: int) -> None:
    """Take one column out. R keeps one entry below the diagonal in each column behind it; rotations take them away."""
    passive.used -= 1
    passive.n_aimed = min(passive.n_aimed, place)
    n, triangle = passive.used, passive.triangle
    for k in range(place, n):
        passive.labels[k] = passive.labels[k + 1]
        passive.costs[k] = passive.costs[k + 1]
        passive.x[k] = passive.x[k + 1]
        passive.sizes[k] = passive.sizes[k + 1]
        for row in range(k + 1):
            triangle[k, row] = triangle[k + 1, row]
        triangle[k, k + 1] = 1.0 / triangle[k + 1, k + 1]
    for k in range(place, n):
        size = math.sqrt(triangle[k, k] * triangle[k, k] + triangle[k, k + 1] * triangle[k, k + 1])
        cosine, sine = triangle[k, k] / size, triangle[k, k + 1] / size
        triangle[k, k] = 1.0 / size
        for later in range(k + 1, n):
            upper, lower = triangle[later, k], triangle[later, k + 1]
            triangle[later, k], triangle[later, k + 1] = cosine * upper + sine * lower, cosine * lower - sine * upper
        if passive.n_rows == WRENCH:
            rotate_rows(passive, k, cosine, sine, WRENCH)
        else:
            rotate_rows(passive, k, cosine, sine, passive.n_rows)


@kernel
def rotate_rows(passive: PassiveSet, place: int, cosine: float, sine: float, n_rows: int) -> None:
    """Turn a basis vector and the next one in their plane."""
    one, other = passive.basis[place], passive.basis[place + 1]
    for row in range(n_rows):
        upper, lower = one[row], other[row]
        one[row], other[row] = cosine * upper + sine * lower, cosine * lower - sine * upper


@kernel
def aim_at(passive: PassiveSet, b: FloatArray) -> None:
    """Take another b."""
    passive.n_aimed = 0
    for row in range(passive.n_rows):
        passive.left[0, row] = b[row]


@kernel
def aim(passive: PassiveSet) -> None:
    """Write the unconstrained least squares solution over the passive columns into ``target``, for b of `aim_at`."""
    if passive.n_rows == WRENCH:
        aim_rows(passive, WRENCH)
    else:
        aim_rows(passive, passive.n_rows)


@kernel
def aim_rows(passive: PassiveSet, n_rows: int) -> None:
    n, residual, left, basis = passive.used, passive.residual, passive.left, passive.basis
    for k in range(n):
        if k < passive.n_aimed:
            continue
        # One basis vector after the other, from what is left: rounding stays that of the residual.
        part = inner(basis[k], left[k], n_rows)
        passive.parts[k] = part
        for row in range(n_rows):
            left[k + 1, row] = left[k, row] - part * basis[k, row]
    passive.n_aimed = n
    for row in range(n_rows):
        residual[row] = left[n, row]
    n_free = n  # of leading columns without a cost
    for k in range(n):
        passive.target[k] = passive.parts[k]
        if passive.costs[k] != 0.0:
            n_free = min(n_free, k)
    for k in range(n_free, n):  # costs hold the columns at a_k . residual = c_k: add Q R^-T c
        held = passive.costs[k]
        for earlier in range(n_free, k):
            held -= passive.triangle[k, earlier] * passive.held[earlier]
        passive.held[k] = held * passive.triangle[k, k]
        if held != 0.0:
            passive.target[k] -= passive.held[k]
            for row in range(n_rows):
                residual[row] += passive.held[k] * basis[k, row]
    solve_triangle(passive)


@kernel
def solve_triangle(passive: PassiveSet) -> None:
    """Replace ``target`` by R^-1 target."""
    n, target, triangle = passive.used, passive.target, passive.triangle
    for place in range(n):  # counted up: the compiler then knows that no index is negative, which is twice as fast
        k = n - 1 - place
        value = target[k]
        for later in range(n):
            if later > k:
                value -= triangle[later, k] * target[later]
        target[k] = value * triangle[k, k]


@kernel
def settle(passive: PassiveSet) -> None:
    """Go from x towards the target until a coefficient reaches zero, drop its column, and so on."""
    while passive.used > 0:
        aim(passive)
        fraction = 1.0
        for k in range(passive.used):
            if passive.target[k] <= 0.0:
                fraction = min(fraction, passive.x[k] / (passive.x[k] - passive.target[k] + 1e-300))
        if fraction == 1.0 and least_target(passive) > 0.0:
            for k in range(passive.used):
                passive.x[k] = passive.target[k]
            return
        lowest, lowest_x = passive.used, math.inf
        for k in range(passive.used):
            passive.x[k] += fraction * (passive.target[k] - passive.x[k])
            if passive.target[k] <= 0.0 and passive.x[k] < lowest_x:
                lowest, lowest_x = k, passive.x[k]
        remove_column(passive, lowest)
    aim(passive)


@kernel
def exchange_column(passive: PassiveSet, column: FloatArray, label: int, cost: float) -> bool:
    """Let in a cheaper column that depends on the passive ones: it takes over from them until one is at zero.

    False: none of them gives way. Only columns with costs need this: without, a dependent column has nothing to offer.
    """
    n = passive.used
    for k in range(n):
        passive.target[k] = inner(passive.basis[k], column, passive.n_rows)
    solve_triangle(passive)
    share = math.inf
    for k in range(n):
        if passive.target[k] > LEAST_COEFFICIENT:
            share = min(share, passive.x[k] / passive.target[k])
    if share == math.inf:
        return False
    leaves, most = n, LEAST_COEFFICIENT
    for k in range(n):  # of those that come to zero together, the one that the new column takes most of
        if passive.target[k] > most and passive.x[k] <= (share + LEAST_COEFFICIENT) * passive.target[k]:
            leaves, most = k, passive.target[k]
    for k in range(n):
        passive.x[k] = max(0.0, passive.x[k] - share * passive.target[k])
    remove_column(passive, leaves)
    if append_column(passive, column, label, cost):
        passive.x[passive.used - 1] = share
    return True


@kernel
def least_target(passive: PassiveSet) -> float:
    least = math.inf
    for k in range(passive.used):
        least = min(least, passive.target[k])
    return least


@kernel
def rounding_scale(passive: PassiveSet) -> float:
    """Return the length of the terms that the residual is the sum of: its rounding is about 1e-16 of this."""
    scale = passive.terms
    for k in range(passive.used):
        scale += passive.x[k] * passive.sizes[k]
    return scale


@kernel
def label_is_passive(passive: PassiveSet, label: int) -> bool:
    found = False
    for k in range(passive.used):
        found = found or passive.labels[k] == label
    return found


@kernel
def nonnegative_least_squares(system: System, n_columns: int, passive: PassiveSet) -> float:
    """Return the least |b - sum x_j a_j| over x >= 0; the solution stays in ``passive``.

    Parameters
    ----------
    system
        Row j of ``columns`` is a_j; ``right_side`` is b.
    n_columns
        How many are in use.
    passive
        Where to start from, and the solution: `clear` it for a cold start; columns from an earlier call with
        the same ``columns`` and another ``b`` are a warm one.
    """
    heed_interrupt()
    columns, b, lengths, rejected = system
    for k in range(passive.used):  # a warm start is any set of columns; from zero, `settle` finds which may stay
        passive.x[k] = 0.0
    keep_above(passive, b, 0.0)
    for j in range(n_columns):
        lengths[j], rejected[j] = length(columns[j], passive.n_rows), False
    for _ in range(ROUNDS_PER_COLUMN * (n_columns + passive.n_rows)):
        least_price = LEAST_PRICE * rounding_scale(passive)
        best, best_price = n_columns, 0.0
        for j in range(n_columns):
            if rejected[j]:
                continue
            along = inner(columns[j], passive.residual, passive.n_rows)
            if along > lengths[j] * max(least_price, best_price) and not label_is_passive(passive, j):
                best, best_price = j, along / lengths[j]
        if best == n_columns:
            break
        if append_column(passive, columns[best], best, 0.0):
            settle(passive)
        if label_is_passive(passive, best):
            for j in range(n_columns):
                rejected[j] = False
        else:  # it depends on the others, or rounding had made its price: it cannot help before something else changes
            rejected[best] = True
    return length(passive.residual, passive.n_rows)


@kernel
def keep_above(passive: PassiveSet, b: FloatArray, least: float) -> None:
    """Keep of the passive columns a set whose coefficients for the new ``b`` are above ``least``."""
    aim_at(passive, b)
    aim(passive)
    while passive.used > 0 and least_target(passive) <= least:
        lowest = passive.used - 1
        for k in range(passive.used):
            if passive.target[k] < passive.target[lowest]:
                lowest = k
        remove_column(passive, lowest)
        aim(passive)
    for k in range(passive.used):
        passive.x[k] = passive.target[k]
