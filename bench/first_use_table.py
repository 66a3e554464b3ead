"""What the first run costs: `cagepose run` in a new process, and the first call in one that has loaded its scene."""

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
STARTS = 7
FIRST_CALL = """
import sys, time
from bench.ours import read_run
from cagepose import load_scene
scene = load_scene(sys.argv[1])
began = time.perf_counter()
read_run(scene, sys.argv[2])
print(time.perf_counter() - began)
"""


def first_use_rows() -> Iterator[Row]:
    """Measure the command in a fresh home folder (wall seconds: a person waits), and the first call from Python."""
    for method in METHODS:
        command = ["-m", "cagepose", "run", str(SCENE), "--method", method, "--json"]
        starts = [_run(command) for _ in range(STARTS)]
        calls_s = [float(_run(["-c", FIRST_CALL, str(SCENE), method])[2]) for _ in range(STARTS)]
        details = {
            "cpu_s": statistics.median(cpu_s for _, cpu_s, _ in starts),
            "first_call_us": statistics.median(calls_s) * 1e6,
        }
        wall_s = statistics.median(wall_s for wall_s, _, _ in starts)
        yield Row("first-use", SCENE.stem, engine_name(method, "-process"), wall_s, details=details)


def _run(arguments: list[str]) -> tuple[float, float, str]:
    """Return (wall seconds, CPU seconds, what it printed) of a Python process of its own."""
    with tempfile.TemporaryDirectory() as home:
        environment = {**os.environ, "HOME": home, "PYTHONPATH": os.pathsep.join(sys.path)}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        began = time.perf_counter()
        done = subprocess.run([sys.executable, *arguments], env=environment, check=True, capture_output=True, text=True)
        wall_s = time.perf_counter() - began
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout
