"""The capture map: from which values of two numbers the part comes to a good rest, the others as in the scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner

COUNT = 60
"""Cells along each side, where the study does not say."""


@dataclass(frozen=True)
class CaptureMap:
    """A grid of runs.

    Attributes
    ----------
    keys
        Of the two numbers: across and up.
    across, up
        Their values at the middles of the cells, (n,) each.
    verdicts, accepted
        Of each cell, (n, n), rows up.
    box
        Least and greatest value of each of the two, in the largest box of cells about the nominal one that are all
        good; None: the nominal one is not.
    """

    keys: tuple[str, str]
    across: FloatArray
    up: FloatArray
    verdicts: NDArray[Any]
    accepted: NDArray[np.bool_]
    box: tuple[tuple[float, float], tuple[float, float]] | None


def capture_map(runner: Runner, columns: RowColumns, distributions: Sequence[Distribution]) -> CaptureMap | None:
    """Return the map over the two numbers that the study names, or the first two; None: only one varies."""
    study = runner.study
    keys = [one.key for one in study.varied]
    if len(keys) < 2:
        return None
    given = study.model.map
    chosen = [keys.index(key) for key in given.over] if given else [0, 1]
    count = given.count if given else COUNT
    across, up = (np.linspace(distributions[one].low, distributions[one].high, count) for one in chosen)
    nominal = np.array([one.nominal for one in study.varied])
    values = np.tile(nominal, (count * count, 1))
    values[:, chosen[0]], values[:, chosen[1]] = np.tile(across, count), np.repeat(up, count)
    verdicts, accepted = list[NDArray[Any]](), list[NDArray[np.bool_]]()

    def told(outcomes: Outcomes, rows: FloatArray) -> None:
        verdicts.append(outcomes.verdict)
        accepted.append(columns.columns(rows, outcomes)["accepted"])

    runner.run_in_parts(values, told)
    good = np.concatenate(accepted).reshape(count, count)
    start = [int(np.abs(axis - nominal[one]).argmin()) for axis, one in zip((across, up), chosen, strict=True)]
    cells = largest_box(good, start[1], start[0])
    box = None
    if cells is not None:
        bottom, top, left, right = cells
        box = (float(across[left]), float(across[right])), (float(up[bottom]), float(up[top]))
    return CaptureMap(
        (keys[chosen[0]], keys[chosen[1]]), across, up, np.concatenate(verdicts).reshape(count, count), good, box
    )


def largest_box(good: NDArray[np.bool_], row: int, column: int) -> tuple[int, int, int, int] | None:
    """Return the first and last row and the first and last column of the largest box of good cells about one cell.

    None: that cell is not good.

    >>> largest_box(np.array([[1, 1, 0], [1, 1, 1]], dtype=bool), 1, 1)
    (0, 1, 0, 1)
    """
    if not good[row, column]:
        return None
    n_columns = good.shape[1]
    # How far each row is good to the left and to the right of the column, counted in columns.
    lefts = np.argmin(np.c_[good[:, column::-1], np.zeros(len(good), bool)], axis=1) - 1
    rights = np.argmin(np.c_[good[:, column:], np.zeros(len(good), bool)], axis=1) - 1
    lefts, rights = np.where(good[:, column], lefts, -n_columns), np.where(good[:, column], rights, -n_columns)
    below = [np.minimum.accumulate(reach[row::-1]) for reach in (lefts, rights)]
    above = [np.minimum.accumulate(reach[row:]) for reach in (lefts, rights)]
    left = np.minimum.outer(below[0], above[0])
    right = np.minimum.outer(below[1], above[1])
    heights = np.add.outer(np.arange(len(below[0])), np.arange(len(above[0]))) + 1
    areas = np.where(left >= 0, heights * (left + right + 1), 0)
    down, up = np.unravel_index(int(areas.argmax()), areas.shape)
    return row - int(down), row + int(up), column - int(left[down, up]), column + int(right[down, up])
