"""What a study keeps of drives: share, greatest force, and whether it could jam, as single runs say it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cagepose
from cagepose import Scene, Study, load_scene, run, run_many, save_scene
from cagepose.runs.cases import greatest_friction
from cagepose.runs.run import STOPPED
from cagepose.runs.variation import Variation
from driven.driven_scenes import jaws, lever, truss
from driven.pins_into_plates import pins_into_a_plate
from our_scenes import SCENES

OURS = {path.stem: path for path in SCENES}
FRICTIONS = [0.0, 0.5, 1.0, 1.6, 3.0]


def expected(scene: Scene, friction: float) -> list[tuple[float, float, bool]]:
    """Share, greatest force and whether it could jam of each phase of one run, by the attributes of its drives."""
    changed = scene.changed(friction_coefficient=friction)
    rows = [(math.nan, math.nan, False)] * len(scene.loads)
    for place, phase in enumerate(run(changed).phases):
        if not scene.loads[place].drive:
            continue
        drive = phase.drive
        if drive is None or (drive.share == 0.0 and phase.verdict not in STOPPED):
            rows[place] = (0.0, math.nan, False)
            continue
        least = drive.critical_jam_friction
        jams = least is not None and least <= greatest_friction(changed, friction)
        rows[place] = (drive.share, drive.greatest_along, jams)
    return rows


@pytest.mark.parametrize("name", ["drawer-jams", "jaws", "lever", "truss", "two phases"])
def test_many_runs_say_of_drives_what_each_says(name: str) -> None:
    made = {"lever": lever, "truss": truss, "two phases": jaws}
    scene = made[name]() if name in made else load_scene(OURS[name])
    runs = run_many(scene, Variation(friction_coefficient=FRICTIONS), threads=1)
    for row, friction in enumerate(FRICTIONS):
        shares, greatest, jams = zip(*expected(scene, friction), strict=True)
        np.testing.assert_array_equal(runs.drive_shares[row], shares)
        np.testing.assert_array_equal(runs.greatest_along[row], greatest)
        assert runs.jam_possible[row].tolist() == list(jams)


def test_a_drive_that_could_jam_has_the_forces_of_its_run_against_it() -> None:
    """The ranges along the curve, and the one word in a row, agree: a drawer on both sides of its limit of 1.5."""
    scene = load_scene(OURS["drawer-jams"])
    runs = run_many(scene, Variation(friction_coefficient=[1.0, 1.6]), threads=1)
    single = [run(scene.changed(friction_coefficient=friction)).phases[0].drive for friction in (1.0, 1.6)]
    assert [bool(drive.jam_possible) for drive in single if drive is not None] == [False, True]
    assert runs.jam_possible[:, 0].tolist() == [False, True]
    assert runs.drive_shares[:, 0].tolist() == [1.0, 0.0]


def rows(study: Study, folder: Path) -> list[dict[str, Any]]:
    return study.run(folder, workers=1).table().to_pylist()


def test_a_study_has_columns_for_each_phase_that_drives(tmp_path: Path) -> None:
    """In one go where friction varies, scene by scene where a body does."""
    save_scene(pins_into_a_plate(), tmp_path / "plate.yaml")
    off = [0.0, 0.4, 0.9]
    varied = Study(
        tmp_path / "plate.yaml",
        {"cage.bodies.head.pose.position[0]": {"grid": off}},
        {"method": "grid"},
        accept="drive_press == 1 and not jam_possible_press and force_max_press < 100",
    )
    found = rows(varied, tmp_path / "one by one")
    assert [row["verdict"] for row in found] == ["rests", "rests", "blocked"]
    assert [row["drive_press"] for row in found] == [1.0, 1.0, pytest.approx(1.0 / 9.0)]
    assert [row["jam_possible_press"] for row in found] == [False, False, True]
    assert [row["accepted"] for row in found] == [True, True, False]
    rough = Study(tmp_path / "plate.yaml", {"friction.coefficient": {"grid": [0.0, 0.2]}}, {"method": "grid"})
    at_once = rows(rough, tmp_path / "at once")
    columns = ["drive_press", "force_max_press", "jam_possible_press"]
    assert [at_once[0][name] for name in columns] == [found[0][name] for name in columns]


def test_a_moment_stands_in_the_unit_of_length_and_what_is_not_reached_is_empty(tmp_path: Path) -> None:
    scene = lever()
    (load,) = scene.loads
    turn = cagepose.Load("turn", gravity=load.gravity_world, springs=load.springs, drive={"arm": load.drive["arm"][0]})
    falls = cagepose.Load("fall", gravity=(0.0, 0.0, 9.81))
    save_scene(Scene(scene.object, scene.cage, [turn], friction_coefficient=0.0), tmp_path / "turn.yaml")
    save_scene(Scene(scene.object, scene.cage, [falls, turn], friction_coefficient=0.0), tmp_path / "fall.yaml")
    vary, sample = {"friction.coefficient": {"grid": [0.0, 0.001]}}, {"method": "grid"}
    row, _ = rows(Study(tmp_path / "turn.yaml", vary, sample), tmp_path / "turned")
    drive = run(Scene(scene.object, scene.cage, [turn], friction_coefficient=0.0)).phases[0].drive
    assert drive is not None
    assert row["force_max_turn"] == pytest.approx(1000.0 * drive.greatest_along)
    row, _ = rows(Study(tmp_path / "fall.yaml", vary, sample), tmp_path / "fallen")
    assert (row["verdict"], row["drive_turn"], row["force_max_turn"]) == ("escapes", None, None)
    assert row["jam_possible_turn"] is False
    assert "drive_fall" not in row


def test_a_data_frame_of_many_runs_has_them_where_runs_drive_something() -> None:
    pytest.importorskip("pandas")
    names = {"share", "greatest_along", "jam_possible"}
    assert names <= set(run_many(jaws(), threads=1).to_frame().columns)
    assert not names & set(run_many(load_scene(OURS["ladder"]), threads=1).to_frame().columns)
