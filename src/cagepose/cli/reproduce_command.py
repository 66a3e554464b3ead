"""``cagepose reproduce``: the paper's cases, run anew."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, refusal

if TYPE_CHECKING:
    from rich.table import Table

    from cagepose.paper.cases import Progress
    from cagepose.paper.reproduction import Reproduction


def reproduce_command(
    *,
    out: Annotated[
        FileName, FILE, Parameter(help="Folder for the report; created if it does not exist.")
    ] = "reproduction",
) -> int:
    """Run the paper's cases, write a report with pictures, and print its numbers beside ours."""
    from cagepose.errors import printable
    from cagepose.views.extra import require_report

    require_report()
    from cagepose.paper.figures import Picture
    from cagepose.paper.report import check_report_folder, write_report
    from cagepose.paper.reproduction import METHODS, reproduce

    try:
        check_report_folder(out, METHODS)
        progress = _teller()
        pictures = dict[str, Picture]()
        reproduction = reproduce(METHODS, progress, lambda part: write_report(out, part, progress, pictures))
        written = write_report(out, reproduction, progress, pictures)
    except OSError as error:
        sys.stderr.write(refusal(f"--out {out}", error) + "\n")
        return 2
    from cagepose.cli.console import print_all

    print_all(_table(reproduction))
    sys.stdout.write(printable(f"wrote {written[0]}, {written[1]} and {len(written) - 2} picture files") + "\n")
    return 0


def _teller() -> Progress:
    """Return what tells on standard error what begins, and how many seconds after now."""
    began = time.perf_counter()

    def tell(step: str) -> None:
        sys.stderr.write(f"[{time.perf_counter() - began:4.1f} s] {step}\n")
        sys.stderr.flush()

    return tell


def _table(reproduction: Reproduction) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    from cagepose.paper.comparison import cells, headings

    styles = {"agrees": "green", "differs": "red", "not derivable": "yellow", "measured": "blue"}
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in headings(reproduction.methods):
        table.add_column(heading, overflow="fold")
    for row in reproduction.rows:
        *numbers, explanation = cells(row)
        last = Text(explanation)
        last.stylize(styles[row.status], 0, len(row.status) + 1)
        table.add_row(*(Text(number) for number in numbers), last)
    return table
