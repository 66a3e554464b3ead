"""What matters: Sobol indices of quantities and of the yield, from runs of their own (Saltelli's design)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from SALib.analyze import sobol as analysis
from scipy.stats import qmc

from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner

ACCEPTED = "accepted"
BASE_ROWS = 1024
"""Rows of the design for each varied number, and two more."""
BASE_ONE_BY_ONE = 256
LEAST_WHOLE_BLOCKS = 0.5
"""Share of the design's blocks. A block in which a run does not come to rest says nothing of poses, and is left out."""


@dataclass(frozen=True)
class Sensitivity:
    """How much of one quantity's variance comes from each varied number.

    Attributes
    ----------
    name, n_runs
        Of the quantity, or "accepted"; how many runs of the design it is from.
    first, first_interval
        Share of the variance that is due to each number alone, (n_varied,), and half of its 95 % interval.
    total, total_interval
        The same with all that it does together with others.
    missing
        Why there are none; None: there are.
    """

    name: str
    n_runs: int
    first: FloatArray
    first_interval: FloatArray
    total: FloatArray
    total_interval: FloatArray
    missing: str | None = None


def sensitivities(
    runner: Runner, columns: RowColumns, distributions: Sequence[Distribution], seed: int
) -> list[Sensitivity]:
    """Return the indices of the yield and of each quantity (Saltelli et al. 2010, Jansen 1999; by SALib)."""
    n_varied = len(distributions)
    problem = {"num_vars": n_varied, "names": list(columns.varied), "bounds": [[0.0, 1.0]] * n_varied}
    n_blocks = BASE_ROWS if runner.is_batch else BASE_ONE_BY_ONE
    base = qmc.Sobol(2 * n_varied, rng=seed % 2**32).random(n_blocks)
    parts: list[dict[str, FloatArray]] = []
    n_at_once = max(runner.rows_of_a_part // (n_varied + 2), 1)
    for first in range(0, n_blocks, n_at_once):
        shares = saltelli_rows(base[first : first + n_at_once])
        rows = np.stack([one.values(share) for one, share in zip(distributions, shares.T, strict=True)], axis=1)
        outcomes = runner.run(rows)
        accepted = columns.columns(rows, outcomes)[ACCEPTED].astype(np.float64)
        parts.append({ACCEPTED: accepted, **columns.quantities_of(rows, outcomes)})
    return [
        _indices(name, np.concatenate([part[name] for part in parts]), problem, seed, columns.resolution.get(name, 0.0))
        for name in (ACCEPTED, *columns.quantities)
    ]


def saltelli_rows(base: FloatArray) -> FloatArray:
    """Return the rows of Saltelli's design, (n (n_varied + 2), n_varied), for some of its base points, (n, 2 n_varied).

    A base point is two of all numbers, A and B. Its block is A, A with each number in turn from B, and B: those of a
    hundred numbers would be 80 MB, so not all of them are made at once.
    """
    n_varied = base.shape[1] // 2
    a, b, places = base[:, :n_varied], base[:, n_varied:], np.arange(n_varied)
    blocks = np.repeat(a[:, None, :], n_varied + 2, axis=1)
    blocks[:, places + 1, places] = b
    blocks[:, -1] = b
    return blocks.reshape(-1, n_varied)


def _indices(name: str, measured: FloatArray, problem: dict[str, Any], seed: int, resolution: float) -> Sensitivity:
    nothing, missing = np.zeros(0), None
    blocks = measured.reshape(-1, problem["num_vars"] + 2)  # of runs that belong together
    whole = blocks[~np.isnan(blocks).any(axis=1)]
    measured = whole.ravel()
    if len(whole) < LEAST_WHOLE_BLOCKS * len(blocks):
        missing = "is not known, as too many runs of the design do not come to rest"
    elif np.ptp(whole[:, [0, -1]]) <= resolution:  # the variance of these is what the others are measured by
        missing = "is the same in all of them, or in nearly all"
    if missing is not None:
        return Sensitivity(name, len(measured), nothing, nothing, nothing, nothing, missing)
    with np.errstate(invalid="ignore", divide="ignore"):  # of resamples that happen to be constant
        found = analysis.analyze(problem, measured, calc_second_order=False, seed=seed % 2**32)
    first, first_half, total, total_half = (np.asarray(found[key]) for key in ("S1", "S1_conf", "ST", "ST_conf"))
    return Sensitivity(name, len(measured), first, first_half, total, total_half)
