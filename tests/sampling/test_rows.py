"""A row is `cagepose.run` of the scene that it describes, whatever varies and whoever ran it."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from cagepose import Run, SceneFileError, Study, StudyFolderError, StudyResults, run
from cagepose.files.document import run_document
from cagepose.files.scene_edit import setting
from cagepose.files.scene_file import read_scene_text
from cagepose.sampling import runner
from cagepose.sampling.runner import Runner
from our_scenes import SCENES
from our_studies import RAIL, RunStudy, rows_of

NEWTONS = ["object.mass=3", "loads[1].gravity=[0,0,-9.81]", "loads[0].gravity=[0,0,-9.81]"]
ANGLES = {f"cage.pose.euler_zyx_deg[{axis}]": {"uniform": [-0.4, 0.4]} for axis in range(3)}
PUSH = {
    "loads[1].force.direction[1]": {"normal": {"sigma": 0.1}},
    "loads[1].force.at[1]": {"grid": [-20, 0, 20]},
}
BATCHED: dict[str, dict[str, Any]] = {
    "the cage": {**ANGLES, "cage.pose.position[2]": {"uniform": [-0.3, 0.3]}},
    "the start": {
        "object.pose.euler_zyx_deg[1]": {"uniform": [0, 0.4]},
        "object.pose.position[0]": {"uniform": [-2, 2]},
    },
    "all points": {"cage.points.*[2]": {"normal": {"sigma": 0.02, "cut": 3}}, **PUSH},
    "friction": {"friction.coefficient": {"uniform": [-0.05, 0.3]}, "cage.points[0][2]": {"uniform": [-1.2, -0.4]}},
}
BUILT: dict[str, dict[str, Any]] = {
    "a size": {"object.boxes[0].size[2]": {"uniform": [0.9, 2.2]}, **PUSH},
    "gravity": {"loads[0].gravity[1]": {"uniform": [-0.5, 0.5]}, "object.center_of_gravity[0]": {"uniform": [-90, 90]}},
    "an angle of friction": {"friction.angle_deg": {"uniform": [-1, 20]}, **ANGLES},
    "a tolerance": {"tolerances.touch": {"uniform": [1e-12, 1e-9]}, **ANGLES},
}


def compare_with_runs(results: StudyResults, method: str | None = None) -> dict[str, int]:
    """Run each row's scene by itself, as a user would from the row; return how many ended how."""
    found: dict[str, int] = {}
    scene_text = results.study.scene_text
    assert results.table().column_names == list(results.columns.names)
    for row in results.table().to_pylist():
        settings = [setting(one.key, row[one.key]) for one in results.study.varied]
        found[row["verdict"]] = found.get(row["verdict"], 0) + 1
        if row["verdict"] == "refused":
            assert (row["position_x"], row["accepted"]) == (None, False)
            with pytest.raises(SceneFileError) as caught:
                scene_text.scene_file(settings)
            assert all(problem.message in row["error"] for problem in caught.value.problems)
            continue
        scene_file = scene_text.scene_file(settings)
        ended = run(scene_file.scene, method)
        document = run_document(ended, scene_file.length_unit)
        assert (row["verdict"], row["error"]) == (document["verdict"], None)
        assert [row[f"position_{axis}"] for axis in "xyz"] == document["pose"]["position"]
        assert [row[f"{angle}_deg"] for angle in ("yaw", "pitch", "roll")] == document["pose"]["euler_zyx_deg"]
        reached = {phase["name"]: phase["verdict"] for phase in document["phases"]}
        phases = [load.name for load in scene_file.scene.loads]
        assert {name: row[f"verdict_{name}"] for name in phases} == {**dict.fromkeys(phases), **reached}
        touching = {f"touching_{contact['point']}" for contact in document["phases"][-1]["contacts"]}
        assert {name for name, value in row.items() if name.startswith("touching_") and value} == touching
        assert row["accepted"] == (row["verdict"] in ("stable", "rests", "may rest"))
        if results.columns.forces:
            assert {name: row[f"force_{name}"] for name in scene_file.scene.cage.element_names} == forces_of(ended)
    return found


