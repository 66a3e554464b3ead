"""Hollow roundings of STEP solids, which no shape has, are left out, and by how much that is off is told."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cagepose import Box, Cylinder, Facets, run
from cagepose.exchange.imported import Import, imported
from cagepose.files.step import fillets, reader, step_file
from cagepose.model.shape_moments import shape_moments

pytest.importorskip("OCP")

TOP = 8.0
"""Height of the base of a bracket above the table."""


def block(low: tuple[float, float, float], high: tuple[float, float, float]) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def pin(at: tuple[float, float, float], along: tuple[float, float, float], radius: float, length: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*at), gp_Dir(*along)), radius, length).Shape()


def fused(one: Any, other: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain

    joined = ShapeUpgrade_UnifySameDomain(BRepAlgoAPI_Fuse(one, other).Shape())
    joined.Build()
    return joined.Shape()


def cut(one: Any, *others: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for other in others:
        one = BRepAlgoAPI_Cut(one, other).Shape()
    return one


def rounded(solid: Any, radius: float, is_meant: Callable[[np.ndarray], bool]) -> Any:
    """Round the edges whose middle is meant."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    made, explorer = BRepFilletAPI_MakeFillet(solid), TopExp_Explorer(solid, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        curve = BRepAdaptor_Curve(edge)
        point = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2.0)
        if is_meant(np.array([point.X(), point.Y(), point.Z()]).round(6)):
            made.Add(radius, edge)
        explorer.Next()
    return made.Shape()


@pytest.fixture
def read(tmp_path, monkeypatch) -> Callable[[Any], Import]:
    """Read a part that stands on a table, in this process."""
    monkeypatch.setattr(step_file, "read_step", lambda path, fillets: reader.read_here(str(path), fillets=fillets))

    def found(solid: Any, *, fillets: bool = False) -> Import:
        from OCP.STEPCAFControl import STEPCAFControl_Writer
        from OCP.STEPControl import STEPControl_AsIs
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDataStd import TDataStd_Name

        document, tool = reader.empty_document()
        for name, shape in (("part", solid), ("table", block((-200, -200, -20), (200, 200, 0)))):
            TDataStd_Name.Set_s(tool.AddShape(shape, False), TCollection_ExtendedString(name))
        writer = STEPCAFControl_Writer()
        writer.SetNameMode(True)
        writer.Transfer(document, STEPControl_AsIs)
        writer.Write(str(tmp_path / "both.step"))
        return imported(str(tmp_path / "both.step"), "part", fillets=fillets)

    return found


def bracket() -> Any:
    whole = fused(block((0, 0, 0), (60, 40, TOP)), block((0, 0, 0), (8, 40, 50)))
    return rounded(whole, 5.0, lambda middle: middle[0] == 8.0 and middle[2] == TOP)


def test_a_bracket_with_a_fillet_and_holes_is_its_walls_and_its_holes(read):
    """A rounding of r in a right corner leaves r (sqrt(2) - 1) of it: 2.07 mm of 5."""
    solid = cut(bracket(), pin((40, 20, -1), (0, 0, 1), 4.0, 20.0), pin((-1, 20, 35), (1, 0, 0), 3.0, 20.0))
    scene, notes, *_ = read(solid)
    assert sorted(hole.radius_m for hole in scene.object.holes) == pytest.approx([3e-3, 4e-3])
    assert len(scene.object.parts) == 2
    assert f"up to {5 * (math.sqrt(2) - 1):.2g} mm off; where something rests in one, make it a chamfer" in notes[0]
    assert notes[0].startswith("'part' has 1 hollow rounding, of 5 mm at most: here, sharp corners")
    assert run(scene).verdict == "rests"


def test_fillets_that_meet_and_those_around_a_shaft_are_left_out(read):
    tray = cut(block((-40, -30, 0), (40, 30, 20)), block((-30, -20, 8), (30, 20, 21)))
    tray = rounded(tray, 5.0, lambda middle: abs(middle[0]) == 30.0 and abs(middle[1]) == 20.0)
    tray = rounded(tray, 2.0, lambda middle: middle[2] == TOP)
    scene, notes, *_ = read(tray)
    assert [type(part) for part in scene.object.parts] == [Box] * 5
    assert "'part' has 12 hollow roundings, of 5 mm at most" in notes[0]
    shaft = fused(pin((0, 0, 0), (0, 0, 1), 20.0, 10.0), pin((0, 0, 10), (0, 0, 1), 10.0, 40.0))
    shaft = rounded(shaft, 3.0, lambda middle: middle[2] == 10.0 and abs(middle[0]) == 10.0)
    scene, notes, *_ = read(shaft)
    assert [type(part) for part in scene.object.parts] == [Cylinder] * 2
    assert notes[0].startswith("'part' has 1 hollow rounding, of 3 mm at most")


