"""What a user reads of a drive in the text of a run."""

from __future__ import annotations

from pathlib import Path

import pytest

import cagepose
from cagepose import Scene, save_scene
from cagepose.cli.app import main
from cagepose.model.load import Load
from driven.driven_scenes import exact_wedge_force, jaws, lever, truss, wedge


def lines_of(scene: Scene) -> list[str]:
    """The text of a run, with runs of blanks as one."""
    return [" ".join(line.split()) for line in str(cagepose.run(scene)).splitlines()]


def test_a_wedge_is_told_with_its_force_its_work_and_how_far_it_got() -> None:
    lines, force = lines_of(wedge()), exact_wedge_force(0.2, 0.1)
    assert "# phase mode driven to motion direction / axis amount new contacts" in lines
    assert "1 lift balanced 0 mm -" in lines
    assert "2 lift driven 20 mm travel (0, 0, 1) 7.2794 mm" in lines
    assert "drive complete, 20 mm" in lines
    assert f"drive force {force:.6g} N at the end, which is the greatest" in lines
    assert "work 127.067 N mm (friction 55.6559, snaps 0)" in lines
    assert "verdict lift: rests (stable)" in lines


def test_jaws_that_hold_a_block_say_so_and_the_next_phase_is_told_beside() -> None:
    lines = lines_of(jaws())
    assert "2 close driven 62.54 % stands still left pad, right pad" in lines
    text = " ".join(lines)
    assert "drive of close 83.33 % of the way (left 25 mm, right 25 mm); blocked: no motion of the object" in text
    assert "makes way for the drive, with any friction" in text
    assert "drive of lift complete (left 1 mm, right 1 mm)" in lines
    assert "close: forces of the load alone; the drive can add forces of any size" in lines
    assert "verdict close: blocked, lift: rests (stable)" in lines


def test_a_snap_is_an_event_at_its_depth_and_its_energy_stands_with_the_work() -> None:
    lines = lines_of(truss())
    assert "4 push free 31 mm travel (0, 0, -1) 30 mm tip" in lines
    assert "6 push driven 50 mm stands still" in lines
    assert "work 38.774 N mm (friction 0, snaps 38.774)" in lines
    (driver,) = [line for line in lines if line.startswith("drive force ")]
    assert driver.startswith("drive force 0 N at the end, the greatest is 1.98")
    assert driver.endswith(" mm")


def test_of_a_body_that_turns_the_angle_is_told_and_a_moment() -> None:
    lines = lines_of(lever())
    assert "drive complete, 1 mm, 30 deg" in lines
    assert "drive force 0 N at the end, the greatest is 467.067 N mm at 0 mm, 30 deg" in lines


def stopping_at(force_n: float) -> Scene:
    """The truss, which is pushed until it needs so much."""
    scene = truss()
    (load,) = scene.loads
    stops = Load("push", springs=load.springs, drive=load.drive, stop_at=force_n)
    return Scene(scene.object, scene.cage, [stops], friction_coefficient=0.0, name="truss")


@pytest.mark.parametrize(
    ("scene", "verdict", "why"),
    [
        (stopping_at(1.0), "stops", "; stops: the drive has reached the force or moment of stop_at"),
        (wedge(wall_friction=5.0), "jams", "; jams: friction alone stops the drive"),
        (
            Scene(jaws().object, jaws().cage, jaws().loads[:1], friction_coefficient=0.3),
            "blocked",
            "; blocked: no motion",
        ),
    ],
    ids=["stops", "jams", "blocked"],
)
def test_a_drive_that_stops_before_its_end_is_an_answer(
    scene: Scene, verdict: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It ends with 0, and the proof says what holds there as the bodies stand."""
    save_scene(scene, tmp_path / "scene.yaml")
    assert main(["run", str(tmp_path / "scene.yaml")]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert f"scene: {verdict}" in text or f"{scene.name}: {verdict}" in text
    assert why in text
    assert "proof rests with the bodies where they stopped: the contacts balance the load" in text
    assert "not a position of rest" not in text
