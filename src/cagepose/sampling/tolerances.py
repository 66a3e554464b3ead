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

STEP = 0.01
"""Of a central difference, in standard deviations: near enough to be a derivative, far above rounding."""


@dataclass(frozen=True)
class ToleranceRow:
    """One quantity.

    Attributes
    ----------
    name, nominal
        Its value with all numbers at their nominal values; NaN: that run does not come to rest.
    derivatives
        By each varied number, (n_varied,), from the nominal run; NaN where a run beside it does not come to rest.
    worst
        Least and greatest value if the quantity were linear and each number at its worst end.
    root_sum_square
        The same with the changes by half of each number's width added as squares, about its middle.
    spread
        What the runs say.
    stays_within_worst
        Whether the runs stay within the worst case, as they would if it were linear; None: one of the two is not known.
    """

    name: str
    nominal: float
    derivatives: FloatArray
    worst: tuple[float, float]
    root_sum_square: tuple[float, float]
    spread: Spread

    @property
    def stays_within_worst(self) -> bool | None:
        low, high = self.worst
        if math.isnan(low) or not self.spread.n:
            return None
        slack = 0.01 * (high - low)
        return self.spread.least >= low - slack and self.spread.greatest <= high + slack


def tolerance_rows(
    runner: Runner, columns: RowColumns, distributions: Sequence[Distribution], spreads: dict[str, Spread]
) -> list[ToleranceRow]:
    """Return a row for each quantity, from one run more than two for each varied number."""
    nominal = np.array([one.nominal for one in runner.study.varied])
    steps = np.array([STEP * one.sigma for one in distributions])
    values = np.concatenate([nominal[None], nominal + np.diag(steps), nominal - np.diag(steps)])
    measured = columns.quantities_of(runner.run(values))
    low, high = np.array([(one.low, one.high) for one in distributions]).T
    rows, n_varied = [], len(nominal)
    for name, found in measured.items():
        ahead, behind = found[1 : n_varied + 1], found[n_varied + 1 :]
        derivatives = np.divide(ahead - behind, 2.0 * steps, out=np.zeros(n_varied), where=steps > 0.0)
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
            )
        )
    return rows
