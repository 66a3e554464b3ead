"""What solids became, as a table: `print_summary`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.styles import plain_table

if TYPE_CHECKING:
    from cagepose.exchange.imported_part import ImportedPart

MOST_ROWS = 24
"""So many parts are printed; a report has all."""


def print_summary(parts: Sequence[ImportedPart]) -> None:
    """Print to standard output; nothing, where nothing is known of solids."""
    if not parts:
        return
    from cagepose.errors import printable
    from cagepose.exchange.import_summary import HEADINGS, summary_rows

    table = plain_table(*HEADINGS)
    for row in summary_rows(parts[:MOST_ROWS]):
        table.add_row(*(Text(printable(cell)) for cell in row))
    more = len(parts) - MOST_ROWS
    print_all("", table, "", *([Text(f"and {more} parts more")] if more > 0 else []))
