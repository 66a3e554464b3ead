"""An `Insertion` as text: how far, with which force, where it could jam, and how far all may be out of place."""

from __future__ import annotations

import math

from rich.table import Table
from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.drive_report import lines_of_phase
from cagepose.cli.styles import plain_table, verdict_style
from cagepose.files.units import LengthUnit, from_metres
from cagepose.files.words import LengthWords, names_of
from cagepose.model.wording import short
from cagepose.studies.insertion_result import Insertion
from cagepose.studies.misalignment import LENGTHS, SHORT, MisalignmentEnd

ENDS = {
    SHORT: "falls short: the drive reaches its end, but the object does not",
    "overlaps": "overlaps: the object would start inside the cage",
}
"""What ends a side, where its word is no verdict of a run."""


def print_insertion(insertion: Insertion, unit: LengthUnit) -> None:
    """Print to standard output, lengths in ``unit``, angles in degrees."""
    run, words = insertion.run, LengthWords(unit, insertion.run.scene.size_m)
    title = Text(f"{run.scene.name}, {run.scene.loads[insertion.phase].name}: ")
    title.append(insertion.verdict, style=verdict_style(insertion.verdict))
    table = Table.grid(padding=(0, 2))
    for name, value in insertion_lines(insertion, words):
        table.add_row(Text(name), Text(value, overflow="fold"))
    print_all(title, "", table)
    if insertion.misalignment:
        print_all("", Text(meaning(insertion)), "", permitted(insertion, unit))
    for warning in run.warnings:
        print_all(Text(f"warning: {warning}", style="yellow"))


def insertion_lines(insertion: Insertion, words: LengthWords) -> list[tuple[str, str]]:
    """Return what came of the drive, and what that says about jamming."""
    run, number = insertion.run, insertion.phase
    if insertion.ended is None:
        before = run.phases[-1].name
        return [("drive", f"it did not start: {before} did not come to rest ({run.verdict})")]
    lines = list(lines_of_phase(run, number, words, is_alone=True))
    if insertion.drive is None:
        return lines
    friction = short(insertion.friction, 6, 1e-9)
    if insertion.least_jam_share is not None:
        where = words.depth(run.scene.loads[number], insertion.least_jam_share)
        lines.append(("", f"the first place to jam, as friction grows, is at {where}"))
    if insertion.cannot_jam:
        within = (
            f"at a friction of {friction} or less" if insertion.friction else "as long as nothing rubs (friction 0)"
        )
        lines.append(("", f"it cannot jam with these contacts along this path, {within}"))
    return lines


def meaning(insertion: Insertion) -> str:
    """Return what the table of how far all may be out of place says."""
    what = names_of(insertion.bodies) + (" with the object" if insertion.takes_object else "")
    return f"Permitted misalignment of {what}, one freedom at a time, and how it fails just outside:"


def permitted(insertion: Insertion, unit: LengthUnit) -> Table:
    """Return that table, a row for each freedom."""
    table = plain_table("", "unit", "from", "to", "fails below", "fails above")
    for name, found in insertion.misalignment.items():
        is_length = name in LENGTHS
        cells = (
            name,
            str(unit) if is_length else "deg",
            *(_value(end, is_length, unit) for end in (found.low, found.high)),
            *(_verdict(end) for end in (found.low, found.high)),
        )
        table.add_row(*(Text(cell, overflow="fold") for cell in cells))
    return table


def _value(end: MisalignmentEnd, is_length: bool, unit: LengthUnit) -> str:
    """Return an end as a number, as ``at least`` one, or a dash: not even where the scene has it."""
    if end.permitted is None:
        return "-"
    shown = float(from_metres(end.permitted, unit)) if is_length else math.degrees(end.permitted)
    return f"{'at least ' if end.fails_at is None else ''}{short(shown, 4, 1e-12)}"


def _verdict(end: MisalignmentEnd) -> str:
    if end.verdict is None:
        return "not searched"
    told = ENDS.get(end.verdict, end.verdict)
    return f"{told} (the run failed: the mechanism may permit more)" if end.is_failure else told
