"""A report as Markdown, with its pictures in files beside it."""

from __future__ import annotations

import re
from collections.abc import Iterable

from cagepose.files.write import MADE_BY
from cagepose.paper.blocks import Block, Bullets, Heading, Paragraph, Picture, Table


def markdown_text(blocks: Iterable[Block]) -> str:
    """Return the whole text."""
    return f"<!-- {MADE_BY} -->\n\n" + "\n\n".join(_markdown(block) for block in blocks) + "\n"


def _markdown(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"{'#' * level} {_escaped(text)}"
        case Paragraph(text):
            return _escaped(text)
        case Bullets(items):
            return "\n".join(f"- {_escaped(item)}" for item in items)
        case Table():
            return _table(block)
        case Picture(stem, caption, alternative, _, _):
            return f"![{_escaped(alternative)}]({stem}.png)\n\n*{_escaped(caption)}*"


def _table(table: Table) -> str:
    head, *rows = ("| " + " | ".join(map(_escaped, cells)) + " |" for cells in (table.headings, *table.rows))
    rule = "|" + " --- |" * len(table.headings)
    return "\n".join((f"{_escaped(table.caption)}:", "", head, rule, *rows))


def _escaped(text: str) -> str:
    r"""Escape what Markdown would take for markup.

    >>> _escaped("|a| < 5 *deg*")
    '\\|a\\| \\< 5 \\*deg\\*'
    """
    return re.sub(r"([\\|*_<>`\[\]#])", r"\\\1", text)
