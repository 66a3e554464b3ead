"""What came of a drive, in the JSON document, in saved runs, in data frames, and in events that are made again."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import cagepose
from cagepose import Run, Scene
from cagepose.files.document import run_document
from cagepose.files.record import record_of
from cagepose.files.units import LengthUnit
from cagepose.runs.replay import replay_event
from driven.driven_scenes import ALL, exact_wedge_force, jaws, lever, truss, wedge

DRIVE = [
    *("share", "along", "work", "friction", "snaps", "jam_possible", "critical_jam_friction", "greatest", "bodies"),
    "curve",
]
BODY = ["pose", "travel", "angle_deg", "force", "moment", "along"]
PER_METRE: dict[LengthUnit, float] = {"mm": 1000.0, "m": 1.0, "in": 1000.0 / 25.4}


@pytest.mark.parametrize("unit", PER_METRE)
def test_the_drive_of_a_wedge_is_told_in_the_units_of_the_document(unit: LengthUnit) -> None:
    run, per_metre = cagepose.run(wedge()), PER_METRE[unit]
    document = run_document(run, unit)
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    (phase,) = document["phases"]
    drive, force = phase["drive"], exact_wedge_force(0.2, 0.1)
    assert list(drive) == DRIVE
    assert (drive["share"], drive["along"]) == (1.0, pytest.approx(force, rel=1e-9))
    assert drive["greatest"]["along"] == pytest.approx(force, rel=1e-9)
    assert drive["work"] == pytest.approx(0.02 * force * per_metre, rel=1e-6)
    (ramp,) = drive["bodies"].values()
    assert list(ramp) == BODY
    assert (ramp["travel"], ramp["angle_deg"], ramp["along"]) == (
        pytest.approx(0.02 * per_metre),
        0.0,
        pytest.approx(force, rel=1e-9),
    )
    assert ramp["force"][0] == pytest.approx(force, rel=1e-9)
    assert run.phases[0].drive is not None
    assert ramp["moment"] == pytest.approx(run.phases[0].drive.bodies["ramp"].moment_nm * per_metre)
    assert {len(column) for column in drive["curve"].values()} == {len(run.phases[0].drive.curve.share)}
    assert drive["curve"]["position"][-1] == phase["pose"]["position"]
    assert [event["share"] for event in phase["events"]] == [0.0, 1.0]


def test_a_turn_is_driven_by_a_moment_and_a_travel_after_it_by_a_force() -> None:
    """The knob pushes the block against a spring of 0.5 N/mm, in N mm; going down it needs nothing."""
    drive = run_document(cagepose.run(lever()))["phases"][0]["drive"]
    arm = drive["bodies"]["arm"]
    assert (arm["travel"], arm["angle_deg"]) == (pytest.approx(1.0), pytest.approx(30.0))
    assert arm["along"] == drive["along"] == pytest.approx(0.0, abs=1e-9)
    turned = np.radians(60.0 * np.array(drive["curve"]["share"]))
    x, y = 50.0 * np.cos(turned) + 10.0 * np.sin(turned), 50.0 * np.sin(turned) - 10.0 * np.cos(turned)
    pushes = (y > -3.0) & (turned < math.radians(30.0))
    exact = 0.5 * (y + 3.0) * x
    assert np.array(drive["curve"]["along"])[pushes] == pytest.approx(exact[pushes], rel=1e-6)
    assert drive["greatest"]["along"] == pytest.approx(467.067, rel=1e-5)
    assert drive["greatest"]["share"] == pytest.approx(0.5)


def without_drives(scene: Scene) -> Scene:
    return Scene(scene.object, scene.cage, [cagepose.Load("weight", gravity=(0, 0, -1))])


def test_phases_and_events_without_a_drive_have_nothing_of_it() -> None:
    (phase,) = run_document(cagepose.run(without_drives(jaws())))["phases"]
    assert "drive" not in phase
    assert all("share" not in event for event in phase["events"])
    stuck = run_document(cagepose.run(wedge(wall_friction=5.0)))["phases"][0]
    assert (stuck["verdict"], stuck["drive"]["share"], stuck["drive"]["curve"]["share"]) == ("jams", 0.0, [0.0])


@pytest.mark.parametrize("name", ALL)
def test_a_saved_run_keeps_its_drives_to_the_last_digit(tmp_path: Path, name: str) -> None:
    before = cagepose.run(ALL[name]())
    cagepose.save_run(before, tmp_path / "run.json")
    after = cagepose.load_run(tmp_path / "run.json")
    assert record_of(after) == record_of(before)
    assert run_document(after) == run_document(before)
    one, other = before.phases[0].drive, after.phases[0].drive
    assert one is not None
    assert other is not None
    for column in ("share", "along", "position_m", "quaternion_wxyz"):
        assert np.array_equal(getattr(one.curve, column), getattr(other.curve, column))
    assert [event.share for phase in after.phases for event in phase.events] == [
        event.share for phase in before.phases for event in phase.events
    ]


def test_a_frame_has_a_row_for_each_place_of_each_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))
    run = cagepose.run(jaws())
    frame, drives = run.to_frame("drive"), [phase.drive for phase in run.phases]
    assert all(drive is not None for drive in drives)
    counts = [len(drive.curve.share) for drive in drives if drive is not None]
    assert frame["phase"] == ["close"] * counts[0] + ["lift"] * counts[1]
    assert {len(column) for column in frame.values()} == {sum(counts)}
    assert [frame[key][-1] for key in ("x_m", "y_m", "z_m")] == run.pose.position_m.tolist()
    assert tuple(frame[key][-1] for key in ("yaw_rad", "pitch_rad", "roll_rad")) == run.pose.euler_zyx
    events = run.to_frame()
    assert events["share"] == [event.share for phase in run.phases for event in phase.events]
    still = cagepose.run(without_drives(run.scene))
    assert still.to_frame("drive") == {key: [] for key in frame}
    assert all(math.isnan(share) for share in still.to_frame()["share"])


def same_bits(run: Run, *, in_python: bool) -> bool:
    """Whether each event of a run is the same when it is made again, to the last digit."""
    for number, phase in enumerate(run.phases):
        for place, event in enumerate(phase.events):
            again = replay_event(run, number, place, in_python=in_python)
            if record_of(again) != record_of(event):
                return False
    return True


@pytest.mark.parametrize("scene", [wedge, jaws, truss], ids=["wedge", "jaws", "truss"])
def test_any_event_of_a_drive_and_after_it_can_be_made_again(scene: Callable[[], Scene]) -> None:
    assert same_bits(cagepose.run(scene()), in_python=False)


def test_an_event_of_a_drive_can_be_made_again_in_plain_python() -> None:
    run = cagepose.run(wedge(friction=0.0, wall_friction=0.0, way_m=1e-4))
    again = replay_event(run, 0, 1, in_python=True)
    event = run.phases[0].events[1]
    assert (again.rule, again.share, again.hit, again.contacts) == ("driven", 1.0, event.hit, event.contacts)
    assert again.pose_world_object.position_m == pytest.approx(event.pose_world_object.position_m, abs=1e-15)
