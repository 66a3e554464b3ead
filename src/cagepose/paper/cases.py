"""The paper's cases, the sample and the rail out of line, and what one method makes of them."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass

from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.paper.rail import ANGLES, misalignment, rail_scene
from cagepose.runs.run import Run
from cagepose.runs.solve import run

EDGE_M = 0.010
START_M = (0.002, 0.004, 0.010)
POINT_SPACING_M = 0.008
FACE_DISTANCES_M = (0.007, 0.005)
"""From the first contact to the cube's faces at low x and at low y: they set the two turns, (4.1) and (4.2)."""
DROP_M = START_M[2] - EDGE_M / 2.0
"""From the underside at the start to the points at z = 0."""
MISALIGNMENT_RAD = math.radians(0.1)
TIMED_RUNS = 9
"""Runs of each case; their median is the measured time."""

Progress = Callable[[str], None]
"""Is told what begins."""


@dataclass(frozen=True)
class CaseRuns:
    """The paper's cases, run by one method.

    Attributes
    ----------
    sample, yaw, pitch, roll
        The cube, and the rail with its rollers 0.1 deg out of line in one angle. (The paper does not show roll.)
    pitch_s, slowest_s
        Measured: median time of the pitch case, and of the slowest case, seconds.
    """

    sample: Run
    yaw: Run
    pitch: Run
    roll: Run
    pitch_s: float
    slowest_s: float


def run_cases(method: str, progress: Progress) -> CaseRuns:
    """Run all cases by ``method``, each several times."""
    runs, times_s = [], []
    for scene in case_scenes():
        progress(f"{method}: {scene.name}")
        repeated = [run(scene, method) for _ in range(TIMED_RUNS)]
        runs.append(repeated[0])
        times_s.append(statistics.median(one.solve_s for one in repeated))
    sample, yaw, pitch, roll = runs
    return CaseRuns(sample, yaw, pitch, roll, pitch_s=times_s[2], slowest_s=max(times_s))


def case_scenes() -> list[Scene]:
    """Return the sample, then the rail out of line in yaw, pitch and roll."""
    rails = [
        rail_scene(misalignment_zyx=misalignment(angle, MISALIGNMENT_RAD), name=f"rail, {angle} 0.1 deg")
        for angle in ANGLES
    ]
    return [sample_scene(), *rails]


def sample_scene() -> Scene:
    """Return the cube over four points: the twin of ``scenes/sample.yaml``, which an installed package lacks."""
    half = POINT_SPACING_M / 2.0
    return Scene(
        Object([Box((EDGE_M, EDGE_M, EDGE_M), name="cube")], (0.0, 0.0, 0.0), pose=Pose(START_M)),
        Cage([(half, half, 0.0), (half, -half, 0.0), (-half, -half, 0.0), (-half, half, 0.0)]),
        [Load("gravity", gravity=(0.0, 0.0, -1.0))],
        name="sample",
    )
