"""One printed number of the paper beside what the program finds: the row of a table, without its looks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Unit = Literal["mm", "deg", "rad", "s", ""]
"""How the paper prints a quantity; "": words."""
Value = float | str | None
"""A number in metres, radians or seconds; words; None where there is none."""
Status = Literal["agrees", "differs", "not derivable", "measured"]

PAPER_METHOD = "stepwise"
"""The method that the paper describes: its value, and geometry, are what a printed number is held against."""

_SI: dict[Unit, float] = {"mm": 1e-3, "deg": math.pi / 180.0, "rad": 1.0, "s": 1.0, "": 1.0}
_ROUNDED = 0.5 + 1e-9
"""Half a unit of the last digit, and rounding of binary fractions."""


@dataclass(frozen=True)
class Printed:
    """What the paper prints.

    Attributes
    ----------
    text
        The number as printed, such as "28.96", or words.
    unit
        Its unit there.
    is_bound
        It is given as an upper limit ("< 5 deg"), so a greater limit agrees with it.
    """

    text: str
    unit: Unit = ""
    is_bound: bool = False

    @property
    def value(self) -> Value:
        """The number in metres, radians or seconds; or the words."""
        return self.text if self.unit == "" else float(self.text) * _SI[self.unit]

    @property
    def last_digit(self) -> float:
        """One unit of the last printed digit, in metres, radians or seconds.

        >>> Printed("0.554", "s").last_digit
        0.001
        """
        decimals = len(self.text.partition(".")[2])
        return float(f"1e-{decimals}") * _SI[self.unit]

    def agrees_with(self, value: float | str) -> bool:
        """Whether ``value`` is this to the last printed digit, or lies beyond it if this is an upper limit."""
        if isinstance(value, str) or isinstance(self.value, str) or self.value is None:
            return value == self.value
        if self.is_bound:
            return value >= self.value
        return abs(value - self.value) <= _ROUNDED * self.last_digit


def in_unit(value: float, unit: Unit) -> float:
    """Turn metres, radians or seconds into what the paper prints.

    >>> in_unit(0.005, "mm")
    5.0
    """
    return value / _SI[unit]


@dataclass(frozen=True)
class Row:
    """One line of the comparison.

    Attributes
    ----------
    section
        Of the paper, such as "IV.B".
    quantity
        What it is.
    printed
        What the paper prints.
    found
        What each method finds, by its name; None: the method does not speak about it. One is `PAPER_METHOD`.
    closed_form
        From geometry alone; None where there is none.
    status
        "agrees" to the paper's last digit, "differs", "not derivable" from the paper's text, or "measured" on this
        machine.
    explanation
        Why.
    """

    section: str
    quantity: str
    printed: Printed
    found: Mapping[str, Value]
    closed_form: Value
    status: Status
    explanation: str

    def difference(self) -> float | None:
        """Return what the paper's method finds, else the closed form, less what the paper prints; None for words."""
        value = self.found[PAPER_METHOD]
        value = self.closed_form if value is None else value
        return _difference(value, self.printed.value)

    def error(self, method: str) -> float | None:
        """Return what a method finds less the closed form; None where either is missing or a word."""
        return _difference(self.found[method], self.closed_form)


def compared(found: Mapping[str, Value], closed_form: Value, printed: Printed) -> Status:
    """Say whether what the paper's method finds, and the closed form, agree with what the paper prints."""
    known = [value for value in (found[PAPER_METHOD], closed_form) if value is not None]
    return "agrees" if known and all(printed.agrees_with(value) for value in known) else "differs"


def _difference(value: Value, other: Value) -> float | None:
    if isinstance(value, float) and isinstance(other, float):
        return value - other
    return None
