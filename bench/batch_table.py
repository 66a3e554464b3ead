"""Many rails with varied misalignment in one call: runs in a second, and what a second thread adds."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from bench.growth_table import exponent
from bench.ours import engine_name
from bench.rail_case import FloatArray, rail_scenes
from bench.rows import Row
from bench.timing import timed
from cagepose import Runs, Scene, Variation, run_many
from cagepose.model.methods import METHODS

AT_REST = {"stepwise": "stable", "quasistatic": "rests"}
BATCHES = tuple(10**k for k in range(7))
THREADS = (1, 2)
LONG = 100_000
"""Batches from here on run once: they are medians of many runs themselves."""
MOST_RUNS = {"stepwise": 1_000_000, "quasistatic": 100_000}
"""Largest batch, so that the table ends within minutes."""


def batch_rows() -> Iterator[Row]:
    """Measure `cagepose.run_many` over growing batches, on one thread and on two in turn."""
    scene = rail_scenes()[0]
    for method in METHODS:
        sizes = [size for size in BATCHES if size <= MOST_RUNS[method]]
        times_s: dict[int, list[float]] = {threads: [] for threads in THREADS}
        for size in sizes:
            for threads, (median_s, lost) in _measured(scene, method, size).items():
                times_s[threads].append(median_s)
                details: dict[str, Any] = {
                    "runs": size,
                    "threads": threads,
                    "runs_per_s": size / median_s,
                    "times_one_thread": times_s[THREADS[0]][-1] / median_s,
                    "not_at_rest": lost,
                }
                if size == sizes[-1]:
                    details["exponent"] = exponent([float(n) for n in sizes], times_s[threads])
                yield Row("batch", "rail, varied", engine_name(method), median_s, details=details)


def _measured(scene: Scene, method: str, size: int) -> dict[int, tuple[float, int]]:
    """Return for each number of threads the median time, and how many runs did not end at rest."""
    poses = misalignments(size)
    repeats = 1 if size >= LONG else 5
    # In turn, so that a processor that changes its speed does so to both.
    rounds = [
        {threads: timed(partial(run_batch, scene, method, poses, threads)) for threads in THREADS}
        for _ in range(repeats)
    ]
    return {
        threads: (
            statistics.median(found[threads][0] for found in rounds),
            int((rounds[0][threads][1].verdict != AT_REST[method]).sum()),
        )
        for threads in THREADS
    }


def misalignments(n_runs: int) -> FloatArray:
    """Return yaw, pitch and roll of each run, (n_runs, 3), radians: up to 0.3 deg either way."""
    return np.radians(np.random.default_rng(1).uniform(-0.3, 0.3, (n_runs, 3)))


def run_batch(scene: Scene, method: str, euler_zyx: FloatArray, threads: int) -> Runs:
    """Run the rail at each misalignment, cage and start pose alike."""
    return run_many(
        scene, Variation(cage_euler_zyx=euler_zyx, object_euler_zyx=euler_zyx), method=method, threads=threads
    )
