"""Drives beside MuJoCo, tuned for each of them: how far its end is from ours, and the time of both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from bench import ours
from bench.drive_cases import DRIVE_CASES, DriveCase
from bench.engine_mujoco_drives import DrivenMujoco, DriveSettings
from bench.rows import Row, with_ratios
from bench.timing import median_cpu_s, median_s
from cagepose import CageposeError, MissingExtraError

BUDGET_S = 0.6
REPEATS = 2
"""Of MuJoCo, for wall and for CPU time each, beside one that is not measured."""
METHOD = "quasistatic"


def drive_rows() -> Iterator[Row]:
    """Measure each of `bench.drive_cases` by cagepose and by MuJoCo."""
    for case in DRIVE_CASES.values():
        own = list(_own_rows(case))
        yield from (with_ratios(row, own[0]) for row in (*own, mujoco_row(case)))


def _own_rows(case: DriveCase) -> Iterator[Row]:
    drive = case.ours.drive
    assert drive is not None
    times_s, _ = ours.measure(case.scene, METHOD, BUDGET_S)
    for part in ours.PARTS:
        wall_s, cpu_s = times_s[part]
        details = {"verdict": case.ours.verdict, "steps": len(drive.curve.share), "cpu_s": cpu_s}
        yield Row("drives", case.name, ours.engine_name(METHOD, part), wall_s, details=details)


def mujoco_row(case: DriveCase) -> Row:
    """Measure MuJoCo with the settings of a case; a row says what it is off by, whether that is allowed or not."""
    settings = DriveSettings(**case.settings)
    try:
        engine = DrivenMujoco(case.scene, settings)
        end = engine.run()
    except MissingExtraError as error:
        return Row("drives", case.name, "mujoco", skipped=str(error))
    except CageposeError as error:
        return Row("drives", case.name, "mujoco", settings=asdict(settings), skipped=str(error))
    off = case.off(end)
    details: dict[str, object] = {
        "verdict": "blocked" if end.is_blocked else "at its end",
        "steps": end.steps,
        "cpu_s": median_cpu_s(engine.run, 0.0, REPEATS),
        "apart_um": off.apart_m * 1e6,
        "force_off": off.force,
        "right": off.is_right(case.allowed_m),
    }
    return Row(
        "drives",
        case.name,
        "mujoco",
        median_s(engine.run, 0.0, REPEATS),
        settings=asdict(settings),
        details=details,
    )
