"""Print `bench/results.json` as the tables of docs/benchmarks.md: `python -m bench.markdown`."""

from __future__ import annotations

import json
from itertools import groupby
from operator import itemgetter
from typing import Any

from bench.report import as_text, time_text
from bench.rows import RESULTS

Document = dict[str, Any]


def main() -> None:
    documents: list[Document] = json.loads(RESULTS.read_text(encoding="utf-8"))
    for table, rows in groupby(documents, itemgetter("table")):
        print(f"\n## {table}\n\n{markdown(list(rows))}")


def markdown(rows: list[Document]) -> str:
    """Return one table; a column that no row fills is left out, and what was skipped stands below."""
    measured = [row for row in rows if row["skipped"] is None]
    names = list(dict.fromkeys(name for row in measured for name in row["details"]))
    lines = []
    cells = [[row["scene"], row["engine"], time_text(row["median_s"]), *_figures(row, names)] for row in measured]
    headings = ["scene", "engine", "median", "error", "ratio", *(name.replace("_", " ") for name in names)]
    filled = [k for k in range(len(headings)) if any(line[k] for line in cells)]
    if cells:
        lines = [_line([headings[k] for k in filled]), _line(["---"] * 2 + ["---:"] * (len(filled) - 2))]
        lines += [_line([line[k] for k in filled]) for line in cells]
    lines += [f"\nSkipped: {row['engine']}, {row['scene']}: {row['skipped']}." for row in rows if row["skipped"]]
    return "\n".join(lines)


def _figures(row: Document, names: list[str]) -> list[str]:
    return [as_text(value) for value in (row["error"], row["ratio_to_ours"], *map(row["details"].get, names))]


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
