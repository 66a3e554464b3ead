"""How long something takes: the median of many calls in this process."""

from __future__ import annotations

import statistics
import time
import tracemalloc
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")


def median_s(call: Callable[[], object], budget_s: float = 1.0, least: int = 3, most: int = 2000) -> float:
    """Return the median wall time of ``call``, seconds.

    It is called once unmeasured, then until ``budget_s`` is used up: ``least`` to ``most`` times.
    """
    call()
    return statistics.median(collected(lambda: timed(call)[0], budget_s, least, most))


def median_cpu_s(call: Callable[[], object], budget_s: float, least: int = 3) -> float:
    """Return the median CPU time of ``call``: on a busy machine a long run has to wait, a short one not."""
    return statistics.median(collected(lambda: _cpu_s(call), budget_s, least))


def _cpu_s(call: Callable[[], object]) -> float:
    began = time.process_time()
    call()
    return time.process_time() - began


def collected(measure: Callable[[], T], budget_s: float, least: int = 3, most: int = 2000) -> list[T]:
    """Return what ``measure`` returns, called ``least`` to ``most`` times within ``budget_s`` seconds."""
    found: list[T] = []
    end = time.perf_counter() + budget_s
    while len(found) < least or (len(found) < most and time.perf_counter() < end):
        found.append(measure())
    return found


def timed(call: Callable[[], T]) -> tuple[float, T]:
    """Return (wall seconds, what the call returned)."""
    began = time.perf_counter()
    answer = call()
    return time.perf_counter() - began, answer


def peak_bytes(call: Callable[[], object]) -> int:
    """Return the most memory that a call held at once, beyond what was held before; NumPy's arrays count."""
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
