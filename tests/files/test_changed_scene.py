"""Scenes back into data and files, and scenes with one key changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cagepose
from cagepose.errors import SceneError
from cagepose.files.record import record_of
from cagepose.files.units import LENGTH_UNITS, LengthUnit
from cagepose.model.pose import Pose

SCENES = sorted((Path(__file__).resolve().parents[2] / "scenes").glob("*.yaml"))
WITH_PARAMETERS = SCENES[0].parent / "studies" / "rail.yaml"
RAIL = cagepose.load_scene(SCENES[0].parent / "rail-pitch.yaml")

HOLED = cagepose.Scene(
    cagepose.Object(
        [cagepose.Box((0.1, 0.1, 0.02), name="plate")],
        shapes=[
            cagepose.Convex([(0, 0, 0), (0.01, 0, 0), (0, 0.01, 0), (0, 0, 0.01)], 0.001, Pose((0, 0, 0.02))),
            cagepose.Cylinder(0.003, 0.02, Pose((0.02, 0, 0.02), euler_zyx=(0.1, 0.2, 0.3))),
            cagepose.Cone(0.003, 0.001, 0.02, Pose((-0.02, 0, 0.02))),
            cagepose.Disc(0.003, Pose((-0.04, 0, 0.02))),
            cagepose.Capsule(0.003, 0.02, Pose((0, 0.02, 0.02))),
            cagepose.Cylinder(0.02, 0.02, Pose((0.03, 0.03, 0.02)), "hub"),
        ],
        holes=[cagepose.Hole(0.004, 0.01, cagepose.Chamfer(0.001, 0.7), ["hub"], Pose((0.03, 0.03, 0.03)))],
        pose=Pose((0, 0, 1 / 30), (0.9, 0.1, 0.2, 0.3)),
        mass_kg=0.7,
        inertia_kg_m2=np.diag([0.0011, 0.0012, 0.0013]),
    ),
    cagepose.Cage(
        [(1 / 3, 0, -0.1), (0, 1 / 7, -0.1)],
        ["no", "012"],
        Pose(euler_zyx=(0.3, 0.1, 0.2)),
        [cagepose.Sphere(0.002, Pose((0, 0, -0.5)), "a, b: #c")],
    ),
    [
        cagepose.Load(
            "all",
            gravity=(0, 0, -9.81),
            forces=[cagepose.Force((1, 2, 3), (0, 0, 0.01), 5.5, follows=True)],
            moments=[cagepose.Moment((0, 0, 1), 0.05)],
            springs=[cagepose.Spring((0, 0, 0), (0, 0, 0.3), 123.4, -2.5)],
        ),
        cagepose.Load("push", force=cagepose.Force((1, 1, 0), (0, 0, 0))),
    ],
    name="all kinds",
    friction_coefficient=0.31,
    friction_of={"no": 0.1, "plate": 0.2, "a, b: #c": 0.7, "disc1": 0.0},
    metric="drag",
    tolerances=cagepose.Tolerances(3e-9, 0.02),
    adjustable=[cagepose.Adjustable("tilt", "object.mass", 0.5, 1.0)],
)


@pytest.mark.parametrize("unit", LENGTH_UNITS)
@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_a_saved_scene_is_the_same_scene(path: Path, unit: LengthUnit, tmp_path: Path) -> None:
    scene = cagepose.load_scene(path)
    again = tmp_path / "again.yaml"
    cagepose.save_scene(scene, again, unit)
    found = record_of(cagepose.load_scene(again))
    if unit == "mm":
        assert found == record_of(scene)
    else:  # a number of millimetres need not have one in another unit
        assert close(found, record_of(scene))
    cagepose.save_scene(scene, again, unit)  # replaces what it wrote itself


def close(one: object, other: object) -> bool:
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(close(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(close, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return one == pytest.approx(other, rel=1e-14, abs=1e-17)
    return one == other


def test_all_that_a_scene_can_have_is_saved(tmp_path: Path) -> None:
    for unit in LENGTH_UNITS:
        cagepose.save_scene(HOLED, tmp_path / f"{unit}.yaml", unit)
        found = cagepose.load_scene(tmp_path / f"{unit}.yaml")
        # holes stand among shapes in a file, and a part's angles are those of its quaternion but for rounding
        assert close(record_of(found), record_of(HOLED))
    text = (tmp_path / "mm.yaml").read_text(encoding="utf-8")
    assert "    - {name: plate, size: [100, 100, 20], position: [0, 0, 0]}\n" in text


def test_expressions_are_saved_as_what_they_came_to_and_parameters_are_left_out(tmp_path: Path) -> None:
    text = WITH_PARAMETERS.read_text(encoding="utf-8")
    text += "adjustable:\n  play: {key: parameters.play, range: [0.5, 2]}\n"
    text += "  back: {key: 'loads[1].force.at[0]', range: [-600, 0]}\n"
    (tmp_path / "rail.yaml").write_text(text, encoding="utf-8")
    scene = cagepose.load_scene(tmp_path / "rail.yaml", ["parameters.play=0.3", "parameters.yaw=0.7"])
    assert [entry.name for entry in scene.adjustable] == ["play", "back"]
    cagepose.save_scene(scene, tmp_path / "again.yaml")
    again = cagepose.load_scene(tmp_path / "again.yaml")
    assert [entry.name for entry in again.adjustable] == ["back"]
    assert record_of(again) == {**record_of(scene), "adjustable": record_of(again)["adjustable"]}
    saved = (tmp_path / "again.yaml").read_text(encoding="utf-8")
    assert "parameters:" not in saved
    assert "parameters." not in saved
    assert "[-91.5, -31.55, -0.65]" in saved


def test_numbers_that_were_expressions_change_like_all_others() -> None:
    scene = cagepose.load_scene(WITH_PARAMETERS)
    raised = scene.changed({"cage.points.C1[2]": -0.002, "cage.pose.euler_zyx_deg[0]": 0.3})
    assert raised.cage.points_cage[0].tolist() == [-0.0915, -0.03155, -0.002]
    assert raised.cage.points_cage[1:].tolist() == scene.cage.points_cage[1:].tolist()
    assert np.degrees(raised.cage.pose_world_cage.euler_zyx[0]) == pytest.approx(0.3)
    for key in ("parameters.play", "parameters"):
        with pytest.raises(SceneError) as caught:
            scene.changed({key: 0.3, "object.mass": 1.0})
        assert str(caught.value).startswith(
            f"{key}: is of a scene file, and a scene holds what its expressions came to;"
        )
    with pytest.raises(SceneError, match=r"object\.mass: is text '=2'; give a number"):
        scene.changed("object.mass", "=2")


def test_what_others_wrote_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("name: mine\n", encoding="utf-8")
    with pytest.raises(FileExistsError, match="holds something else than a scene that cagepose saved"):
        cagepose.save_scene(RAIL, tmp_path / "mine.yaml")


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_a_change_changes_nothing_else(path: Path) -> None:
    scene = cagepose.load_scene(path)
    assert record_of(scene.changed("name", "other")) == {**record_of(scene), "name": "other"}
    assert record_of(scene.changed("cage.pose.position[0]", 0.0)) == record_of(
        scene.changed("cage.pose.position[0]", 0)
    )


def test_keys_are_those_of_the_file_lengths_metres_and_angles_degrees() -> None:
    again = cagepose.load_scene(
        SCENES[0].parent / "rail-pitch.yaml",
        ["cage.pose.euler_zyx_deg[1]=0.2", "object.boxes[1].size[0]=1000", "cage.points[0][0]=-110"],
    )
    changes = {
        "cage.pose.euler_zyx_deg[1]": 0.2,
        "object.boxes[1].size[0]": np.float64(1.0),
        "cage.points.C1[0]": -0.11,
    }
    assert record_of(RAIL.changed(changes)) == record_of(again)
    one_by_one = RAIL
    for key, value in changes.items():
        one_by_one = one_by_one.changed(key, value)
    assert record_of(one_by_one) == record_of(again)


def test_the_centre_of_gravity_follows_a_changed_box_unless_it_was_given() -> None:
    load = cagepose.Load("weight", gravity=(0, 0, -1))
    boxes = [cagepose.Box((1, 1, 1)), cagepose.Box((1, 1, 1), Pose((1, 0, 0)))]
    for center, expected in ((None, (1 + 1 / 3 * 0.5, 0, 0)), ((0.5, 0, 0), (0.5, 0, 0))):
        held = cagepose.Object(boxes, center, pose=Pose((0, 0, 2)))
        changed = cagepose.Scene(held, cagepose.Cage([(0, 0, 0)]), [load]).changed("object.boxes[1].position[0]", 2.0)
        expected = (1.0, 0, 0) if center is None else expected
        assert changed.object.center_of_gravity_m == pytest.approx(expected)


def test_a_quaternion_can_be_changed_as_angles_and_angles_as_a_quaternion() -> None:
    turned = HOLED.changed("object.pose.euler_zyx_deg[0]", 10.0).object.pose_world_object
    assert np.degrees(turned.euler_zyx)[0] == pytest.approx(10.0)
    assert turned.euler_zyx[1:] == pytest.approx(HOLED.object.pose_world_object.euler_zyx[1:])
    upright = RAIL.changed("cage.pose.quat_wxyz", (1, 0, 0, 0)).cage.pose_world_cage
    assert upright.euler_zyx == (0.0, 0.0, 0.0)


def test_none_leaves_out_and_keywords_still_change() -> None:
    assert HOLED.changed({"object.mass": None, "object.inertia": None, "loads": [{"name": "w", "gravity": (0, 0, -1)}]})
    assert RAIL.changed("friction.coefficient", 0.2, metric="drag").metric == "drag"
    assert RAIL.changed("friction.coefficient", 0.2).friction_coefficient == 0.2


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("object.masss", 2, "object.masss: is no known key; did you mean mass?"),
        ("object.mass", "2", "object.mass: is text '2'; give a number"),
        ("object.boxes[9].size[0]", 1, "object.boxes holds 6 values, so it has no index 9; give an index from 0 to 5"),
        ("object..mass", 1, "'object..mass' is not a path to a value"),
        ("friction.coefficient", -1, "friction.coefficient: is -1; give a number from 0 upwards"),
        ("object.boxes[0].size[0]", 0.0, "object.boxes[0].size[0]: is 0; give a number above 0"),
        ("cage.points.C1", [0, 0], "cage.points[0]: has 2 values; give 3"),
        ("cage.pose", Pose(), "cage.pose: is of type Pose; give keys with values"),
        (5, 2, "5 is no key; write one as in a scene file, such as 'object.mass'"),
    ],
)
def test_what_cannot_be_is_told_at_its_key(key: object, value: object, message: str) -> None:
    with pytest.raises(SceneError) as caught:
        RAIL.changed(key, value)  # type: ignore[arg-type]
    assert message in str(caught.value)
