"""The drives that are measured beside MuJoCo, the settings found for it, and what counts as right: `DRIVE_CASES`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from bench.engine_mujoco_drives import AT_END, DriveEnd
from bench.rail_case import SCENES
from cagepose import PhaseRun, Scene, run
from cagepose.exchange.crosscheck import apart_m, surface_points
from cagepose.files.scene_file import read_scene_file
from cagepose.runs.driven import DriveRun

APART_M, APART_OF_PLAY, FORCE_OFF = 2e-5, 0.05, 0.05
"""Right: no point of the part, and no driven body, is farther off than 0.02 mm or this part of the play, whichever is
more, and the drivers' force by no more than this part of ours."""
MEAN_OF = 101
"""Places of which a force is a mean."""
BLOCKED = ("blocked", "jams")


@dataclass(frozen=True)
class DriveOff:
    """How far MuJoCo's end is from ours: metres, a part of our force, and whether both or neither are blocked."""

    apart_m: float
    force: float
    same_verdict: bool

    def is_right(self, allowed_m: float) -> bool:
        """Whether all of it is as near as is asked."""
        return self.same_verdict and self.apart_m <= allowed_m and self.force <= FORCE_OFF


@dataclass(frozen=True, eq=False)
class DriveCase:
    """A scene whose last phase is a drive.

    Attributes
    ----------
    file, changes
        The scene file, and what is set in it.
    play_m
        How far the part can move as the scene begins.
    settings
        For MuJoCo, found by `bench.tune_drives`.
    """

    name: str
    file: str
    play_m: float = 0.0
    changes: tuple[str, ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def scene(self) -> Scene:
        """The scene."""
        return read_scene_file(SCENES / f"{self.file}.yaml", self.changes).scene

    @cached_property
    def ours(self) -> PhaseRun:
        """The drive as cagepose runs it."""
        return run(self.scene).phases[-1]

    @property
    def allowed_m(self) -> float:
        """How far off an end may be."""
        return max(APART_M, APART_OF_PLAY * self.play_m)

    def off(self, end: DriveEnd) -> DriveOff:
        """Compare an end of MuJoCo's with ours.

        Where we end blocked the force means nothing, and how near it can tell the place counts as how far it is off.
        """
        drive, scene = self.ours.drive, self.scene
        assert drive is not None
        way_m = max(float(np.linalg.norm(np.asarray(leg.travel_m))) for (leg,) in scene.loads[-1].drive.values())
        is_blocked = self.ours.verdict in BLOCKED
        apart = max(
            apart_m(surface_points(scene.object), end.pose, self.ours.pose),
            abs(end.share - drive.share) * way_m,
            end.look * way_m if is_blocked else 0.0,
        )
        along_n = mean_along_n(drive)
        force = 0.0 if is_blocked else abs(end.along_n - along_n) / abs(along_n)
        return DriveOff(apart, force, is_blocked == end.is_blocked)


def mean_along_n(drive: DriveRun) -> float:
    """Return the mean force of a drive over the last part of its way, as it is taken of MuJoCo's."""
    shares = np.linspace(1.0 - AT_END, 1.0, MEAN_OF) * drive.share
    return float(np.interp(shares, drive.curve.share, drive.curve.along).mean())


DRIVE_CASES = {
    case.name: case
    for case in (
        DriveCase(
            "dock",
            "dock",
            play_m=1e-3,
            settings={
                "step_s": 0.01,
                "drive_s": 5.0,
                "settle_s": 0.0,
                "damping_ratio": 0.5,
                "cone": "pyramidal",
            },
        ),
        DriveCase(
            "insertion",
            "insertion",
            play_m=5e-5,
            settings={
                "step_s": 0.001,
                "drive_s": 3.0,
                "damping_per_s": 2.0,
                "mass_times": 0.3,
                "impedance": 0.999,
                "ccd_tolerance": 1e-14,
            },
        ),
        DriveCase(
            "jaws",
            "jaws",
            settings={
                "step_s": 0.001,
                "drive_s": 1.5,
                "settle_s": 0.0,
                "damping_per_s": 0.0,
                "time_constant_steps": 3.0,
                "damping_ratio": 0.5,
                "impedance": 0.999,
                "solver": "CG",
                "iterations": 20,
                "tolerance": 1e-6,
            },
        ),
        DriveCase(
            "drawer, friction 0.5",
            "drawer-jams",
            changes=("friction.coefficient=0.5",),
            settings={
                "step_s": 0.003,
                "drive_s": 15.0,
                "settle_s": 0.0,
                "damping_per_s": 100.0,
                "cone": "pyramidal",
                "integrator": "implicitfast",
            },
        ),
        DriveCase(
            "drawer, friction 1.6", "drawer-jams", settings={"step_s": 0.002, "settle_s": 0.06, "cone": "pyramidal"}
        ),
    )
}
"""By name."""
