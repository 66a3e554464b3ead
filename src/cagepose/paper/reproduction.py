"""The paper, run anew: its cases by one method after the other, its numbers beside ours, and its range of angles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.paper.cases import CaseRuns, Progress, run_cases
from cagepose.paper.comparison import PAPER_METHOD, Row
from cagepose.paper.numbers import number_rows
from cagepose.paper.rail import ANGLES, PAPER_RAIL
from cagepose.paper.range_study import RangeStudy, range_study

METHODS = (PAPER_METHOD, "quasistatic")
"""Those that the report compares: each gets its column in the table and its pictures."""
RANGE_RAD = np.radians(np.linspace(-0.5, 0.5, 21))
"""Misalignments of the range study."""


@dataclass(frozen=True, eq=False)
class Reproduction:
    """All of it.

    Attributes
    ----------
    runs
        The paper's cases, by method.
    rows
        Every number that the paper prints.
    ranges
        By method: for each angle, both pins.
    """

    runs: dict[str, CaseRuns]
    rows: tuple[Row, ...]
    ranges: dict[str, tuple[RangeStudy, ...]]

    @property
    def methods(self) -> tuple[str, ...]:
        return tuple(self.runs)


def reproduce(
    methods: Sequence[str], progress: Progress, keep: Callable[[Reproduction], object] | None = None
) -> Reproduction:
    """Run the paper's cases and its range of misalignments by each of ``methods``; ``keep`` gets what is there after
    each but the last.
    """
    runs, ranges = dict[str, CaseRuns](), {}
    half = PAPER_RAIL.pin_spacing_m / 2.0
    for method in methods:
        runs[method] = run_cases(method, progress)
        progress(f"{method}: the rail at {len(RANGE_RAD)} misalignments in each of 3 angles, both pins")
        ranges[method] = tuple(
            range_study(angle, RANGE_RAD, pin_y_m, method) for angle in ANGLES for pin_y_m in (half, -half)
        )
        if keep is not None and method != methods[-1]:
            keep(Reproduction(dict(runs), tuple(number_rows(runs)), dict(ranges)))
    return Reproduction(runs, tuple(number_rows(runs)), ranges)
