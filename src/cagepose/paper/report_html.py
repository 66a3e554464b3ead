"""A report as one HTML page that needs nothing else: pictures within, no script, no font, no address."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from html import escape

from cagepose.files.write import MADE_BY
from cagepose.paper.blocks import Block, Bullets, Heading, Paragraph, Picture, Table

STYLE = """
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 68rem; padding: 2rem 1.5rem 4rem; background: #fff; color: #1b1b1b;
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 1rem; }
h2 { font-size: 1.35rem; margin: 2.6rem 0 .6rem; padding-top: .6rem; border-top: 2px solid #0072b2; }
h3 { font-size: 1.1rem; margin: 2rem 0 .4rem; }
p, ul { max-width: 46rem; }
li { margin: .35rem 0; }
table { border-collapse: collapse; width: 100%; margin: 1.2rem 0; font-size: .86rem; line-height: 1.4; }
caption { text-align: left; font-weight: 600; padding: 0 0 .5rem; }
th, td { padding: .38rem .55rem; text-align: left; vertical-align: top; border-bottom: 1px solid #d9d9d9; }
th { border-bottom: 2px solid #1b1b1b; }
td.short { font-variant-numeric: tabular-nums; }
td.number { white-space: nowrap; }
tr.agrees td:last-child { border-left: 5px solid #009e73; }
tr.differs td:last-child { border-left: 5px solid #d55e00; }
tr.not-derivable td:last-child { border-left: 5px dotted #6e6e6e; }
tr.measured td:last-child { border-left: 5px double #0072b2; }
td.wide { min-width: 17rem; }
figure { margin: 1.6rem 0 2.2rem; }
figure img { display: block; width: 100%; max-width: 52rem; height: auto; }
figcaption { max-width: 46rem; margin-top: .5rem; font-size: .9rem; color: #3c3c3c; }
.scroll { overflow-x: auto; }
@page { size: A4; margin: 14mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  table { font-size: 7.5pt; }
  th, td { padding: 1.2mm 1mm; }
  td.wide { min-width: 0; }
  thead { display: table-header-group; }
  tr, figure { break-inside: avoid; }
  figure img { max-height: 170mm; width: auto; max-width: 100%; }
  h2, h3 { break-after: avoid; }
  .scroll { overflow: visible; }
}
"""


def html_page(title: str, blocks: Iterable[Block]) -> str:
    """Return the whole page."""
    body = "\n".join(_html(block) for block in blocks)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="generator" content="{MADE_BY}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n"
    )


def _html(block: Block) -> str:
    match block:
        case Heading(text, level):
            return f"<h{level}>{escape(text)}</h{level}>"
        case Paragraph(text):
            return f"<p>{escape(text)}</p>"
        case Bullets(items):
            return "<ul>\n" + "\n".join(f"<li>{escape(item)}</li>" for item in items) + "\n</ul>"
        case Table():
            return _table(block)
        case Picture(_, caption, alternative, png, _):
            data = b64encode(png).decode()
            return (
                f'<figure>\n<img alt="{escape(alternative)}" src="data:image/png;base64,{data}">\n'
                f"<figcaption>{escape(caption)}</figcaption>\n</figure>"
            )


def _table(table: Table) -> str:
    head = "".join(f'<th scope="col">{escape(heading)}</th>' for heading in table.headings)
    kinds = table.kinds or [""] * len(table.rows)
    first_wide = len(table.headings) - table.n_wide
    rows = []
    for cells, kind in zip(table.rows, kinds, strict=True):
        tint = f' class="{escape(kind.replace(" ", "-"))}"' if kind else ""
        texts = "".join(f"<td{_looks(column, first_wide)}>{escape(cell)}</td>" for column, cell in enumerate(cells))
        rows.append(f"<tr{tint}>{texts}</tr>")
    return (
        f'<div class="scroll"><table>\n<caption>{escape(table.caption)}</caption>\n<thead><tr>{head}</tr></thead>\n'
        "<tbody>\n" + "\n".join(rows) + "\n</tbody>\n</table></div>"
    )


def _looks(column: int, first_wide: int) -> str:
    if column >= first_wide:
        return ' class="wide"'
    return ' class="short number"' if column > 1 else ' class="short"'
