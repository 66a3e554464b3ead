"""A linear program's maximum bounded from its multipliers alone, so that no rounding of its solution counts (7.12).

For any multipliers that are not negative, f . x = (sum of multipliers times rows) . x + (what they miss of f) . x, and
the first term is at most the sum of multipliers times bounds. Neumaier and Shcherbina, "Safe bounds in linear and
mixed-integer linear programming", Math. Program. 99 (2004), do so with directed rounding; here the rounding of the two
sums is bounded instead.
"""

from __future__ import annotations

from cagepose.kernels.algebra.linear_program import N_UNKNOWNS, ProgramRoom, coefficient
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.native.kernel import kernel

SUM_ROUNDING = 4e-15
"""Of the magnitudes that are summed: twice the rounding of six products and their sum, twice."""


@kernel
def dual_bound(rows: FloatArray, bounds: FloatArray, room: ProgramRoom) -> tuple[float, float]:
    """Return (b, r) with f . x <= b + r max |x_k| for each x within the rows, after the program is solved.

    The rows of the basis count, unless they are of the far box, whose multipliers are zero but for rounding.
    """
    n_rows = len(rows)
    bound, magnitude, left_over = 0.0, 0.0, 0.0
    for i in range(N_UNKNOWNS):
        if room.basis[i] < n_rows:
            part = max(room.multipliers[i], 0.0) * bounds[room.basis[i]]
            bound += part
            magnitude += abs(part)
    for k in range(N_UNKNOWNS):
        missed, size = room.objective[k], abs(room.objective[k])
        for i in range(N_UNKNOWNS):
            if room.basis[i] < n_rows:
                part = max(room.multipliers[i], 0.0) * coefficient(rows, room.basis[i], k)
                missed -= part
                size += abs(part)
        left_over += abs(missed) + SUM_ROUNDING * size
    return bound + SUM_ROUNDING * magnitude, left_over
