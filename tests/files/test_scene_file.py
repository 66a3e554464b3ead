"""What a scene file means: units, poses, points, loads, and where a changed value is put."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from cagepose import Scene, SceneFileError, load_scene
from cagepose.files.record import record_of
from cagepose.files.scene_file import parse_scene, read_scene_file


def test_lengths_are_metres_inside_to_the_last_digit(sample_text: str) -> None:
    scene = parse_scene(sample_text)
    assert scene.object.boxes[0].size_m.tolist() == [0.01, 0.01, 0.01]
    assert scene.object.pose_world_object.position_m.tolist() == [0.002, 0.004, 0.01]
    assert scene.cage.points_cage.tolist()[1] == [0.004, -0.004, 0.0]


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("m", 1e-3), ("in", 1.0 / 25.4)])
def test_a_scene_is_the_same_in_every_unit(sample_text: str, unit: str, factor: float) -> None:
    text = f"units: {{length: {unit}}}\n" + _scaled(sample_text, factor)
    found, expected = parse_scene(text), parse_scene(sample_text)
    assert np.allclose(found.cage.points_cage, expected.cage.points_cage, rtol=1e-15, atol=0.0)
    assert np.allclose(found.object.boxes[0].size_m, expected.object.boxes[0].size_m, rtol=1e-15)
    assert math.isclose(found.size_m, expected.size_m, rel_tol=1e-15)


def _scaled(text: str, factor: float) -> str:
    for old, numbers in (
        ("[10, 10, 10]", [10, 10, 10]),
        ("[2, 4, 10]", [2, 4, 10]),
        ("[4, 4, 0]", [4, 4, 0]),
        ("[4, -4, 0]", [4, -4, 0]),
        ("[-4, -4, 0]", [-4, -4, 0]),
        ("[-4, 4, 0]", [-4, 4, 0]),
    ):
        assert old in text
        text = text.replace(old, repr([number * factor for number in numbers]))
    return text


def test_an_inertia_is_given_in_the_length_unit_squared(sample_text: str) -> None:
    inertia = "  mass: 1\n  inertia: [[2, 0, 0], [0, 2, 0], [0, 0, 2]]\n  pose:"
    scene = parse_scene(sample_text.replace("  pose:", inertia))
    assert scene.object.inertia_kg_m2 is not None
    assert np.allclose(scene.object.inertia_kg_m2, 2e-6 * np.eye(3), rtol=1e-15)


def test_euler_angles_and_quaternions_say_the_same(sample_text: str) -> None:
    angles = parse_scene(sample_text, set_values=["cage.pose.euler_zyx_deg=[90, 0, 0]"])
    half = math.sqrt(0.5)
    quaternion = parse_scene(sample_text, set_values=[f"cage.pose.quat_wxyz=[{half}, 0, 0, {half}]"])
    assert np.allclose(angles.cage.points_world()[1], [0.004, 0.004, 0.0], atol=1e-18)
    assert np.allclose(angles.cage.points_world(), quaternion.cage.points_world(), atol=1e-17)


def test_a_box_without_a_position_is_at_the_origin_of_its_part(sample_text: str) -> None:
    assert "      position: [0, 0, 0]\n" in sample_text
    boxes = parse_scene(sample_text.replace("      position: [0, 0, 0]\n", "")).object.boxes
    assert boxes[0].pose_object_box.position_m.tolist() == [0.0, 0.0, 0.0]


def test_points_have_default_names_or_their_own(sample_text: str) -> None:
    assert parse_scene(sample_text).cage.names == ("C1", "C2", "C3", "C4")
    named = sample_text.replace("[[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]", "{b: [4, 4, 0], a: [0, 0, 0]}")
    assert parse_scene(named).cage.names == ("b", "a")


def test_friction_as_an_angle_is_its_tangent(sample_text: str) -> None:
    scene = parse_scene(sample_text, set_values=["friction.angle_deg=45"])
    assert scene.friction_coefficient == pytest.approx(1.0, rel=1e-15)
    assert parse_scene(sample_text).friction_coefficient is None


def test_everything_that_is_optional_can_be_given(sample_text: str) -> None:
    extra = """
