"""Time one compiled run of each scene: median of many in one process, the first call (compile or load) apart.

Machines are noisy and differ: compare figures of one table, not of two. ``make bench``, or ``make bench ONLY=rail`` for
the scenes whose names hold "rail".
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

SCENES = Path(__file__).resolve().parent.parent / "scenes"
N_RUNS = 2000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="run only scenes whose file names hold this text")
    only = parser.parse_args().only

    began = time.perf_counter()
    from cagepose import load_scene, run

    import_s = time.perf_counter() - began
    table = Table(title=f"median of {N_RUNS} runs each, in one process")
    for heading in ("scene", "method", "verdict", "events", "run, us", "fastest, us", "events/s", "first, s"):
        table.add_column(heading, justify="left" if heading in ("scene", "method", "verdict") else "right")
    for path in sorted(SCENES.glob("*.yaml")):
        if only not in path.name:
            continue
        scene = load_scene(path)
        began = time.perf_counter()
        result = run(scene)
        first_s = time.perf_counter() - began
        times_s = [run(scene).solve_s for _ in range(N_RUNS)]
        median_s = statistics.median(times_s)
        n_events = sum(len(phase.events) for phase in result.phases)
        table.add_row(
            path.stem,
            result.method,
            result.verdict,
            str(n_events),
            f"{median_s * 1e6:.1f}",
            f"{min(times_s) * 1e6:.1f}",
            f"{n_events / median_s:,.0f}",
            f"{first_s:.2f}",
        )
    console = Console(width=100)
    console.print(table)
    console.print(f"import of cagepose.run: {import_s:.2f} s. 'first' compiles the kernels, or loads them from disk.")


if __name__ == "__main__":
    main()
