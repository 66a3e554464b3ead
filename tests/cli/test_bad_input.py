"""Each broken scene file gives one line with its place, the key, what was found and what to do; exit code 2."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cagepose import SceneFileError, load_scene
from cagepose.files.read import MAX_FILE_BYTES

SIZE = "size: [10, 10, 10]"
C1 = "    C1: [4, 4, 0]\n"
GRAVITY = "    gravity: [0, 0, -1]\n"
POINTS = """\
  points:
    C1: [4, 4, 0]
    C2: [4, -4, 0]
    C3: [-4, -4, 0]
    C4: [-4, 4, 0]
"""
PUSH = "  - name: push\n    force: {direction: [1, 0, 0], at: [0, 0, 0]}\n"

KEYS = (
    "name, units, parameters, object, cage, loads, friction, method, metric, planar, tolerances, adjustable, left_out"
)

# What is broken, the text to replace, what to put there, and the whole line that must come out.
EDITS = [
    ("unknown key", "name: sample", "nmae: sample\nname: x", "1:1: nmae: is no known key; did you mean name?"
     f" known keys: {KEYS}"),
    ("unknown key in a box", SIZE, SIZE + "\n      colour: red", "5:7: object.boxes[0].colour: is no known key;"
     " remove it; known keys: size, position, euler_zyx_deg, name"),
    ("key in the wrong place", "name: sample", "name: sample\nmass: 2", "2:1: mass: is no known key; it belongs to"
     f" object; known keys: {KEYS}"),
    ("key of several places", "name: sample", "name: sample\nposition: 2", "2:1: position: is no known key; it belongs"
     f" to object.boxes[i] or object.shapes[i] or object.pose or cage.shapes[i] or cage.pose; known keys: {KEYS}"),
    ("missing name", "name: sample\n", "", "1:1: name: is missing; add it, for example name: bracket"),
    ("missing size", SIZE + "\n      ", "",
     "4:7: object.boxes[0].size: is missing; add it, for example size: [10, 20, 30]"),
    ("missing cage points", POINTS, "  pose: {}\n",
     "7:1: cage: has neither points nor shapes; give at least one of them"),
    ("two values for a vector", SIZE, "size: [10, 10]", "4:13: object.boxes[0].size: has 2 values; give 3"),
    ("four values for a vector", "position: [0, 0, 0]", "position: [0, 0, 0, 1]",
     "5:17: object.boxes[0].position: has 4 values; give 3"),
    ("text for a number", SIZE, "size: [10, ten, 10]", "4:18: object.boxes[0].size[1]: is text 'ten'; give a number"),
    ("quoted number", SIZE, 'size: [10, "10", 10]', "4:18: object.boxes[0].size[1]: is text '10'; give a number"),
    ("number with an underscore", SIZE, "size: [10, 1_0, 10]",
     "4:18: object.boxes[0].size[1]: is text '1_0'; give a number"),
    ("true for a number", SIZE, "size: [10, true, 10]", "4:18: object.boxes[0].size[1]: is true; give a number"),
    ("null for a number", SIZE, "size: [10, null, 10]", "4:18: object.boxes[0].size[1]: is empty; give a number"),
    ("number for a list", SIZE, "size: 10",
     "4:13: object.boxes[0].size: is 10; write the three edge lengths: size: [10, 10, 10]"),
    ("number for text", "name: sample", "name: 12",
     "1:7: name: is 12; give text (in quotes if it looks like a number)"),
    ("list for keys", "pose: {position: [2, 4, 10]}", "pose: [2, 4, 10]",
     "6:9: object.pose: is a list; write pose: {position: [2, 4, 10]}"),
    ("not a number", SIZE, "size: [10, .nan, 10]",
     "4:18: object.boxes[0].size[1]: is not a number (.nan); give a finite number"),
    ("infinite", SIZE, "size: [10, -.inf, 10]", "4:18: object.boxes[0].size[1]: is infinite; give a finite number"),
    ("number beyond doubles", SIZE, "size: [10, 1e999, 10]",
     "4:18: object.boxes[0].size[1]: is infinite; give a finite number"),
    ("integer of 5000 digits", SIZE, f"size: [10, {'9' * 5000}, 10]",
     "4:18: object.boxes[0].size[1]: is infinite; give a finite number"),
    ("number too great", SIZE, "size: [10, 1e13, 10]",
     "4:18: object.boxes[0].size[1]: is 1e+13; give a number up to 1e+12"),
    ("number too small", SIZE, "size: [10, 1e-13, 10]",
     "4:18: object.boxes[0].size[1]: is 1e-13; give a number of at least 1e-12, or another unit"),
    ("zero size", SIZE, "size: [10, 0, 10]", "4:18: object.boxes[0].size[1]: is 0; give a number above 0"),
    ("negative size", SIZE, "size: [10, 10, -10]", "4:22: object.boxes[0].size[2]: is -10; give a number above 0"),
    ("negative mass", "  pose: {", "  mass: -1\n  pose: {", "6:9: object.mass: is -1; give a number above 0"),
    ("no boxes", f"\n    - {SIZE}\n      position: [0, 0, 0]", " []",
     "3:10: object.boxes: is empty; give at least one"),
    ("no points", POINTS, "  points: []\n", "8:11: cage.points: is empty; give at least one"),
    ("no named points", POINTS, "  points: {}\n", "8:11: cage.points: is empty; give at least one"),
    ("points as a number", POINTS, "  points: 3\n", "8:11: cage.points: is 3; give a list of [x, y, z],"
     " a NAME: [x, y, z] for each point, or file: points.csv"),
    ("no loads", "\n  - name: gravity\n" + GRAVITY, " []\n", "13:8: loads: is empty; give at least one"),
    ("two boxes of one name", "  pose: {", "    - {name: box1, size: [1, 1, 1], position: [0, 0, 0]}\n  pose: {",
     "6:14: object.boxes[1].name: 'box1' is already the name of boxes[0]; rename one"),
    ("two phases of one name", GRAVITY, GRAVITY + PUSH.replace("push", "gravity"),
     "16:11: loads[1].name: 'gravity' is already the name of loads[0]; rename one"),
    ("key given twice", "name: sample", "name: sample\nname: other",
     "2:1: name: stands here for the second time (first in line 1); remove one of the two"),
    ("point name given twice", C1, C1 + C1,
     "10:5: cage.points.C1: stands here for the second time (first in line 9); remove one of the two"),
    ("tab as indentation", "  boxes:", "\tboxes:", "3:1: has a tab as indentation; use spaces"),
    ("open bracket", "position: [0, 0, 0]", "position: [0, 0, 0", "6:7: is not YAML: expected ',' or ']', but got ':';"
     " correct this line or the one above"),
    ("tag", SIZE, "size: !!python/tuple [10, 10, 10]", "4:13: object.boxes[0].size:"
     " has the tag tag:yaml.org,2002:python/tuple; remove it (scene files have no tags)"),
    ("tag that would run code", "name: sample", "name: !!python/object/apply:os.system [ls]", "1:7: name:"
     " has the tag tag:yaml.org,2002:python/object/apply:os.system; remove it (scene files have no tags)"),
    ("anchor", SIZE, "size: &s [10, 10, 10]",
     "4:13: object.boxes[0].size: has the anchor &s; remove it (scene files have no anchors and aliases)"),
    ("second document", "cage:", "---\ncage:",
     "7:1: starts a second document; keep one scene in a file and remove the line ---"),
    ("point inside the object", C1, "    C1: [2, 4, 9.58]\n", "9:9: cage.points.C1: starts 4.58 mm inside"
     " object.boxes[0] (box1); move the point out or move the object's start pose"),
    ("points on top of each other", "C3: [-4, -4, 0]", "C3: [4, -4, 0]",
     "11:9: cage.points.C3: lies 0 mm from C2, so they are one point; remove or move one"),
    ("gravity without direction", "gravity: [0, 0, -1]", "gravity: [0, 0, 0]",
     "15:14: loads[0].gravity: is all zeros, which points nowhere; give at least one number other than 0"),
    ("force without direction", GRAVITY, GRAVITY + PUSH.replace("[1, 0, 0]", "[0, 0, 0]"),
     "17:24: loads[1].force.direction: is all zeros, which points nowhere; give at least one number other than 0"),
    ("force point missing", GRAVITY, GRAVITY + PUSH.replace(", at: [0, 0, 0]", ""),
     "17:12: loads[1].force: has neither at nor at_world; give one of them: at rides on the object, at_world stays in"
     " the world"),
    ("neither gravity nor force", GRAVITY, "",
     "14:5: loads[0]: has no gravity, force, moment, spring, drive or press; give at least one of them"),
    ("unknown method", "name: sample", "name: sample\nmethod: magic", "2:9: method: is 'magic';"
     " use one of: stepwise, quasistatic"),
    ("unknown unit", "name: sample", "name: sample\nunits: {length: ft}",
     "2:17: units.length: is text 'ft'; multiply the lengths by 12 and use in"),
    ("unknown metric", "name: sample", "name: sample\nmetric: slow",
     "2:9: metric: is text 'slow'; use one of: release, drag"),
    ("two orientations", "pose: {", "pose: {euler_zyx_deg: [0, 0, 0], quat_wxyz: [1, 0, 0, 0], ",
     "6:9: object.pose: has both euler_zyx_deg and quat_wxyz; keep one of them"),
    ("zero quaternion", "pose: {", "pose: {quat_wxyz: [0, 0, 0, 0], ", "6:21: object.pose.quat_wxyz:"
     " is all zeros, which points nowhere; give at least one number other than 0"),
    ("two frictions", "name: sample", "name: sample\nfriction: {coefficient: 0.1, angle_deg: 5}",
     "2:11: friction: has both of coefficient and angle_deg; give one of them"),
    ("no friction in friction", "name: sample", "name: sample\nfriction: {}",
     "2:11: friction: has neither of coefficient and angle_deg; give one of them"),
    ("friction angle of 90 deg", "name: sample", "name: sample\nfriction: {angle_deg: 90}",
     "2:23: friction.angle_deg: is 90; give a number below 90"),
    ("touch tolerance too great", "name: sample", "name: sample\ntolerances: {touch: 0.1}",
     "2:21: tolerances.touch: is 0.1; give a number up to 0.0001"),
    ("adjustable without its number", "name: sample",
     "name: sample\nadjustable: {tilt: {key: cage.pose.tilt, range: [0, 1]}}",
     "2:26: adjustable.tilt.key: points to cage.pose.tilt, where nothing stands; point to a number of this scene,"
     " or write one there"),
    ("adjustable with an empty range", "name: sample",
     "name: sample\nadjustable: {x: {key: 'object.boxes[0].size[0]', range: [9, 9]}}",
     "2:57: adjustable.x.range: runs from 9.0 to 9.0; give the lower number first"),
    ("inertia without mass", "  pose: {", "  inertia: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n  pose: {",
     "6:12: object.inertia: is given without a mass; give object.mass too, or leave the inertia out"),
    ("inertia that no body has", "  pose: {", "  mass: 1\n  inertia: [[1, 0, 0], [0, 1, 0], [0, 0, 3]]\n  pose: {",
     "7:12: object.inertia: has principal moments 1e-06, 1e-06, 3e-06, which no body has:"
     " each must be above zero and at most the sum of the others"),
    ("points file missing", POINTS, "  points: {file: points.csv}\n",
     "8:18: cage.points.file: points.csv does not exist; check the name and the folder"),
    ("points file of a number", POINTS, "  points: {file: 3}\n",
     "8:18: cage.points.file: is 3; give text (in quotes if it looks like a number)"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "line"), [edit[1:] for edit in EDITS], ids=[edit[0] for edit in EDITS])
def test_a_broken_scene_is_refused_in_one_line_with_place_key_and_remedy(
    command: Callable[..., Any], in_folder: Path, sample_text: str, old: str, new: str, line: str
) -> None:
    assert old in sample_text
    (in_folder / "scene.yaml").write_text(sample_text.replace(old, new, 1), encoding="utf-8")
    answer = command("run", "scene.yaml", "--json")
    assert answer == (2, "", f"scene.yaml:{line}\n")


FILES: list[tuple[str, bytes | None, str]] = [
    ("missing file", None, "scene.yaml: does not exist; check the name and the folder"),
    ("empty file", b"", "scene.yaml: is empty; write a scene into it (`cagepose init NAME` makes one to start from)"),
    ("only a comment", b"# nothing\n", "scene.yaml: is empty; write a scene into it"
     " (`cagepose init NAME` makes one to start from)"),
    ("binary file", bytes(range(256)), "scene.yaml: is a binary file; give a text file"),
    ("UTF-16", "name: x".encode("utf-16"), "scene.yaml: is UTF-16 text; save it as UTF-8"),
    ("Latin-1", "name: x\n# für\n".encode("latin-1"),
     "scene.yaml:2:4: holds byte 0xfc, which is not UTF-8; save it as UTF-8"),
    ("control character", b"name: a\x1bb\n", "scene.yaml:1:8: holds the control character U+001B; remove it"),
    ("too large", b"#" * (MAX_FILE_BYTES + 1),
     "scene.yaml: is larger than 4 MiB, the size limit of scene and points files; give fewer points"),
    ("a number", b"3\n", "scene.yaml:1:1: is 3; give keys with values"),
    ("a list", b"- 3\n", "scene.yaml:1:1: is a list; give keys with values"),
    ("prose", b"Here: is: a scene\n",
     "scene.yaml:1:9: is not YAML: a second colon, or a line indented differently from those above; check both"),
    ("nested flow", b"[" * 100_000, "scene.yaml:1:33: nests more than 32 levels deep; flatten it"),
    ("nested block", b"- " * 100_000, "scene.yaml:1:65: nests more than 32 levels deep; flatten it"),
    ("other YAML version", b"%YAML 1.1\n---\nname: x\n",
     "scene.yaml:2:1: asks for another YAML than 1.2; remove the %YAML line"),
    ("key that is a list", b"[a, b]: 3\n", "scene.yaml:1:1: has a key that is not text; write keys as plain words"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "line"), [case[1:] for case in FILES], ids=[case[0] for case in FILES])
def test_a_file_that_holds_no_scene_is_refused_in_one_line(
    command: Callable[..., Any], in_folder: Path, content: bytes | None, line: str
) -> None:
    if content is not None:
        (in_folder / "scene.yaml").write_bytes(content)
    assert command("check", "scene.yaml") == (2, "", line + "\n")


def test_a_directory_is_refused(command: Callable[..., Any], in_folder: Path) -> None:
    (in_folder / "scene.yaml").mkdir()
    assert command("run", "scene.yaml") == (2, "", "scene.yaml: is a directory; name a file in it\n")


def test_a_device_is_refused_before_it_is_read(command: Callable[..., Any]) -> None:
    answer = command("run", "/dev/zero")
    assert answer.code == 2
    assert answer.err == "/dev/zero: is not a regular file; save the text in one and name that\n"


def test_a_file_without_read_permission_is_refused(
    command: Callable[..., Any], sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # tests may run as root, who may read everything
    assert command("run", sample) == (
        2,
        "",
        "scene.yaml: cannot be read (Permission denied); check its name and permissions\n",
    )


def test_an_alias_bomb_is_refused_without_being_expanded(command: Callable[..., Any], in_folder: Path) -> None:
    rows = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    rows += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 30)]
    (in_folder / "scene.yaml").write_text("\n".join(rows), encoding="utf-8")
    answer = command("run", "scene.yaml")
    assert answer.code == 2
    assert "scene.yaml:1:5: a0: has the anchor &a0; remove it (scene files have no anchors and aliases)\n" in answer.err
    assert "scene.yaml:2:10: a1[0]: is the alias *a0; write the value itself" in answer.err


def test_all_problems_come_at_once_in_the_order_of_the_file(
    command: Callable[..., Any], in_folder: Path, sample_text: str
) -> None:
    text = sample_text.replace(SIZE, "size: [10, ten]").replace("gravity: [0, 0, -1]", "gravity: [0, 0, 0]")
    text = text.replace(C1, C1 + C1).replace("name: sample", "nmae: sample").replace("[4, -4, 0]", "!x [4, -4]")
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    answer = command("run", "scene.yaml")
    places = [line.split(": ")[0:2] for line in answer.err.splitlines()]
    assert places == [
        ["scene.yaml:1:1", "name"],
        ["scene.yaml:1:1", "nmae"],
        ["scene.yaml:4:18", "object.boxes[0].size[1]"],
        ["scene.yaml:10:5", "cage.points.C1"],
        ["scene.yaml:11:9", "cage.points.C2"],  # the tag only: what is wrong with the value below it is its echo
        ["scene.yaml:16:14", "loads[0].gravity"],
    ]


def test_problems_of_several_nouns_come_at_once(command: Callable[..., Any], in_folder: Path, sample_text: str) -> None:
    text = sample_text.replace("[4, 4, 0]", "[2, 4, 10]").replace("[-4, 4, 0]", "[-4, -4, 0]")
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    answer = command("run", "scene.yaml")
    assert [line.split(": ")[1] for line in answer.err.splitlines()] == ["cage.points.C1", "cage.points.C4"]


def test_mistakes_of_all_kinds_in_all_sections_come_at_once(command: Callable[..., Any], in_folder: Path) -> None:
    """Of the form, of single parts, and of parts beside each other, with what follows from none of them."""
    text = """\
