"""`python -m bench [--only TABLE]`: measure, print, and save to `bench/results.json`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator

from rich.console import Console

from bench.batch_table import batch_rows
from bench.first_use_table import first_use_rows
from bench.growth_table import growth_rows
from bench.rail_table import rail_rows
from bench.report import show
from bench.rows import RESULTS, Row, machine, save
from bench.scenes_table import scene_rows
from bench.shapes_table import shape_rows

TABLES: dict[str, Callable[[], Iterator[Row]]] = {
    "rail": rail_rows,
    "scenes": scene_rows,
    "shapes": shape_rows,
    "growth": growth_rows,
    "batch": batch_rows,
    "first-use": first_use_rows,
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("--only", choices=sorted(TABLES), help="measure this table alone")
    only = parser.parse_args().only
    console = Console(width=120)
    began = time.perf_counter()
    rows: list[Row] = []
    for table in [only] if only else TABLES:
        found = []
        with console.status("") as status:
            for row in TABLES[table]():
                status.update(f"{table}: {row.scene}, {row.engine}  ({time.perf_counter() - began:.0f} s)")
                found.append(row)
        show(console, table, found)
        rows += found
        save(rows)
    described = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in machine().items())
    console.print(f"{described}\n{len(rows)} rows in {RESULTS}, {time.perf_counter() - began:.0f} s", markup=False)


if __name__ == "__main__":
    main()
