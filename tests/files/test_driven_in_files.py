"""Bodies of the cage and drives in scene files, saved scenes and saved runs."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from cagepose import Scene, SceneError, SceneFileError, load_scene, save_scene
from cagepose.cli.app import main
from cagepose.files.record import from_record, record_of
from cagepose.files.scene_document import scene_document
from cagepose.files.scene_file import parse_scene
from cagepose.files.yaml_source import parse_yaml
from cagepose.sampling.batch_columns import BatchColumns

TEXT = """\
name: dock
units: {length: mm}
object: {boxes: [{size: [20, 20, 20], position: [0, 0, 0]}], mass: 2}
cage:
  points: {below: [0, 0, -10]}
  bodies:
    mate:
      shapes:
        - {box: {size: [10, 10, 10]}, position: [0, 0, 0], name: block, friction: 0.3}
        - {hole: {radius: 2, depth: 5, in: [block]}, position: [-5, 0, 0], euler_zyx_deg: [0, -90, 0]}
      points: [[-10, 4, 0], [-10, -4, 0]]
      pose: {position: [50, 0, 0], euler_zyx_deg: [0, 0, 20]}
    jaw:
      points: {tip: [-30, 0, 0]}
loads:
  - {name: weight, gravity: [0, 0, -9.81]}
  - name: go
    gravity: [0, 0, -9.81]
    springs: [{at: [0, 0, 0], to: [-20, 0, 5], of: mate, stiffness: 0.5, preload: 2}]
    drive:
      mate: {travel: [-25, 0, 0]}
      jaw: [{travel: [0, 0, 5], turn: {about: [0, 0, 2], angle_deg: 30}}, {travel: [5, 0, 0]}]
    stop_at: {force: 200}
  - name: turn
    drive: {mate: {turn: {about: [0, 0, 1], through: [50, 0, 0], angle_deg: -12.5}}}
    stop_at: {moment: 500}
friction: {coefficient: 0.1, of: {tip: 0, mate/C1: 0.2}}
adjustable:
  reach: {key: "loads[1].drive.mate.travel[0]", range: [-30, -20]}
  off: {key: "cage.bodies.mate.pose.position[1]", range: [-1, 1]}
