"""Numbers and counts as people read them: in `repr`, in tables, in messages."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.tolerances import SHOWN_AS_ZERO


def short(value: float, digits: int, noise: float) -> str:
    """Return a number as people read it; below ``noise`` it is zero."""
    return "0" if abs(value) < noise else f"{value:.{digits}g}"


def components(direction: FloatArray) -> str:
    """Return a unit vector to four digits."""
    return ", ".join(short(value, 4, 5e-5) for value in direction.tolist())


def number_or_dash(value: float | None, noise: float = 0.0) -> str:
    """Return a number as people read it; a dash where there is none; below ``noise`` it is zero.

    >>> number_or_dash(0.12345649), number_or_dash(None), number_or_dash(-0.0), number_or_dash(-5e-15, 1e-9)
    ('0.12346', '-', '0', '0')
    """
    return "-" if value is None else short(value + 0.0, 5, noise)


def range_or_dash(ends: Sequence[float | None], noise: float = 0.0) -> str:
    """Return two ends, as `number_or_dash` each; one dash where there is neither.

    >>> range_or_dash([-1.5, 1e-16], 1e-9), range_or_dash([None, None])
    ('-1.5 to 0', '-')
    """
    return " to ".join(number_or_dash(end, noise) for end in ends) if any(end is not None for end in ends) else "-"


def percent(share: float) -> str:
    """Return a share: more digits near all and none, so that one of a million is seen.

    >>> percent(0.5), percent(0.99973), percent(1.0), percent(1e-6), percent(1.0 - 3.84e-6)
    ('50.00 %', '99.973 %', '100 %', '0.00010 %', '99.99962 %')
    """
    least = min(share, 1.0 - share)
    if least <= 0.0:
        return f"{100.0 * share:.0f} %"
    digits = 2 if least >= 0.01 else max(3, 1 + math.ceil(-math.log10(100.0 * least)))
    return f"{100.0 * share:.{digits}f} %"


def duration(seconds: float) -> str:
    """Return how long something took, as people say it.

    >>> duration(0.000251), duration(0.0236), duration(4.24), duration(23.6), duration(200.0), duration(9000.0)
    ('0.25 ms', '24 ms', '4.2 s', '24 s', '3 min 20 s', '2 h 30 min')
    """
    minutes, rest = divmod(round(seconds), 60)
    if minutes >= 60:
        return f"{minutes // 60} h {minutes % 60} min"
    if minutes >= 1:
        return f"{minutes} min {rest} s"
    amount, unit = (seconds, "s") if seconds >= 0.9995 else (1000.0 * seconds, "ms")
    return f"{amount:.0f} {unit}" if amount >= 99.5 else f"{amount:.2g} {unit}"


def coordinates(values: FloatArray, digits: int = 6) -> str:
    """Return numbers in round brackets.

    >>> coordinates(np.array([0.26, -0.0, 1e-19]))
    '(0.26, 0, 0)'
    """
    noise = SHOWN_AS_ZERO * float(np.abs(values).max(initial=0.0)) or SHOWN_AS_ZERO
    return f"({', '.join(short(value, digits, noise) for value in values.tolist())})"


def number_of(count: int, one: str, many: str | None = None) -> str:
    """Return how many there are of what; its plural is that of most words, if none is given.

    >>> number_of(1, "contact"), number_of(12_000, "run"), number_of(2, "vertex", "vertices")
    ('1 contact', '12,000 runs', '2 vertices')
    """
    return f"{count:,} {one if count == 1 else many or f'{one}s'}"


def counted(*numbers: tuple[int, str, str]) -> str:
    """Return how many there are of what, each with its singular and its plural; of what there is none of, nothing.

    >>> counted((1, "box", "boxes"), (0, "shape", "shapes"), (2, "hole", "holes"))
    '1 box, 2 holes'
    """
    return ", ".join(f"{number:,} {one if number == 1 else many}" for number, one, many in numbers if number)


def few(names: Iterable[str], most: int = 4) -> str:
    """Return the first of some names, and how many more there are.

    >>> few(["C1", "C2", "C3", "C4", "C5", "C6"])
    'C1, C2, C3, C4 and 2 more'
    """
    all_names = list(names)
    rest = len(all_names) - most
    shown = ", ".join(all_names[:most])
    return f"{shown} and {rest} more" if rest > 0 else shown
