"""Newton's step to an extreme of the play: on the faces that limit it, along what they leave free (7.6).

A linear program says which gaps limit an extreme. Where they are fewer than six, curvature decides the rest: that of
the gaps and of the value over the directions that the limiting rows leave open.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.linear_program import ProgramRoom
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm
from cagepose.kernels.native.kernel import kernel

DEPENDENT = 1e-7
"""Rows of length about one: a part outside the span of the others that is shorter says nothing new."""
SETTING_OFF = 1e-3
"""Radians, and lengths of the scene: less than the slope of a step that is worth a look."""
FLAT = 1e-6
"""Of the curvature: added to it, so that directions in which nothing changes stay where they are."""


class NewtonRoom:
    """Room for one step; a record.

    Attributes
    ----------
    n_rows, pairs
        How many rows limit, and which.
    basis
        Orthonormal: first the span of the limiting rows, then what they leave free.
    triangle, bounds, prices
        Of the limiting rows: parts along the basis, right sides, multipliers by least squares.
    curvature
        Second derivatives of the value with the gaps at their prices (7.6).
    reduced, factor, right_side
        The system along what is left free, its lower half, and its Cholesky factor.
    bent
        A row of the basis times the curvature.
    onto, along, step
        The step onto the limiting faces, along them, and both.
    """

    n_rows: int
    pairs: Annotated[IntArray, 6]
    basis: Annotated[FloatArray, 6, 6]
    triangle: Annotated[FloatArray, 6, 6]
    bounds: Annotated[FloatArray, 6]
    prices: Annotated[FloatArray, 6]
    curvature: Annotated[FloatArray, 6, 6]
    reduced: Annotated[FloatArray, 6, 6]
    factor: Annotated[FloatArray, 6, 6]
    right_side: Annotated[FloatArray, 6]
    bent: Annotated[FloatArray, 6]
    onto: Annotated[FloatArray, 6]
    along: Annotated[FloatArray, 6]
    step: Annotated[FloatArray, 6]


@kernel
def make_orthogonal(room: NewtonRoom, place: int, n_before: int) -> float:
    """Make basis vector ``place`` orthogonal to the first ``n_before``, and of length one; return its former length."""
    vector = room.basis[place]
    for j in range(6):
        room.triangle[place, j] = 0.0
    for _ in range(2):
        for j in range(n_before):
            part = 0.0
            for k in range(6):
                part += room.basis[j, k] * vector[k]
            room.triangle[place, j] += part
            for k in range(6):
                vector[k] -= part * room.basis[j, k]
    size = 0.0
    for k in range(6):
        size += vector[k] * vector[k]
    size = math.sqrt(size)
    if size > DEPENDENT:
        for k in range(6):
            vector[k] /= size
    return size


@kernel
def take_row(rows: FloatArray, bounds: FloatArray, pair: int, room: NewtonRoom) -> None:
    """Take one more row, unless it depends on those that are taken."""
    if room.n_rows == 6:
        return
    for k in range(6):
        room.basis[room.n_rows, k] = rows[pair, k]
    size = make_orthogonal(room, room.n_rows, room.n_rows)
    if size > DEPENDENT:
        room.triangle[room.n_rows, room.n_rows] = size
        room.bounds[room.n_rows] = bounds[pair]
        room.pairs[room.n_rows] = pair
        room.n_rows += 1


@kernel
def take_rows(rows: FloatArray, bounds: FloatArray, n_pairs: int, program: ProgramRoom, room: NewtonRoom) -> None:
    """Take the rows that the program's solution leans on, without those of the trust region."""
    room.n_rows = 0
    for i in range(6):
        if program.basis[i] < n_pairs and program.multipliers[i] > 0.0:
            take_row(rows, bounds, program.basis[i], room)


@kernel
def complete_basis(room: NewtonRoom) -> None:
    """Write an orthonormal basis of what the rows leave free behind theirs."""
    found = room.n_rows
    for k in range(6):
        if found == 6:
            break
        for j in range(6):
            room.basis[found, j] = 1.0 if j == k else 0.0
        if make_orthogonal(room, found, found) > DEPENDENT:
            found += 1


@kernel
def find_prices(program: ProgramRoom, room: NewtonRoom) -> None:
    """Write the multipliers that come nearest to the objective."""
    for back in range(room.n_rows):
        i = room.n_rows - 1 - back
        price = 0.0
        for k in range(6):
            price += room.basis[i, k] * program.objective[k]
        for later in range(i + 1, room.n_rows):
            price -= room.triangle[later, i] * room.prices[later]
        room.prices[i] = price / room.triangle[i, i]


@kernel
def add_turning(curvature: FloatArray, a: Vector, b: Vector, factor: float) -> None:
    """Add that of factor * a . (w x (w x b)) / 2 = factor * ((w . a)(w . b) - w^2 a . b) / 2."""
    along = dot(a, b)
    for i in range(3):
        for k in range(3):
            curvature[3 + i, 3 + k] += 0.5 * factor * (a[i] * b[k] + b[i] * a[k])
        curvature[3 + i, 3 + i] -= factor * along


@kernel
def add_product(curvature: FloatArray, a: Vector, b: Vector, factor: float) -> None:
    """Add that of factor * (w . a)(w . b) / 2."""
    for i in range(3):
        for k in range(3):
            curvature[3 + i, 3 + k] += 0.5 * factor * (a[i] * b[k] + b[i] * a[k])


