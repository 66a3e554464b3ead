"""Newton's step to an extreme of the play: on the faces that limit it, along what they leave free (7.6).

A linear program says which gaps limit an extreme. Where they are fewer than six, curvature decides the rest: that of
the gaps and of the value over the directions that the limiting rows leave open.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.dense import (
    add_across,
    cholesky,
    confine,
    frobenius_norm,
    remove_span,
    solve_lower,
    solve_upper,
)
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import WRENCH, PassiveSet, append_column, clear, inner, label_is_passive
from cagepose.kernels.algebra.linear_program import Program, write_corner
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import norm
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.play.tolerances import ADDED_CURVATURE, ROUNDING_OF_TERMS, SAME_ROW


class NewtonStep:
    """One step; a record.

    Attributes
    ----------
    held
        The limiting rows, their labels being pairs; ``target`` holds their prices, multipliers by least squares.
    curvature
        Second derivatives of the value with the gaps at their prices (7.6).
    factor, vectors
        Of minus the curvature along what the rows leave free: Cholesky's factor, or eigenvectors.
    onto, along, step
        The step onto the limiting faces, along them, and both.
    """

    held: PassiveSet
    curvature: Annotated[FloatArray, WRENCH, WRENCH]
    factor: Annotated[FloatArray, WRENCH, WRENCH]
    vectors: Annotated[FloatArray, WRENCH, WRENCH]
    onto: Annotated[FloatArray, WRENCH]
    along: Annotated[FloatArray, WRENCH]
    step: Annotated[FloatArray, WRENCH]


@kernel
def hold_row(rows: FloatArray, pair: int, newton: NewtonStep) -> bool:
    """Take one more limiting row; False: it depends on those that are taken."""
    held = newton.held
    if not append_column(held, rows[pair], pair, 0.0):
        return False
    if held.triangle[held.used - 1, held.used - 1] * SAME_ROW > 1.0:
        held.used -= 1
        return False
    return True


@kernel
def hold_limits(rows: FloatArray, n_pairs: int, program: Program, newton: NewtonStep) -> None:
    """Take the rows that the program's solution leans on, without those of the trust region."""
    clear(newton.held, WRENCH, 1.0)
    passive = program.passive
    for i in range(passive.used):
        if passive.labels[i] < n_pairs and passive.x[i] > 0.0:
            hold_row(rows, passive.labels[i], newton)


@kernel
def write_free_curvature(newton: NewtonStep) -> None:
    """Write minus the curvature along what the rows leave free, with a little of its size everywhere."""
    for j in range(WRENCH):
        for k in range(WRENCH):
            newton.factor[j, k] = -newton.curvature[j, k]
    size = frobenius_norm(newton.curvature, WRENCH)
    shift = ADDED_CURVATURE * confine(newton.factor, newton.held) + ROUNDING_OF_TERMS * size
    add_across(newton.factor, newton.held, size)
    for j in range(WRENCH):
        newton.factor[j, j] += shift


@kernel
def write_growth(newton: NewtonStep) -> None:
    """Turn the slope ``along`` into the direction of the greatest curvature, the way that the slope points."""
    write_free_curvature(newton)
    symmetric_eigen(newton.factor, newton.vectors, WRENCH)
    least = 0
    for k in range(1, WRENCH):
        if newton.factor[k, k] < newton.factor[least, least]:
            least = k
    slope = 0.0
    for k in range(WRENCH):
        slope += newton.along[k] * newton.vectors[k, least]
    for k in range(WRENCH):
        newton.along[k] = math.copysign(1.0, slope) * newton.vectors[k, least]


@kernel
def write_steps(bounds: FloatArray, objective: FloatArray, newton: NewtonStep) -> bool:
    """Write the step onto the limiting faces, ``onto``, and along them to the top, ``along``.

    False: there is no top, and ``along`` is a direction in which the value grows, if any.
    """
    write_corner(bounds, newton.held, newton.onto)
    for k in range(WRENCH):
        newton.along[k] = objective[k] + inner(newton.curvature[k], newton.onto, WRENCH)
    for _ in range(2):  # little may be left of the objective: the second time that is free of rounding, too
        remove_span(newton.along, newton.held)
    write_free_curvature(newton)
    if not cholesky(newton.factor, 0.0, WRENCH):
        write_growth(newton)
        return False
    solve_lower(newton.factor, newton.along, newton.along, WRENCH)
    solve_upper(newton.factor, newton.along, WRENCH)
    remove_span(newton.along, newton.held)
    return True


@kernel
def join_steps(
    rows: FloatArray, bounds: FloatArray, n_pairs: int, is_top: bool, longest_step: float, newton: NewtonStep
) -> int:
    """Write the step that goes along the faces to the top, or as far as the other rows and ``longest_step`` allow.

    Returns the row that ends it before the first half of this way, -1: none.
    """
    size = max(size_of_step(newton.along), 1e-300)
    whole = min(1.0, longest_step / size) if is_top else longest_step / size
    share, blocks = whole, -1
    for pair in range(n_pairs):
        gap, speed = bounds[pair], 0.0
        for k in range(WRENCH):
            gap -= rows[pair, k] * newton.onto[k]
            speed += rows[pair, k] * newton.along[k]
        gap = max(gap, 0.0)
        if speed > ROUNDING_OF_TERMS * size and gap < share * speed and not label_is_passive(newton.held, pair):
            share, blocks = gap / speed, pair
    for k in range(WRENCH):
        newton.step[k] = newton.onto[k] + share * newton.along[k]
    return blocks if share < 0.5 * whole else -1


@kernel
def size_of_step(step: FloatArray) -> float:
    """Return the size of a step: of its travel in lengths of the scene, or of its turn in radians."""
    return max(norm((step[0], step[1], step[2])), norm((step[3], step[4], step[5])))
