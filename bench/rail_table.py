"""The rail: cagepose, physics engines, scipy and NumPy, one process, one check of accuracy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict
from typing import Any

from bench import ours
from bench.peer_body import SPHERE_RADIUS_MM, peer_body
from bench.peers import TIME_STEPPERS, load_time_stepper
from bench.rail_case import PLAY_M, Answer, rail_scenes, tilt_error
from bench.rows import Row, with_ratios
from bench.settle import QUIET_PART_OF_PLAY, NotSettledError, run_to_rest
from bench.timing import median_cpu_s, median_s
from cagepose import Scene
from cagepose.exchange.settle import QUIET_WINDOWS
from cagepose.model.methods import METHODS

BUDGET_S = 0.4
"""Time for one engine on one scene; a slow engine runs three times, whatever that takes."""


def rail_rows() -> Iterator[Row]:
    """Measure all engines on all rails."""
    for scene in rail_scenes():
        own = list(_own_rows(scene))
        slower = max((row for row in own if row.engine in REFERENCE), key=lambda row: row.median_s or 0.0)
        for row in own:
            yield with_ratios(row, slower)
        for engine in PEERS:
            yield with_ratios(peer_row(scene, engine), slower)


REFERENCE = tuple(ours.engine_name(method) for method in METHODS)
"""Engines of which the slower one is 1 in ``ratio_to_ours``."""


def _own_rows(scene: Scene) -> Iterator[Row]:
    for method in METHODS:
        times_s, answer = ours.measure(scene, method, BUDGET_S)
        error = tilt_error(scene, answer.rotations)
        for part in ours.PARTS:
            wall_s, cpu_s = times_s[part]
            engine = ours.engine_name(method, part)
            yield Row("rail", scene.name or "", engine, wall_s, error, details={"cpu_s": cpu_s})


def peer_row(scene: Scene, engine: str) -> Row:
    name = scene.name or ""
    try:
        run, settings = PEERS[engine](scene, engine)
    except ImportError as error:
        reason = f"not installed: {error}; pip install 'cagepose[bench]' brings it"
        return Row("rail", name, engine, skipped=reason)
    try:
        answer = run()
    except (NotSettledError, RuntimeError) as error:
        return Row("rail", name, engine, settings=settings, skipped=f"found no rest: {error}")
    off = tilt_error(scene, answer.rotations)
    details = {"cpu_s": median_cpu_s(run, BUDGET_S)}
    return Row("rail", name, engine, median_s(run, BUDGET_S), off, settings=settings, details=details)


Prepared = tuple[Callable[[], Answer], dict[str, Any]]


def _time_stepper(scene: Scene, engine: str) -> Prepared:
    make, settings = load_time_stepper(engine)
    body = peer_body(scene)
    stepper = make(body, settings)
    stated = asdict(settings) | {
        "sphere_radius_mm": SPHERE_RADIUS_MM,
        "settled": f"{QUIET_WINDOWS} windows with less than {QUIET_PART_OF_PLAY:g} of the play",
    }
    return lambda: run_to_rest(stepper, body, PLAY_M * 1e3), stated


def _linear_programs(scene: Scene, _: str) -> Prepared:
    from bench.engine_lp import LpSequence, LpSettings

    programs = LpSequence(peer_body(scene, 0.0), LpSettings())
    return programs.run, programs.settings()


def _numpy_sweep(scene: Scene, _: str) -> Prepared:
    from bench.engine_sweep import NumpySweep

    sweep = NumpySweep(scene)
    return sweep.run, sweep.settings()


PEERS: dict[str, Callable[[Scene, str], Prepared]] = {
    **dict.fromkeys(TIME_STEPPERS, _time_stepper),
    "scipy-lp": _linear_programs,
    "numpy-sweep": _numpy_sweep,
}
