"""What solids and bodies of models became, as a table: `print_summary`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.styles import plain_table
from cagepose.model.wording import number_of

if TYPE_CHECKING:
    from cagepose.exchange.imported_part import ImportedPart
    from cagepose.exchange.model_parts import Weight

MOST_ROWS = 24
"""So many parts are printed; a report has all."""


def print_summary(parts: Sequence[ImportedPart], weight: Weight | None) -> None:
    """Print to standard output; nothing, where the source measures nothing."""
    if not parts:
        return
    from cagepose.errors import printable
    from cagepose.exchange.import_summary import HEADINGS, summary_rows, weight_words

    table = plain_table(*HEADINGS)
    for row in summary_rows(parts[:MOST_ROWS]):
        table.add_row(*(Text(printable(cell)) for cell in row))
    more = len(parts) - MOST_ROWS
    below = [f"and {number_of(more, 'part')} more"] if more > 0 else []
    below += [weight_words(weight)] if weight else []
    print_all("", table, "", *(Text(line) for line in below), *([""] if below else []))
