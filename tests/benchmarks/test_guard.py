"""Runs may not become slower unnoticed: measured against other work in the same process, on whatever machine."""

from __future__ import annotations

import gc
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from bench.ours import native_call, read_run
from cagepose.kernels.algebra.linear_program import Program, program_rows, solve_program
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.native.library import kernel_library
from cagepose.kernels.native.slots import Slots
from rails import rail_scene

REPEATS, RUNS, PROGRAMS = 100, 10, 20

needs_machine_code = pytest.mark.skipif(kernel_library() is None, reason="plain Python is not what users wait for")
COUNT = """
import sys
from collections import Counter
from rails import rail_scene
from cagepose import run
scene = rail_scene(pitch_deg=0.1)
calls = Counter()
def note(frame, event, argument):
    if event == "call" and "kernels" in frame.f_code.co_filename:
        calls[frame.f_code.co_name] += 1
sys.setprofile(note)
run(scene, "stepwise")
sys.setprofile(None)
print(calls["place_boxes"], calls["turn_entry"], calls["below_face"], calls["steepest_contact"])
"""


def yardstick() -> Callable[[], None]:
    """Solve one small linear program of 60 rows a few times: the same kind of work, and no part of a run."""
    rng = np.random.default_rng(1)
    rows, bounds = program_rows(60)
    rows[:], bounds[:] = rng.normal(size=(60, 6)), rng.uniform(0.5, 1.0, 60)
    work = empty_record(Program)
    work.objective[:] = rng.normal(size=6)
    solve = partial(solve_program, *[Slots(part) for part in (rows, bounds, work)])

    def solve_all() -> None:
        for _ in range(PROGRAMS):
            work.passive.used = 0
            solve()

    return solve_all


def seconds(call: Callable[[], object]) -> float:
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def in_programs(call: Callable[[], object]) -> float:
    """How many linear programs could have been solved during a call: the median of pairs, one after the other."""
    programs = yardstick()
    gc.collect()
    gc.disable()  # a collection takes as long as there are objects in this process, most of them not ours
    try:
        pairs = [(seconds(call), seconds(programs)) for _ in range(REPEATS)]
    finally:
        gc.enable()
    return statistics.median(call_s / (program_s / PROGRAMS) for call_s, program_s in pairs)


@needs_machine_code
@pytest.mark.parametrize(("method", "most"), [("stepwise", 9.5), ("quasistatic", 11.5)])
def test_a_rail_run_takes_no_more_linear_programs_than_it_did(method: str, most: float) -> None:
    """With the proofs of its two ends, one that rests by friction and one that nothing balances."""
    call = native_call(rail_scene(pitch_deg=0.1), method)
    ratio = in_programs(lambda: [call() for _ in range(RUNS)]) / RUNS
    assert ratio < most, f"a run takes as long as {ratio:.1f} programs; at most {most} when this was written"


@needs_machine_code
@pytest.mark.parametrize(("method", "most"), [("stepwise", 430), ("quasistatic", 360)])
def test_a_run_that_is_read_takes_no_more_calls_of_python_than_it_did(method: str, most: int) -> None:
    """What Python adds to the one native call, counted: time beside other tests tells little."""
    scene, n_calls = rail_scene(pitch_deg=0.1), 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal n_calls
        n_calls += event in ("call", "c_call")

    read_run(scene, method)  # prepares the scene
    sys.setprofile(count)
    read_run(scene, method)
    sys.setprofile(None)
    assert n_calls <= most, f"{n_calls} calls"


def test_a_rail_run_asks_no_more_of_its_kernels_than_it_did() -> None:
    """Counted with kernels as plain Python: what culling saves shows here, on any machine, to the last call."""
    environment = {**os.environ, "CAGEPOSE_KERNELS": "python", "PYTHONPATH": os.pathsep.join(sys.path)}
    printed = subprocess.run(
        [sys.executable, "-c", COUNT],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parent,
    ).stdout
    placed, turns, faces, steepest = (int(number) for number in printed.split())
    assert placed <= 15
    assert turns <= 257
    assert faces <= 890
    assert steepest <= 53
