"""The ends of the play, and what limits them; by linear programs over the polytope of the start."""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import PassiveSet, System, clear, inner, length, nonnegative_least_squares
from cagepose.kernels.algebra.linear_program import OPTIMAL, UNBOUNDED, Program, solve_program
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.goal import Goal, write_slope
from cagepose.kernels.play.polytope import N_TRUST, START_MOTION, PlayWorkspace
from cagepose.kernels.play.tolerances import LEAST_PRICE

REACHED, OPEN, NOT_FOUND, UNFINISHED = range(4)


class Limits:
    """The pairs that limit an end, and how much its value gains for each length that such a gap grows; a record."""

    n_pairs: int
    pairs: Annotated[IntArray, 6]
    prices: Annotated[FloatArray, 6]


class Extreme:
    """One end of the play; a record.

    Attributes
    ----------
    linear_outcome, linear, linear_twist, linear_limits
        By the linear program at the start: REACHED, OPEN (no end) or NOT_FOUND; the value, radians or lengths of the
        scene; a twist that reaches it, and what limits it.
    outcome, value, position, quaternion, limits
        The same exactly: REACHED, OPEN, or UNFINISHED, where the value is the farthest known but no end (7.14); and the
        motion that reaches it.
    """

    linear_outcome: int
    linear: float
    linear_twist: Annotated[FloatArray, 6]
    linear_limits: Limits
    outcome: int
    value: float
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    limits: Limits


@kernel
def write_limits(passive: PassiveSet, n_pairs: int, factor: float, limits: Limits) -> None:
    """Write the rows in use that limit an end; ``factor`` was taken out of the slope that they hold."""
    limits.n_pairs = 0
    for k in range(passive.used):
        if passive.labels[k] < n_pairs and passive.x[k] > LEAST_PRICE:
            limits.pairs[limits.n_pairs] = passive.labels[k]
            limits.prices[limits.n_pairs] = factor * passive.x[k]
            limits.n_pairs += 1


@kernel
def find_linear(goal: Goal, rows: FloatArray, bounds: FloatArray, program: Program, extreme: Extreme) -> None:
    """Find the greatest value over the polytope (7.1) of the start."""
    factor = write_slope(goal, START_MOTION, program.objective)
    program.passive.used = 0
    outcome = solve_program(rows, bounds, program)
    extreme.linear, extreme.linear_outcome = goal.sign * math.inf, OPEN
    if outcome == OPTIMAL:
        extreme.linear = goal.sign * factor * inner(program.objective, program.x, 6)
        extreme.linear_outcome = REACHED
        for k in range(6):
            extreme.linear_twist[k] = program.x[k]
        write_limits(program.passive, len(rows) - N_TRUST, factor, extreme.linear_limits)
    elif outcome != UNBOUNDED:
        extreme.linear_outcome = NOT_FOUND


@entry
def find_linear_play(
    goals: Rows[Goal], rows: FloatArray, bounds: FloatArray, program: Program, extremes: Rows[Extreme]
) -> None:
    """Find the linear extremes alone, over any polytope of twists from the start."""
    for i in range(len(goals)):
        find_linear(goals[i], rows, bounds, program, extremes[i])


@kernel
def travels_without_end(work: PlayWorkspace) -> bool:
    """Whether some translation alone lets the value grow without end: no point is in its way, and that is exact."""
    objective, passive = work.program.objective, work.program.passive
    clear(passive, 3, length(objective, 3))
    system = System(work.rows, objective, work.lengths, work.is_rejected)
    rest = nonnegative_least_squares(system, len(work.faces), passive)
    passive.used = 0
    return rest > LEAST_PRICE
