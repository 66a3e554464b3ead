"""What the table of drives calls right, and its rows; MuJoCo itself is asked in `driven/test_mujoco_drives.py`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench import drives_table
from bench.drive_cases import DRIVE_CASES, FORCE_OFF, DriveCase, mean_along_n
from bench.engine_mujoco_drives import DriveEnd
from cagepose import Pose


def our_end(case: DriveCase) -> DriveEnd:
    """What MuJoCo would say if it were us."""
    drive = case.ours.drive
    assert drive is not None
    is_blocked = case.ours.verdict == "blocked"
    return DriveEnd(drive.share, case.ours.pose, mean_along_n(drive), is_blocked, 1e-5, 1, 0.0)


@pytest.mark.parametrize("name", ["drawer, friction 0.5", "jaws", "insertion"])
def test_our_own_end_is_right_and_one_beside_it_is_not(name: str) -> None:
    case = DRIVE_CASES[name]
    end = our_end(case)

    def is_right(**changes: object) -> bool:
        return case.off(replace(end, **changes)).is_right(case.allowed_m)

    beside = Pose(end.pose.position_m + np.array([1.01 * case.allowed_m, 0.0, 0.0]), end.pose.quaternion_wxyz)
    assert is_right()
    assert not is_right(pose=beside)
    assert not is_right(share=end.share - 0.01)
    assert not is_right(is_blocked=not end.is_blocked)
    assert is_right(along_n=(1.0 + 1.1 * FORCE_OFF) * end.along_n) == end.is_blocked
    assert is_right(look=0.01) != end.is_blocked


def test_a_drive_has_rows_of_both_and_their_ratio(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.setattr(drives_table, "BUDGET_S", 0.01)
    monkeypatch.setattr(drives_table, "DRIVE_CASES", {"jaws": DRIVE_CASES["jaws"]})
    rows = {row.engine: row for row in drives_table.drive_rows()}
    assert set(rows) == {"cagepose-quasistatic", "cagepose-quasistatic-call", "mujoco"}
    theirs, ours = rows["mujoco"], rows["cagepose-quasistatic"]
    assert theirs.median_s is not None
    assert ours.median_s is not None
    assert theirs.ratio_to_ours == pytest.approx(theirs.median_s / ours.median_s)
    assert theirs.details["right"] is True
