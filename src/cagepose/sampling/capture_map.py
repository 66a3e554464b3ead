"""The capture map: from which values of two numbers the part comes to a good rest, the others as in the scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.files.schema_study import MapModel
from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner

LINES_OF_SIDE = 60
"""At least so many lines of cells are run along each side, or all of them."""
LAYERS, MOST_LAYERS = 4, 9
"""Values of a third number: so many, or those that the study lists, if they are not more than the latter."""
CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))
"""Corners of a block, down and right."""

Indices = NDArray[np.int64]


@dataclass(frozen=True)
class CaptureMap:
    """A grid of runs.

    Attributes
    ----------
    keys
        Of the two numbers: across and up.
    layer
        A third number and its value here; None: there are but two.
    across, up
        Their values at the middles of the cells, (n,) each.
    verdicts, accepted
        Of each cell, (n, n), rows up.
    box
        Least and greatest value of each of the two, in the largest box of cells about the nominal one that are all
        good; None: the nominal one is not, or is not on the map.
    n_runs
        How many cells were run; the others lie among cells that agree.
    lattice
        Of the lines that were run whole, (m,): all of them, if there are few.
    quantities
        Where the part is at the end, by name, (m, m) each, on the lattice, rows up; NaN where it does not come to rest.
    """

    keys: tuple[str, str]
    layer: tuple[str, float] | None
    across: FloatArray
    up: FloatArray
    verdicts: NDArray[Any]
    accepted: NDArray[np.bool_]
    box: tuple[tuple[float, float], tuple[float, float]] | None
    n_runs: int
    lattice: Indices
    quantities: Mapping[str, FloatArray]


def capture_maps(
    runner: Runner, columns: RowColumns, distributions: Sequence[Distribution], asked: MapModel
) -> tuple[CaptureMap, ...]:
    """Return the map over the two numbers that are asked for; of three, one for each of a few values of the third."""
    keys = [one.key for one in runner.study.varied]
    chosen = [keys.index(key) for key in asked.over]
    nominal = np.array([one.nominal for one in runner.study.varied])
    axes = [np.linspace(distributions[one].low, distributions[one].high, asked.count) for one in chosen[:2]]
    if len(chosen) == 2:
        return (_map(runner, columns, chosen, axes, nominal),)
    return tuple(
        _map(runner, columns, chosen, axes, np.where(np.arange(len(nominal)) == chosen[2], value, nominal))
        for value in _layers(distributions[chosen[2]])
    )


def _layers(distribution: Distribution) -> list[float]:
    """Return the values of the third number: those that are listed, or some of them, or evenly spaced ones."""
    if distribution.kind != "listed":
        return list(np.linspace(distribution.low, distribution.high, LAYERS))
    listed = distribution.numbers
    places = np.linspace(0, len(listed) - 1, min(len(listed), MOST_LAYERS)).round().astype(int)
    return [listed[place] for place in places.tolist()]


def _map(
    runner: Runner, columns: RowColumns, chosen: Sequence[int], axes: Sequence[FloatArray], nominal: FloatArray
) -> CaptureMap:
    """Return the map over the first two of the chosen numbers, all others as in ``nominal``."""
    across, up = axes
    kinds: dict[tuple[str, bool], int] = {}
    ends = {name: np.full((len(up), len(across)), np.nan) for name in columns.quantities}

    def kinds_of(rows: Indices, places: Indices) -> Indices:
        """Run cells; return the number of what happens in each, the same for the same verdict and acceptance."""
        values = np.tile(nominal, (len(rows), 1))
        values[:, chosen[0]], values[:, chosen[1]] = across[places], up[rows]
        found = list[int]()

        def told(outcomes: Outcomes, part: FloatArray) -> None:
            here = slice(len(found), len(found) + len(part))
            for name, measured in columns.quantities_of(part, outcomes).items():
                ends[name][rows[here], places[here]] = measured
            accepted = columns.columns(part, outcomes)["accepted"].tolist()
            for kind in zip(outcomes.verdict.tolist(), accepted, strict=True):
                found.append(kinds.setdefault(kind, len(kinds)))

        runner.run_in_parts(values, told)
        return np.array(found, dtype=np.int64)

    cells, n_runs = refined_map(len(across), kinds_of)
    verdicts = np.array([verdict for verdict, _ in kinds])[cells]
    good = np.array([accepted for _, accepted in kinds])[cells]
    starts = [(axis, nominal[one]) for axis, one in zip(axes, chosen, strict=False)]
    column, row = (int(np.abs(axis - value).argmin()) for axis, value in starts)
    is_on_map = all(axis[0] <= value <= axis[-1] for axis, value in starts)
    around = largest_box(good, row, column) if is_on_map else None
    box = None
    if around is not None:
        bottom, top, left, right = around
        box = (float(across[left]), float(across[right])), (float(up[bottom]), float(up[top]))
    names = [runner.study.varied[one].key for one in chosen]
    layer = (names[2], float(nominal[chosen[2]])) if len(names) > 2 else None
    lattice = _lattice(len(across), _first_stride(len(across)))
    known = {name: found[np.ix_(lattice, lattice)] for name, found in ends.items()}
    return CaptureMap((names[0], names[1]), layer, across, up, verdicts, good, box, n_runs, lattice, known)


def _first_stride(count: int) -> int:
    stride = 1
    while count > 2 * stride * LINES_OF_SIDE:
        stride *= 2
    return stride


def _lattice(count: int, stride: int) -> Indices:
    """Return every so many of count lines, and the last one."""
    n_blocks = -(-(count - 1) // stride)
    return np.minimum(np.arange(n_blocks + 1) * stride, count - 1)


def refined_map(count: int, kinds_of: Callable[[Indices, Indices], Indices]) -> tuple[Indices, int]:
    """Return what happens in each of count x count cells, (count, count), and how many of them were run.

    ``kinds_of`` runs cells by their rows and columns and says what happens there. A coarse lattice is run first, of
    `LINES_OF_SIDE` lines at least. Its blocks whose corners differ are halved, until single cells are left. So are
    their neighbours, into which the boundary may bulge. All other blocks are as their corners. What is narrower than a
    block of the first lattice, and lies within one, can be missed.
    """
    cells = np.full((count, count), -1)
    stride = _first_stride(count)
    n_blocks = len(_lattice(count, stride)) - 1
    is_active = np.ones((n_blocks, n_blocks), np.bool_)
    n_runs = 0
    while True:
        # run the corners of the blocks that were halved
        lines = np.minimum(np.arange(len(is_active) + 1) * stride, count - 1)
        is_corner = np.zeros((len(lines), len(lines)), np.bool_)
        for down, right in CORNERS:
            is_corner[down : len(lines) - 1 + down, right : len(lines) - 1 + right] |= is_active
        rows, places = (lines[index] for index in np.nonzero(is_corner))
        asked = np.unique(np.stack([rows, places])[:, cells[rows, places] < 0], axis=1)
        n_runs += asked.shape[1]
        cells[asked[0], asked[1]] = kinds_of(asked[0], asked[1])
        if stride == 1:
            return cells, n_runs
        # find the blocks whose corners differ, and their neighbours
        corners = cells[np.ix_(lines, lines)]
        differs = is_active & (
            (corners[:-1, :-1] != corners[1:, :-1])
            | (corners[:-1, :-1] != corners[:-1, 1:])
            | (corners[:-1, :-1] != corners[1:, 1:])
        )
        around = np.pad(differs, 1)
        near = np.logical_or.reduce(
            [around[i : i + len(differs), j : j + len(differs)] for i in range(3) for j in range(3)]
        )
        is_halved = is_active & near
        # fill all other blocks, and halve these
        for one, other in np.argwhere(is_active & ~is_halved).tolist():
            block = cells[lines[one] : lines[one + 1] + 1, lines[other] : lines[other + 1] + 1]
            block[block < 0] = cells[lines[one], lines[other]]
        is_active = np.kron(is_halved, np.ones((2, 2), np.bool_))
        stride //= 2


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
