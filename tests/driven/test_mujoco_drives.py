"""MuJoCo with slowly pushed mocap bodies ends where our drives do, and its drivers push as hard.

Poses may be apart by a few times what contacts give, which is how soft MuJoCo is, and what the exported shapes are off;
a place at which it is blocked, by the way between two looks at its force as well. Forces may be off by drag, and by a
part of them, for they tremble.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.drive_cases import DRIVE_CASES, mean_along_n
from bench.engine_mujoco_drives import DriveEnd, DrivenMujoco, DriveSettings
from bench.rail_case import SCENES
from cagepose import PhaseRun, Scene, run
from cagepose.exchange.crosscheck import apart_m, surface_points
from cagepose.files.scene_file import read_scene_file

pytest.importorskip("mujoco")

TREMBLES = 0.1
"""Part of a force."""
LEVER = 5.0
"""What gives at contacts is seen so much larger: the rail's end is 3.3 times as far from its middle as its rollers are
from each other.
"""


class Both:
    """A scene whose last phase drives one body or two alike, in both programs."""

    def __init__(self, file: str, changes: tuple[str, ...] = (), **settings: Any) -> None:
        self.scene: Scene = read_scene_file(SCENES / f"{file}.yaml", changes).scene
        self.ours: PhaseRun = run(self.scene).phases[-1]
        chosen = DriveSettings(**settings)
        engine = DrivenMujoco(self.scene, chosen)
        self.theirs: DriveEnd = engine.run()
        (first, *_) = self.scene.loads[-1].drive.values()
        self.way_m = float(np.linalg.norm(first[0].travel_m))
        mass = (self.scene.object.mass_kg or 1.0) * chosen.mass_times
        self.drag_n = chosen.damping_per_s * mass * self.way_m / chosen.drive_s
        self.softness_m = LEVER * (self.theirs.penetration_m + engine.error_m)

    def assert_same_end(self) -> None:
        look_m = self.theirs.look * self.way_m
        assert self.ours.drive is not None
        assert apart_m(surface_points(self.scene.object), self.theirs.pose, self.ours.pose) <= self.softness_m + look_m
        assert abs(self.theirs.share - self.ours.drive.share) * self.way_m <= self.softness_m + look_m

    def assert_same_force(self) -> None:
        assert self.ours.drive is not None
        along = mean_along_n(self.ours.drive)
        assert abs(self.theirs.along_n - along) <= self.drag_n + TREMBLES * abs(along)


def test_a_block_between_jaws_is_flat_and_held_at_the_same_place() -> None:
    both = Both("jaws", step_s=2e-4, drive_s=2.0)
    assert both.ours.verdict == "blocked"
    assert both.theirs.is_blocked
    both.assert_same_end()
    assert abs(np.degrees(both.theirs.pose.euler_zyx[0])) < 0.2


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_drawer_goes_in_below_its_limit(friction: float) -> None:
    both = Both("drawer-jams", (f"friction.coefficient={friction}",), **DRAWER)
    assert both.ours.drive is not None
    assert both.ours.drive.along == pytest.approx(1.0 / (1.0 - 2.0 * friction * 20.0 / 60.0), rel=1e-9)
    assert (both.ours.drive.share, both.theirs.share, both.theirs.is_blocked) == (1.0, 1.0, False)
    both.assert_same_end()
    both.assert_same_force()


def test_a_drawer_sticks_beyond_its_limit() -> None:
    both = Both("drawer-jams", ("friction.coefficient=1.6",), **DRAWER)
    assert both.ours.verdict == "jams"
    assert both.theirs.is_blocked
    both.assert_same_end()


DRAWER = {"step_s": 0.001, "drive_s": 30.0, "damping_per_s": 20.0, "damping_ratio": 4.0}
"""Without much drag and soft contacts it clatters between its pins."""


def test_a_peg_is_in_its_hole_at_the_same_place() -> None:
    both = Both("insertion", step_s=5e-4, drive_s=3.0, damping_per_s=5.0, mass_times=0.1, ccd_tolerance=1e-14)
    both.assert_same_end()
    both.assert_same_force()
    assert apart_m(surface_points(both.scene.object), both.theirs.pose, both.ours.pose) < 0.2 * 5e-5  # of its play


def test_a_rail_is_turned_into_line_by_its_mate() -> None:
    case = DRIVE_CASES["dock"]
    both = Both("dock", step_s=0.005, drive_s=5.0)
    both.assert_same_end()
    both.assert_same_force()
    pitch = np.degrees([pose.euler_zyx[1] for pose in (case.scene.object.pose_world_object, both.theirs.pose)])
    assert pitch[1] < 0.8 * pitch[0]


def test_what_is_right_in_the_table_is_as_near() -> None:
    case = DRIVE_CASES["drawer, friction 1.6"]
    end = DrivenMujoco(case.scene, DriveSettings(**case.settings)).run()
    assert case.off(end).is_right(case.allowed_m)
    passed = DriveEnd(1.0, end.pose, end.along_n, False, end.look, end.steps, end.penetration_m)
    assert not case.off(passed).is_right(case.allowed_m)