@kernel
def add_gap(curvature: FloatArray, normal: Vector, arm: Vector, price: float) -> None:
    """Add that of a gap at its price: n . (w x (w x d)) / 2 + n . (w x t) (7.3)."""
    add_turning(curvature, normal, arm, price)
    for j in range(3):
        e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
        part = cross(e, normal)  # n . (w x e_j) = w . (e_j x n)
        for i in range(3):
            curvature[3 + i, j] += price * part[i]
            curvature[j, 3 + i] += price * part[i]


@kernel
def reduce_curvature(room: NewtonRoom) -> float:
    """Write minus the curvature along what is left free, its lower half; return its largest entry."""
    largest = 0.0
    for i in range(room.n_rows, 6):
        for j in range(6):
            room.bent[j] = 0.0
            for k in range(6):
                room.bent[j] += room.basis[i, k] * room.curvature[k, j]
        for other in range(room.n_rows, i + 1):
            total = 0.0
            for j in range(6):
                total -= room.bent[j] * room.basis[other, j]
            room.reduced[i, other] = total
            largest = max(largest, abs(total))
    return largest


@kernel
def factorise_reduced(room: NewtonRoom, shift: float) -> bool:
    """Write the Cholesky factor of the reduced system with ``shift`` on its diagonal; False: it has none."""
    for i in range(room.n_rows, 6):
        for j in range(room.n_rows, i + 1):
            total = room.reduced[i, j] if i != j else room.reduced[i, i] + shift
            for k in range(room.n_rows, j):
                total -= room.factor[i, k] * room.factor[j, k]
            if i != j:
                room.factor[i, j] = total / room.factor[j, j]
            elif total > 0.0:
                room.factor[i, i] = math.sqrt(total)
            else:
                return False
    return True


@kernel
def write_onto(room: NewtonRoom) -> None:
    """Write the shortest step onto the limiting faces."""
    for k in range(6):
        room.onto[k] = 0.0
    for i in range(room.n_rows):
        part = room.bounds[i]
        for j in range(i):
            part -= room.triangle[i, j] * room.right_side[j]
        room.right_side[i] = part / room.triangle[i, i]
        for k in range(6):
            room.onto[k] += room.right_side[i] * room.basis[i, k]


@kernel
def newton_step(program: ProgramRoom, room: NewtonRoom) -> bool:
    """Write the step onto the limiting faces, ``onto``, and along them to the top, ``along``.

    False: there is no top, and ``along`` is a direction in which the value grows, if any.
    """
    n = room.n_rows
    complete_basis(room)
    write_onto(room)
    for k in range(6):
        room.along[k] = 0.0
    for i in range(n, 6):
        slope = 0.0
        for k in range(6):
            bent = 0.0
            for j in range(6):
                bent += room.curvature[k, j] * room.onto[j]
            slope += room.basis[i, k] * (program.objective[k] + bent)
        room.right_side[i] = slope
    largest = reduce_curvature(room)
    shift = FLAT * largest + 1e-15
    is_top = factorise_reduced(room, shift)
    has_factor = is_top
    while not has_factor:  # six entries of a row are no more than six times the largest
        shift = max(2.0 * shift, 0.01 * largest)
        has_factor = factorise_reduced(room, shift)
    if not is_top:  # a saddle has no slope to follow: set off in any direction, growth chooses the steepest
        for i in range(n, 6):
            room.right_side[i] += math.copysign(SETTING_OFF * shift * (1.0 + 0.1 * i), room.right_side[i])
    for i in range(n, 6):
        for j in range(n, i):
            room.right_side[i] -= room.factor[i, j] * room.right_side[j]
        room.right_side[i] /= room.factor[i, i]
    for back in range(6 - n):
        i = 5 - back
        for j in range(i + 1, 6):
            room.right_side[i] -= room.factor[j, i] * room.right_side[j]
        room.right_side[i] /= room.factor[i, i]
    for i in range(n, 6):
        for k in range(6):
            room.along[k] += room.right_side[i] * room.basis[i, k]
    return is_top


@kernel
def join_steps(
    rows: FloatArray, bounds: FloatArray, n_pairs: int, is_top: bool, longest_step: float, room: NewtonRoom
) -> int:
    """Write the step that goes along the faces to the top, or as far as the other rows (and ``longest_step``) allow.

    Returns the row that ends it before the first half of the way to the top, -1: none.
    """
    share = 1.0 if is_top else longest_step / max(size_of_step(room.along), 1e-12 * longest_step)
    whole, blocks = share, -1
    for pair in range(n_pairs):
        left, speed = bounds[pair], 0.0
        for k in range(6):
            left -= rows[pair, k] * room.onto[k]
            speed += rows[pair, k] * room.along[k]
        if speed > 1e-12 * longest_step and max(left, 0.0) < share * speed and not is_taken(room, pair):
            share, blocks = max(left, 0.0) / speed, pair
    for k in range(6):
        room.step[k] = room.onto[k] + share * room.along[k]
    return blocks if share < 0.5 * whole else -1


@kernel
def is_taken(room: NewtonRoom, pair: int) -> bool:
    found = False
    for i in range(room.n_rows):
        found = found or room.pairs[i] == pair
    return found


@kernel
def size_of_step(step: FloatArray) -> float:
    """Return the size of a step: of its travel in lengths of the scene, or of its turn in radians."""
    return max(norm((step[0], step[1], step[2])), norm((step[3], step[4], step[5])))
