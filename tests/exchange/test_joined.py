"""Files of single parts are joined to a scene, and what became of them is told beside what they were."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Cage, Cylinder, Hole, Load, Object, Pose, Scene, SceneFileError, load_scene, run
from cagepose.cli.app import main
from cagepose.exchange.imported import imported
from cagepose.exchange.joined import PlacedFile, joined
from cagepose.exchange.step import step_solid
from cagepose.exchange.step_writer import write_here
from cagepose.model.boundary.inexact import exact_faces
from exchange import cad_parts
from exchange.poses_apart import apart

pytest.importorskip("OCP")
trimesh = pytest.importorskip("trimesh")

PIN = Cylinder(0.0049, 0.04, Pose((0, 0, 0.02)))
PLATE = Box((0.05, 0.05, 0.01), Pose((0, 0, -0.005)), "plate")
HOLE = Hole(0.005, 0.008, pose_body_shape=Pose((0, 0, 0)), in_=("plate",))


def step(folder: Path, name: str, *solids: tuple[str, object, list[Hole]]) -> str:
    write_here([step_solid(own, shape, holes, Pose()) for own, shape, holes in solids], str(folder / name))
    return str(folder / name)


def pin(folder: Path) -> str:
    return step(folder, "pin.step", ("pin", PIN, []))


def plate(folder: Path) -> str:
    return step(folder, "plate.step", ("plate", PLATE, [HOLE]))


@pytest.mark.usefixtures("in_this_process")
def test_a_pin_over_its_hole_is_the_scene_of_the_primitives(tmp_path):
    """A pin of 9.8 mm that starts 5 mm above a hole of 10 mm, 8 mm deep, a little aslant."""
    start = Pose((0.00003, 0, 0.005), euler_zyx=(0, math.radians(0.1), 0))
    loads = [Load("weight", gravity=(0, 0, -9.81))]
    plain = Scene(Object([], shapes=[PIN], pose=start), Cage([], shapes=[PLATE], holes=[HOLE]), loads)
    found = joined(PlacedFile(pin(tmp_path), start), [PlacedFile(plate(tmp_path))])
    assert [part.off_m for part in found.parts] == [0.0, 0.0]
    assert run(found.scene).verdict == run(plain).verdict == "rests"
    assert apart(plain, found.scene) < 1e-9


@pytest.mark.usefixtures("in_this_process")
def test_step_stl_and_glb_stand_where_their_own_units_say(tmp_path):
    source = pin(tmp_path)
    for name, size in (("wall.stl", (10.0, 60.0, 60.0)), ("floor.glb", (0.1, 0.1, 0.01))):
        trimesh.creation.box(size).export(tmp_path / name)
    walls = [PlacedFile(str(tmp_path / "wall.stl"), Pose((0.03, 0, 0))), PlacedFile(str(tmp_path / "floor.glb"))]
    found = joined(PlacedFile(source, Pose((0, 0, 0.006))), walls)
    assert {part.name: part.size_m.tolist() for part in found.scene.cage.shapes} == {
        "wall": pytest.approx([0.01, 0.06, 0.06]),
        "floor": pytest.approx([0.1, 0.1, 0.01]),
    }
    assert "wall.stl: the file does not say its unit: here, millimetres" in found.notes
    assert not any(note.startswith("floor.glb") for note in found.notes)
    assert run(found.scene).pose.position_m[2] == pytest.approx(0.005, abs=1e-9)


@pytest.mark.usefixtures("in_this_process")
def test_the_command_joins_files_at_places(tmp_path, monkeypatch, capsys):
    """A bar lies on two others that are one file at two places; turned by the command line, it lies along x."""
    monkeypatch.chdir(tmp_path)
    pin(tmp_path)
    command = ["import", "--object", "pin.step@-20,0,30,0,90,0", "-o", "scene.yaml"]
    for x in (-12, 12):
        command += ["--cage", f"pin.step@{x},20,0,0,0,90"]
    assert main([*command, "--report", "page.html"]) == 0
    out = capsys.readouterr().out
    assert "pin 3  cage    1 cylinder" in out
    assert "note: loads: the weight alone" in out
    scene = load_scene("scene.yaml")
    assert [shape.name for shape in scene.cage.shapes] == ["pin 2", "pin 3"]
    ended = run(scene)
    assert ended.verdict in ("rests", "may rest")
    assert ended.pose.position_m[2] == pytest.approx(0.0098, abs=1e-9)
    page = Path("page.html").read_text()
    assert page.count("data:image/png;base64,") == 8
    assert "<td>pin 2</td>" in page
    Path("mine.html").write_text("<p>mine")
    assert main([*command, "--report", "mine.html"]) == 2
    assert "--report mine.html: holds something else" in capsys.readouterr().err
    assert Path("mine.html").read_text() == "<p>mine"


@pytest.mark.usefixtures("in_this_process")
def test_what_became_exact_is_counted_by_faces(tmp_path, monkeypatch, capsys):
    """A plate with two bores, a conical pocket and a groove that is a torus, which divides the top: 8 planes."""
    monkeypatch.chdir(tmp_path)
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    part = cad_parts.box((-20, -20, -10), (20, 20, 0)) - cad_parts.bar((-30, 12, -5), (1, 0, 0), 2, 60)
    part -= cad_parts.bar((0, -15, -12), (0, 0, 1), 2, 14)
    part -= cad_parts.cone((14, -14, 0), (0, 0, -1), 3, 1, 4)
    solid = BRepAlgoAPI_Cut(part.solid, BRepPrimAPI_MakeTorus(5.0, 1.0).Shape()).Shape()
    cad_parts.write_step(replace(part, solid=solid), tmp_path / "part.step")
    pin(tmp_path)
    files = ["--object", "pin.step@0,0,50", "--cage", "part.step"]
    assert main(["import", *files, "-o", "scene.yaml", "--report", "page.html"]) == 0
    out, page = capsys.readouterr().out, Path("page.html").read_text()
    (n_facets,) = re.findall(r"part  +cage  +8 planes, 2 cylinders, 1 cone, ([\d,]+) facets", out)
    assert f"<td>8 planes, 2 cylinders, 1 cone, {n_facets} facets</td>" in page
    assert f"note: 'part' has {n_facets} flat facets where it is no plane, cylinder, cone, ball or outward torus" in out
    assert "mm off; exact: 8 planes, 2 cylinders, 1 cone" in out
    (saved,) = load_scene("scene.yaml").cage.shapes  # whose numbers are not written by the library for YAML
    assert int(n_facets.replace(",", "")) == exact_faces(saved).n_facets


def test_where_a_file_is_placed_is_its_name_and_numbers():
    assert PlacedFile.of("pin.step") == PlacedFile("pin.step")
    assert PlacedFile.of("a@b 2.step").file == "a@b 2.step"
    found = PlacedFile.of("logo@2x.step@1,-2,3e1,90,0,0")
    assert found.file == "logo@2x.step"
    assert found.pose.position_m.tolist() == [0.001, -0.002, 0.03]
    assert found.pose.transform(np.array([[1.0, 0.0, 0.0]]))[0] == pytest.approx([0.001, 0.998, 0.03])
    assert PlacedFile.of("asm#2.step#arm/1#a") == PlacedFile("asm#2.step", solid="arm/1#a")
    assert PlacedFile.of("no.txt#pin").file == "no.txt#pin"
    found = PlacedFile.of("a.STEP#pin@2@0,0,5")
    assert (found.file, found.solid, found.pose.position_m[2]) == ("a.STEP", "pin@2", 0.005)
    for numbers in ("1,2", "1,2,3,4", "1,,3", "1,2,1e999"):
        with pytest.raises(SceneFileError, match=r"pin.step: is placed at .*; give x,y,z in mm, or x,y,z,yaw,pitch"):
            PlacedFile.of(f"pin.step@{numbers}")


@pytest.mark.usefixtures("in_this_process")
def test_solids_of_one_file_are_chosen_by_name_and_placed(tmp_path, monkeypatch, capsys):
    """Of a pin, a plate and a spare in one file the pin comes to rest in the hole of the plate, 8 mm deep."""
    monkeypatch.chdir(tmp_path)
    step(tmp_path, "all.step", ("pin", PIN, []), ("plate", PLATE, [HOLE]), ("spare", Box((0.3, 0.3, 0.3)), []))
    command = ["import", "--object", "all.step#pin@0,0,5", "--cage", "all.step#plate", "-o", "scene.yaml"]
    assert main(command) == 0
    assert "note: all.step: solids left out: spare" in capsys.readouterr().out
    scene = load_scene("scene.yaml")
    assert (scene.name, [part.name for part in scene.cage.shapes]) == ("pin in plate", ["plate"])
    assert run(scene).pose.position_m[2] == pytest.approx(-0.008, abs=1e-9)
    command[2] = "all.step#pen"
    assert main(command) == 2
    assert "all.step: has no solid 'pen'; its solids: pin, plate, spare" in capsys.readouterr().err


@pytest.mark.usefixtures("in_this_process")
def test_a_file_alone_is_told_how_to_be_joined(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pin(tmp_path)
    assert main(["import", "pin.step", "-o", "scene.yaml"]) == 2
    assert "cagepose import --object pin.step --cage FILE -o scene.yaml" in capsys.readouterr().err
    assert main(["import", "pin.step", "--object", "pin.step", "--cage", "plate.step", "-o", "scene.yaml"]) == 2
    assert "no solid 'pin.step'; if that is a file, join both: cagepose import --object FILE" in capsys.readouterr().err
    assert main(["import", "-o", "scene.yaml"]) == 2
    assert "import needs a FILE, or --object FILE and --cage FILE, to join files" in capsys.readouterr().err
    assert main(["import", "--object", "pin.step", "--cage", "robot.xml", "-o", "scene.yaml"]) == 2
    assert "robot.xml: is a robot model, which cannot be joined with files; give it what it" in capsys.readouterr().err
    assert main(["import", "--object", "pin.step", "--cage", "none.stl", "-o", "scene.yaml"]) == 2
    assert "none.stl: is no file; check the name and the folder" in capsys.readouterr().err


@pytest.mark.usefixtures("in_this_process")
def test_files_that_are_in_each_other_say_where_they_reach(tmp_path):
    with pytest.raises(SceneFileError) as caught:
        joined(PlacedFile(pin(tmp_path), Pose((0.02, 0, -0.005))), [PlacedFile(plate(tmp_path))])
    _, held, cage = map(str, caught.value.problems)
    assert "the object, which reaches from (15.1, -4.9, -5) to (24.9, 4.9, 35) mm" in held
    assert "the cage, which reaches from (-25, -25, -10) to (25, 25, 0) mm" in cage
    assert "@x,y,z" in cage


@pytest.mark.usefixtures("in_this_process")
def test_measures_are_beside_those_of_open_cascade(tmp_path):
    """A quarter turned bar: its own closed forms are the truth."""
    source = step(tmp_path, "both.step", ("pin", PIN, []), ("plate", PLATE, [HOLE]))
    found = imported(source, "pin").parts
    bar, body = found
    radius, length = PIN.radius_m, PIN.length_m
    along, across = radius**2 / 2, radius**2 / 4 + length**2 / 12
    for measured in (bar.source, bar.ours):
        assert measured.volume_m3 == pytest.approx(math.pi * radius**2 * length)
        assert measured.center_m == pytest.approx([0, 0, 0.02], abs=1e-9)
        assert measured.size_m == pytest.approx([2 * radius, 2 * radius, length])
        assert measured.gyration_m2 == pytest.approx(np.diag([across, across, along]), abs=1e-12)
    assert (bar.became, body.became) == ("1 cylinder", "1 box, 1 hole")
    assert abs(body.volume_off) < 1e-9
    turned = joined(
        PlacedFile(source, Pose((0, 0, 1))), [PlacedFile(pin(tmp_path), Pose(euler_zyx=(0, math.pi / 2, 0)))]
    ).parts[-1]
    assert turned.source.center_m == pytest.approx([0.02, 0, 0], abs=1e-9)
    assert turned.source.gyration_m2 == pytest.approx(np.diag([along, across, across]), abs=1e-12)
    assert turned.gyration_off < 1e-9


@pytest.mark.usefixtures("in_this_process")
def test_measures_of_a_mesh_are_what_its_chords_are_off(tmp_path):
    """A cylinder of 24 sides: the prism has sin(a) / a of its volume, and its sides are a sagitta within."""
    trimesh.creation.cylinder(5.0, 20.0, sections=24).export(tmp_path / "rod.stl")
    (rod,) = (
        part
        for part in joined(
            PlacedFile(str(tmp_path / "rod.stl")), [PlacedFile(plate(tmp_path), Pose((0, 0, -0.1)))]
        ).parts
        if part.body == "object"
    )
    angle = 2 * math.pi / 24
    assert rod.became == "1 cylinder"
    assert 1.0 / (1.0 + rod.volume_off) == pytest.approx(math.sin(angle) / angle, rel=1e-5)
    assert rod.off_m == pytest.approx(0.005 * (1 - math.cos(angle / 2)), rel=1e-4)
