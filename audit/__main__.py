"""`python -m audit [--scenes N] [--family NAME] [--case FAMILY:INDEX]`: ask all oracles, print counts and failures."""

from __future__ import annotations

import argparse
import math
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from rich.console import Console

from audit.families import FAMILIES, ROUND, WITH_SHAPES
from audit.oracles import Finding, examine_drawn
from audit.report import read_known, show_endings, show_failures, show_mended, show_oracles, show_times

DEFAULT_SCENES = 6075
"""About six minutes on two cores."""
OUT = Path("build/audit")
CHUNK = 4
WIDTH = 170
ALL_ROUND = "round"
FEWER = 4
"""Beside the other families, of those with round shapes one case is asked in so many."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m audit", description=__doc__)
    parser.add_argument(
        "--scenes", type=int, default=DEFAULT_SCENES, metavar="N", help="in all, shared by the families"
    )
    parser.add_argument(
        "--family", action="append", choices=(*FAMILIES, ALL_ROUND), help="ask this family alone; may be repeated"
    )
    parser.add_argument("--case", action="append", metavar="FAMILY:INDEX", help="ask this case alone; may be repeated")
    parser.add_argument("--seed", type=int, default=0, help="of all random draws")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=OUT, help="folder for the scenes that fail")
    given = parser.parse_args()
    wanted = given.family or FAMILIES
    families = tuple(name for name in FAMILIES if name in wanted or (name in ROUND and ALL_ROUND in wanted))
    chosen = [_named(parser, text) for text in given.case or ()] or _all(families, given.scenes)

    console = Console(width=WIDTH)
    began = time.perf_counter()
    findings = []
    with console.status("") as status:
        for finding in _examined(chosen, given.seed, given.processes):
            findings.append(finding)
            status.update(f"{len(findings)} of {len(chosen)} cases  ({time.perf_counter() - began:.0f} s)")
    known = read_known() if given.seed == 0 else {}
    findings.sort(key=lambda finding: (FAMILIES.index(finding.family), finding.index))
    failures = sorted((f for finding in findings for f in finding.failures), key=lambda failure: failure.oracle)
    show_endings(console, findings)
    show_oracles(console, findings)
    show_times(console, findings)
    is_bad = show_failures(console, failures, given.out, given.seed, known)
    show_mended(console, findings, known)
    console.print(f"{len(findings)} cases, {len(failures)} failures, {time.perf_counter() - began:.0f} s")
    return int(is_bad)


def _all(families: Sequence[str], n_scenes: int) -> list[tuple[str, int]]:
    """Family by family in turn, so that slow ones are spread over the processes."""
    is_mixed = not set(families) <= set(WITH_SHAPES)
    shares = [1 / FEWER if is_mixed and family in WITH_SHAPES else 1.0 for family in families]
    counts = [math.ceil(n_scenes * share / sum(shares)) for share in shares]
    return [
        (family, index)
        for index in range(max(counts))
        for family, count in zip(families, counts, strict=True)
        if index < count
    ]


def _named(parser: argparse.ArgumentParser, text: str) -> tuple[str, int]:
    family, _, index = text.rpartition(":")
    if family not in FAMILIES or not index.isdigit():
        parser.error(f"--case {text}: give a family and a number, such as grid:12; families: {', '.join(FAMILIES)}")
    return family, int(index)


def _examined(chosen: Sequence[tuple[str, int]], seed: int, processes: int) -> Iterator[Finding]:
    families, indices = zip(*chosen, strict=True)
    seeds = [seed] * len(chosen)
    if processes == 1:
        yield from map(examine_drawn, families, indices, seeds)
        return
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        yield from pool.map(examine_drawn, families, indices, seeds, chunksize=CHUNK)


if __name__ == "__main__":
    sys.exit(main())
