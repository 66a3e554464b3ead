"""Solids of STEP files, by Open CASCADE in a process of its own. Millimetres throughout."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.files.extra import require
from cagepose.files.own_process import answer, ask
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex

Data = dict[str, Any]

CPU_SECONDS, WALL_SECONDS = 8, 60.0
"""Of the process; the start of Open CASCADE is one second of it."""
AROUND = 64
"""Chords of a full circle at least."""
CHORD_OF_SIZE = 1e-2
"""How far triangles may be from the surface, where that is less than `AROUND` gives."""
SAME = 1e-7
"""Of the size: places and moments that are this near are one."""


def read_step(path: Path) -> Data:
    """Return the ``solids`` of a file, each with ``name``, and ``vertices`` and ``faces`` of its triangles, and
    ``volume``, or the ``core`` of a rounded hull and its ``radius``; and what was left ``out``, in words.

    Raises
    ------
    SceneError
        Open CASCADE cannot read it, or takes too long.
    MissingExtraError
        Open CASCADE is not installed.
    """
    return _ask({"read": str(path.resolve())})


def write_step(solids: list[Data], path: Path) -> None:
    """Write solids: each has a ``name``, and ``added`` and ``removed`` primitives, see `_primitive`.

    Raises
    ------
    SceneError, MissingExtraError
        As `read_step`.
    """
    _ask({"write": str(path.resolve()), "solids": solids})


def _ask(task: Data) -> Data:
    require("OCP", "STEP files need Open CASCADE", "cad")
    found: Data = json.loads(ask(__name__, json.dumps(task).encode(), WALL_SECONDS, "Open CASCADE"))
    return found


def _done(task: Data) -> Data:
    return _read(task["read"]) if "read" in task else _write(task["solids"], task["write"])


def _document() -> tuple[Any, Any]:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("cagepose"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def _read(path: str) -> Data:
    from OCP.collections import Sequence_TDF_Label
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location

    document, tool = _document()
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(path) != IFSelect_RetDone or not reader.Transfer(document):
        raise ValueError("is no STEP file that Open CASCADE can read; export it again")
    roots = Sequence_TDF_Label()
    tool.GetFreeShapes(roots)
    solids: list[Data] = []
    out: list[str] = []
    for index in range(1, roots.Length() + 1):
        for name, shape in _leaves(roots.Value(index), TopLoc_Location(), ""):
            explorer, of_leaf = TopExp_Explorer(shape, TopAbs_SOLID), []
            while explorer.More():
                of_leaf.append(_solid(explorer.Current()))
                explorer.Next()
            if TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID).More() or not of_leaf:
                out.append(f"what is no solid in {name or 'a part without a name'}")
            for number, solid in enumerate(of_leaf):
                part = name or f"solid {len(solids) + 1}"
                solids.append({"name": part if len(of_leaf) == 1 else f"{part}/{number + 1}", **solid})
    return {"solids": solids, "out": out}


def _leaves(label: Any, place: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield the parts of an assembly with their names, where they are."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    found = TDataStd_Name()
    own = found.Get().ToExtString() if label.FindAttribute(TDataStd_Name.GetID_s(), found) else ""
    if XCAFDoc_ShapeTool.IsReference_s(label):
        place = place * XCAFDoc_ShapeTool.GetLocation_s(label)
        original = TDF_Label()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, original)
        yield from _leaves(original, place, own)
    elif XCAFDoc_ShapeTool.IsAssembly_s(label):
        parts = Sequence_TDF_Label()
        XCAFDoc_ShapeTool.GetComponents_s(label, parts)
        for index in range(1, parts.Length() + 1):
            yield from _leaves(parts.Value(index), place, own)
    else:
        yield own or name, XCAFDoc_ShapeTool.GetShape_s(label).Moved(place)


def _solid(solid: Any) -> Data:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    mass = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, mass)
    faces, explorer = [], TopExp_Explorer(solid, TopAbs_FACE)
    while explorer.More():
        faces.append(TopoDS.Face(explorer.Current()))
        explorer.Next()
    return _rounded(faces, mass) or {"volume": abs(mass.Mass()), **_triangles(solid, faces)}


def _rounded(faces: list[Any], mass: Any) -> Data | None:
    """Return the ``core`` of a convex solid all of whose edges are round, such as a ball or a bar with round ends, and
    the ``radius`` that it is blown up by; None: it is another.

    The corners of the core are the middles of the spheres. That their hull is the solid is seen by the volume, its
    middle and its second moments.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cylinder, GeomAbs_Plane, GeomAbs_Sphere

    radii, centers = [], []
    for face in faces:
        surface = BRepAdaptor_Surface(face)
        if surface.GetType() == GeomAbs_Sphere:
            ball = surface.Sphere()
            radii.append(ball.Radius())
            centers.append(_xyz(ball.Location()))
        elif surface.GetType() == GeomAbs_Cylinder:
            radii.append(surface.Cylinder().Radius())
        elif surface.GetType() != GeomAbs_Plane:
            return None
    if len(centers) == len(faces) == 1:  # as of points far away, whose moments are but rounding
        return {"core": centers, "radius": radii[0]}
    if not centers or np.ptp(radii) > SAME * radii[0]:
        return None
    size = float(np.ptp(centers, axis=0).max()) + radii[0]
    _, corners = np.unique(np.round(np.array(centers) / (SAME * size)), axis=0, return_index=True)
    core = np.array(centers)[corners]
    found = shape_moments(Convex(core, radii[0]))
    second = mass.MatrixOfInertia()
    inertia = np.array([[second.Value(row, column) for column in (1, 2, 3)] for row in (1, 2, 3)]) / mass.Mass()
    of_core = np.trace(found.second_moment_m2) * np.eye(3) - found.second_moment_m2
    is_it = (
        abs(found.volume_m3 - mass.Mass()) <= SAME * found.volume_m3
        and np.abs(found.centroid_m - _xyz(mass.CentreOfMass())).max() <= SAME * size
        and np.abs(of_core - inertia).max() <= SAME * size**2
    )
    return {"core": core.tolist(), "radius": radii[0]} if is_it else None


