"""One number of the paper beside what the program finds: whether they agree, and as texts for terminal and report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

Unit = Literal["mm", "deg", "rad", "s", ""]
"""How the paper prints a quantity; "": words."""
Value = float | str | None
"""A number in metres, radians or seconds; words; None where there is none."""
Status = Literal["agrees", "differs", "not derivable", "measured"]

PAPER_METHOD = "stepwise"
"""The method that the paper describes: its value, and geometry, are what a printed number is held against."""
MORE_DIGITS = 3
"""Decimals shown beyond those that the paper prints."""
NOTHING = "-"

_SI: dict[Unit, float] = {"mm": 1e-3, "deg": math.pi / 180.0, "rad": 1.0, "s": 1.0, "": 1.0}
_ROUNDED = 0.5 + 1e-9
"""Half a unit of the last digit, and rounding of binary fractions."""


@dataclass(frozen=True)
class Printed:
    """What the paper prints.

    Attributes
    ----------
    text, unit
        The number as printed, such as "28.96", and its unit there; or words.
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
    def decimals(self) -> int:
        """How many the paper prints."""
        return len(self.text.partition(".")[2])

    def agrees_with(self, value: float | str) -> bool:
        """Whether ``value`` is this to the last printed digit, or lies beyond it if this is an upper limit."""
        if isinstance(value, str) or isinstance(self.value, str) or self.value is None:
            return value == self.value
        if self.is_bound:
            return value >= self.value
        return abs(value - self.value) <= _ROUNDED * 10.0**-self.decimals * _SI[self.unit]

    def shown(self, value: Value, sign: str = "") -> str:
        """Return a value as a text in the paper's unit, with more digits than the paper's."""
        if value is None or isinstance(value, str):
            return value or NOTHING
        number = value / _SI[self.unit]
        # Our times are a thousandth of the paper's.
        text = f"{number:{sign}.3g}" if self.unit == "s" else f"{number:{sign}.{self.decimals + MORE_DIGITS}f}"
        return f"{'0' if float(text) == 0.0 else text} {self.unit}"


@dataclass(frozen=True)
class Row:
    """One line of the comparison.

    Attributes
    ----------
    section, quantity
        Where it stands in the paper, such as "IV.B", and what it is.
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
        return _difference(self.closed_form if value is None else value, self.printed.value)

    def error(self, method: str) -> float | None:
        """Return what a method finds less the closed form; None where either is missing or a word."""
        return _difference(self.found[method], self.closed_form)


def compared(found: Mapping[str, Value], closed_form: Value, printed: Printed) -> Status:
    """Say whether what the paper's method finds, and the closed form, agree with what the paper prints."""
    known = [value for value in (found[PAPER_METHOD], closed_form) if value is not None]
    return "agrees" if known and all(printed.agrees_with(value) for value in known) else "differs"


def _difference(value: Value, other: Value) -> float | None:
    return value - other if isinstance(value, float) and isinstance(other, float) else None


def headings(methods: Sequence[str]) -> list[str]:
    """Return the headings of `cells`; the difference is that of the paper's method."""
    return ["section", "quantity", "paper", *methods, "closed form", "difference", "explanation"]


def cells(row: Row) -> list[str]:
    """Return the texts of one line."""
    printed = row.printed
    return [
        row.section,
        row.quantity,
        f"{'< ' if printed.is_bound else ''}{printed.text} {printed.unit}".rstrip(),
        *(printed.shown(value) for value in row.found.values()),
        printed.shown(row.closed_form),
        printed.shown(row.difference(), sign="+"),
        f"{row.status.capitalize()}. {row.explanation}",
    ]


def error_cells(row: Row) -> list[str]:
    """Return the quantity, and each method's difference from the closed form in scientific notation."""
    return [row.quantity, *(_error(row.error(method), row.printed.unit) for method in row.found)]


def _error(error: float | None, unit: Unit) -> str:
    if error is None:
        return NOTHING
    return f"{error / _SI[unit]:.1e} {unit}" if error else f"0 {unit}"
