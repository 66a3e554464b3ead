"""Flags that hold three numbers, such as ``--at=1,2,3``."""

from __future__ import annotations

from math import isfinite

from cagepose.errors import printable


def read_triple(flag: str, text: str, problems: list[str]) -> tuple[float, ...]:
    """Return the three numbers of a flag; what is wrong with them goes to ``problems``."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(isfinite(number) for number in numbers):
        problems.append(printable(f"{flag} {text}: is not three numbers; write them as x,y,z without blanks"))
        return (1.0, 0.0, 0.0)
    return numbers
