"""Solids as a STEP file, made by Open CASCADE in a process of its own: `write_step`. Millimetres throughout."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.files.extra import require
from cagepose.files.own_process import answer, ask
from cagepose.files.step.reader import empty_document
from cagepose.files.step.solids import CPU_SECONDS, WALL_SECONDS

Data = dict[str, Any]


def write_step(solids: list[Data], path: Path) -> None:
    """Write solids: each has a ``name``, and ``added`` and ``removed`` primitives, see `_primitive`.

    Raises
    ------
    SceneError
        Open CASCADE cannot make one, or takes too long.
    MissingExtraError
        Open CASCADE is not installed.
    """
    require("OCP", "STEP files need Open CASCADE", "cad")
    task = json.dumps({"solids": solids, "path": str(path.resolve())})
    ask(__name__, task.encode(), WALL_SECONDS, "Open CASCADE")


def _answer(task: bytes) -> bytes:
    write_here(**json.loads(task))
    return b""


def write_here(solids: list[Data], path: str) -> None:
    """As `write_step`, in this process.

    Raises
    ------
    ValueError
        Open CASCADE cannot make a solid, or not write the file.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    document, tool = empty_document()
    for solid in solids:
        shape, *more = [_primitive(part) for part in solid["added"]]
        for one in more:
            shape = BRepAlgoAPI_Fuse(shape, one).Shape()
        for one in solid["removed"]:
            shape = BRepAlgoAPI_Cut(shape, _primitive(one)).Shape()
        if more:
            joined = ShapeUpgrade_UnifySameDomain(shape)
            joined.Build()
            shape = joined.Shape()
        if not BRepCheck_Analyzer(shape).IsValid():
            raise ValueError(f"{solid['name']!r} cannot be made a solid by Open CASCADE; leave it out")
        label = tool.AddShape(shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(solid["name"], True))
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    if not writer.Transfer(document, STEPControl_AsIs) or writer.Write(path) != IFSelect_RetDone:
        raise ValueError("cannot be written by Open CASCADE")


def _primitive(part: Data) -> Any:
    """Return a shape: ``corners`` and ``loops`` of flat faces, or a ``profile`` of lines and arcs that turn about z,
    (radius, height) each; and ``rotation`` and ``position`` where it stands.
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Trsf

    place = gp_Trsf()
    numbers = np.column_stack([part["rotation"], part["position"]]).ravel().tolist()
    place.SetValues(*numbers)
    shape = _polyhedron(part) if "corners" in part else _turned(part["profile"])
    return BRepBuilderAPI_Transform(shape, place, True).Shape()


def _polyhedron(part: Data) -> Any:
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakePolygon,
        BRepBuilderAPI_MakeSolid,
        BRepBuilderAPI_Sewing,
    )
    from OCP.BRepLib import BRepLib
    from OCP.gp import gp_Pnt
    from OCP.TopoDS import TopoDS

    sewing = BRepBuilderAPI_Sewing(1e-7)
    for loop in part["loops"]:
        outline = BRepBuilderAPI_MakePolygon()
        for corner in loop:
            outline.Add(gp_Pnt(*part["corners"][corner]))
        outline.Close()
        sewing.Add(BRepBuilderAPI_MakeFace(outline.Wire(), True).Face())
    sewing.Perform()
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(sewing.SewedShape())).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def _turned(profile: list[list[float]]) -> Any:
    """Turn lines, or arcs where three points are given, about z; both ends are on the axis."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.GC import GC_MakeArcOfCircle
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    wire = BRepBuilderAPI_MakeWire()
    pieces = [[gp_Pnt(line[k], 0.0, line[k + 1]) for k in range(0, len(line), 2)] for line in profile]
    for points in [*pieces, [pieces[-1][-1], pieces[0][0]]]:
        arc = len(points) == 3
        edge = BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(*points).Value()) if arc else BRepBuilderAPI_MakeEdge(*points)
        wire.Add(edge.Edge())
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire(), True).Face(), axis).Shape()


if __name__ == "__main__":
    answer(_answer, CPU_SECONDS)