def _xyz(point: Any) -> list[float]:
    return [point.X(), point.Y(), point.Z()]


def _is_ball(face: Any) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane

    return BRepAdaptor_Surface(face).GetType() not in (GeomAbs_Plane, GeomAbs_Cylinder, GeomAbs_Cone)


def _triangles(solid: Any, faces: list[Any]) -> Data:
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.IMeshTools import IMeshTools_Parameters
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box)
    size = float(np.sqrt(box.SquareExtent()))
    wanted = IMeshTools_Parameters()
    wanted.Deflection, wanted.Angle = CHORD_OF_SIZE * size, 0.999 * 2.0 * np.pi / AROUND
    wanted.InternalVerticesMode = any(_is_ball(face) for face in faces)  # a cylinder needs none between its ends
    wanted.ControlSurfaceDeflection = wanted.InternalVerticesMode
    BRepMesh_IncrementalMesh(solid, wanted)
    points: list[list[float]] = []
    triangles: list[list[int]] = []
    for face in faces:
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        if mesh is None:
            raise ValueError("has a face that Open CASCADE cannot make triangles of; repair it, or export it again")
        turn, first = place.Transformation(), len(points) - 1
        nodes = [mesh.Node(index).Transformed(turn) for index in range(1, mesh.NbNodes() + 1)]
        points += [_xyz(node) for node in nodes]
        order = (1, 3, 2) if face.Orientation() == TopAbs_REVERSED else (1, 2, 3)
        for index in range(1, mesh.NbTriangles() + 1):
            triangle = mesh.Triangle(index)
            triangles.append([first + triangle.Value(corner) for corner in order])
    _, kept, same = np.unique(
        np.round(np.array(points) / (1e-8 * size)), axis=0, return_index=True, return_inverse=True
    )
    corners = same.ravel()[np.array(triangles)]
    distinct = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    return {"vertices": np.array(points)[kept].tolist(), "faces": corners[distinct].tolist()}


def _write(solids: list[Data], path: str) -> Data:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.STEPControl import STEPControl_AsIs
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    document, tool = _document()
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
    return {}


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
    answer(lambda task: json.dumps(_done(json.loads(task))).encode(), CPU_SECONDS)
