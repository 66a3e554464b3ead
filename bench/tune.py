"""Find the settings at which an engine is fastest and still right: `python -m bench.tune mujoco --minutes 3`.

Right: on all three rails it settles with a tilt error of at most `ERROR_LIMIT`. Of the settings that are right the ones
with the least time, summed over the rails, win. The search starts at the settings as they stand and changes one to
three of the best at a time. Times are CPU times, since a busy machine must not decide. The answer goes into the
engine's settings class by hand.
"""

from __future__ import annotations

import argparse
import math
import random
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from itertools import product
from typing import Any

from bench.peer_body import peer_body
from bench.peers import load_time_stepper
from bench.rail_case import PLAY_M, FloatArray, rail_scenes, tilt_error
from bench.settle import NotSettledError, TimeStepper, run_to_rest

ERROR_LIMIT = 1e-5
"""Part of the play angle; three orders more than our own error, so that no peer pays for digits that nobody needs."""
SLOWEST_S = 5.0
"""A rail that takes longer is given up."""

STEPS: Mapping[str, Sequence[Any]] = {
    "step_s": (0.001, 0.002, 0.003, 0.005, 0.007, 0.01, 0.014, 0.02, 0.03, 0.04, 0.06, 0.08),
    "window_steps": (2, 3, 5, 7, 10, 15, 20, 30, 50),
    "loads": tuple(product((30, 60, 100, 200, 400, 800, 1600), (10, 20, 50, 100, 200, 400, 800))),
    "damping_per_s": (0.0, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0),
}
"""Settings of all time-stepping engines that are tuned, and the values tried."""
OWN: Mapping[str, Mapping[str, Sequence[Any]]] = {
    "mujoco": {
        "time_constant_steps": (2.0, 2.5, 3.0, 4.0, 6.0),
        "damping_ratio": (0.5, 0.7, 1.0, 1.5, 2.0, 4.0),
        "impedance": (0.99, 0.999, 0.9999),
        "friction": (0.0, 0.1),
        "solver": ("Newton", "CG", "PGS"),
        "iterations": (2, 3, 5, 10, 20, 100),
        "tolerance": (1e-8, 1e-10, 1e-12, 1e-14, 1e-16),
        "cone": ("pyramidal", "elliptic"),
        "integrator": ("Euler", "implicitfast", "RK4"),
    },
    "drake": {
        "friction": (0.0, 0.1),
        "stiffness": (1e5, 1e6, 3e6, 1e7, 3e7, 1e8, 1e9),
        "dissipation": (0.0, 0.01, 0.1, 1.0, 10.0, 100.0),
        "approximation": ("sap", "tamsi", "similar", "lagged"),
        "near_rigid": (0.0, 0.01, 0.1, 1.0),
    },
    "pybullet": {
        "friction": (0.0, 0.1),
        "linear_damping": (0.0, 0.04, 0.2, 0.5, 0.9, 0.99),
        "angular_damping": (0.0, 0.04, 0.2, 0.5, 0.9, 0.99),
        "units_per_mm": (0.1, 1.0, 3.0, 10.0, 30.0, 100.0),
        "erp": (0.1, 0.2, 0.4, 0.6, 0.8, 1.0),
        "iterations": (3, 5, 10, 20, 50, 100, 200),
        "residual": (0.0, 1e-12, 1e-9, 1e-7, 1e-5),
    },
}


class Impatient:
    """A `TimeStepper` that gives up after a while: most random settings never settle."""

    def __init__(self, stepper: TimeStepper, give_up_s: float) -> None:
        self._stepper, self._give_up_s = stepper, give_up_s
        self._began = 0.0

    def restart(self) -> None:
        self._began = time.process_time()
        self._stepper.restart()

    def push(self, phase: int, torque: FloatArray, force: FloatArray) -> None:
        self._stepper.push(phase, torque, force)

    def advance(self) -> None:
        if time.process_time() - self._began > self._give_up_s:
            raise NotSettledError("too slow")
        self._stepper.advance()

    def pose(self) -> tuple[FloatArray, FloatArray]:
        return self._stepper.pose()


def cost(make: Callable[..., TimeStepper], settings: Any, give_up_s: float) -> tuple[float, float]:
    """Return (CPU seconds for all rails, greatest error); infinite where it does not settle or is slower than asked."""
    total_s, worst = 0.0, 0.0
    for scene in rail_scenes():
        body = peer_body(scene)
        try:
            stepper = Impatient(make(body, settings), give_up_s)
            times_s = []
            for _ in range(2):
                began = time.process_time()
                answer = run_to_rest(stepper, body, PLAY_M * 1e3)
                times_s.append(time.process_time() - began)
        except (NotSettledError, RuntimeError, ValueError):
            return math.inf, math.inf
        worst = max(worst, tilt_error(scene, answer.rotations))
        total_s += min(times_s)
        if worst > ERROR_LIMIT or total_s > give_up_s:
            return math.inf, worst
    return total_s, worst


def search(engine: str, minutes: float, seed: int) -> tuple[Any, float, float]:
    """Return (settings, seconds for all rails, greatest error) of the best found."""
    make, settings = load_time_stepper(engine)
    choices = {name: values for name, values in {**STEPS, **OWN[engine]}.items() if hasattr(settings, name)}
    draw = random.Random(seed)
    end = time.monotonic() + 60.0 * minutes
    best, (best_s, best_error) = settings, cost(make, settings, SLOWEST_S)
    n_tried = 1

    def consider(candidate: Any) -> None:
        nonlocal best, best_s, best_error, n_tried
        found_s, error = cost(make, candidate, min(SLOWEST_S, best_s))
        n_tried += 1
        if found_s < 0.98 * best_s:  # less is noise
            best, best_s, best_error = candidate, found_s, error
            print(f"{n_tried:5d}  {best_s / 3.0 * 1e3:8.2f} ms a rail  error {error:.1e}  {asdict(best)}", flush=True)

    while time.monotonic() < end:
        names = draw.sample(list(choices), draw.choice((1, 1, 2, 3)))
        consider(replace(best, **{name: draw.choice(choices[name]) for name in names}))
    print(f"{n_tried} settings tried")
    return best, best_s, best_error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("engine", choices=sorted(OWN))
    parser.add_argument("--minutes", type=float, default=3.0)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    best, seconds, error = search(chosen.engine, chosen.minutes, chosen.seed)
    print(f"{chosen.engine}: {seconds / 3.0 * 1e3:.2f} ms a rail, greatest error {error:.1e}\n{best}")


if __name__ == "__main__":
    main()
