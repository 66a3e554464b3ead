"""Kernels that are plain Python until they have taken their time: what they give, and when they are compiled."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.native import cache, jit
from cagepose.kernels.native.jit import Kernel, RareEntry
from jit import JIT_IS_OFF

pytestmark = pytest.mark.skipif(JIT_IS_OFF, reason="nothing is compiled")
SCENES = Path(__file__).parents[2] / "scenes"


def half(value: float) -> float:
    return 0.5 * value


halved = Kernel(half)


def halves(values: FloatArray) -> float:
    total = 0.0
    for value in values:
        total += halved(value)
    return total


def divide(one: float, other: float) -> float:
    return one / other


def root(value: float) -> float:
    return math.sqrt(value)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)
    return tmp_path


def test_a_call_is_plain_python_at_first(folder: Path) -> None:
    rare = RareEntry(halves)
    assert rare(np.ones(10)) == 5.0
    assert not rare.loaded
    assert not list(folder.iterdir())
    assert 0.0 < rare.patience_s < jit.PATIENCE_S


def test_one_that_takes_too_long_is_compiled_and_gives_the_same(folder: Path) -> None:
    rare = RareEntry(halves)
    rare.patience_s = 0.01
    assert rare(np.ones(1_000_000)) == 500_000.0
    assert rare.loaded
    assert [path.suffix for path in folder.iterdir()] == [".o"]
    assert halved(3.0) == 1.5  # no time limit stays behind
    assert rare(np.ones(10)) == 5.0


def test_many_short_calls_are_compiled_too() -> None:
    rare = RareEntry(halves)
    rare.patience_s, deadline = 0.05, time.perf_counter() + 60.0
    while not rare.loaded:
        assert rare(np.ones(1000)) == 500.0
        assert time.perf_counter() < deadline


def test_machine_code_on_disk_is_used_at_once() -> None:
    first = RareEntry(halves)
    first.patience_s = 0.0
    assert first(np.ones(10)) == 5.0
    second = RareEntry(halves)
    assert second(np.ones(10)) == 5.0
    assert second.loaded
    assert second.patience_s == jit.PATIENCE_S


@pytest.mark.parametrize(
    ("function", "arguments", "expected"), [(divide, (1.0, 0.0), math.inf), (root, (-1.0,), math.nan)]
)
def test_where_python_has_an_error_machine_code_has_infinity_or_no_number(function, arguments, expected) -> None:
    rare = RareEntry(function)
    assert rare(*arguments) == pytest.approx(expected, nan_ok=True)
    assert rare.loaded


def test_the_time_limit_of_one_thread_does_not_stop_another(monkeypatch: pytest.MonkeyPatch) -> None:
    began, go_on = threading.Event(), threading.Event()

    def waits(value: float) -> float:
        began.set()
        assert go_on.wait(60.0)
        return halved(value)

    slow, answers = RareEntry(waits), list[float]()
    slow.patience_s = 1e-6
    monkeypatch.setattr(slow, "bound", lambda value: lambda: answers.append(value))
    thread = threading.Thread(target=slow, args=(2.0,))
    thread.start()
    assert began.wait(60.0)
    try:
        assert halved(4.0) == 2.0  # its own limit is over, ours is not
    finally:
        go_on.set()
        thread.join()
    assert answers == [2.0]  # it ran out of patience and was called as machine code


def test_threads_that_try_at_the_same_time_take_turns() -> None:
    rare = RareEntry(halves)
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(rare, [np.ones(1000)] * 20)) == [500.0] * 20
    assert not rare.loaded


def test_a_rare_kernel_may_be_a_part_of_another(folder: Path) -> None:
    part = RareEntry(halves)

    def twice(values: FloatArray) -> float:
        return 2.0 * part(values)

    assert RareEntry(twice)(np.ones(10)) == 10.0
    assert not list(folder.iterdir())


def test_what_no_kernel_takes_is_refused_before_it_is_tried() -> None:
    with pytest.raises(TypeError, match="no list"):
        RareEntry(halves)([1.0])


def test_a_run_compiles_only_the_method_that_is_asked_for(tmp_path: Path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "cagepose", "run", str(SCENES / "rail-pitch.yaml"), "--method", "stepwise"]
    subprocess.run(command, env=environment, capture_output=True, check=True)
    assert [path.name.split("-")[0] for path in tmp_path.rglob("*.o")] == ["stepwise_run"]
