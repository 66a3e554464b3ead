"""Scenes as STEP and STL come back as the scenes that they were; foreign solids are chosen by name."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Capsule,
    Convex,
    Cylinder,
    Hole,
    Load,
    MissingExtraError,
    Object,
    Pose,
    Scene,
    SceneFileError,
    load_scene,
    run,
)
from cagepose.cli.app import main
from cagepose.exchange.export import exported
from cagepose.exchange.imported import imported
from cagepose.exchange.solids_note import file_beside, read_solids_note, solids_note
from cagepose.exchange.step import step_solid
from cagepose.exchange.step_writer import write_here, write_step
from cagepose.files.step import solids as step_solids
from exchange.poses_apart import apart
from our_scenes import SCENES

FILES = {path.stem: path for path in SCENES}


def there_and_back(scene: Scene, name: str, folder: Path):
    for file, content in exported(run(scene), name.rpartition(".")[2], name).files.items():
        (folder / file).write_bytes(content)
    return imported(str(folder / name))


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", ["rollers", "peg-in-hole", "plate-on-pins", "v-groove", "phone-dock"])
def test_step_gives_the_same_final_pose(name, tmp_path):
    """Balls, bars, pins, points, holes through and blind, a part with round edges: to a billionth of the size."""
    pytest.importorskip("OCP")
    scene = load_scene(FILES[name])
    found = there_and_back(scene, "scene.step", tmp_path)
    assert apart(scene, found.scene) < 1e-9
    assert found.notes == ()
    for ours, theirs in ((scene.object, found.scene.object), (scene.cage, found.scene.cage)):
        assert {part.name: part.kind for part in parts(theirs)} == {part.name: part.kind for part in parts(ours)}
        assert len(theirs.holes) == len(ours.holes)


def parts(body: Object | Cage):
    return body.parts if isinstance(body, Object) else body.shapes


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize(("to", "n_notes"), [("step", 0), ("stl", 2)])
def test_a_taper_and_a_chamfer_come_back(to, n_notes, tmp_path):
    """Their numbers; the pin may turn about its axis as it likes, so that its final poses are no measure."""
    pytest.importorskip("OCP")
    scene = load_scene(FILES["tapered-pin"])
    found = there_and_back(scene, f"scene.{to}", tmp_path)
    (hole,), (wanted,) = found.scene.cage.holes, scene.cage.holes
    (pin,), (pin_wanted,) = found.scene.object.shapes, scene.object.shapes
    assert [hole.radius_m, hole.depth_m, hole.chamfer.width_m, hole.chamfer.angle_rad] == pytest.approx(
        [wanted.radius_m, wanted.depth_m, wanted.chamfer.width_m, wanted.chamfer.angle_rad], rel=1e-9
    )
    assert sorted(radius for _, radius in pin.rims) == pytest.approx(sorted(r for _, r in pin_wanted.rims), rel=1e-9)
    assert len(found.notes) == n_notes


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", ["rollers", "rail-pitch", "v-groove", "plate-on-pins", "phone-dock"])
def test_stl_gives_the_same_final_pose_within_its_error(name, tmp_path):
    """Here far within, as all corners of the triangles are on the true surface and have all their digits."""
    scene = load_scene(FILES[name])
    found = there_and_back(scene, "scene.stl", tmp_path)
    assert apart(scene, found.scene) < 1e-9
    assert all("flat sides where it is round" in note for note in found.notes)


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("n_corners", [1, 2, 3, 8])
def test_what_is_round_all_over_is_one_solid_of_step_and_its_core(n_corners, tmp_path):
    pytest.importorskip("OCP")
    corners = np.array([(x, y, z) for x in (-0.02, 0.02) for y in (-0.01, 0.01) for z in (-0.005, 0.005)])[:n_corners]
    write_step([step_solid("part", Convex(corners, 0.003), [], Pose())], tmp_path / "part.step")
    (solid,) = step_solids.read_step(tmp_path / "part.step")["solids"]
    assert solid["radius"] == pytest.approx(3.0)
    assert np.sort(solid["core"], axis=0) == pytest.approx(np.sort(1e3 * corners, axis=0), abs=1e-9)


@pytest.mark.usefixtures("in_this_process")
def test_what_is_round_at_one_end_alone_has_no_core(tmp_path):
    pytest.importorskip("OCP")
    bar, sleeve = step_solid("bullet", Capsule(0.003, 0.02), [], Pose()), Cylinder(0.003, 0.014, Pose((0, 0, 0.01)))
    bar["added"] += step_solid("", sleeve, [], Pose())["added"]
    write_step([bar], tmp_path / "part.step")
    (solid,) = step_solids.read_step(tmp_path / "part.step")["solids"]
    assert "core" not in solid
    assert solid["volume"] == pytest.approx(np.pi * 9 * (17 + 10) + 2 / 3 * np.pi * 27, rel=1e-9)


def with_rough_hole() -> Scene:
    block, bore = (
        Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "block"),
        Hole(0.0051, 0.02, None, ["block"], name="bore"),
    )
    peg = Object(shapes=[Cylinder(0.005, 0.06, name="peg")], pose=Pose((0, 0, 0.025)))
    of = {"bore": 0.7}
    loads = [Load("weight", gravity=(0.1, 0, -9.81))]
    return Scene(peg, Cage(shapes=[block, bore]), loads, friction_coefficient=0.2, friction_of=of)


@pytest.mark.parametrize("to", ["step", "stl"])
def test_a_hole_keeps_its_name_and_its_friction(to, tmp_path):
    pytest.importorskip("OCP")
    found = there_and_back(with_rough_hole(), f"scene.{to}", tmp_path).scene
    assert found.friction_of == {"bore": 0.7}
    (bore,) = found.cage.holes
    assert (bore.name, bore.depth_m) == ("bore", 0.02)


@pytest.mark.usefixtures("in_this_process")
def test_friction_that_comes_back_nowhere_is_told(tmp_path):
    (tmp_path / "scene.stl").write_bytes(exported(run(with_rough_hole()), "stl", "scene.stl").files["scene.stl"])
    note = solids_note(with_rough_hole(), run(with_rough_hole()).pose)
    file_beside(tmp_path / "scene.stl").write_text(note.replace('"holes": {"bore"', '"holes": {"other"'))
    assert "friction of bore is lost, as nothing there has the name" in imported(str(tmp_path / "scene.stl")).notes


def test_models_without_holes_say_that_their_friction_is_not_there():
    for to in ("mjcf", "urdf"):
        notes = exported(run(with_rough_hole()), to, "scene.xml").notes
        assert "bore, a hole with a friction of its own, has that of 'block' here" in notes


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"points": [', '"points": 3, "p": ['),
        ('"friction": {', '"friction": 7, "f": {'),
        ('"friction": {', '"f": {'),
        ("[[", "[[0, "),
        ("{", "[{"),
        ('"holes": {', '"holes": {"x": 3'),
        ("{", 100_000 * "["),
    ],
)
def test_a_note_that_somebody_spoilt_is_said_and_passed_over(old, new, tmp_path):
    """The bodies are read then as those of another program are."""
    path = tmp_path / "scene.stl"
    scene = load_scene(FILES["rail-pitch"])
    text = solids_note(scene, scene.object.pose_world_object)
    file_beside(path).write_text(text)
    notes: list[str] = []
    assert len(read_solids_note(path, notes)["points"]) == 14
    assert notes == []
    file_beside(path).write_text(text.replace(old, new))
    assert read_solids_note(path, notes) == {}
    (told,) = notes
    assert told.startswith("the note of cagepose in scene.stl.json is damaged")


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", ["scene.step", "scene.xml", "scene.urdf"])
def test_a_spoilt_note_within_a_file_is_said(name, tmp_path):
    pytest.importorskip("OCP")
    pytest.importorskip("mujoco")
    to = {"xml": "mjcf"}.get(name.rpartition(".")[2], name.rpartition(".")[2])
    ((_, content),) = exported(run(load_scene(FILES["rollers"])), to, name).files.items()
    told = f"the note of cagepose in {name} is damaged or of another version: here, the bodies alone; export it again"
    (tmp_path / name).write_bytes(content)
    assert told not in imported(str(tmp_path / name)).notes
    for old, new in ((b"version", b"vision"), (b"points", b"pints")):
        assert old in content
        (tmp_path / name).write_bytes(content.replace(old, new, 1))
        assert told in imported(str(tmp_path / name)).notes


@pytest.mark.usefixtures("in_this_process")
def test_solids_that_cannot_be_used_without_their_note_say_that_it_is_damaged(tmp_path):
    """Cage points are balls of nearly no size then."""
    path, scene = tmp_path / "scene.stl", load_scene(FILES["rail-pitch"])
    path.write_bytes(exported(run(scene), "stl", "scene.stl").files["scene.stl"])
    file_beside(path).write_text("{")
    with pytest.raises(SceneFileError) as caught:
        imported(str(path))
    assert "times its size away from the origin" in str(caught.value.problems[0])
    assert "the note of cagepose in scene.stl.json is damaged" in str(caught.value.problems[1])


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("to", ["mjcf", "urdf", "step", "stl"])
def test_what_is_adjustable_is_said_not_to_be_in_a_file(to):
    pytest.importorskip("OCP")
    told = "what is adjustable in the scene is not in the file: radius of the hole, friction"
    assert told in exported(run(load_scene(FILES["peg-in-hole"])), to, f"scene.{to}").notes


def assembly(folder: Path) -> str:
    """Solids of another program: names of its own, no note."""
    block, pin = Box((0.03, 0.03, 0.02), Pose((0, 0, 0.0101))), Cylinder(0.05, 0.01, Pose((0, 0, -0.005)))
    cover = Box((0.01, 0.01, 0.01), Pose((0, 0, 0.2)))
    solids = [step_solid(name, shape, [], Pose()) for name, shape in (("block", block), ("table", pin), ("lid", cover))]
    write_here(solids, str(folder / "parts.step"))
    return str(folder / "parts.step")


@pytest.mark.usefixtures("in_this_process")
def test_foreign_solids_are_chosen_by_name(tmp_path, monkeypatch, capsys):
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    source = assembly(tmp_path)
    assert main(["import", source, "-o", "scene.yaml"]) == 2
    assert "does not say which solid is held; give --object and one of: block, table, lid" in capsys.readouterr().err
    assert main(["import", source, "--object", "block", "--cage", "table", "-o", "scene.yaml"]) == 0
    out = capsys.readouterr().out
    assert "note: solids left out: lid" in out
    assert "note: loads: the weight alone" in out
    found = run(load_scene("scene.yaml"))
    assert found.verdict == "rests"
    assert found.pose.position_m[2] == pytest.approx(-1e-4, abs=1e-10)
    assert main(["import", source, "--object", "black", "-o", "other.yaml"]) == 2
    assert "has no solid 'black'; its solids: block, table, lid" in capsys.readouterr().err


BOMB = b"HEADER;\nENDSEC;\nDATA;\n" + b"#1=ADVANCED_FACE('',(#1),#1,.T.);\n" * 1000
GOOD = b"'block'"
HOSTILE = {
    "truncated": lambda content: content[: len(content) // 3],
    "garbage": lambda content: content[:20] + bytes(range(256)) * 400,
    "empty": lambda content: content[:0],
    "itself": lambda content: content[:14] + BOMB,
    "folder": lambda content: content.replace(GOOD, b"'../../etc/x'"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_step_files_are_clear_errors_and_nothing_is_written(name, tmp_path, monkeypatch, capsys):
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    source = Path(assembly(tmp_path))
    source.write_bytes(HOSTILE[name](source.read_bytes()))
    before = sorted(tmp_path.iterdir())
    began = time.process_time()
    assert main(["import", str(source), "--object", "block", "-o", "scene.yaml"]) == 2
    assert time.process_time() - began < 10.0
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith(str(source))
    assert sorted(tmp_path.iterdir()) == before


def test_a_solid_that_takes_too_long_is_stopped(tmp_path, monkeypatch):
    pytest.importorskip("OCP")
    source = assembly(tmp_path)
    monkeypatch.setattr(step_solids, "WALL_SECONDS", 0.2)
    with pytest.raises(Exception, match=r"takes Open CASCADE more than 0.2 s; simplify it"):
        imported(source, "block")


def test_a_missing_extra_is_named(tmp_path, monkeypatch):
    (tmp_path / "x.step").write_text("ISO-10303-21;")
    monkeypatch.setitem(sys.modules, "OCP", None)
    with pytest.raises(MissingExtraError, match=r"STEP files need Open CASCADE.*pip install 'cagepose\[cad\]'"):
        imported(str(tmp_path / "x.step"))
    scene = Scene(Object([Box((1, 1, 1))]), Cage([(0, 0, -0.5)]), [Load("weight", gravity=(0, 0, -1))])
    with pytest.raises(MissingExtraError, match=r"pip install 'cagepose\[cad\]'"):
        exported(run(scene), "step", "x.step")