units: {length: mm}
friction: {coefficient: 0.3}
method: stepwise
metric: drag
tolerances: {touch: 1.0e-8, grazing_band_deg: 2}
adjustable: {height: {key: object.pose.position.2, range: [5, 15]}}
"""
    scene = parse_scene(
        sample_text + "  - {name: push, force: {direction: [0, 3, 4], at: [1, 2, 3], magnitude: 7}}" + extra
    )
    assert (scene.method, scene.metric, scene.friction_coefficient) == ("stepwise", "drag", 0.3)
    assert (scene.tolerances.touch, scene.tolerances.grazing_band_rad) == (1e-8, math.radians(2.0))
    assert (scene.adjustable[0].name, scene.adjustable[0].low, scene.adjustable[0].high) == ("height", 5.0, 15.0)
    force = scene.loads[1].force
    assert force is not None
    assert (force.direction.tolist(), force.at_object_m.tolist()) == ([0.0, 0.6, 0.8], [0.001, 0.002, 0.003])
    assert force.magnitude_n == 7.0


def test_a_key_left_empty_is_as_if_left_out(sample_text: str) -> None:
    scene = parse_scene(sample_text.replace("cage:\n", "cage:\n  pose:\n") + "friction:\nmethod: null\n")
    assert record_of(scene) == record_of(parse_scene(sample_text))


def test_json_scenes_are_read(tmp_path: Path) -> None:
    data = {
        "name": "j",
        "object": {"boxes": [{"size": [1, 1, 1], "position": [0, 0, 0]}]},
        "cage": {"points": [[0, 0, -2]]},
        "loads": [{"name": "g", "gravity": [0, 0, -9.81]}],
    }
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    assert load_scene(path).name == "j"


def test_a_byte_order_mark_is_no_error(tmp_path: Path, sample_text: str) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(sample_text, encoding="utf-8-sig")
    assert load_scene(str(path)).name == "sample"


def test_the_files_length_unit_is_kept(tmp_path: Path, sample_text: str) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(sample_text + "units: {length: m}\n", encoding="utf-8")
    assert read_scene_file(path).length_unit == "m"
    path.write_text(sample_text, encoding="utf-8")
    assert read_scene_file(path).length_unit == "mm"


@pytest.mark.parametrize("path", ["object.boxes[0].size[2]", "object.boxes.0.size.2", "object.boxes[0].size.2"])
def test_set_changes_one_value(sample_text: str, path: str) -> None:
    scene = parse_scene(sample_text, set_values=[f"{path}=12"])
    assert scene.object.boxes[0].size_m.tolist() == [0.01, 0.01, 0.012]


def test_set_takes_lists_mappings_and_text(sample_text: str) -> None:
    changes = ["name=other", "cage.points={a: [0, 0, 0]}", "object.pose = {position: [0, 0, 9]}"]
    scene: Scene = parse_scene(sample_text, set_values=changes)
    assert (scene.name, scene.cage.names) == ("other", ("a",))
    assert scene.object.pose_world_object.position_m.tolist() == [0.0, 0.0, 0.009]


def test_set_makes_the_mappings_on_the_way(sample_text: str) -> None:
    scene = parse_scene(sample_text, set_values=["cage.pose.position=[1, 0, 0]", "tolerances.touch=1e-8"])
    assert scene.cage.points_world()[0].tolist() == [0.005, 0.004, 0.0]
    assert scene.tolerances.touch == 1e-8


def test_a_later_set_wins_and_an_empty_one_leaves_the_key_out(sample_text: str) -> None:
    changes = ["friction.coefficient=0.3", "object.mass=1", "object.mass=2", "friction="]
    scene = parse_scene(sample_text, set_values=changes)
    assert (scene.object.mass_kg, scene.friction_coefficient) == (2.0, None)


def test_set_can_mend_a_broken_file(sample_text: str) -> None:
    broken = sample_text.replace("size: [10, 10, 10]", "size: [10, 10]")
    assert parse_scene(broken, set_values=["object.boxes[0].size=[10, 10, 10]"]).name == "sample"


@pytest.mark.parametrize(
    ("argument", "message"),
    [
        ("name", "has no =; write key.path=value, such as object.mass=0.5"),
        ("=3", "the path is empty; write keys with dots, such as object.mass"),
        ("a..b=3", "'a..b' is not a path to a value; write keys with dots and indices in brackets,"
                   " such as object.boxes[0].size[2]"),
        ("object.boxes[1].name=x", "object.boxes holds 1 value, so it has no index 1; give an index from 0 to 0"),
        ("object.boxes.size=3", "object.boxes is a list, which has no key 'size'; give an index from 0 to 0"),
        ("name.first=x", "name is a single value, which holds no 'first'; set name itself"),
        ("object.inertia[0]=1", "object.inertia is missing, so it has no index 0; write it into the scene, or set it as"
                                " a whole"),
        ("object.mass=[1", "is not YAML: expected ',' or ']', but got the end of the file;"
                           " close the bracket or quote that is open"),
        (f"{'a.' * 4999}a=1", "names a place 5000 levels deep; a scene has at most 32"),
        ("object.mass=!x 1", "has the tag !x; remove it (scene files have no tags)"),
        ("object.mass=true", "object.mass: is true; give a number"),
        ("objct.mass=1", "objct: is no known key; did you mean object? known keys: name, units, parameters, object,"
                         " cage, loads, friction, method, metric, planar, tolerances, adjustable, left_out"),
        ("object.pose.position[2]=3", "cage.points.C1: starts 2 mm inside object.boxes[0] (box1); move the point out or"
                                      " move the object's start pose"),
        ("cage.points[2]=[4, -4, 0]", "cage.points.C3: lies 0 mm from C2, so they are one point; remove or move one"),
    ],
)  # fmt: skip
def test_what_set_breaks_is_blamed_on_set(sample_text: str, argument: str, message: str) -> None:
    with pytest.raises(SceneFileError) as caught:
        parse_scene(sample_text, set_values=[argument])
    assert str(caught.value) == f"--set {argument}: {message}"


def test_what_the_file_breaks_is_not_blamed_on_set(sample_text: str) -> None:
    broken = sample_text.replace("size: [10, 10, 10]", "size: [10, 10]")
    with pytest.raises(SceneFileError) as caught:
        parse_scene(broken, "s.yaml", ["object.boxes[0].size[1]=11", "object.mass=0"])
    assert str(caught.value).splitlines() == [
        "--set object.mass=0: object.mass: is 0; give a number above 0",
        "s.yaml:4:13: object.boxes[0].size: has 2 values; give 3",
    ]


def test_a_problem_far_from_what_was_set_names_all_that_was_set(sample_text: str) -> None:
    changes = ["object.boxes[0].size=[10, 10, 10.1]", "object.pose.position=[2, 4, 5]"]
    with pytest.raises(
        SceneFileError, match=r"^--set object.boxes.* --set object.pose.position=.*: cage.points.C1: starts"
    ):
        parse_scene(sample_text, set_values=changes)


def test_points_come_from_a_csv_file_beside_the_scene(tmp_path: Path, sample_text: str) -> None:
    text = sample_text.replace("[[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]", "{file: sub/points.csv}")
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "sub").mkdir()
    points = tmp_path / "sub" / "points.csv"
    points.write_text("4,4,0\n4,-4,0\n-4,-4,0\n-4,4,0\n", encoding="utf-8")
    expected = record_of(parse_scene(sample_text))
    assert record_of(load_scene(tmp_path / "scene.yaml")) == expected
    points.write_text(
        'Name, X, Y, Z\n# corners\nC1, 4, 4, 0\n\nC2,4,-4,0\nC3,-4,-4,0\n"C4",-4,4.0e0,0\n', encoding="utf-8"
    )
    assert record_of(load_scene(tmp_path / "scene.yaml")) == expected


@pytest.mark.parametrize(
    ("rows", "messages"),
    [
        ("4,4\n1,2,3\nx,1,2,3,4\n", [
            "1:1: cage.points.file: has 2 values; give x,y,z or name,x,y,z",
            "2:1: cage.points.file: has 3 values, the first row 2; give all points a name or none",
            "3:1: cage.points.file: has 5 values; give x,y,z or name,x,y,z"]),
        ("x,y,z\n4,4,0\n4,four,0\n4,nan,0\n4,inf,0\n1e13,0,0\n1_0,0,0\n", [
            "3:1: cage.points.file: holds 'four', which is no number; give x, y and z with a decimal point",
            "4:1: cage.points.file: holds 'nan'; give a finite number up to 1e+12",
            "5:1: cage.points.file: holds 'inf'; give a finite number up to 1e+12",
            "6:1: cage.points.file: holds '1e13'; give a finite number up to 1e+12",
            "7:1: cage.points.file: holds '1_0'; give a finite number up to 1e+12"]),
        ("a,4,4,0\n,4,-4,0\n", [
            "2:1: cage.points.file: has the name ''; give a name of 1 to 100 visible characters"]),
        ("a,4,4,0\nb,4,-4,0\na,0,0,0\n", ["3:1: cage.points.a: is the name of 2 points; rename all but one"]),
        ("4,4,0\n\n2,4,10\n", [
            "3:1: cage.points.C2: starts 5 mm inside object.boxes[0] (box1); move the point out or"
            " move the object's start pose"]),
        ("4,4,\"0\n", ["1:1: cage.points.file: is not CSV (unexpected end of data); correct this line"]),
    ],
)  # fmt: skip
def test_bad_rows_of_a_points_file_are_named_by_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sample_text: str, rows: str, messages: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = sample_text.replace("[[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]", "{file: points.csv}")
    Path("scene.yaml").write_text(text, encoding="utf-8")
    Path("points.csv").write_text(rows, encoding="utf-8")
    with pytest.raises(SceneFileError) as caught:
        load_scene("scene.yaml")
    assert str(caught.value).splitlines() == [f"points.csv:{message}" for message in messages]


@pytest.mark.parametrize("content", [b"", b"x,y,z\n"])
def test_a_points_file_without_points_is_found_where_the_scene_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sample_text: str, content: bytes
) -> None:
    monkeypatch.chdir(tmp_path)
    text = sample_text.replace("[[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]", "{file: points.csv}")
    Path("scene.yaml").write_text(text, encoding="utf-8")
    Path("points.csv").write_bytes(content)
    with pytest.raises(SceneFileError) as caught:
        load_scene("scene.yaml")
    assert str(caught.value) == (
        "scene.yaml:8:18: cage.points.file: points.csv holds no points; give rows of x,y,z or name,x,y,z"
    )


def test_a_named_point_may_be_called_file(sample_text: str) -> None:
    named = sample_text.replace("[[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]", "{file: [4, 4, 0]}")
    assert parse_scene(named).cage.names == ("file",)
