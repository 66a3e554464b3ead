"""How one number varies: `Distribution`, from shares of likelihood to values."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import special, stats

from cagepose.files.schema_study import DistributionModel
from cagepose.files.study_file import VariedKey
from cagepose.model.checks import FloatArray

WIDTH_IN_SIGMAS = 3.0
"""A normal distribution without a cut counts as this wide, where a width is asked for."""
LEAST_SHARE = 2.0**-54
"""In the place of 0, at which a normal distribution is infinite."""


@dataclass(frozen=True)
class Distribution:
    """The distribution of one varied number, in the scene file's unit.

    Attributes
    ----------
    kind
        "uniform", "normal", "triangular", or "listed" for values that are equally likely.
    low, high
        The least and greatest value; for a normal distribution without a cut `WIDTH_IN_SIGMAS` from its mean.
    mean, sigma
        Mean and standard deviation.
    numbers
        Of "normal": mean, sigma and cut (infinite: none) before cutting; of "triangular": the likeliest; of "listed":
        the values.
    """

    kind: Literal["uniform", "normal", "triangular", "listed"]
    low: float
    high: float
    mean: float
    sigma: float
    numbers: tuple[float, ...] = ()

    def values(self, shares: FloatArray) -> FloatArray:
        """Return the values that the distribution stays below with these likelihoods, from 0 to below 1."""
        found: FloatArray
        if self.kind == "uniform":
            found = self.low + shares * (self.high - self.low)
        elif self.kind == "normal":
            mean, sigma, cut = self.numbers
            least = special.ndtr(-cut)
            inside = np.clip(least + shares * (1.0 - 2.0 * least), LEAST_SHARE, 1.0 - LEAST_SHARE)
            found = np.clip(mean + sigma * special.ndtri(inside), mean - sigma * cut, mean + sigma * cut)
        elif self.kind == "triangular":
            (likeliest,) = self.numbers
            width = self.high - self.low
            rising = self.low + np.sqrt(shares * width * (likeliest - self.low))
            falling = self.high - np.sqrt((1.0 - shares) * width * (self.high - likeliest))
            found = np.where(shares * width < likeliest - self.low, rising, falling)
        else:
            found = np.array(self.numbers)[(shares * len(self.numbers)).astype(np.int64)]
        return found


def distribution_of(varied: VariedKey) -> Distribution:
    """Return how a number of a study varies."""
    model: DistributionModel = varied.distribution
    if model.uniform is not None:
        low, high = model.uniform
        return Distribution("uniform", low, high, (low + high) / 2.0, (high - low) / math.sqrt(12.0))
    if model.normal is not None:
        mean = varied.nominal if model.normal.mean is None else model.normal.mean
        cut, sigma = model.normal.cut or math.inf, model.normal.sigma
        reach = sigma * min(cut, WIDTH_IN_SIGMAS if math.isinf(cut) else cut)
        spread = sigma if math.isinf(cut) else sigma * float(stats.truncnorm.std(-cut, cut))
        return Distribution("normal", mean - reach, mean + reach, mean, spread, (mean, sigma, cut))
    if model.triangular is not None:
        low, likeliest, high = model.triangular
        found = stats.triang((likeliest - low) / (high - low), low, high - low)
        return Distribution("triangular", low, high, float(found.mean()), float(found.std()), (likeliest,))
    if model.steps is not None:
        values = np.linspace(model.steps.first, model.steps.last, model.steps.count)
    else:
        values = np.sort(model.grid or [])
    return Distribution(
        "listed", float(values[0]), float(values[-1]), float(values.mean()), float(values.std()), tuple(values.tolist())
    )
