"""What tables and verdicts look like on a terminal."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.table import Table

from cagepose.studies.ending import Kind, verdict_kind

NUMBERS = ("#", "amount", "driven to")
"""Columns of numbers."""
STYLES: dict[Kind, str] = {
    "rest": "bold green",
    "open": "bold yellow",
    "failure": "bold red",
    "elsewhere": "bold yellow",
}


def plain_table(*headings: str) -> Table:
    """Return a table without frames."""
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in headings:
        is_number = heading in NUMBERS
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number, overflow="fold")
    return table


def verdict_style(verdict: str) -> str:
    """Return the colour of a verdict."""
    return STYLES[verdict_kind(verdict)]
