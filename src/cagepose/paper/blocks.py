"""What a report is made of, before it becomes HTML or Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from cagepose.views.style import figure_bytes


@dataclass(frozen=True)
class Heading:
    """A title; ``level`` 1 is that of the report."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """Plain text."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of plain texts."""

    items: Sequence[str]


@dataclass(frozen=True)
class Table:
    """Cells of plain text, row by row.

    Attributes
    ----------
    caption
        Stands above it.
    headings, rows
        One text for each column.
    kinds
        A word for each row, by which it is tinted; none: no tints.
    n_wide
        So many columns at the end hold sentences, the others numbers and names.
    """

    caption: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    kinds: Sequence[str] = ()
    n_wide: int = 0


@dataclass(frozen=True)
class Picture:
    """A figure, written once for the screen and once for print.

    Attributes
    ----------
    stem
        Name of its files, without the suffix.
    caption
        Stands below it.
    alternative
        What it shows, for whoever cannot see it.
    png, svg
        The files' content.
    """

    stem: str
    caption: str
    alternative: str
    png: bytes
    svg: bytes


Block = Heading | Paragraph | Bullets | Table | Picture


def picture(stem: str, figure: Figure, caption: str, alternative: str) -> Picture:
    """Write a figure in both forms."""
    return Picture(stem, caption, alternative, figure_bytes(figure, ".png"), figure_bytes(figure, ".svg"))
