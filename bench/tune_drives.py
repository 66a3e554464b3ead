"""Find settings at which MuJoCo runs a drive fastest and still right: `python -m bench.tune_drives dock --minutes 2`.

Right is what `bench.drive_cases` says. The search starts at the settings as they stand and changes one to three of the
best at a time; until some are right, what is less far off is better. The answer goes into `bench.drive_cases` by hand.
"""

from __future__ import annotations

import argparse
import math
import random
import time
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from bench.drive_cases import DRIVE_CASES, FORCE_OFF, DriveCase
from bench.engine_mujoco_drives import DrivenMujoco, DriveSettings
from cagepose import CageposeError

SLOWEST_STEPS = 40_000
"""Settings that need more time steps are not tried; nor are, once some are right, such that need half as many again."""
CHOICES: Mapping[str, Sequence[Any]] = {
    "step_s": (1e-4, 2e-4, 3e-4, 5e-4, 7e-4, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.01, 0.014, 0.02, 0.03),
    "drive_s": (0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0),
    "settle_s": (0.0, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 1.0),
    "damping_per_s": (0.0, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0),
    "mass_times": (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0),
    "time_constant_steps": (2.0, 2.5, 3.0, 4.0, 6.0),
    "damping_ratio": (0.5, 0.7, 1.0, 1.5, 2.0, 4.0),
    "impedance": (0.9, 0.99, 0.999, 0.9999),
    "solver": ("Newton", "CG", "PGS"),
    "iterations": (3, 5, 10, 20, 100),
    "tolerance": (1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16),
    "cone": ("pyramidal", "elliptic"),
    "integrator": ("Euler", "implicitfast", "RK4"),
    "noslip_iterations": (0, 5, 50),
    "ccd_tolerance": (1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-14),
}
"""Settings that are tuned, and the values tried; how heavy a part is is free where gravity does not act on it."""


def cost(case: DriveCase, settings: DriveSettings) -> tuple[float, float]:
    """Return (how far off, in what is allowed: 1 and less is right; CPU seconds)."""
    try:
        engine = DrivenMujoco(case.scene, settings)
        began = time.process_time()
        off = case.off(engine.run())
    except CageposeError:
        return math.inf, math.inf
    taken_s = time.process_time() - began
    worst = max(off.apart_m / case.allowed_m, off.force / FORCE_OFF) + (0.0 if off.same_verdict else 1e3)
    return (worst if math.isfinite(worst) else math.inf), taken_s


def search(case: DriveCase, minutes: float, seed: int) -> tuple[DriveSettings, float, float]:
    """Return (settings, how far off, CPU seconds) of the best found."""
    is_weightless = all(load.gravity_world is None for load in case.scene.loads)
    names = [name for name in CHOICES if name != "mass_times" or is_weightless]
    draw, end, n_tried = random.Random(seed), time.monotonic() + 60.0 * minutes, 1
    best = DriveSettings(**case.settings)
    off, seconds = cost(case, best)
    while time.monotonic() < end:
        changed = draw.sample(names, draw.choice((1, 1, 2, 3)))
        candidate = replace(best, **{name: draw.choice(CHOICES[name]) for name in changed})
        if _steps(candidate) > (SLOWEST_STEPS if off > 1.0 else 1.5 * _steps(best)):
            continue
        found_off, found_s = cost(case, candidate)
        n_tried += 1
        is_faster = found_off <= 1.0 and (off > 1.0 or found_s < 0.97 * seconds)  # less is noise
        if is_faster or (off > 1.0 and found_off < off):
            best, off, seconds = candidate, found_off, found_s
            print(f"{n_tried:5d}  {off:8.3g} of what is allowed  {seconds * 1e3:8.1f} ms", flush=True)
    print(f"{n_tried} settings tried")
    return best, off, seconds


def _steps(settings: DriveSettings) -> float:
    return (settings.drive_s + settings.settle_s) / settings.step_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", choices=sorted(DRIVE_CASES))
    parser.add_argument("--minutes", type=float, default=2.0)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    best, off, seconds = search(DRIVE_CASES[chosen.case], chosen.minutes, chosen.seed)
    changed = {one.name: getattr(best, one.name) for one in fields(best) if getattr(best, one.name) != one.default}
    print(f"{chosen.case}: {off:.3g} of what is allowed, {seconds * 1e3:.1f} ms\n{changed}")


if __name__ == "__main__":
    main()
