"""Which values are run: `Sample`, whose row of a number never depends on which rows are asked for."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import numpy as np
from scipy.stats import qmc

from cagepose.files.schema_study import MOST_RUNS, SampleModel
from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution

GRID, LATIN = "grid", "latin hypercube"
MOST_LATIN = 100_000_000
"""Numbers of a Latin hypercube: 0.8 GB."""


class Sample:
    """All rows of a study, made when they are asked for.

    Attributes
    ----------
    n_runs
        How many rows.

    Raises
    ------
    ValueError
        A grid of more than `MOST_RUNS` combinations, or a Latin hypercube of more than `MOST_LATIN` numbers.
    """

    def __init__(self, model: SampleModel, distributions: Sequence[Distribution]) -> None:
        self._method, self._seed, self._distributions = model.method, model.seed, tuple(distributions)
        self._counts = tuple(len(one.numbers) for one in distributions)
        self.n_runs = math.prod(self._counts) if self._method == GRID else int(model.runs or 0)
        if self.n_runs > MOST_RUNS:
            raise ValueError(f"has {self.n_runs} combinations; give grids of at most {MOST_RUNS} in all")
        if self._method == LATIN and self.n_runs * len(distributions) > MOST_LATIN:
            raise ValueError(f"is a Latin hypercube, which is kept as a whole: at most {MOST_LATIN} numbers; use sobol")
        self._sobol: qmc.Sobol | None = None
        self._latin: FloatArray | None = None

    def values(self, first: int, last: int) -> FloatArray:
        """Return rows ``first`` up to, without, ``last``: (n, n_varied), in the scene file's unit."""
        shares = self._shares(first, last)
        columns = [one.values(share) for one, share in zip(self._distributions, shares.T, strict=True)]
        return np.stack(columns, axis=1)

    def _shares(self, first: int, last: int) -> FloatArray:
        n_varied = len(self._distributions)
        if self._method == GRID:
            indices = np.unravel_index(np.arange(first, last), self._counts)
            grid: FloatArray = (np.stack(indices, axis=1) + 0.5) / np.array(self._counts)
            return grid
        if self._method == "random":
            bits = np.random.PCG64(self._seed).advance(first * n_varied)
            return np.random.Generator(bits).random((last - first, n_varied))
        if self._method == "sobol":
            return self._sobol_rows(first, last, n_varied)
        if self._latin is None:  # each of its columns is one permutation of all runs, so it is kept as a whole
            self._latin = qmc.LatinHypercube(n_varied, rng=self._seed).random(self.n_runs)
        return self._latin[first:last]

    def _sobol_rows(self, first: int, last: int, n_varied: int) -> FloatArray:
        if self._sobol is None or self._sobol.num_generated > first:
            self._sobol = qmc.Sobol(n_varied, rng=self._seed)
        if self._sobol.num_generated < first:
            self._sobol.fast_forward(first - self._sobol.num_generated)
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "The balance properties")  # the user says how many runs there are
            found: FloatArray = self._sobol.random(last - first)
        return found
