"""What matters: Sobol indices of quantities and of the yield, from runs of their own (Saltelli's design)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as design

from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner

ACCEPTED = "accepted"
BASE = 1024
"""Rows of the design for each varied number, and two more."""
BASE_ONE_BY_ONE = 256
LEAST_WHOLE = 0.5
"""Of the design's blocks: a block in which a run does not come to rest says nothing of poses, and is left out."""


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
    base = BASE if runner.is_batch else BASE_ONE_BY_ONE
    shares = design.sample(problem, base, calc_second_order=False, seed=seed % 2**32)
    values = np.stack([one.values(share) for one, share in zip(distributions, shares.T, strict=True)], axis=1)
    parts: list[dict[str, FloatArray]] = []

    def told(outcomes: Outcomes, rows: FloatArray) -> None:
        accepted = columns.columns(rows, outcomes)[ACCEPTED].astype(np.float64)
        parts.append({ACCEPTED: accepted, **columns.quantities_of(outcomes)})

    runner.run_in_parts(values, told)
    return [
        _indices(name, np.concatenate([part[name] for part in parts]), problem, seed, columns.resolution.get(name, 0.0))
        for name in (ACCEPTED, *columns.quantities)
    ]


def _indices(name: str, measured: FloatArray, problem: dict[str, Any], seed: int, resolution: float) -> Sensitivity:
    nothing, missing = np.zeros(0), None
    blocks = measured.reshape(-1, problem["num_vars"] + 2)  # of runs that belong together
    whole = blocks[~np.isnan(blocks).any(axis=1)]
    measured = whole.ravel()
    if len(whole) < LEAST_WHOLE * len(blocks):
        missing = "is not known, as too many runs of the design do not come to rest"
    elif np.ptp(measured) <= resolution:
        missing = "is the same in all of them"
    if missing is not None:
        return Sensitivity(name, len(measured), nothing, nothing, nothing, nothing, missing)
    with np.errstate(invalid="ignore", divide="ignore"):  # of resamples that happen to be constant
        found = analysis.analyze(problem, measured, calc_second_order=False, seed=seed % 2**32)
    first, first_half, total, total_half = (np.asarray(found[key]) for key in ("S1", "S1_conf", "ST", "ST_conf"))
    return Sensitivity(name, len(measured), first, first_half, total, total_half)