def forces_of(ended: Run) -> dict[str, float | None]:
    """Summed by hand; none are known where none balance the load."""
    names = ended.scene.cage.element_names
    if any(contact.force_normal_n is None for contact in ended.contacts):
        return dict.fromkeys(names)
    of_each = {name: [contact for contact in ended.contacts if contact.point == name] for name in names}
    return {name: float(sum(contact.force_normal_n or 0.0 for contact in found)) for name, found in of_each.items()}


@pytest.mark.parametrize("varied", BATCHED, ids=list(BATCHED))
@pytest.mark.parametrize("method", ["quasistatic", "stepwise"])
def test_a_row_of_the_batch_is_the_run_of_its_scene(
    run_study: RunStudy, scene_with: Callable[..., Path], varied: str, method: str, cases: Callable[[int, int], int]
) -> None:
    scene = scene_with(f"method={method}")
    results = run_study(BATCHED[varied], cases(60, 1_000), scene=scene, method="random", forces=True)
    assert Runner(results.study).is_batch
    found = compare_with_runs(results)
    assert sum(found.values()) == len(results)
    if varied == "friction":
        assert found["refused"] > 5  # negative friction, or a point inside the rail


@pytest.mark.parametrize("varied", BUILT, ids=list(BUILT))
def test_a_row_whose_scene_is_built_is_the_run_of_its_scene(run_study: RunStudy, varied: str) -> None:
    results = run_study(BUILT[varied], 25, forces=True)
    assert not Runner(results.study).is_batch
    compare_with_runs(results)


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_rows_of_every_scene_are_its_runs(run_study: RunStudy, path: Path) -> None:
    data: Any = read_scene_text(path).yaml.data
    vary: dict[str, Any] = {"friction.coefficient": {"uniform": [0, 0.2]}}
    if data["cage"].get("points"):
        vary["cage.points.*[2]"] = {"normal": {"sigma": 0.01}}
    if mass := data["object"].get("mass"):
        vary["object.mass"] = {"uniform": [0.9 * mass, 1.1 * mass]}
    results = run_study(vary, 6, scene=path, forces=True)
    assert Runner(results.study).is_batch == ("object.mass" not in vary)
    compare_with_runs(results)


def test_a_force_in_newtons_varies_in_the_batch(run_study: RunStudy, scene_with: Callable[..., Path]) -> None:
    vary = {"loads[1].force.magnitude": {"uniform": [-1, 60]}, **PUSH}
    results = run_study(vary, 60, scene=scene_with(*NEWTONS, "loads[1].force.magnitude=10"))
    assert Runner(results.study).is_batch
    assert set(compare_with_runs(results)) == {"rests", "refused"}


def test_a_parameter_reaches_the_batch_by_expressions(run_study: RunStudy, scene_with: Callable[..., Path]) -> None:
    scene = scene_with(
        "parameters={play: 1, pitch: 0.1}",
        "cage.points[1][2]==play",
        "cage.points[0][2]==-play**1.1",
        "cage.pose.euler_zyx_deg[1]==pitch",
        "object.pose.euler_zyx_deg[1]==pitch",
    )
    vary = {"parameters.play": {"uniform": [0.4, 1.5]}, "parameters.pitch": {"uniform": [-0.3, 0.3]}}
    results = run_study(vary, 60, scene=scene)
    assert Runner(results.study).is_batch
    assert set(compare_with_runs(results)) >= {"rests", "refused"}