"""
LENGTHS = {"mm": 1e-3, "m": 1.0, "in": 0.0254}


@pytest.mark.parametrize("unit", LENGTHS)
def test_lengths_and_limits_have_the_files_unit(unit: str) -> None:
    length = LENGTHS[unit]
    scene = parse_scene(TEXT.replace("length: mm", f"length: {unit}"))
    mate, jaw = scene.cage.bodies
    assert (mate.name, jaw.name, mate.names, jaw.names) == ("mate", "jaw", ("mate/C1", "mate/C2"), ("tip",))
    assert mate.pose_cage_body.position_m == pytest.approx([50 * length, 0, 0])
    assert mate.points_body[1] == pytest.approx([-10 * length, -4 * length, 0])
    assert scene.cage.element_names == ("below", "mate/C1", "mate/C2", "tip", "block", "mate/hole1")
    assert scene.friction_of == {"tip": 0.0, "mate/C1": 0.2, "block": 0.3}
    _, go, turn = scene.loads
    (travel,), (screw, back), (leg,) = go.drive["mate"], go.drive["jaw"], turn.drive["mate"]
    assert travel.travel_m == pytest.approx([-25 * length, 0, 0])
    assert (screw.travel_m, back.travel_m) == (pytest.approx([0, 0, 5 * length]), pytest.approx([5 * length, 0, 0]))
    assert (screw.about_cage, screw.through_cage_m) == (pytest.approx([0, 0, 1]), pytest.approx([0, 0, 0]))
    assert (screw.angle_rad, leg.angle_rad) == (math.radians(30), math.radians(-12.5))
    assert (leg.through_cage_m, leg.is_turn) == (pytest.approx([50 * length, 0, 0]), True)
    assert (go.stop_at, turn.stop_at) == (200.0, pytest.approx(500 * length))
    assert (go.springs[0].of, go.springs[0].to_m) == ("mate", pytest.approx([-20 * length, 0, 5 * length]))


@pytest.mark.parametrize("unit", ["mm", "in"])
def test_a_scene_that_is_saved_comes_back_with_its_bodies_and_drives(tmp_path: Path, unit: str) -> None:
    scene = parse_scene(TEXT.replace("length: mm", f"length: {unit}"))
    path = tmp_path / "dock.yaml"
    save_scene(scene, path, unit)  # type: ignore[arg-type]
    assert record_of(load_scene(path)) == record_of(scene)
    document = scene_document(scene, unit)  # type: ignore[arg-type]
    assert document["cage"]["points"] == {"below": [0, 0, -10]}
    assert document["cage"]["bodies"]["mate"]["points"] == [[-10, 4, 0], [-10, -4, 0]]
    assert document["loads"][1]["drive"]["mate"] == {"travel": [-25, 0, 0]}
    assert [load.get("stop_at") for load in document["loads"]] == [None, {"force": 200}, {"moment": 500}]


def test_the_record_of_a_scene_has_bodies_once_and_what_stands_still_alone() -> None:
    scene = parse_scene(TEXT)
    record = json.loads(json.dumps(record_of(scene)))
    assert record["point_names"] == ["below"]
    assert [body["name"] for body in record["cage_bodies"]] == ["mate", "jaw"]
    again = from_record(Scene, record)
    assert record_of(again) == record_of(scene)
    assert again.cage.element_bodies == scene.cage.element_bodies == (0, 1, 1, 2, 1, 1)


CHANGES: dict[str, object] = {
    "cage.bodies.mate.pose.position[0]": 0.06,
    "cage.bodies.mate.pose.euler_zyx_deg[0]": 5.0,
    "cage.bodies.mate.points.mate/C2[1]": -0.005,
    "cage.bodies.jaw.points.tip[1]": -0.005,
    "cage.bodies.mate.shapes[0].box.size[1]": 0.012,
    "cage.points.below[2]": -0.02,
    "loads[1].drive.mate.travel[0]": -0.02,
    "loads[1].drive.jaw[0].turn.angle_deg": 45.0,
    "loads[2].drive.mate.turn.through[1]": 0.001,
    "loads[2].stop_at.moment": 2.0,
    "loads[1].springs[0].of": "jaw",
}


@pytest.mark.parametrize("key", CHANGES)
def test_each_number_of_a_body_and_a_drive_can_be_changed(key: str) -> None:
    scene = parse_scene(TEXT)
    before, after = record_of(scene), record_of(scene.changed(key, CHANGES[key]))
    assert after != before
    again = scene.changed(key, CHANGES[key]).changed(key, _value(scene, key))
    assert record_of(again) == before


def _value(scene: Scene, key: str) -> object:
    from cagepose.files.changed_scene import _by_index
    from cagepose.files.key_path import parse_key_path, value_at

    data = scene_document(scene, "m")
    return value_at(data, _by_index(scene, data, parse_key_path(key)))


def test_a_change_to_what_there_is_not_is_told() -> None:
    with pytest.raises(SceneError, match=r"loads\[1\].drive.maet: is no body of the cage; did you mean mate"):
        parse_scene(TEXT).changed("loads[1].drive.maet", {"travel": [0.1, 0.0, 0.0]})


def test_numbers_of_bodies_and_drives_may_be_expressions_and_are_set() -> None:
    text = TEXT.replace("units:", "parameters: {way: 20}\nunits:").replace("travel: [-25", "travel: ['=-way - 5'")
    assert record_of(parse_scene(text))["loads"] == record_of(parse_scene(TEXT))["loads"]
    named = (
        text.replace("    mate:", '    "=mate":').replace("of: mate", 'of: "=mate"').replace("mate: {", '"=mate": {')
    )
    named = named.replace("mate/C1", "=mate/C1").replace("  reach", "  # reach").replace("  off", "  # off")
    assert parse_scene(named.replace("adjustable:", "")).loads[1].springs[0].of == "=mate"
    scene = parse_scene(TEXT, set_values=["cage.bodies.mate.pose.position[1]=1", "loads[1].drive.mate.travel[0]=-20"])
    assert scene.cage.bodies[0].pose_cage_body.position_m.tolist() == [0.05, 0.001, 0.0]


TRAVEL, TURN = "{travel: [-25, 0, 0]}", "{turn: {about: [0, 0, 1], through: [50, 0, 0], angle_deg: -12.5}}"
JAW = "jaw:\n      points: {tip: [-30, 0, 0]}"
MATE, GO = "cage.bodies.mate", "loads[1]"
WRONG = [
    # what drives
    (TRAVEL, "[-25, 0, 0]", f"21:13: {GO}.drive.mate: is a list; give travel: [x, y, z], turn: with about:"),
    (TRAVEL, "25", f"{GO}.drive.mate: is 25; give travel: [x, y, z]"),
    (TRAVEL, "{travel: [0, 0, 0]}", f"21:22: {GO}.drive.mate.travel: is all zeros, which points nowhere"),
    (TRAVEL, "{travel: 25}", f"{GO}.drive.mate.travel: is 25; give a list in brackets"),
    (TRAVEL, "{travel: [25, 0]}", f"{GO}.drive.mate.travel: has 2 values; give 3"),
    (TRAVEL, "{travle: [-25, 0, 0]}", f"{GO}.drive.mate.travle: is no known key; did you mean travel?"),
    (TRAVEL, "{about: [0, 0, 1]}", f"{GO}.drive.mate.about: is no known key; it belongs to loads[i].drive.NAME.turn"),
    (TRAVEL, "{}", f"21:13: {GO}.drive.mate: has neither travel nor turn; give one of them, or both"),
    (TRAVEL, "[]", f"{GO}.drive.mate: is empty; give at least one"),
    (TRAVEL, "[{travel: [0, 0, 0]}]", f"21:23: {GO}.drive.mate[0].travel: is all zeros"),
    (
        TRAVEL,
        "{travel: [-25, 0, 0], turn: {about: [0, 0, 1], angle_deg: 3}}",
        f"21:22: {GO}.drive.mate.travel: is aslant to about, and a screw travels along its axis; give a list of two",
    ),
    (f"mate: {TRAVEL}", f"maet: {TRAVEL}", f"21:13: {GO}.drive.maet: is no body of the cage; did you mean mate?"),
    (f"mate: {TRAVEL}", f"block: {TRAVEL}", f"{GO}.drive.block: is no body of the cage; block is a point, a shape"),
    (TURN, "{turn: 30}", "loads[2].drive.mate.turn: is 30; give keys with values"),
    ("angle_deg: -12.5", "angle_deg: 0", "25:77: loads[2].drive.mate.turn.angle_deg: is 0.0; a turn has a finite"),
    (", angle_deg: -12.5", "", "loads[2].drive.mate.turn.angle_deg: is missing; add it, for example angle_deg: 30"),
    ("about: [0, 0, 1], thr", "about: [0, 0, 0], thr", "loads[2].drive.mate.turn.about: is all zeros"),
    ("about: [0, 0, 1], thr", "axis: [0, 0, 1], thr", "turn.axis: is no known key; did you mean about?"),
    # limits
    ("stop_at: {force: 200}", "stop_at: 200", f"23:14: {GO}.stop_at: is 200; write stop_at: {{force: 200}}"),
    ("force: 200", "force: 0", f"{GO}.stop_at.force: is 0; give a number above 0"),
    (
        "force: 200",
        "moment: 200",
        f"23:23: {GO}.stop_at.moment: is a moment, and the drive travels, which takes a force",
    ),
    ("moment: 500", "force: 500", "26:22: loads[2].stop_at.force: is a force, and the drive turns alone"),
    ("{force: 200}", "{}", f"{GO}.stop_at: has neither force nor moment; give one of them"),
    ("{force: 200}", "{force: 1, moment: 2}", f"{GO}.stop_at: has both force and moment; give one of them"),
    ("[0, 0, -9.81]}", "[0, 0, -9.81], stop_at: {force: 3}}", "loads[0].stop_at: stands without a drive"),
    (
        TURN,
        "[{travel: [1, 0, 0]}, {turn: {about: [0, 0, 1], angle_deg: 3}}]",
        "26:14: loads[2].stop_at: is of travels and of turns alone, and newtons are no newton metres",
    ),
    (", mass: 2}", "}", "3:9: object.mass: is missing, and gravity acts beside other loads in loads[1] (go)"),
    # springs
    ("of: mate", "of: mat", f"19:52: {GO}.springs[0].of: is 'mat', no body of the cage; did you mean mate?"),
    ("of: mate", "of: tip", f"{GO}.springs[0].of: is 'tip', no body of the cage; tip is a point, a shape or a hole"),
    ("of: mate", "of: 5", f"{GO}.springs[0].of: is 5; give text"),
    ("of: mate", "body: mate", f"{GO}.springs[0].body: is no known key; did you mean of?"),
    # bodies
    (
        "position: [50, 0, 0]",
        "position: [14, 0, 0]",
        "11:16: cage.bodies.mate.points.mate/C1: starts 6 mm inside",
    ),
    ("points: [[-10, 4, 0], [-10, -4, 0]]", "points: []", f"{MATE}.points: is empty; give at least one"),
    (
        "points: [[-10, 4, 0], [-10, -4, 0]]",
        "points: [-10, 4]",
        f"11:16: {MATE}.points[0]: is -10; put each point",
    ),
    ("[-10, -4, 0]]", "[-10, 4, 0]]", f"11:29: {MATE}.points.mate/C2: lies 0 mm from mate/C1, so they are one point"),
    ("points: {tip", "poinst: {tip", "14:7: cage.bodies.jaw.poinst: is no known key; did you mean points?"),
    (JAW, "jaw: [[-30, 0, 0]]", "cage.bodies.jaw: is a list; give keys with values"),
    (
        "{tip: [",
        "{below: [",
        "14:23: cage.bodies.jaw.points.below: 'below' is already the name of points.below",
    ),
    ("{tip: [", "{mate: [", "14:22: cage.bodies.jaw.points.mate: 'mate' is already the name of bodies.mate; rename"),
    ("in: [block]", "in: [blok]", f"{MATE}.shapes[1].hole.in[0]: is 'blok', no box or shape of this body"),
    ("friction: 0.3", "friction: -1", f"{MATE}.shapes[0].friction: is -1; give a number from 0 upwards"),
    ("friction: 0.3", "frction: 1", f"{MATE}.shapes[0].frction: is no known shape; did you mean friction?"),
    ("radius: 2", "radius: wide", f"{MATE}.shapes[1].hole.radius: is text 'wide'; give a number"),
    ("  bodies:", "  bodys:", "6:3: cage.bodys: is no known key; did you mean bodies?"),
    ("{tip: 0,", "{mate: 0,", "friction.of.mate: is neither in the cage nor in the object"),
    ("bodies.mate.pose.position[1]", "bodies.maet.pose.position[1]", "adjustable.off.key: points to cage.bodies.maet"),
]


ECHOES = ("adjustable.", "friction.of.", "loads[2].drive.mate.turn.about", f"{MATE}.points[1]")
"""What else is told of some of them: of a number that a slider leads to, say."""


@pytest.mark.parametrize(("old", "new", "told"), WRONG, ids=[f"{told.split(';')[0]}" for _, _, told in WRONG])
def test_what_is_wrong_is_told_with_its_place(old: str, new: str, told: str) -> None:
    assert old in TEXT
    with pytest.raises(SceneFileError) as refused:
        parse_scene(TEXT.replace(old, new, 1))
    told_there, *echoes = sorted(str(refused.value).splitlines(), key=lambda line: told not in line)
    assert told in told_there
    assert all(line.split(": ")[1].startswith(ECHOES) for line in echoes), refused.value


def test_a_body_that_starts_inside_the_part_is_told_by_its_shape() -> None:
    text = TEXT.replace("      points: [[-10, 4, 0], [-10, -4, 0]]\n", "").replace(", mate/C1: 0.2", "")
    with pytest.raises(SceneFileError, match=r"9:11: cage.bodies.mate.shapes\[0\]: block starts 1 mm inside object"):
        parse_scene(text.replace("position: [50, 0, 0], euler", "position: [14, 0, 0], euler"))


def test_check_counts_bodies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "dock.yaml").write_text(TEXT)
    assert main(["check", str(tmp_path / "dock.yaml")]) == 0
    assert (
        "4 cage points, 1 cage shape, 1 cage hole, 2 cage bodies, 3 loads (weight, go, turn)" in capsys.readouterr().out
    )


def test_points_beside_bodies_vary_scene_by_scene() -> None:
    """The batch kernel takes all points of a cage, and those of bodies stand elsewhere in the file."""
    text = parse_yaml(TEXT, "dock.yaml").data
    path = ("cage", "points", "below", 2)
    assert not BatchColumns(text, "mm").takes(path)
    assert isinstance(text, dict)
    del text["cage"]["bodies"]
    assert BatchColumns(text, "mm").takes(path)
