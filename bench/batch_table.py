"""Many rails with varied misalignment in one call: runs in a second, and what a second thread adds."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bench.growth_table import exponent
from bench.ours import METHODS, engine_name
from bench.rail_case import FloatArray, rail_scenes
from bench.rows import Row
from bench.timing import timed
from cagepose import Runs, Scene, Variation, run_many

AT_REST = {"stepwise": "stable", "quasistatic": "rests"}
BATCHES = tuple(10**k for k in range(7))
THREADS = (1, 2)
LONG = 100_000
"""Batches from here on run once: they are medians of many runs themselves."""
MOST_RUNS = {"stepwise": 1_000_000, "quasistatic": 100_000}
"""Largest batch, so that the table ends within minutes."""


def batch_rows() -> Iterator[Row]:
    """Measure `cagepose.run_many` over growing batches."""
    scene = rail_scenes()[0]
    for method in METHODS:
        run_batch(scene, method, misalignments(8), 1)  # compiles
        alone_s = dict[int, float]()
        for threads in THREADS:
            yield from _curve(scene, method, threads, alone_s)


def _curve(scene: Scene, method: str, threads: int, alone_s: dict[int, float]) -> Iterator[Row]:
    sizes = [size for size in BATCHES if size <= MOST_RUNS[method]]
    times_s = list[float]()
    for size in sizes:
        poses = misalignments(size)
        once = partial(run_batch, scene, method, poses, threads)
        times_s.append(statistics.median(timed(once)[0] for _ in range(1 if size >= LONG else 3)))
        if threads == 1:
            alone_s[size] = times_s[-1]
        details: dict[str, Any] = {
            "runs": size,
            "threads": threads,
            "runs_per_s": size / times_s[-1],
            "times_one_thread": alone_s[size] / times_s[-1],
        }
        row = Row("batch", "rail, varied", engine_name(method), times_s[-1], details=details)
        if size == sizes[-1]:
            row = replace(row, details=row.details | {"exponent": exponent([float(n) for n in sizes], times_s)})
        yield row


def misalignments(n_runs: int) -> FloatArray:
    """Return yaw, pitch and roll of each run, (n_runs, 3), radians: up to 0.3 deg either way."""
    return np.radians(np.random.default_rng(1).uniform(-0.3, 0.3, (n_runs, 3)))


def run_batch(scene: Scene, method: str, euler_zyx: FloatArray, threads: int) -> Runs:
    """Run the rail at each misalignment, cage and start pose alike."""
    found = run_many(
        scene, Variation(cage_euler_zyx=euler_zyx, object_euler_zyx=euler_zyx), method=method, threads=threads
    )
    lost = int((found.verdict != AT_REST[method]).sum())
    if lost:
        raise RuntimeError(f"{lost} of {len(found)} rails did not come to rest: the benchmark is wrong")
    return found
