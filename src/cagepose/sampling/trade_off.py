"""The trade-off of a design: what is reached at values of one number, and the loosest that keeps a wish."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cagepose.model.checks import FloatArray

PARTS_OF_RANGE = 16
"""Into which the range of the changed number is cut, at first, evenly."""
HALVINGS_OF_PART = 6
"""A part in which the wish is lost or won is halved so many times."""


@dataclass(frozen=True)
class TradeOffPoint:
    """What is reached at one value.

    Attributes
    ----------
    value
        Of the changed number, in the scene file's unit.
    reached
        The share of good runs, or the width of the capture range.
    low, high
        The yield's 95 % interval (Wilson); of a capture range, which no chance is in, its width twice.
    """

    value: float
    reached: float
    low: float
    high: float


Measure = Callable[[float], TradeOffPoint]


@dataclass(frozen=True)
class TradeOff:
    """What a search has found.

    Attributes
    ----------
    points
        All values that were asked, from tight to loose.
    kept
        Ranges within which the wish is kept, each from its tight to its loose end.
    loosest
        The loosest value that was found to keep the wish; None: none.
    between
        The 95 % interval of that: the loosest value of which even the low end of the yield's interval keeps the wish,
        and the one of which its high end still does; None: none does.
    accuracy
        How far a value next to an end of ``kept`` is away that does not keep the wish.
    """

    points: tuple[TradeOffPoint, ...]
    kept: tuple[tuple[float, float], ...]
    loosest: float | None
    between: tuple[float | None, float | None]
    accuracy: float

    @property
    def is_monotone(self) -> bool:
        """Whether each value asked that is tighter than one which keeps the wish keeps it, too."""
        return not self.kept or (len(self.kept) == 1 and self.kept[0][0] == self.points[0].value)


def trade_off(measure: Measure, tight: float, loose: float, wish: float) -> TradeOff:
    """Search a number between two ends for the loosest value at which at least ``wish`` is reached.

    Each value is measured once. The range is cut into `PARTS_OF_RANGE`. Where the wish is lost or won within a part,
    the part is halved `HALVINGS_OF_PART` times. Of its two ends that one counts which keeps the wish; a root finder
    would return either. What changes twice within a part is not seen.
    """
    points: dict[float, TradeOffPoint] = {}

    def at(value: float) -> TradeOffPoint:
        if value not in points:
            points[value] = measure(value)
        return points[value]

    scan = np.linspace(tight, loose, PARTS_OF_RANGE + 1).tolist()
    for value in scan:
        at(value)

    def ranges(keeps: Callable[[TradeOffPoint], bool]) -> list[tuple[float, float]]:
        found: list[tuple[float, float]] = []
        begins = tight if keeps(at(tight)) else None
        for one, other in pairwise(scan):
            is_kept = keeps(at(one))
            if is_kept == keeps(at(other)):
                continue
            good, bad = (one, other) if is_kept else (other, one)
            for _ in range(HALVINGS_OF_PART):
                middle = (good + bad) / 2.0
                good, bad = (middle, bad) if keeps(at(middle)) else (good, middle)
            if is_kept:
                assert begins is not None, "it was kept until here"
                found.append((begins, good))
            begins = None if is_kept else good
        return found if begins is None else [*found, (begins, loose)]

    kept, surely, perhaps = (
        ranges(lambda point, name=name: getattr(point, name) >= wish)  # type: ignore[misc]
        for name in ("reached", "low", "high")
    )
    return TradeOff(
        tuple(sorted(points.values(), key=lambda point: abs(point.value - tight))),
        tuple(kept),
        _loosest(kept),
        (_loosest(surely), _loosest(perhaps)),
        abs(loose - tight) / PARTS_OF_RANGE / 2**HALVINGS_OF_PART,
    )


def _loosest(ranges: Sequence[tuple[float, float]]) -> float | None:
    return ranges[-1][1] if ranges else None


RUNS_ON_WAY = 64
"""Runs on the way from the nominal value to an end, and again between the last good one and the next."""


def captured_range(good: Callable[[FloatArray], FloatArray], nominal: float, low: float, high: float) -> float:
    """Return how wide the range about ``nominal``, within ``low`` and ``high``, is in which all runs are good.

    ``good`` says of values, (n,), which of them are; each end is right to 1/`RUNS_ON_WAY` squared of the way to it.
    """
    return _end(good, nominal, high) - _end(good, nominal, low)


def _end(good: Callable[[FloatArray], FloatArray], nominal: float, end: float) -> float:
    begin = nominal
    for _ in range(2):
        values = np.linspace(begin, end, RUNS_ON_WAY + 1)
        is_good = good(values)
        if is_good.all():
            return end
        first_bad = int(is_good.argmin())
        if first_bad == 0:  # the nominal run itself
            return nominal
        begin, end = float(values[first_bad - 1]), float(values[first_bad])
    return begin
