"""Each broken study file gives lines with their place, the key, what was found and what to do; exit code 2."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import Scene, SceneError, SceneFileError, Study, StudyResults
from cagepose.cli.app import main

SCENE = """\
name: sample
parameters: {side: 10, half: "=side/2"}
object:
  boxes:
    - {size: ["=side", "=side", 10], position: [0, 0, 0]}
  pose: {position: [2, 4, 10]}
cage:
  points: [[4, 4, 0], [4, -4, 0], [-4, -4, 0], [-4, 4, 0]]
loads:
  - {name: gravity, gravity: [0, 0, -1]}
"""
STUDY = """\
scene: scene.yaml
vary:
  parameters.side: {uniform: [9, 11]}
  cage.points.*[2]: {normal: {sigma: 0.02, cut: 3}}
  friction.coefficient: {triangular: [0.05, 0.1, 0.2]}
sample: {method: sobol, runs: 100, seed: 1}
watch:
  corner: {point: [5, 5, 5], of: object}
accept: "verdict == 'rests' and abs(pitch_deg) < 0.05 and abs(corner.z) < 20"
"""

SIDE, RUNS, CORNER = "parameters.side: {uniform: [9, 11]}", "runs: 100", "corner: {point: [5, 5, 5], of: object}"
KINDS = "give one of: uniform, normal, triangular, grid, steps"

# What is broken, the text to replace, what to put there, and the line that must come out, or its beginning.
EDITS = [
    ("unknown key", "watch:", "wach:", "7:1: wach: is no known key; did you mean watch? known keys: scene, vary,"
     " watch, ask, compute, accept, sample, forces, sensitivities, map"),
    ("no scene", "scene: scene.yaml\n", "", "1:1: scene: is missing; add it, for example scene: scene.yaml"),
    ("no sample", "sample: {method: sobol, runs: 100, seed: 1}\n", "", "1:1: sample: is missing; add it"),
    ("nothing varies", STUDY[STUDY.index("vary:") : STUDY.index("sample:")], "vary: {}\n",
     "2:7: vary: is empty; give at least one"),
    ("unknown distribution", SIDE, "parameters.side: {gamma: [9, 11]}",
     "3:21: vary.parameters.side.gamma: is no known key"),
    ("two distributions", SIDE, "parameters.side: {uniform: [9, 11], grid: [10]}",
     f"3:20: vary.parameters.side: has both uniform and grid; {KINDS}"),
    ("no distribution", SIDE, "parameters.side: {}", f"3:20: vary.parameters.side: says nothing; {KINDS}"),
    ("a number for a distribution", SIDE, "parameters.side: 10",
     "3:20: vary.parameters.side: is 10; give keys with values"),
    ("limits the wrong way round", SIDE, "parameters.side: {uniform: [11, 9]}",
     "3:30: vary.parameters.side.uniform: is [11.0, 9.0]; give the lower number first"),
    ("limits that are one", SIDE, "parameters.side: {uniform: [9, 9]}",
     "3:30: vary.parameters.side.uniform: is [9.0, 9.0], which does not vary; give two different numbers, or leave"),
    ("steps on the spot", SIDE, "parameters.side: {steps: {first: 9, last: 9, count: 2}}",
     "3:28: vary.parameters.side.steps: run from 9.0 to 9.0; give two different numbers, or leave this key out"),
    ("a key with brackets and no quotes", "vary:\n", "map: {over: [cage.points[0][2], parameters.side]}\nvary:\n",
     "2:25: is not YAML: expected ',' or ']', but got '['; put a key with brackets in quotes where it stands within"),
    ("three limits", SIDE, "parameters.side: {uniform: [9, 10, 11]}",
     "3:30: vary.parameters.side.uniform: has 3 values; give 2"),
    ("negative sigma", "sigma: 0.02", "sigma: -0.02",
     "4:38: vary.cage.points.*[2].normal.sigma: is -0.02; give a number above 0"),
    ("triangle out of order", "[0.05, 0.1, 0.2]", "[0.05, 0.3, 0.2]",
     "5:38: vary.friction.coefficient.triangular: is [0.05, 0.3, 0.2]; give the lower number first"),
    ("grid with one value twice", SIDE, "parameters.side: {grid: [9, 10, 9]}",
     "3:27: vary.parameters.side.grid: holds a number twice; give each once"),
    ("infinite", SIDE, "parameters.side: {uniform: [9, .inf]}",
     "3:34: vary.parameters.side.uniform[1]: is infinite; give a finite number"),
    ("no such parameter", SIDE, "parameters.sode: {normal: {sigma: 1}}",
     "3:3: vary.parameters.sode: is no parameter of the scene; use one of: side, half, or write it into"),
    ("no nominal value", SIDE, "object.mass: {normal: {sigma: 1}}",
     "3:3: vary.object.mass: is not in the scene, so the normal distribution needs its mean; give mean"),
    ("an expression varies", SIDE, "parameters.half: {uniform: [4, 6]}",
     "3:3: vary.parameters.half: holds the expression '=side/2'; vary the parameters that it is made of"),
    ("text varies", SIDE, "name: {uniform: [4, 6]}", "3:3: vary.name: is text 'sample'; vary a number of the scene"),
    ("a list varies", SIDE, "object.pose.position: {uniform: [4, 6]}",
     "3:3: vary.object.pose.position: is a list; vary a number of the scene"),
    ("an index too high", "cage.points.*[2]", "cage.points.*[3]", "4:3: vary.cage.points.*[3]: cage.points[0] holds 3"),
    ("a star where no list is", "cage.points.*[2]", "object.mass.*", "4:3: vary.object.mass.*: has a * at object.mass,"
     " which holds no list; name what varies"),
    ("a number twice", SIDE, "cage.points[1][2]: {uniform: [-1, 1]}",
     "4:3: vary.cage.points.*[2]: stands for cage.points[1][2], which another key varies; keep one of the two"),
    ("no path", SIDE, "parameters..side: {uniform: [4, 6]}",
     "3:3: vary.parameters..side: 'parameters..side' is not a path"),
    ("a key that no scene has", SIDE, "object.weight: {uniform: [4, 6]}",
     "3:3: vary.object.weight: at its nominal value 5.0: is no known key"),
    ("a nominal value that cannot be", SIDE, "object.mass: {uniform: [-4, 2]}",
     "3:3: vary.object.mass: at its nominal value -1.0: is -1; give a number above 0"),
    ("unknown method", "method: sobol", "method: sobel",
     "6:18: sample.method: is text 'sobel'; use one of: sobol, latin hypercube, random, grid"),
    ("a grid beyond all runs", STUDY[STUDY.index("vary:") : STUDY.index("watch:")],
     "vary:\n  cage.points.*[0]: {steps: {first: -9, last: 9, count: 90000}}\nsample: {method: grid}\n",
     "4:9: sample: has 65610000000000000000 combinations; give grids of at most 1073741824 in all"),
    ("a hypercube beyond all memory", "method: sobol, runs: 100,", "method: latin hypercube, runs: 100000000,",
     "6:9: sample: is a Latin hypercube, which is kept as a whole: at most 100000000 numbers; use sobol"),
    ("no runs", "runs: 100, ", "", "6:9: sample: has no runs; add how many, for example runs: 10000"),
    ("zero runs", RUNS, "runs: 0", "6:31: sample.runs: is 0; give a number from 1 upwards"),
    ("half a run", RUNS, "runs: 1.5", "6:31: sample.runs: is 1.5"),
    ("more runs than there are", RUNS, "runs: 2000000000", "6:31: sample.runs: is 2e+09; give a number up to"),
    ("negative seed", "seed: 1", "seed: -1", "6:42: sample.seed: is -1; give a number from 0 upwards"),
    ("a grid of what has none", "method: sobol, runs: 100, ", "method: grid, ",
     "3:3: vary.parameters.side: is uniform, and the sample a grid; give grid or steps, or another sample.method"),
    ("a grid with runs", "method: sobol", "method: grid",
     "6:30: sample.runs: stands beside a grid, which is run as a whole; leave it out"),
    ("a name that is no column", CORNER, "the corner: {point: [5, 5, 5]}",
     "8:15: watch.the corner: is no name of columns"),
    ("a name that is taken", CORNER, "position: {point: [5, 5, 5]}", "8:13: watch.position: is no name of columns"),
    ("a point of something else", "of: object", "of: cage",
     "8:34: watch.corner.of: is text 'cage'; use one of: object"),
    ("a plane point", "[5, 5, 5], of", "[5, 5], of", "8:19: watch.corner.point: has 2 values; give 3"),
    ("an expression that calls", "abs(pitch_deg)", "open('x')", "9:9: accept: calls open, which no expression may"),
    ("an expression that imports", "abs(pitch_deg)", "__import__('os').getpid()",
     "9:9: accept: calls __import__('os').getpid, which no expression may"),
    ("an expression that reads", "abs(pitch_deg)", "verdict.__class__.__mro__",
     "9:9: accept: has the unknown name verdict.__class__.__mro__; known names: parameters.side"),
    ("an unknown column", "abs(corner.z)", "abs(tip.z)", "9:9: accept: has the unknown name tip.z; known names:"),
    ("a formula of what there is not", "watch:", "compute:\n  far: hypot(tip.x, 1)\nwatch:",
     "8:8: compute.far: has the unknown name tip.x; known names: parameters.side"),
    ("a formula that comes to no number", "watch:", "compute:\n  far: pitch_deg > 1\nwatch:",
     "8:8: compute.far: comes to no number; write a formula"),
    ("a formula of another one that follows", "watch:", "compute:\n  far: 2 * near\n  near: pitch_deg\nwatch:",
     "8:8: compute.far: has the unknown name near"),
    ("a function of too few", "watch:", "compute:\n  far: atan2(pitch_deg)\nwatch:",
     "8:8: compute.far: cannot be worked out (atan2 of 1)"),
    ("a function that there is not", "watch:", "compute:\n  far: open('x')\nwatch:",
     "8:8: compute.far: calls open, which no expression may; write numbers, names, + - * / **, comparisons, and, or,"
     " not, abs, min, max, sqrt"),
    ("a root of less than nothing", "watch:", "compute:\n  far: sqrt(-1)\nwatch:",
     "8:8: compute.far: comes to no number (sqrt in sqrt(-1)); change it"),
    ("a column for the second time", "watch:", "compute:\n  yaw_deg: 2 * pitch_deg\nwatch:",
     "8:12: compute.yaw_deg: gives the column yaw_deg a second meaning; rename what is computed"),
    ("no truth", STUDY[STUDY.index("accept:") :], "accept: pitch_deg\n", "9:9: accept: is no comparison"),
    ("no expression", STUDY[STUDY.index("accept:") :], 'accept: "pitch_deg <"\n', "9:9: accept: is no expression"),
    ("text that is compared with numbers", "verdict == 'rests'", "verdict < 3", "9:9: accept: cannot be worked out"),
    ("a map of what does not vary", "watch:", "map: {over: [parameters.side, object.mass]}\nwatch:",
     "7:31: map.over[1]: is 'object.mass', which does not vary; use some of: parameters.side, cage.points[0][2]"),
    ("a map over one", "watch:", "map: {over: [parameters.side, parameters.side]}\nwatch:",
     "7:31: map.over[1]: stands here before; name another"),
    ("a key twice", "watch:", "scene: x.yaml\nwatch:",
     "7:1: scene: stands here for the second time (first in line 1); remove one of the two"),
    ("a tag", "scene: scene", "scene: !!python/object:os.system scene", "1:8: scene: has the tag"),
    ("no YAML", "vary:", "vary: {", "4:3: is not YAML"),
]  # fmt: skip


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    path = tmp_path / "study.yaml"
    path.write_text(STUDY, encoding="utf-8")
    return path


@pytest.mark.parametrize(("old", "new", "line"), [edit[1:] for edit in EDITS], ids=[edit[0] for edit in EDITS])
def test_a_broken_study_is_refused_in_place(
    study: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, line: str
) -> None:
    assert old in STUDY
    study.write_text(STUDY.replace(old, new, 1), encoding="utf-8")
    assert main(["study", "study.yaml", "--out", "out"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert any(found.startswith(f"study.yaml:{line}") for found in lines), lines
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("command", "name", "told"),
    [
        (("study",), "scene", "is a scene, not a study; run it with `cagepose run FILE`, or name it as the scene of"),
        (("study",), "design", "is a design, not a study; run it with `cagepose design FILE`"),
        (("design",), "study", "is a study, not a design; run it with `cagepose study FILE --out FOLDER`"),
        (("run",), "study", "is a study, not a scene; run it with `cagepose study FILE --out FOLDER`"),
        (("check",), "design", "is a design, not a scene; run it with `cagepose design FILE`"),
    ],
)
def test_a_file_of_another_kind_is_told_its_command(
    study: Path, capsys: pytest.CaptureFixture[str], command: tuple[str, ...], name: str, told: str
) -> None:
    Path("design.yaml").write_text(STUDY + "change: {parameters.half: [1, 2]}\n", encoding="utf-8")
    out = ("--out", "out") if command == ("study",) else ()
    assert main([*command, str(study.with_name(f"{name}.yaml")), *out]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{study.with_name(name)}.yaml: {told}")


def test_a_right_study_has_its_runs(study: Path) -> None:
    assert len(Study.load("study.yaml")) == 100
    grid = STUDY.replace(SIDE, "parameters.side: {grid: [9, 10]}").replace(
        "method: sobol, runs: 100, ", "method: grid, "
    )
    grid = grid.replace("{normal: {sigma: 0.02, cut: 3}}", "{steps: {first: -1, last: 1, count: 3}}")
    study.write_text(grid.replace("{triangular: [0.05, 0.1, 0.2]}", "{grid: [0.1]}"), encoding="utf-8")
    assert len(Study.load("study.yaml")) == 2 * 3**4


@pytest.mark.usefixtures("study")
def test_a_scene_that_is_wrong_is_told_in_its_own_place() -> None:
    Path("scene.yaml").write_text(SCENE.replace("[2, 4, 10]", "[2, 4, 3]"), encoding="utf-8")
    with pytest.raises(SceneFileError, match=r"scene\.yaml:8:12: cage\.points\.C1: starts 2 mm inside"):
        Study.load("study.yaml")
    turned = SCENE.replace("[0, 0, -1]}", "[0, 0, -1], moments: [{direction: [0, 0, 1], magnitude: 1}]}")
    Path("scene.yaml").write_text(turned.replace("object:", "method: stepwise\nobject:\n  mass: 1"), encoding="utf-8")
    with pytest.raises(
        SceneFileError, match=r"study\.yaml:1:8: scene: cannot be run: loads\[0\]: 'gravity' has moments"
    ):
        Study.load("study.yaml")
    Path("scene.yaml").unlink()
    with pytest.raises(SceneFileError, match="does not exist; check the name"):
        Study.load("study.yaml")


@pytest.mark.parametrize(
    ("name", "column"),
    [("verdict", "verdict_x"), ("force", "force_x"), ("touching", "touching_x"), ("touching_y", "touching_y_x")],
)
@pytest.mark.usefixtures("study")
def test_a_watched_point_whose_column_is_another_one_is_refused(name: str, column: str) -> None:
    points = "{x: [4, 4, 0], y: [4, -4, 0], y_x: [-4, -4, 0], z: [-4, 4, 0]}"
    text = SCENE.replace(SCENE[SCENE.index("[[4, 4") : SCENE.index("\nloads")], points)
    Path("scene.yaml").write_text(text.replace("name: gravity", "name: x"), encoding="utf-8")
    vary, watch = {"object.mass": {"uniform": [1, 2]}}, {name: {"point": [0, 0, 0]}}
    with pytest.raises(SceneFileError, match=f"watch: gives the column {column} a second meaning; rename the point"):
        Study("scene.yaml", vary, {"runs": 8}, watch=watch, forces=True)


@pytest.mark.usefixtures("study")
def test_a_study_in_python_is_checked_as_its_file_is() -> None:
    with pytest.raises(SceneFileError, match=r"vary\.parameters\.side\.uniform: is .11.0, 9.0.; give the lower"):
        Study("scene.yaml", {"parameters.side": {"uniform": [11, 9]}}, {"runs": 10})
    with pytest.raises(SceneFileError, match="is no plain data"):
        Study("scene.yaml", {"parameters.side": object()}, {"runs": 10})
    assert len(Study("scene.yaml", {"parameters.side": {"uniform": [9, 11]}}, {"runs": 10})) == 10


def test_a_hint_for_scenes_is_none_for_names_in_a_study(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    (tmp_path / "study.yaml").write_text(STUDY.replace(CORNER, "force: [5, 5, 5]"), encoding="utf-8")
    with pytest.raises(SceneFileError, match=r"watch\.force: is a list; give keys with values"):
        Study.load(tmp_path / "study.yaml")


def test_what_stands_in_the_place_of_an_argument_is_refused_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    vary, sample = {"object.mass": {"uniform": [1, 2]}}, {"runs": 8}
    good = {"scene": tmp_path / "scene.yaml", "vary": vary, "sample": sample}
    scene = Study(**good)._file.nominal.scene
    assert isinstance(scene, Scene)
    for name, value, told in (
        ("scene", scene, "scene: is of type Scene; give the name of a scene file: cagepose.save_scene writes one"),
        ("scene", None, "scene: is of type NoneType; give the name of a scene file: cagepose.save_scene writes one"),
        ("vary", [1], "vary: is a list; give keys with values"),
        ("vary", {"object.mass": (1, 2)}, "vary.object.mass: is a list; give keys with values"),
        ("sample", 8, "sample: is 8; give keys with values"),
        ("watch", "corner", "watch: is text 'corner'; give keys with values"),
        ("accept", 5, "accept: is 5; give text"),
        ("accept", object(), "is no plain data (type object); give numbers and text"),
    ):
        with pytest.raises(SceneError) as caught:
            Study(**{**good, name: value})
        assert told in str(caught.value)
    for workers in (0, -1, "2", True, 2.0, 1.5):
        with pytest.raises(SceneError) as caught:
            Study(**good).run(tmp_path / "out", workers=workers)
        assert str(caught.value) == f"workers: is {workers!r}; give a whole number from 1 upwards"
    assert not (tmp_path / "out").exists()


def test_values_may_be_arrays(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    vary = {"object.mass": {"grid": np.linspace(1.0, 2.0, 3)}, "friction.coefficient": {"grid": [np.float32(0.5)]}}
    assert len(Study(tmp_path / "scene.yaml", vary, {"method": "grid", "seed": np.int64(2)})) == 3


def test_a_study_and_what_it_found_are_shown_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    study = Study(
        tmp_path / "scene.yaml", {"parameters.side": {"uniform": [9, 11]}}, {"runs": 8}, accept="pitch_deg < 1"
    )
    assert repr(study) == "<Study of 'sample': 8 runs, parameters.side vary>"
    results = study.run(tmp_path / "out")
    assert repr(results) == f"<StudyResults: 8 runs in {str(tmp_path / 'out')!r}>"
    found = (results.study, results.columns, results.folder, *results.study.varied, results.study.scene_text)
    for thing in (*found, results.study.nominal, results.study.accept):
        text = repr(thing)
        assert text.startswith(("<", "SceneFile("))
        assert len(text) <= 160 + len(str(tmp_path)), text
        assert "\n" not in text
    assert repr(StudyResults(tmp_path / "out")) == repr(results)
