"""When a body that an engine moves through time counts as at rest: `windows_until_quiet`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray

QUIET_WINDOWS = 4
"""So many quiet windows in a row: at rest."""


class Settled(NamedTuple):
    """Whether a body came to rest, after how many windows, and how far its points went in the last one."""

    is_quiet: bool
    windows: int
    moved: float


def windows_until_quiet(advance: Callable[[], FloatArray], start: FloatArray, quiet: float, limit: int) -> Settled:
    """Advance until `QUIET_WINDOWS` in a row were quiet: no point moved by ``quiet`` or more.

    Parameters
    ----------
    advance
        Goes on by a window of time steps and returns where points of the body then are, (n, 3).
    start
        Where they are, (n, 3).
    quiet
        In the unit of the points.
    limit
        Windows after which it is given up; it also is if a point's place is no number any more.
    """
    before, n_quiet, moved = start, 0, np.inf
    for window in range(1, limit + 1):
        after = advance()
        moved = float(np.linalg.norm(after - before, axis=1).max())
        if not np.isfinite(moved):
            return Settled(False, window, moved)
        n_quiet = n_quiet + 1 if moved < quiet else 0
        if n_quiet == QUIET_WINDOWS:
            return Settled(True, window, moved)
        before = after
    return Settled(False, limit, moved)
