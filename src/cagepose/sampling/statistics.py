"""What the rows of a study say of yield, spread and contacts, read part by part: memory does not grow with the rows."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.sampling.outcome import at_rest
from cagepose.sampling.results import StudyResults

SHARE_OF_TAIL = 0.00135
"""Share of a normal distribution that lies more than three standard deviations above its mean."""
N_BINS = 20_000
"""The range of a quantity has so many bins. Its quantiles are exact to that."""


@dataclass
class Spread:
    """How a quantity is spread over the runs that came to rest.

    Attributes
    ----------
    n, mean, least, greatest
        Of those of these runs in which it is a finite number.
    squares
        Sum of the squares of the distances from the mean.
    counts
        Of runs in `N_BINS` equal parts of the range.
    """

    n: int = 0
    mean: float = math.nan
    least: float = math.inf
    greatest: float = -math.inf
    squares: float = 0.0
    counts: FloatArray = field(default_factory=lambda: np.zeros(N_BINS))

    def add(self, values: FloatArray) -> None:
        """Take in more runs: all but ``counts``, which needs the range first (Chan et al. 1983)."""
        if len(values) == 0:
            return
        n, mean, squares = len(values), float(values.mean()), float(((values - values.mean()) ** 2).sum())
        if self.n:
            apart, total = mean - self.mean, self.n + n
            squares += self.squares + apart**2 * self.n * n / total
            mean, n = self.mean + apart * n / total, total
        self.n, self.mean, self.squares = n, mean, squares
        self.least, self.greatest = min(self.least, float(values.min())), max(self.greatest, float(values.max()))

    def count(self, values: FloatArray) -> None:
        """Count runs, all of which were taken in before, by equal parts of the range."""
        if len(values) == 0:
            return
        places = (values - self.least) / max(self.greatest - self.least, 1e-300) * N_BINS
        self.counts += np.bincount(np.minimum(places.astype(np.int64), N_BINS - 1), minlength=N_BINS)

    @property
    def sigma(self) -> float:
        """The standard deviation; NaN: of no runs."""
        return math.sqrt(self.squares / self.n) if self.n else math.nan

    @property
    def three_sigma(self) -> tuple[float, float]:
        """Quantiles that `SHARE_OF_TAIL` of the runs lie below and above, as beyond three sigmas of a normal
        distribution; NaN: of no runs.
        """
        return (self.quantile(SHARE_OF_TAIL), self.quantile(1.0 - SHARE_OF_TAIL)) if self.n else (math.nan, math.nan)

    def quantile(self, share: float) -> float:
        """Return what a share of the runs lies below."""
        below = np.concatenate([[0.0], np.cumsum(self.counts)]) / max(self.n, 1)
        return float(np.interp(share, below, np.linspace(self.least, self.greatest, N_BINS + 1)))


@dataclass
class Statistics:
    """The statistics of all rows.

    Attributes
    ----------
    n_runs, n_accepted, n_accepted_moving
        How many rows, how many of them are good, and how many of these did not come to rest.
    verdicts
        How many rows ended with each.
    spreads
        By name of the quantity.
    n_touching
        By name of a column of touching: in how many runs that point or shape touches at the end.
    """

    n_runs: int = 0
    n_accepted: int = 0
    n_accepted_moving: int = 0
    verdicts: Counter[str] = field(default_factory=Counter)
    spreads: dict[str, Spread] = field(default_factory=dict)
    n_touching: Counter[str] = field(default_factory=Counter)


def statistics_of(results: StudyResults) -> Statistics:
    """Return what all rows say, reading them twice: the quantiles need the range first."""
    columns = results.columns
    found = Statistics(spreads={name: Spread() for name in columns.quantities})
    for part in results.parts([*columns.quantities, *columns.touching, "verdict", "accepted"]):
        found.n_runs += len(part["verdict"])
        rests = at_rest(part["verdict"])
        found.n_accepted += int(part["accepted"].sum())
        found.n_accepted_moving += int((part["accepted"] & ~rests).sum())
        names, counts = np.unique(part["verdict"], return_counts=True)
        found.verdicts.update(dict(zip(names.tolist(), counts.tolist(), strict=True)))
        for name, spread in found.spreads.items():
            spread.add(_numbers(part[name][rests]))
        for name in columns.touching:
            found.n_touching[name] += int(part[name].sum())
    for part in results.parts([*columns.quantities, "verdict"]):
        for name, spread in found.spreads.items():
            spread.count(_numbers(part[name][at_rest(part["verdict"])]))
    return found


def _numbers(values: FloatArray) -> FloatArray:
    """Return those that are: a formula or a question may have no value in a row, or one without end."""
    return values[np.isfinite(values)]
