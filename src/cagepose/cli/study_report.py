"""A study's findings as tables on the terminal."""

from __future__ import annotations

from typing import Any

from rich.table import Table

from cagepose.cli.console import print_all
from cagepose.cli.styles import plain_table
from cagepose.model.wording import number_of, number_or_dash, percent, range_or_dash

MOST_ROWS = 8
"""So many of the numbers that matter are printed; the page shows more."""


def print_study(found: dict[str, Any]) -> None:
    """Print yield, tolerances, what matters and the permitted box; ``found`` is what report.json holds."""
    share = found["yield"]
    parts: list[Any] = [
        f"{found['scene']}: {number_of(found['runs'], 'run')} ({found['method']})",
        f"yield {percent(share['share'])}, between {percent(share['low'])} and {percent(share['high'])} (95 %)",
        *_warnings(found),
        "",
        _verdicts(found),
        "",
        _tolerances(found),
    ]
    matters = _matters(found)
    if matters is not None:
        parts += ["", matters]
    parts += ["", *map(_box, found["maps"])] if found["maps"] else []
    print_all(*parts)


def _warnings(found: dict[str, Any]) -> list[str]:
    lines = [f"{n:,} failed ({name}): they have no result and count as not good" for name, n in found["failed"].items()]
    if found["at_rest"] and not found["yield"]["runs"]:
        rests = " and ".join(f"{n:,} as {name!r}" for name, n in found["at_rest"].items())
        lines.append(f"no run is good, though runs come to rest: {rests}; is accept right?")
    if moving := found["good_but_not_at_rest"]:
        lines.append(f"{moving:,} good runs do not come to rest; write verdict == 'rests' into accept, if they must")
    return lines


def _verdicts(found: dict[str, Any]) -> Table:
    table = plain_table("verdict", "runs", "share", "95 % interval")
    for name, share in found["verdicts"].items():
        limits = f"{percent(share['low'])} to {percent(share['high'])}"
        table.add_row(name, f"{share['runs']:,}", percent(share["share"]), limits)
    return table


def _tolerances(found: dict[str, Any]) -> Table:
    table = plain_table("quantity", "nominal", "worst case", "root sum square", "runs: 99.73 %", "runs: range")
    for row in found["tolerances"]:
        runs = row["monte_carlo"]
        pairs = (row["worst_case"], row["root_sum_square"], runs["three_sigma"], runs["range"])
        noise = row["resolution"]
        cells = [number_or_dash(row["nominal"], noise), *(range_or_dash(pair, noise) for pair in pairs)]
        table.add_row(row["name"], *cells)
    return table


def _matters(found: dict[str, Any]) -> Table | None:
    shown = [one for one in found["sensitivities"] if one["missing"] is None]
    if not shown:
        return None
    first = shown[0]
    table = plain_table(f"Sobol indices of {first['name']}", "first order", "total")
    for row in sorted(first["indices"], key=lambda row: -row["total"])[:MOST_ROWS]:
        table.add_row(
            row["key"],
            f"{row['first']:.3f} ± {row['first_interval']:.3f}",
            f"{row['total']:.3f} ± {row['total_interval']:.3f}",
        )
    return table


def _box(found: dict[str, Any]) -> str:
    layer = "".join(f", {key} {number_or_dash(value)}" for key, value in (found["layer"] or {}).items())
    if found["box"] is None:
        return f"capture map{layer}: no box, as the nominal values are not accepted, or not on the map"
    sides = [f"{key} {range_or_dash(side)}" for key, side in zip(found["over"], found["box"], strict=True)]
    return f"largest box of accepted runs{layer}: {', '.join(sides)}"
