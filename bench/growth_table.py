"""How the cost of one run grows with the number of points and of boxes, and how much memory it takes."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from bench.crowd import Kind, crowd_scene
from bench.ours import engine_name
from bench.rows import Row
from bench.timing import collected, peak_bytes
from cagepose import Scene, run
from cagepose.model.methods import METHODS

KINDS: tuple[Kind, ...] = ("dense", "spread")
POINTS = tuple(2**k for k in range(2, 13))
BOXES = tuple(2**k for k in range(10))
FIXED_BOXES, FIXED_POINTS = 6, 14
"""As many as the rail has."""
BUDGET_S = 0.3


def growth_rows() -> Iterator[Row]:
    """Measure the machine code's part of a run over growing scenes.

    Each curve's exponent stands in its last row. It is fitted to the fastest runs: on a busy machine the long ones have
    to wait more often than the short ones, so medians would bend the curve.
    """
    for kind in KINDS:
        for method in METHODS:
            yield from _curve(kind, method, "points", [(FIXED_BOXES, n) for n in POINTS])
            yield from _curve(kind, method, "boxes", [(n, FIXED_POINTS) for n in BOXES])


def exponent(sizes: Sequence[float], times_s: Sequence[float]) -> float:
    """Return p of time ~ size^p: least squares of the logarithms over the upper half of the sizes."""
    half = len(sizes) // 2
    return float(np.polyfit(np.log(sizes[half:]), np.log(times_s[half:]), 1)[0])


def _curve(kind: Kind, method: str, grown: str, sizes: Sequence[tuple[int, int]]) -> Iterator[Row]:
    fastest_s = list[float]()
    for n_boxes, n_points in sizes:
        scene = crowd_scene(kind, n_boxes, n_points)
        result = run(scene, method)
        times_s = collected(partial(_solve_s, scene, method), BUDGET_S)
        fastest_s.append(min(times_s))
        row = Row(
            "growth",
            f"{kind} table, {grown}",
            engine_name(method),
            statistics.median(times_s),
            details={
                "fastest_us": fastest_s[-1] * 1e6,
                "boxes": n_boxes,
                "points": n_points,
                "events": sum(len(phase.events) for phase in result.phases),
                "verdict": result.verdict,
                "peak_kib": round(peak_bytes(partial(run, scene, method)) / 1024.0),
            },
        )
        if len(fastest_s) == len(sizes):
            grown_sizes = [float(pair[1 if grown == "points" else 0]) for pair in sizes]
            row = replace(row, details=row.details | {"exponent": exponent(grown_sizes, fastest_s)})
        yield row


def _solve_s(scene: Scene, method: str) -> float:
    return run(scene, method).solve_s
