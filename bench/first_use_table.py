"""What the first run costs: `cagepose run` in a new process, with and without machine code on disk."""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

from bench.ours import engine_name
from bench.rail_case import SCENES
from bench.rows import Row
from cagepose.model.methods import METHODS

SCENE = SCENES / "rail-pitch.yaml"
CACHED_STARTS = 5


def first_use_rows() -> Iterator[Row]:
    """Measure a cold start (CPU seconds: compilers do not wait) and cached ones (wall seconds: a person does)."""
    for method in METHODS:
        with tempfile.TemporaryDirectory() as cache:
            cold_wall_s, cold_cpu_s = _start(method, cache)
            cached = [_start(method, cache) for _ in range(CACHED_STARTS)]
        details = {
            "cold_cpu_s": cold_cpu_s,
            "cold_wall_s": cold_wall_s,
            "cached_cpu_s": statistics.median(cpu_s for _, cpu_s in cached),
        }
        wall_s = statistics.median(wall_s for wall_s, _ in cached)
        yield Row("first-use", SCENE.stem, engine_name(method, "-process"), wall_s, details=details)


def _start(method: str, cache: str) -> tuple[float, float]:
    """Return (wall seconds, CPU seconds) of one `cagepose run` in a process of its own."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began = time.perf_counter()
    command = [sys.executable, "-m", "cagepose", "run", str(SCENE), "--method", method, "--json"]
    subprocess.run(command, env=environment, check=True, capture_output=True)
    wall_s = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
