"""Which row of the kernels each contact of a problem is: `rows_in_order`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray


def rows_in_order(in_kernels: FloatArray, columns: FloatArray) -> NDArray[np.int64]:
    """Return which row of the kernels each contact of a problem is, by their scaled wrenches, (n, 3, 6) each; where the
    numbers of contacts differ, none.
    """
    if len(in_kernels) != len(columns):
        return np.zeros(0, np.int64)
    apart = np.linalg.norm(in_kernels[:, 0] - columns[:, None, 0], axis=2)
    found = np.zeros(len(columns), np.int64)
    for number, ways in enumerate(apart):
        found[number] = ways.argmin()
        apart[:, found[number]] = np.inf
    return found
