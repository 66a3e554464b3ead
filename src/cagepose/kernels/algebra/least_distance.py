"""The shortest vector that linear inequalities allow, by non-negative least squares.

Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23.4: minimise |x| subject to G x >= h. With r the
residual of the least squares problem with the columns (g_i, h_i) and the right side (0, 1), x = -r / r_last; where r is
zero, no x is allowed.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import PassiveSet, System, clear, nonnegative_least_squares
from cagepose.kernels.algebra.linear_program import N_UNKNOWNS
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import RESIDUAL_OF_RIGHT_SIDE
from cagepose.kernels.native.kernel import entry


@entry
def shortest_inside(rows: FloatArray, bounds: FloatArray, system: System, passive: PassiveSet, x: FloatArray) -> bool:
    """Write the shortest x, (6,), with rows x <= bounds, of which an infinite one does not count; False: there is none.

    ``system`` has a column for each row.
    """
    columns = system.columns
    for i in range(len(rows)):
        counts = bounds[i] < math.inf
        for k in range(N_UNKNOWNS):
            columns[i, k] = -rows[i, k] if counts else 0.0
        columns[i, N_UNKNOWNS] = -bounds[i] if counts else 0.0
    for k in range(N_UNKNOWNS):
        system.right_side[k] = 0.0
    system.right_side[N_UNKNOWNS] = 1.0
    clear(passive, N_UNKNOWNS + 1, 1.0)
    if nonnegative_least_squares(system, len(rows), passive) <= RESIDUAL_OF_RIGHT_SIDE:
        return False
    for k in range(N_UNKNOWNS):
        x[k] = -passive.residual[k] / passive.residual[N_UNKNOWNS]
    return True
