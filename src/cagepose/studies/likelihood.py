"""How likely something is, of which some of many tries came true: `wilson`."""

from __future__ import annotations

import math

CONFIDENCE = 1.959963984540054
"""Of 95 %, in standard deviations."""


def wilson(n_in: int, n: int) -> tuple[float, float]:
    """Return the interval in which a likelihood lies, with 95 % confidence, given that ``n_in`` of ``n`` came true
    (Wilson 1927).

    >>> [round(limit, 4) for limit in wilson(0, 100)]
    [0.0, 0.037]
    """
    if n == 0:
        return 0.0, 1.0
    share, square = n_in / n, CONFIDENCE**2 / n
    middle = (share + square / 2.0) / (1.0 + square)
    half = math.sqrt(share * (1.0 - share) * square + square**2 / 4.0) / (1.0 + square)
    return (middle - half if n_in else 0.0), (middle + half if n_in < n else 1.0)  # at its ends without rounding
