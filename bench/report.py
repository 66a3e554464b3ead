"""Tables of rows on the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from bench.rows import Row

TITLES = {
    "rail": "The rail: gravity, then the push. Error: tilt, as a part of the play angle. Ratio: to the slower of ours",
    "scenes": "All scenes, both methods: solve and proof",
    "shapes": "True shapes beside MuJoCo. Apart, penetration: in sizes of the scene. Ratio: to ours",
    "drives": "Drives beside MuJoCo, tuned for each. Apart: the farthest point, or body. Ratio: to ours",
    "growth": "How the cost of one run grows: exponent of a power law fitted to the upper half",
    "batch": "Many runs in one call",
    "first-use": "The first run in a new process",
    "pulls": "Pulls by hand in the live viewer: from the pointer's move to the picture. Depth: in sizes of the scene",
}


def show(console: Console, table: str, rows: Sequence[Row]) -> None:
    """Print the rows of one table, then what was skipped and why."""
    measured = [row for row in rows if row.skipped is None]
    details = list(dict.fromkeys(name for row in measured for name in row.details))
    has_error = any(row.error is not None for row in measured)
    has_ratio = any(row.ratio_to_ours is not None for row in measured)
    drawn = Table(title=TITLES.get(table, table), title_justify="left")
    drawn.add_column("scene")
    drawn.add_column("engine")
    headings = ["median"] + ["error"] * has_error + ["ratio"] * has_ratio + [name.replace("_", " ") for name in details]
    for heading in headings:
        drawn.add_column(heading, justify="right")
    before = None
    for row in measured:
        if before is not None and row.scene != before:
            drawn.add_section()
        cells = [row.scene if row.scene != before else "", row.engine, time_text(row.median_s)]
        cells += [as_text(row.error)] * has_error + [as_text(row.ratio_to_ours)] * has_ratio
        drawn.add_row(*cells, *(as_text(row.details.get(name)) for name in details))
        before = row.scene
    if measured:
        console.print(drawn)
    for row in rows:
        if row.skipped is not None:
            console.print(f"skipped: {row.engine}, {row.scene}: {row.skipped}", markup=False)


def time_text(seconds: float | None) -> str:
    """Write a time in the unit that suits it; None: nothing."""
    if seconds is None:
        return ""
    if seconds >= 1.0:
        return f"{seconds:.3g} s"
    return f"{seconds * 1e3:.3g} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.3g} us"


def as_text(value: object) -> str:
    """Write a figure with two digits or so; None: nothing."""
    if value is None:
        return ""
    if not isinstance(value, float):
        return str(value)
    if value == 0.0 or math.isinf(value):
        return f"{value:g}"
    return f"{value:.1e}" if abs(value) < 1e-3 else f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.2g}"
