"""Limits that `make bench` checks: how long a run may take, told in other work that is timed beside it.

They are no tests: a process on a shared machine is fast or slow as a whole, by more than most changes are.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from bench.ours import native_call
from bench.rail_case import rail_scenes
from cagepose.kernels.algebra.linear_program import Program, program_rows, solve_program
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.native.slots import Slots

IN_PROGRAMS = {"stepwise": 9.5, "quasistatic": 11.5}
"""For each method how many linear programs may be solved during a run of the rail, with the proofs of its ends: one
that rests by friction and one that nothing balances.
"""
REPEATS, RUNS, PROGRAMS = 100, 10, 20


class Measured(NamedTuple):
    """What was measured beside its limit."""

    name: str
    value: float
    limit: float


def measured_limits() -> Iterator[Measured]:
    """Measure all that has a limit."""
    scene = next(scene for scene in rail_scenes() if "pitch" in scene.name)
    for method, limit in IN_PROGRAMS.items():
        call = native_call(scene, method)
        ratio = in_programs(lambda call=call: [call() for _ in range(RUNS)]) / RUNS  # type: ignore[misc]
        yield Measured(f"{scene.name}, {method}, in linear programs", ratio, limit)


def in_programs(call: Callable[[], object]) -> float:
    """Return how many linear programs could be solved during a call: the median of pairs, one after the other."""
    programs = _programs()
    gc.collect()
    gc.disable()  # a collection takes as long as there are objects in this process, most of them not ours
    try:
        pairs = [(_seconds(call), _seconds(programs)) for _ in range(REPEATS)]
    finally:
        gc.enable()
    return statistics.median(call_s / (program_s / PROGRAMS) for call_s, program_s in pairs)


def _programs() -> Callable[[], None]:
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


def _seconds(call: Callable[[], object]) -> float:
    began = time.perf_counter()
    call()
    return time.perf_counter() - began
