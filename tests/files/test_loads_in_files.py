"""Forces, moments and springs in scene files and saved runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cagepose import SceneFileError, load_run, load_scene, run, save_run, save_scene
from cagepose.files.scene_file import parse_scene

TEXT = """\
name: hung
units: {length: UNIT}
object: {boxes: [{size: [20, 20, 20], position: [0, 0, 0]}], mass: 2}
cage: {points: [[100, 0, 0]]}
loads:
  - name: all
    gravity: [0, 0, -9.81]
    forces:
      - {direction: [3, 0, 0], at: [1, 2, 3], magnitude: 4}
      - {direction: [0, 1, 0], at: [0, 0, 5], magnitude: 1, follows: true}
    moments: [{direction: [0, 0, 2], magnitude: 50, follows: true}]
    springs:
      - {at: [0, 0, 10], to: [0, 0, 60], stiffness: 0.5, preload: -3}
      - {at: [0, 9, 10], to: [0, 9, 60], stiffness: 2}
"""
LENGTHS = {"mm": 1e-3, "m": 1.0, "in": 0.0254}


@pytest.mark.parametrize("unit", LENGTHS)
def test_moments_and_stiffnesses_have_the_files_unit_of_length(unit: str) -> None:
    length = LENGTHS[unit]
    load = parse_scene(TEXT.replace("UNIT", unit)).loads[0]
    dead, following = load.forces
    assert (dead.magnitude_n, dead.follows, following.follows) == (4.0, False, True)
    assert dead.direction.tolist() == [1.0, 0.0, 0.0]
    assert dead.at_object_m.tolist() == pytest.approx([1 * length, 2 * length, 3 * length])
    (moment,) = load.moments
    assert (moment.magnitude_nm, moment.follows) == (pytest.approx(50 * length), True)
    one, other = load.springs
    assert (one.stiffness_n_per_m, one.preload_n) == (pytest.approx(0.5 / length), -3.0)
    assert (other.stiffness_n_per_m, other.preload_n) == (pytest.approx(2 / length), 0.0)
    assert other.to_m.tolist() == pytest.approx([0, 9 * length, 60 * length])


def test_a_force_may_stay_at_a_point_of_the_world(tmp_path: Path) -> None:
    scene = parse_scene(TEXT.replace("UNIT", "mm").replace("at: [1, 2, 3]", "at_world: [1, 2, 3]"))
    (fixed, riding) = scene.loads[0].forces
    assert (fixed.at_object_m, riding.at_world_m) == (None, None)
    assert fixed.at_world_m == pytest.approx([1e-3, 2e-3, 3e-3])
    assert "m of the world" in repr(fixed)
    save_scene(scene, tmp_path / "again.yaml")
    again = load_scene(tmp_path / "again.yaml", ["loads[0].forces[0].at_world[2]=4"]).loads[0].forces[0]
    assert again.at_world_m == pytest.approx([1e-3, 2e-3, 4e-3])
    save_run(run(scene), tmp_path / "run.json")
    assert np.array_equal(load_run(tmp_path / "run.json").scene.loads[0].forces[0].at_world_m, fixed.at_world_m)


def test_one_value_of_a_spring_is_set() -> None:
    scene = parse_scene(TEXT.replace("UNIT", "mm"), set_values=["loads[0].springs[1].preload=7"])
    assert scene.loads[0].springs[1].preload_n == 7.0


WRONG = {
    "stiffness: 0.5": ("stiffness: -1", "13:53: loads[0].springs[0].stiffness: is -1"),
    "to: [0, 9, 60]": ("to: [0, 9, 10]", "14:30: loads[0].springs[1].to: lies where the spring holds the object"),
    "stiffness: 2}": ("stiffness: 0}", "14:53: loads[0].springs[1].stiffness: is zero without a preload"),
    ", magnitude: 4}": ("}", "9:9: loads[0].forces[0].magnitude: is missing, and other loads act beside this force"),
    "magnitude: 50,": ("", "11:15: loads[0].moments[0].magnitude: is missing; add it, for example magnitude: 50"),
    ", mass: 2}": ("}", "3:9: object.mass: is missing, and gravity acts beside other loads in loads[0] (all)"),
    "follows: true}]": ("follows: 1}]", "loads[0].moments[0].follows: is 1"),
    "    gravity": (
        "    force: {direction: [1, 0, 0], at: [0, 0, 0]}\n    gravity",
        "loads[0].forces: stands beside force",
    ),
    "at: [0, 0, 5]": (
        "at_world: [0, 0, 5]",
        "10:42: loads[0].forces[1].at_world: is a point of the world, and the force",
    ),
    "at: [1, 2, 3], ": ("", "9:9: loads[0].forces[0]: has neither at nor at_world; give one of them"),
    "at: [1, 2, 3], m": ("at: [1, 2, 3], at_world: [0, 0, 0], m", "loads[0].forces[0]: has both at and at_world"),
    "preload: -3": ("prelaod: -3", "loads[0].springs[0].prelaod: is no known key; did you mean preload?"),
}


@pytest.mark.parametrize("old", WRONG)
def test_a_broken_load_is_told_with_its_place(old: str) -> None:
    new, told = WRONG[old]
    text = TEXT.replace("UNIT", "mm")
    assert old in text
    with pytest.raises(SceneFileError) as refused:
        parse_scene(text.replace(old, new))
    assert [told in line for line in str(refused.value).splitlines()].count(True) == 1, refused.value
    assert len(refused.value.problems) == 1


def test_a_saved_run_has_its_loads_and_an_older_one_has_none(tmp_path: Path) -> None:
    result = run(parse_scene(TEXT.replace("UNIT", "mm")))
    path = tmp_path / "hung.json"
    save_run(result, path)
    again = load_run(path)
    mine, other = result.scene.loads[0], again.scene.loads[0]
    assert [force.follows for force in other.forces] == [False, True]
    assert other.moments[0].magnitude_nm == mine.moments[0].magnitude_nm
    assert other.springs[0].preload_n == mine.springs[0].preload_n
    assert np.array_equal(other.springs[1].to_m, mine.springs[1].to_m)
    assert np.array_equal(run(again.scene).pose.position_m, result.pose.position_m)

    content = json.loads(path.read_text())
    (load,) = content["exact"]["scene"]["loads"]
    for key in ("forces", "moments", "springs"):
        del load[key]
    load["force"] = {"direction": [1.0, 0.0, 0.0], "at_m": [0.0, 0.0, 0.0], "magnitude_n": None}
    path.write_text(json.dumps(content))
    older = load_run(path).scene.loads[0]
    assert (older.forces, older.moments, older.springs) == ((), (), ())
    assert older.force is not None
    assert older.force.follows is False
