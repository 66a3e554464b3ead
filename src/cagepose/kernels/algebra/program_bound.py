"""A linear program's maximum bounded from its multipliers alone, so that no rounding of its solution counts (7.12).

For any multipliers that are not negative, f . x = (sum of multipliers times rows) . x + (what they miss of f) . x, and
the first term is at most the sum of multipliers times bounds. Neumaier and Shcherbina, "Safe bounds in linear and
mixed-integer linear programming", Math. Program. 99 (2004), do so with directed rounding; here the rounding of the two
sums is bounded instead.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.linear_program import N_UNKNOWNS, OPTIMAL, UNBOUNDED, Program, solve_program
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import SUM_ROUNDING
from cagepose.kernels.native.kernel import entry, kernel


@kernel
def dual_bound(rows: FloatArray, bounds: FloatArray, program: Program) -> tuple[float, float]:
    """Return (b, r) with f . x <= b + r max |x_k| for each x within the rows, after the program is solved."""
    passive = program.passive
    bound, magnitude, missing = 0.0, 0.0, 0.0
    for i in range(passive.used):
        part = passive.x[i] * bounds[passive.labels[i]]
        bound += part
        magnitude += abs(part)
    for k in range(N_UNKNOWNS):
        missed, size = program.objective[k], abs(program.objective[k])
        for i in range(passive.used):
            part = passive.x[i] * rows[passive.labels[i], k]
            missed -= part
            size += abs(part)
        missing += abs(missed) + SUM_ROUNDING * size
    return bound + SUM_ROUNDING * magnitude, missing


@entry
def extents(
    rows: FloatArray, bounds: FloatArray, program: Program, least: FloatArray, greatest: FloatArray
) -> tuple[int, float]:
    """Bound each unknown from below and above, (6,) each, -inf and inf where it has no end.

    Returns OPTIMAL, or INFEASIBLE or FAILED of the first program that was, and r: each bound holds once r times the
    greatest |x_k| is added.
    """
    most_missing = 0.0
    for side in range(2 * N_UNKNOWNS):
        k, sign = side % N_UNKNOWNS, (1.0 if side < N_UNKNOWNS else -1.0)
        for other in range(N_UNKNOWNS):
            program.objective[other] = sign if other == k else 0.0
        program.passive.used = 0
        outcome = solve_program(rows, bounds, program)
        bound, missing = math.inf, 0.0
        if outcome == OPTIMAL:
            bound, missing = dual_bound(rows, bounds, program)
        elif outcome != UNBOUNDED:
            return outcome, 0.0
        most_missing = max(most_missing, missing)
        if side < N_UNKNOWNS:
            greatest[k] = bound
        else:
            least[k] = -bound
    return OPTIMAL, most_missing
