"""A `SeatedPlay` as text: how far each freedom goes from the seated pose, and what stops it."""

from __future__ import annotations

import math

from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.styles import plain_table
from cagepose.files.play_document import LENGTHS
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.wording import short
from cagepose.studies.seated_play import SeatedEnd, SeatedPlay, SeatedRange

DIGITS, NOISE = 5, 1e-9
MEANING = (
    "seated: while all points that carry load stay closed; lifted: any of them may open; to first order, and free:"
    " nothing nearby ends it"
)


def print_seated_play(found: SeatedPlay, names: tuple[str, ...], unit: LengthUnit) -> None:
    """Print to standard output, lengths in ``unit``, angles in degrees; ``names`` are those of the points asked."""
    print_all(Text(f"{found.run.scene.name}: play from where {found.phase} has seated it, in the cage's frame"))
    print_all(Text(f"load is carried by {', '.join(found.bearing)}"), "")
    table = plain_table("", "unit", "seated", "stopped by", "lifted", "stopped by")
    rows = [*found.freedoms.items(), *zip(names, found.points, strict=True)]
    for name, ends in rows:
        is_length = name in LENGTHS or name not in found.freedoms
        table.add_row(*(Text(cell) for cell in (name, unit if is_length else "deg", *_cells(ends, is_length, unit))))
    print_all(table, "", Text(MEANING))


def _cells(ends: SeatedRange, is_length: bool, unit: LengthUnit) -> list[str]:
    cells = []
    for low, high in (ends.seated, ends.lifted):
        cells.append(f"{_value(low, is_length, unit)} to {_value(high, is_length, unit)}")
        cells.append("; ".join(" ".join(end.stops) or "-" for end in (low, high)))
    return cells


def _value(end: SeatedEnd, is_length: bool, unit: LengthUnit) -> str:
    if end.value is None:
        return "free"
    return short(float(from_metres(end.value, unit)) if is_length else math.degrees(end.value), DIGITS, NOISE)
