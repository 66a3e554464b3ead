"""What tables and verdicts look like on a terminal."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.table import Table

from cagepose.runs.run import AT_REST, FAILURES

NUMBERS = ("#", "amount")
"""Columns of numbers."""


def plain_table(*headings: str) -> Table:
    """Return a table without frames."""
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in headings:
        is_number = heading in NUMBERS
        table.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number, overflow="fold")
    return table


def verdict_style(verdict: str) -> str:
    """Return the colour of a verdict."""
    if verdict in AT_REST:
        return "bold green"
    return "bold red" if verdict in FAILURES else "bold yellow"
