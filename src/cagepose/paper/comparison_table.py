"""The paper's numbers beside ours as texts, in the paper's own units: for the terminal and for the report alike."""

from __future__ import annotations

from collections.abc import Sequence

from cagepose.paper.printed import Printed, Row, Unit, Value, in_unit

MORE_DIGITS = 3
"""Decimals shown beyond those that the paper prints."""
NOTHING = "-"


def headings(methods: Sequence[str]) -> list[str]:
    """Return the table's columns; the difference is that of the paper's method."""
    return ["section", "quantity", "paper", *methods, "closed form", "difference", "explanation"]


def cells(row: Row) -> list[str]:
    """Return the texts of one line."""
    printed = row.printed
    return [
        row.section,
        row.quantity,
        _printed(printed),
        *(_value(value, printed) for value in row.found.values()),
        _value(row.closed_form, printed),
        _difference(row),
        f"{row.status.capitalize()}. {row.explanation}",
    ]


def error_cells(row: Row) -> list[str]:
    """Return the quantity, and each method's difference from the closed form in scientific notation."""
    return [row.quantity, *(_error(row.error(method), row.printed.unit) for method in row.found)]


def _error(error: float | None, unit: Unit) -> str:
    if error is None:
        return NOTHING
    return f"{in_unit(error, unit):.1e} {unit}" if error else f"0 {unit}"


def _printed(printed: Printed) -> str:
    return f"{'< ' if printed.is_bound else ''}{printed.text} {printed.unit}".rstrip()


def _value(value: Value, printed: Printed) -> str:
    if value is None:
        return NOTHING
    if isinstance(value, str):
        return value
    return f"{_rounded(in_unit(value, printed.unit), printed)} {printed.unit}"


def _difference(row: Row) -> str:
    difference = row.difference()
    if difference is None:
        return NOTHING
    unit: Unit = row.printed.unit
    return f"{_rounded(in_unit(difference, unit), row.printed, sign='+')} {unit}"


def _rounded(number: float, printed: Printed, sign: str = "") -> str:
    if printed.unit == "s":  # our times are a thousandth of the paper's
        return f"{number:{sign}.3g}"
    decimals = len(printed.text.partition(".")[2]) + MORE_DIGITS
    text = f"{number:{sign}.{decimals}f}"
    return "0" if float(text) == 0.0 else text
