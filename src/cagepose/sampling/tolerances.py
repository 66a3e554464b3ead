"""The tolerance table: nominal, worst case, root sum square, and Monte Carlo with re-settling, side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.sampling.distribution import Distribution
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner
from cagepose.sampling.statistics import Spread

STEP_IN_SIGMAS = 0.01
"""Step of a difference, in standard deviations. It is near enough to give a derivative, and far above rounding."""
SHARE_OF_JUMP = 0.75
"""Share of a change. A quantity jumps if more of its change is left when the step is halved; half of it would be."""


@dataclass(frozen=True)
class ToleranceRow:
    """One quantity.

    Attributes
    ----------
    name, nominal
        Its value with all numbers at their nominal values; NaN: that run does not come to rest.
    derivatives
        By each varied number, (n_varied,), from the nominal run; NaN where a run beside it does not come to rest, or
        where the quantity jumps.
    worst
        Least and greatest value if the quantity were linear and each number at its worst end.
    root_sum_square
        The same with the changes by half of each number's width added as squares, about its middle.
    spread
        What the runs say.
    resolution
        What differs by less does not differ.
    stays_within_worst
        Whether the runs stay within the worst case, as they would if it were linear; None: one of the two is not known.
    """

    name: str
    nominal: float
    derivatives: FloatArray
    worst: tuple[float, float]
    root_sum_square: tuple[float, float]
    spread: Spread
    resolution: float

    @property
    def stays_within_worst(self) -> bool | None:
        low, high = self.worst
        if math.isnan(low) or not self.spread.n:
            return None
        slack = 0.01 * (high - low) + self.resolution
        return self.spread.least >= low - slack and self.spread.greatest <= high + slack


def tolerance_rows(
    runner: Runner, columns: RowColumns, distributions: Sequence[Distribution], spreads: dict[str, Spread]
) -> list[ToleranceRow]:
    """Return a row for each quantity, from one run more than four for each varied number.

    Derivatives are central differences; where a step would leave a number's range, they are one-sided: below a friction
    of 0, for one, no scene is.
    """
    nominal = np.array([one.nominal for one in runner.study.varied])
    steps = np.array([STEP_IN_SIGMAS * one.sigma for one in distributions])
    low, high = np.array([(one.low, one.high) for one in distributions]).T
    steps_ahead, steps_back = np.where(nominal + steps > high, 0.0, steps), np.where(nominal - steps < low, 0.0, steps)
    ways = [way * np.diag(reach) for way in (1.0, 0.5) for reach in (steps_ahead, -steps_back)]
    values = nominal + np.concatenate([np.zeros((1, len(nominal))), *ways])
    measured = columns.quantities_of(values, runner.run(values))
    rows, n_varied = [], len(nominal)
    for name, found in measured.items():
        with np.errstate(invalid="ignore"):  # an end of play may be infinite all over
            whole, half = (ahead - behind for ahead, behind in found[1:].reshape(2, 2, n_varied))
        steps = (steps_ahead + steps_back) / 2.0
        derivatives = np.divide(half, steps, out=np.zeros(n_varied), where=steps > 0.0)
        derivatives[np.abs(half) > np.maximum(SHARE_OF_JUMP * np.abs(whole), columns.resolution[name])] = np.nan
        ends = np.sort([derivatives * (low - nominal), derivatives * (high - nominal)], axis=0).sum(axis=1)
        middle = float(found[0] + ends.sum() / 2.0)
        reach = math.sqrt(float(((derivatives * (high - low) / 2.0) ** 2).sum()))
        rows.append(
            ToleranceRow(
                name,
                float(found[0]),
                derivatives,
                (float(found[0] + ends[0]), float(found[0] + ends[1])),
                (middle - reach, middle + reach),
                spreads[name],
                columns.resolution[name],
            )
        )
    return rows