@pytest.mark.parametrize("text", ["min(0.001/a, 5)/100", "min(a**0.5, 0.001)", "(1/a < 1)*0.001", "(1/(1/a) > 9)*a"])
def test_a_row_whose_expression_comes_to_no_number_is_refused(
    run_study: RunStudy, scene_with: Callable[..., Path], text: str
) -> None:
    scene = scene_with("parameters={a: 1}", f"cage.pose.position[0]=={text}")
    vary = {"parameters.a": {"steps": {"first": -1, "last": 1, "count": 5}}}
    results = run_study(vary, scene=scene, method="grid")
    assert Runner(results.study).is_batch
    assert set(compare_with_runs(results)) == {"rests", "refused"}


def test_a_row_that_was_refused_has_no_forces(run_study: RunStudy) -> None:
    rows = run_study(BATCHED["friction"], 20, forces=True).table().to_pylist()
    assert {(row["verdict"] == "refused", row["force_C1"] is None) for row in rows} == {(True, True), (False, False)}


def test_a_watched_point_is_where_the_pose_takes_it(run_study: RunStudy) -> None:
    results = run_study(ANGLES, 20, watch={"tip": {"point": [600, 5, -3]}}, accept="tip.z > 0 and verdict != 'refused'")
    for row in results.table().to_pylist():
        if row["verdict"] != "refused":
            scene = results.study.scene_text.scene_file([setting(key, row[key]) for key in ANGLES]).scene
            tip = run(scene).pose.transform([0.6, 0.005, -0.003]) * 1000.0
            assert [row[f"tip_{axis}"] for axis in "xyz"] == pytest.approx(tip, abs=1e-9)
            assert row["accepted"] == (row["tip_z"] > 0.0)


def test_the_table_is_the_same_for_one_and_two_threads_or_processes(run_study: RunStudy) -> None:
    for kind, runs, vary in (("batch", 2000, ANGLES), ("built", 150, BUILT["a size"])):
        one = run_study(vary, runs, workers=1, folder=f"{kind}-1")
        two = run_study(vary, runs, workers=2, folder=f"{kind}-2")
        assert Runner(one.study).is_batch == (kind == "batch")
        assert rows_of(one) == rows_of(two)


@pytest.mark.parametrize("workers", [1, 2])
def test_progress_is_told_within_a_part_and_never_goes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    monkeypatch.setattr(runner, "ROWS_ONE_BY_ONE", 80)
    told = list[tuple[int, int, bool]]()
    study = Study(RAIL, BUILT["a size"], {"runs": 200, "method": "sobol", "seed": 1})
    study.run(tmp_path / "out", workers=workers, progress=lambda *args: told.append(args))
    done = [n_rows for n_rows, _, _ in told]
    assert done == sorted(set(done))
    assert done[0] <= 16
    assert done[-1] == 200
    assert {args[1:] for args in told} == {(200, True)}


def test_a_study_goes_on_where_parts_are_missing(
    run_study: RunStudy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "ROWS_ONE_BY_ONE", 64)
    vary, runs = BUILT["a size"], 2 * 64 + 10
    whole = run_study(vary, runs, folder="whole", workers=1)
    again = run_study(vary, runs, folder="again", workers=1)
    first, second, _ = again.folder.parts()
    kept = first.stat().st_mtime_ns
    second.unlink()
    (second.parent / f".{second.name}.123.part").write_bytes(b"cut sho")  # what kill -9 leaves
    (tmp_path / "again" / ".study.yaml.123.part").write_bytes(b"sce")
    resumed = run_study(vary, runs, folder="again", resume=True, workers=1)
    assert rows_of(resumed) == rows_of(whole)
    assert first.stat().st_mtime_ns == kept
    assert not list((tmp_path / "again").rglob("*.part"))
    for folder in ("again", "new"):  # all is done, and nothing was begun
        assert rows_of(run_study(vary, runs, folder=folder, resume=True, workers=1)) == rows_of(whole)


KILLED = """
import sys
from cagepose import Study
from cagepose.sampling import runner
runner.ROWS_OF_A_BATCH = 256
print("begun", flush=True)
Study.load(sys.argv[1]).run(sys.argv[2], resume=True, workers=1)
"""


