"""All scenes of the project in MuJoCo beside cagepose, for docs/files.md: `python -m bench.crosscheck_table`."""

from __future__ import annotations

import math
import time

from bench.rail_case import SCENES
from cagepose import load_scene, run
from cagepose.exchange.crosscheck import PhaseCheck, crosscheck

HEADINGS = ("scene", "phase", "apart", "allowed", "penetration", "angle, deg", "agrees", "time")


def main() -> None:
    print(f"| {' | '.join(HEADINGS)} |\n|---|---|---:|---:|---:|---:|---|---:|")
    for path in sorted(SCENES.glob("*.yaml")):
        done = run(load_scene(path))
        began = time.perf_counter()
        found = crosscheck(done)
        taken = f"{time.perf_counter() - began:.2f} s"
        for place, phase in enumerate(found.phases):
            shown = (path.stem, taken) if place == 0 else ("", "")
            print(
                f"| {shown[0]} | {phase.phase.name} | {' | '.join(_figures(phase, done.scene.size_m))} | {shown[1]} |"
            )


def _figures(phase: PhaseCheck, size_m: float) -> list[str]:
    lengths = (phase.distance_m, phase.allowed_m, phase.mujoco.penetration_m)
    return [
        *(f"{length / size_m:.1e}" for length in lengths),
        f"{math.degrees(phase.angle_rad):.0e}",
        "yes" if phase.agrees else "no",
    ]


if __name__ == "__main__":
    main()
