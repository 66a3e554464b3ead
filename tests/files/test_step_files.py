"""A STEP file in a scene is the shapes that it holds; its shapes are kept, and hostile files do no harm."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from cagepose import Box, Cylinder, Scene, SceneFileError, load_scene, run
from cagepose.cli.app import main
from cagepose.files.step import step_file

pytest.importorskip("OCP")

SCENE = """\
name: on a plate
object:
  shapes: [{{name: part, mesh: {{{mesh}}}}}]
  pose: {{position: [0, 0, 5]}}
cage:
  shapes: [{{name: plate, box: {{size: [100, 100, 10]}}, position: [0, 0, -5]}}]
loads: [{{name: weight, gravity: [0, 0, -1]}}]
"""


def pin(x: float) -> Any:
    """Return a bar of radius 5 and length 20."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, 0, 0), gp_Dir(0, 0, 1)), 5.0, 20.0).Shape()


def block() -> Any:
    """Return a block of 8 x 8 x 30 that stands in x = 30."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(26, -4, 0), gp_Pnt(34, 4, 30)).Shape()


def written(path: Path, solids: Sequence[tuple[str, Any]], unit: str = "MM") -> None:
    """Write solids with names, as Open CASCADE does by itself; lengths are millimetres, and written in a unit."""
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    from cagepose.files.step.reader import empty_document

    document, tool = empty_document()
    for name, shape in solids:
        label = tool.AddShape(shape)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    writer = STEPCAFControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer.SetNameMode(True)
    writer.Transfer(document, STEPControl_AsIs)
    writer.Write(str(path))
    Interface_Static.SetCVal_s("write.step.unit", "MM")


@pytest.fixture
def scene(tmp_path) -> Callable[[str], Scene]:
    def found(mesh: str) -> Scene:
        (tmp_path / "scene.yaml").write_text(SCENE.format(mesh=mesh))
        return load_scene(tmp_path / "scene.yaml")

    return found


@pytest.fixture
def anew() -> Callable[[], None]:
    """Forget what this process read, as another process would not know it."""

    def forget() -> None:
        step_file._shapes.cache_clear()
        step_file._solids.cache_clear()

    return forget


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("unit", ["MM", "INCH", "M"])
def test_a_bar_is_a_cylinder_whatever_the_unit_of_its_file(unit, scene, tmp_path):
    written(tmp_path / "pin.step", [("pin", pin(0.0))], unit)
    found = scene("file: pin.step")
    (bar,) = found.object.shapes
    assert isinstance(bar, Cylinder)
    assert (bar.radius_m, bar.length_m) == pytest.approx((5e-3, 20e-3), rel=1e-12)
    ended = run(found)
    assert ended.verdict == "rests"
    assert ended.pose.position_m[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.usefixtures("in_this_process")
def test_solids_are_one_body_or_one_of_them_is_chosen(scene, tmp_path):
    written(tmp_path / "two.step", [("pin", pin(0.0)), ("block", block())])
    both = scene("file: two.step").object
    assert {part.name: type(part) for part in both.parts} == {"part/pin": Cylinder, "part/block": Box}
    assert both.center_of_gravity_m[0] == pytest.approx(0.03 * 1920 / (1920 + 500 * 3.141592653589793))
    (one,) = scene("file: two.step, solid: block").object.parts
    assert isinstance(one, Box)
    assert one.name == "part"
    assert one.size_m == pytest.approx((8e-3, 8e-3, 30e-3))
    with pytest.raises(SceneFileError, match=r"two\.step has no solid 'black'; its solids: pin, block"):
        scene("file: two.step, solid: black")


@pytest.mark.usefixtures("in_this_process")
def test_what_a_program_writes_where_there_is_no_name_is_none(tmp_path):
    """Open CASCADE calls the one solid of what it cut SOLID, within the part that has the name."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    written(tmp_path / "ring.step", [("ring", BRepAlgoAPI_Cut(block(), pin(34.0)).Shape())])
    written(tmp_path / "none.step", [("Open CASCADE STEP translator 8.0 1", block())])
    names = [list(step_file.named_solids(step_file.read_step(tmp_path / f"{name}.step"))) for name in ("ring", "none")]
    assert names == [["ring"], ["solid 1"]]


@pytest.mark.usefixtures("in_this_process")
def test_a_unit_beside_step_and_a_solid_beside_a_mesh_are_errors(scene, tmp_path):
    written(tmp_path / "pin.step", [("pin", pin(0.0))])
    with pytest.raises(SceneFileError, match=r"pin\.step says its unit itself, as STEP files do; remove the key unit"):
        scene("file: pin.step, unit: mm")
    with pytest.raises(SceneFileError, match=r"pin\.stl has no solids to choose from"):
        scene("file: pin.stl, solid: pin")
    with pytest.raises(SceneFileError, match=r"other\.stp is no file; check the name and the folder"):
        scene("file: other.stp")
    with pytest.raises(SceneFileError, match=r"is not a file name; remove the unprintable character"):
        scene('file: "pin\\0.stp"')


@pytest.mark.usefixtures("in_this_process")
def test_shapes_are_kept_for_as_long_as_the_file_stays_the_same(scene, anew, tmp_path, monkeypatch):
    asked: list[Path] = []
    read = step_file.read_step
    monkeypatch.setattr(step_file, "read_step", lambda path, fillets: asked.append(path) or read(path, fillets=fillets))
    written(tmp_path / "two.step", [("pin", pin(0.0)), ("block", block())])
    first = [scene(f"file: two.step, solid: {solid}").object.parts[0] for solid in ("pin", "block")]
    assert len(asked) == 1  # the file is read once for both
    anew()
    again = [scene(f"file: two.step, solid: {solid}").object.parts[0] for solid in ("pin", "block")]
    assert len(asked) == 1
    assert [part.form for part in again] == [part.form for part in first]
    anew()
    kept = tmp_path / "two.step.shapes.json"
    kept.write_text(kept.read_text().replace('"radius_m": 0.005', '"radius_m": -0.005'))
    assert scene("file: two.step, solid: pin").object.shapes[0].radius_m == pytest.approx(5e-3)
    assert len(asked) == 2
    anew()
    written(tmp_path / "two.step", [("pin", block())])
    assert isinstance(scene("file: two.step, solid: pin").object.parts[0], Box)
    assert len(asked) == 3


def test_a_file_of_somebody_else_stays_where_shapes_would_be_kept(scene, tmp_path):
    written(tmp_path / "pin.step", [("pin", pin(0.0))])
    kept = tmp_path / "pin.step.shapes.json"
    kept.write_text('{"mine": 1}')
    assert isinstance(scene("file: pin.step").object.shapes[0], Cylinder)
    assert kept.read_text() == '{"mine": 1}'


@pytest.mark.parametrize("content", [b"", b"ISO-10303-21;\n" + bytes(range(256)) * 400, b"DATA;#1=ADVANCED_FACE(#1);"])
def test_a_damaged_file_is_one_clear_line_and_nothing_is_kept(content, tmp_path, capsys):
    (tmp_path / "part.step").write_bytes(content)
    (tmp_path / "scene.yaml").write_text(SCENE.format(mesh="file: part.step"))
    before, began = sorted(tmp_path.iterdir()), time.process_time()
    assert main(["run", str(tmp_path / "scene.yaml")]) == 2
    assert time.process_time() - began < 10.0
    (line,) = capsys.readouterr().err.splitlines()
    assert "object.shapes[0].mesh.file: " in line
    assert sorted(tmp_path.iterdir()) == before