def test_after_kills_at_random_moments_the_table_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cases: Callable[[int, int], int]
) -> None:
    """Real processes and kill -9: each leaves whole parts alone, and what goes on needs no more than --resume."""
    study = tmp_path / "study.yaml"
    study.write_text(
        f"scene: {RAIL}\nvary:\n  cage.pose.euler_zyx_deg[1]: {{uniform: [-0.4, 0.4]}}\n"
        "  friction.coefficient: {uniform: [0, 0.3]}\nsample: {runs: 4000}\n",
        encoding="utf-8",
    )
    rng, n_parts = np.random.default_rng(3), []
    command = [sys.executable, "-c", KILLED, str(study)]
    for _ in range(cases(2, 25)):
        with subprocess.Popen([*command, str(tmp_path / "killed")], stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()
            time.sleep(rng.uniform(0.1, 0.5))
            os.kill(process.pid, signal.SIGKILL)
        parts = list((tmp_path / "killed").glob("parts/*.parquet"))
        assert all(pq.read_table(part).num_rows > 0 for part in parts)
        n_parts.append(len(parts))
    assert n_parts == sorted(n_parts)
    monkeypatch.setattr(runner, "ROWS_OF_A_BATCH", 256)
    killed, whole = (Study.load(study).run(tmp_path / folder, resume=True, workers=1) for folder in ("killed", "whole"))
    assert len(whole) == 4000
    assert rows_of(killed) == rows_of(whole)


def test_a_folder_that_another_process_writes_is_refused_until_that_ends_however_it_ends(tmp_path: Path) -> None:
    """The one waits inside its first part; then it is killed."""
    study = tmp_path / "study.yaml"
    study.write_text(f"scene: {RAIL}\nvary: {{friction.coefficient: {{uniform: [0, 0.3]}}}}\nsample: {{runs: 100}}\n")
    out = tmp_path / "out"
    waits = "runner.Runner.run = lambda *a, **b: (print('inside', flush=True), __import__('time').sleep(600))"
    command = [sys.executable, "-c", f"from cagepose.sampling import runner\n{waits}{KILLED}", str(study), str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert [process.stdout.readline() for _ in range(2)] == ["begun\n", "inside\n"]
            (out / "parts" / ".rows.123.part").write_bytes(b"its own")
            with pytest.raises(StudyFolderError, match="out: is being written by another study that runs now; wait"):
                Study.load(study).run(out, resume=True)
            assert (out / "parts" / ".rows.123.part").exists()
        finally:
            process.kill()
    assert len(Study.load(study).run(out, resume=True)) == 100
    assert not list((out / "parts").glob(".*"))


def test_a_folder_of_something_else_is_refused_and_left_alone(run_study: RunStudy, tmp_path: Path) -> None:
    one = run_study(ANGLES, 10)
    before = rows_of(one)
    with pytest.raises(StudyFolderError, match="holds this study already; add --resume"):
        run_study(ANGLES, 10)
    for resume in (False, True):
        with pytest.raises(StudyFolderError, match=r"holds another study: its study\.yaml differs"):
            run_study(ANGLES, 11, resume=resume)
    assert rows_of(StudyResults(tmp_path / "out")) == before
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear", encoding="utf-8")
    with pytest.raises(StudyFolderError, match="holds something else than a study"):
        run_study(ANGLES, 10, folder="mine")
    with pytest.raises(StudyFolderError, match="is not a folder"):
        run_study(ANGLES, 10, folder="mine/letter.txt")
    with pytest.raises(StudyFolderError, match="holds no study"):
        StudyResults(tmp_path / "mine")


def test_a_scene_that_has_changed_since_is_another_study(run_study: RunStudy, scene_with: Callable[..., Path]) -> None:
    scene = scene_with()
    run_study(ANGLES, 10, scene=scene)
    scene.write_text(scene.read_text(encoding="utf-8").replace("1200, 4, 1]", "1200, 4, 1.1]"), encoding="utf-8")
    with pytest.raises(StudyFolderError, match=r"its scene\.yaml differs"):
        run_study(ANGLES, 10, scene=scene, resume=True)


def test_damaged_parts_and_those_of_another_version_are_named(run_study: RunStudy) -> None:
    (part,) = run_study(ANGLES, 10).folder.parts()
    table = pq.read_table(part)
    pq.write_table(table.replace_schema_metadata({"cagepose": "0.0.1"}), part)
    with pytest.raises(StudyFolderError, match=r"holds rows of cagepose 0\.0\.1, and this is"):
        run_study(ANGLES, 10, resume=True)
    part.write_bytes(b"PAR1 nothing")
    with pytest.raises(StudyFolderError, match=r"cannot be read .*; remove it and add --resume"):
        run_study(ANGLES, 10, resume=True)


def test_a_bit_that_has_changed_on_the_disk_is_no_other_number(run_study: RunStudy) -> None:
    results = run_study(ANGLES, 10)
    (part,) = results.folder.parts()
    content, column = bytearray(part.read_bytes()), pq.read_metadata(part).row_group(0).column(1)
    content[column.data_page_offset + column.total_compressed_size - 1] ^= 1  # of the last number of a varied key
    part.write_bytes(content)
    with pytest.raises(StudyFolderError, match=r"cannot be read .*; remove it and add --resume"):
        results.table()


def test_points_of_a_file_go_with_the_study(run_study: RunStudy, scene_with: Callable[..., Path]) -> None:
    points = read_scene_text(RAIL).scene_file().scene.cage.points_cage * 1000.0
    scene = scene_with("cage.points={file: rollers.csv}")
    text = "\n".join(",".join(map(repr, row)) for row in points.tolist())
    (scene.parent / "rollers.csv").write_text(text, encoding="utf-8")
    results = run_study({"cage.pose.euler_zyx_deg[1]": {"uniform": [0, 0.4]}}, 10, scene=scene)
    (scene.parent / "rollers.csv").unlink()
    compare_with_runs(StudyResults(results.folder.path))
    (scene.parent / "rollers.csv").write_text(text, encoding="utf-8")
    with pytest.raises(SceneFileError, match="is a point of a file; write the points that vary into the scene"):
        run_study({"cage.points[0][1]": {"uniform": [0, 1]}}, 10, scene=scene, folder="other")


def test_a_mesh_goes_with_the_study(run_study: RunStudy, tmp_path: Path) -> None:
    ball = pytest.importorskip("trimesh").creation.icosphere(subdivisions=1, radius=5.0)
    (tmp_path / "ball.stl").write_bytes(ball.export(file_type="stl"))
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        "name: ball\nobject: {shapes: [{mesh: {file: ball.stl}}], pose: {position: [0, 0, 9]}}\n"
        "cage: {points: [[2, 0, 0], [-1, 2, 0], [-1, -2, 0]]}\nloads: [{name: weight, gravity: [0, 0, -1]}]\n",
        encoding="utf-8",
    )
    results = run_study({"cage.points.*[2]": {"normal": {"sigma": 0.05}}}, 10, scene=scene)
    (tmp_path / "ball.stl").unlink()
    assert compare_with_runs(StudyResults(results.folder.path))["rests"] == 10


def test_rows_come_as_a_data_frame(run_study: RunStudy, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ROWS_OF_A_BATCH", 512)
    results = run_study({**ANGLES, "cage.pose.position[2]": {"uniform": [-2, 2]}}, 1100)
    assert len(results.folder.parts()) == 3
    frame = results.to_frame()
    assert frame["run"].tolist() == list(range(1100))
    refused = frame[frame["verdict"] == "refused"]
    assert len(refused) > 100
    assert refused["pitch_deg"].isna().all()
    assert not refused["accepted"].any()
    assert math.isclose(frame["cage.pose.euler_zyx_deg[0]"].mean(), 0.0, abs_tol=5e-3)