def test_holes_and_notches_are_no_fillets(read):
    """A hole is round all around, the end of a slot joins walls that do not meet, and a notch has sharp edges."""
    slot = fused(block((-10, -4, -1), (10, 4, 30)), fused(*(pin((x, 0, -1), (0, 0, 1), 4.0, 31.0) for x in (-10, 10))))
    notch = pin((30, -30, 10), (0, 1, 0), 4.0, 60.0)
    solid = cut(block((-30, -20, 0), (30, 20, 10)), slot, notch, pin((-20, -12, -1), (0, 0, 1), 2.0, 20.0))
    scene, notes, *_ = read(solid)
    assert not any("hollow rounding" in note for note in notes)
    assert [part.kind for part in (*scene.object.parts, *scene.object.holes)] == ["facets"]
    assert run(scene).verdict == "rests"


def test_round_edges_are_round(read):
    """Four quarters of a cylinder in the corners of a plate: its volume, less (4 - pi) r^2 of its face, to rounding."""
    plate = rounded(block((-30, -20, 0), (30, 20, 10)), 4.0, lambda middle: middle[2] == 5.0)
    scene, notes, parts, *_ = read(plate)
    (part,) = scene.object.parts
    assert sorted(surface.kind for surface in part.surfaces) == ["cylinder"] * 4 + ["plane"] * 6
    assert shape_moments(part).volume_m3 == pytest.approx(10e-9 * (2400.0 - (4.0 - math.pi) * 16.0), rel=1e-11)
    assert not any("flat" in note for note in notes)
    assert parts[0].off_m < 1e-15


def test_fillets_stay_unless_they_are_to_go(read):
    """A hollow rounding is a part of a bore: a rod of its radius lies in it, one of half of that in the corner."""
    scene, notes, *_ = read(bracket(), fillets=True)
    (part,) = scene.object.parts
    (fillet,) = [surface for surface in part.surfaces if surface.kind == "cylinder"]
    assert fillet.radius_m == pytest.approx(-5e-3, abs=1e-15)
    assert not any("hollow rounding" in note for note in notes)


def test_a_great_rounding_stays(read):
    """A cradle for a roller is no fillet that may be left out."""
    whole = fused(block((0, 0, 0), (60, 40, 8)), block((0, 0, 0), (8, 40, 50)))
    whole = rounded(whole, 30.0, lambda middle: middle[0] == 8.0 and middle[2] == TOP)
    scene, notes, *_ = read(whole)
    (part,) = scene.object.parts
    assert isinstance(part, Facets)
    assert [surface.radius_m for surface in part.surfaces if surface.is_round] == [pytest.approx(-0.03, abs=1e-15)]
    assert not any("hollow rounding" in note for note in notes)


def test_too_many_fillets_stay(read, monkeypatch):
    """Open CASCADE would take minutes, and the file be refused."""
    monkeypatch.setattr(fillets, "MOST_FACES", 0)
    scene, notes, *_ = read(bracket())
    assert isinstance(scene.object.parts[0], Facets)
    assert not any("hollow rounding" in note for note in notes)


def test_a_part_without_fillets_stays_what_it_is(read):
    scene, notes, *_ = read(block((-30, -20, 0), (30, 20, 10)))
    (box,) = scene.object.parts
    assert isinstance(box, Box)
    assert box.pose_body_shape.position_m == pytest.approx((0, 0, 0.005), abs=1e-12)
    assert not any("flat sides" in note for note in notes)


def test_a_hole_across_a_shaft_is_facets_of_the_right_volume(read):
    """Open CASCADE's triangles leave a band of the wall out where they have no corners within it."""
    shaft = cut(pin((0, 0, 0), (0, 0, 1), 2.5, 30.0), pin((-10, 0, 10), (1, 0, 0), 1.264, 20.0))
    scene, *_ = read(shaft)
    (part,) = scene.object.parts
    assert isinstance(part, Facets)
    assert shape_moments(part).volume_m3 == pytest.approx(564.782e-9, rel=1e-6)
