"""`python -m bench [--only TABLE]`: measure, print, save to `bench/results.json`; 1 if something is over its limit."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator

from rich.console import Console

from bench.batch_table import batch_rows
from bench.drives_table import drive_rows
from bench.first_use_table import first_use_rows
from bench.growth_table import growth_rows
from bench.limits import measured_limits
from bench.pulls_table import pull_rows
from bench.rail_table import rail_rows
from bench.report import show
from bench.rows import RESULTS, Row, machine, save
from bench.scenes_table import scene_rows
from bench.shapes_table import shape_rows

TABLES: dict[str, Callable[[], Iterator[Row]]] = {
    "rail": rail_rows,
    "scenes": scene_rows,
    "shapes": shape_rows,
    "drives": drive_rows,
    "growth": growth_rows,
    "batch": batch_rows,
    "first-use": first_use_rows,
    "pulls": pull_rows,
}


LIMITS = "limits"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("--only", choices=[*sorted(TABLES), LIMITS], help="measure this table alone")
    only = parser.parse_args().only
    console = Console(width=120)
    began = time.perf_counter()
    rows: list[Row] = []
    for table in TABLES if only is None else [only] if only != LIMITS else []:
        found = []
        with console.status("") as status:
            for row in TABLES[table]():
                status.update(f"{table}: {row.scene}, {row.engine}  ({time.perf_counter() - began:.0f} s)")
                found.append(row)
        show(console, table, found)
        rows += found
        save(rows)
    is_over = False
    for name, value, limit in measured_limits() if only in (None, LIMITS) else ():
        is_over |= value > limit
        console.print(f"{name}: {value:.1f}, {'over' if value > limit else 'within'} its limit of {limit}")
    described = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in machine().items())
    console.print(f"{described}\n{len(rows)} rows in {RESULTS}, {time.perf_counter() - began:.0f} s", markup=False)
    return int(is_over)


if __name__ == "__main__":
    sys.exit(main())