name: pin
object:
  mass: -1
  shapes:
    - {name: pin, cylinder: {radius: 2.9, lenght: 60}}
    - {name: cap, convex: {vertices: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}}
    - {name: eye, hole: {radius: 1, depth: 5, in: [pin]}}
cage:
  shapes:
    - {name: lower, box: {size: [14, 14]}}
    - {name: upper, box: {size: [14, 14, 20]}, position: [0, 0, 20]}
    - {name: bore, hole: {radius: 3, depth: 20, in: [lower]}, position: [0, 0, 10]}
    - {name: mouth, hole: {radius: 3, depth: 20, in: [uper]}, position: [0, 0, 30]}
loads:
  - {name: weight, gravity: 9.81}
  - name: pull
    forces: [{direction: [0, 0, 1], at_world: [0, 0, 9], magnitude: 2, follows: true}]
    springs: [{at: [0, 0, 0], to: [0, 0, 9], stiffness: 0}]
    moments: [{direction: [0, 0, 0], magnitude: 1}]
friction: 0.2
"""
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    told = [line.split(": ")[1] for line in command("run", "scene.yaml").err.splitlines()]
    assert told == [
        "object.mass",
        "object.shapes[0].cylinder.length",
        "object.shapes[0].cylinder.lenght",
        "object.shapes[1].convex.vertices",
        "cage.shapes[0].box.size",
        "cage.shapes[3].hole.in[0]",
        "loads[0].gravity",
        "loads[1].forces[0].at_world",
        "loads[1].springs[0].stiffness",
        "loads[1].moments[0].direction",
        "friction",
    ]


def test_what_lies_inside_is_told_beside_mistakes_in_loads(
    command: Callable[..., Any], in_folder: Path, sample_text: str
) -> None:
    text = sample_text.replace("[4, 4, 0]", "[4, 4, 12]").replace("gravity: [0, 0, -1]", "gravity: [0, 0, 0]")
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    told = [line.split(": ")[1] for line in command("run", "scene.yaml").err.splitlines()]
    assert told == ["cage.points.C1", "loads[0].gravity"]


def test_points_in_a_list_are_found_by_their_default_names(
    command: Callable[..., Any], in_folder: Path, sample_text: str
) -> None:
    text = sample_text.replace(POINTS, "  points:\n    - [4, 4, 0]\n    - [2, 4, 10]\n")
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    answer = command("run", "scene.yaml")
    assert answer.err.startswith("scene.yaml:10:7: cage.points.C2: starts 5 mm inside object.boxes[0]")


def test_the_api_raises_what_the_command_prints(command: Callable[..., Any], in_folder: Path, sample_text: str) -> None:
    (in_folder / "scene.yaml").write_text(sample_text.replace(SIZE, "size: [10, 10]"), encoding="utf-8")
    with pytest.raises(SceneFileError) as caught:
        load_scene("scene.yaml")
    assert f"{caught.value}\n" == command("run", "scene.yaml").err
    (problem,) = caught.value.problems
    assert problem.path == ("object", "boxes", 0, "size")
    assert (problem.source, problem.line, problem.column) == ("scene.yaml", 4, 13)  # type: ignore[attr-defined]


def test_names_cannot_break_the_one_line_of_a_problem(
    command: Callable[..., Any], in_folder: Path, sample_text: str
) -> None:
    text = sample_text.replace("C1:", '"C\\n1\\e[31m":')
    (in_folder / "scene.yaml").write_text(text, encoding="utf-8")
    answer = command("run", "scene.yaml")
    assert answer.err.count("\n") == 1
    assert "\x1b" not in answer.err
    assert "give a name of visible characters" in answer.err


def test_hundreds_of_points_at_one_place_or_with_a_size_that_is_mistyped_are_told_at_once(
    command: Callable[..., Any], in_folder: Path, sample_text: str
) -> None:
    """Both have been quartic in the number of points: 300 took two minutes."""
    rows = "".join(f"    C{index}: [0, 0, -9]\n" for index in range(5, 505))
    (in_folder / "scene.yaml").write_text(
        sample_text.replace("loads:", rows + "loads:").replace("  C5: [0, 0, -9]", "  C5: [0, 0, -8]"), encoding="utf-8"
    )
    began = time.perf_counter()
    assert command("check", "scene.yaml").err.count("so they are one point") == 498
    assert (
        command("check", "scene.yaml", "--set", "object.boxes[0].size[0]=1e12").err.count("so they are one point")
        == 503
    )
    assert time.perf_counter() - began < 5.0


@pytest.mark.usefixtures("sample")
def test_a_scene_whose_ending_was_left_out_is_found(command):
    for wrong in ("scene", "scenes.yaml", "scene.yml"):
        told = "did you mean scene.yaml? Else check the name and the folder"
        assert command("run", wrong) == (2, "", f"{wrong}: does not exist; {told}\n")
    assert command("run", "entirely-other.yaml").err.endswith("does not exist; check the name and the folder\n")


def test_two_scenes_and_a_scene_without_a_command_are_told_apart_from_changes(command, sample):
    assert "one scene at a time, and other.yaml is left over" in command("check", sample, "other.yaml").err
    assert "each change needs its own --set" in command("run", sample, "object.mass=2").err
    assert command(sample) == (2, "", f"cagepose: {sample} is no command; did you mean: cagepose run {sample}\n")


def test_check_prints_remarks(command, sample):
    out = command("check", sample, "--set", "friction.coefficient=3").out
    assert out.splitlines()[-1].startswith("remark: friction: a coefficient of 3 is more than dry surfaces have")
