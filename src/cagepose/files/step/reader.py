"""What a STEP file holds, as Open CASCADE tells it in this process: `read_here`. Millimetres throughout."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from cagepose.files.step.fillets import each, moments_of, without_fillets
from cagepose.files.step.tolerances import SAME_OF_SIZE
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex

Data = dict[str, Any]

CHORDS_OF_CIRCLE = 64
"""Chords of a full circle at least."""
CHORD_OF_SIZE = 1e-2
"""How far triangles may be from the surface, where that is less than `CHORDS_OF_CIRCLE` gives."""
NO_NAME = re.compile(r"Open CASCADE STEP translator.*|SOLID|COMPOUND|=>\[[\d:]+\]|")
"""What Open CASCADE writes, or says, where there is no name."""
UNNAMED = "solid"
"""What a solid without a name is called, and its number."""
MOST_FILLETS = 300
"""Faces of them in one file that are left out, which takes seconds."""


def empty_document() -> tuple[Any, Any]:
    """Return a document of Open CASCADE, and its tool for shapes."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("cagepose"))
    return document, XCAFDoc_DocumentTool.ShapeTool_s(document.Main())


def read_here(path: str) -> Data:
    """As `cagepose.files.step.solids.read_step`, in this process.

    Raises
    ------
    ValueError
        Open CASCADE cannot read it.
    """
    from OCP.collections import Sequence_TDF_Label
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location

    document, tool = empty_document()
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(path) != IFSelect_RetDone or not reader.Transfer(document):
        raise ValueError("is no STEP file that Open CASCADE can read; export it again")
    roots = Sequence_TDF_Label()
    tool.GetFreeShapes(roots)
    solids: list[Data] = []
    out: list[str] = []
    most_fillets = MOST_FILLETS
    for index in range(1, roots.Length() + 1):
        for name, shape in _leaves(roots.Value(index), TopLoc_Location(), ""):
            of_leaf = []
            for solid in each("Solid", shape):
                of_leaf.append(_solid(solid, most_fillets))
                most_fillets -= of_leaf[-1].get("n_fillets", 0)
            if TopExp_Explorer(shape, TopAbs_FACE, TopAbs_SOLID).More() or not of_leaf:
                out.append(f"what is no solid in {name or 'a part without a name'}")
            for number, solid in enumerate(of_leaf):
                part = name or f"{UNNAMED} {len(solids) + 1}"
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
    own = name if NO_NAME.fullmatch(own) else own
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
        yield own, XCAFDoc_ShapeTool.GetShape_s(label).Moved(place)


def _solid(solid: Any, most_fillets: int) -> Data:
    faces, mass = [*each("Face", solid)], moments_of(solid)
    measures = {"volume": abs(mass.Mass()), **_measures(solid, faces, mass)}
    core = _rounded(faces, mass)
    if core is not None:
        return {**measures, **core}  # to make triangles of a ball takes 0.3 s
    found = {**measures, **_triangles(solid, faces)}
    if off_volume(found) > 0.0:  # holes across round walls come out so at times
        found |= _triangles(solid, faces, within=True)
    sharp = without_fillets(solid, faces, most_fillets)
    if sharp is not None:
        try:
            without = _triangles(sharp.solid, [*each("Face", sharp.solid)])
        except ValueError:  # it stays as it is
            return found
        without["volume"] = abs(moments_of(sharp.solid).Mass())
        found |= {"sharp": without, "n_fillets": sharp.n_faces, "radius": sharp.radius}
    return found


def _measures(solid: Any, faces: list[Any], mass: Any) -> Data:
    """Return the ``center`` of a solid, its ``gyration``, inertia by volume about the center (3, 3), the ``low`` and
    ``high`` corners of the box around it, and how many faces it has of each kind (``surfaces``).
    """
    from OCP.Bnd import Bnd_Box
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(solid, box, False, False)
    kinds = Counter(BRepAdaptor_Surface(face).GetType().name.removeprefix("GeomAbs_") for face in faces)
    return {
        "center": _xyz(mass.CentreOfMass()),
        "gyration": (_inertia(mass) / mass.Mass()).tolist(),
        "low": _xyz(box.CornerMin()),
        "high": _xyz(box.CornerMax()),
        "surfaces": dict(kinds),
    }


def _inertia(mass: Any) -> Any:
    found = mass.MatrixOfInertia()
    return np.array([[found.Value(row, column) for column in (1, 2, 3)] for row in (1, 2, 3)])


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
    if not centers or np.ptp(radii) > SAME_OF_SIZE * radii[0]:
        return None
    size = float(np.ptp(centers, axis=0).max()) + radii[0]
    _, corners = np.unique(np.round(np.array(centers) / (SAME_OF_SIZE * size)), axis=0, return_index=True)
    core = np.array(centers)[corners]
    found = shape_moments(Convex(core, radii[0]))
    inertia = _inertia(mass) / mass.Mass()
    of_core = np.trace(found.second_moment_m2) * np.eye(3) - found.second_moment_m2
    is_it = (
        abs(found.volume_m3 - mass.Mass()) <= SAME_OF_SIZE * found.volume_m3
        and np.abs(found.centroid_m - _xyz(mass.CentreOfMass())).max() <= SAME_OF_SIZE * size
        and np.abs(of_core - inertia).max() <= SAME_OF_SIZE * size**2
    )
    return {"core": core.tolist(), "radius": radii[0]} if is_it else None


def _off(face: Any) -> float:
    """Return how far the triangles of a face are off at most: the sagitta of their chords, along and across."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane, GeomAbs_Sphere, GeomAbs_Torus
    from OCP.TopLoc import TopLoc_Location

    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind == GeomAbs_Plane:
        return 0.0
    if kind == GeomAbs_Cylinder:
        radii = surface.Cylinder().Radius()
    elif kind == GeomAbs_Cone:
        ends, cone = (surface.FirstVParameter(), surface.LastVParameter()), surface.Cone()
        radii = max(abs(cone.RefRadius() + end * np.sin(cone.SemiAngle())) for end in ends)
    elif kind == GeomAbs_Sphere:
        radii = 2.0 * surface.Sphere().Radius()
    elif kind == GeomAbs_Torus:
        radii = surface.Torus().MajorRadius() + 2.0 * surface.Torus().MinorRadius()
    else:
        return float(BRep_Tool.Triangulation_s(face, TopLoc_Location()).Deflection())
    return float(radii * (1.0 - np.cos(np.pi / CHORDS_OF_CIRCLE)))


def _xyz(point: Any) -> list[float]:
    return [point.X(), point.Y(), point.Z()]


def _is_ball(face: Any) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane

    return BRepAdaptor_Surface(face).GetType() not in (GeomAbs_Plane, GeomAbs_Cylinder, GeomAbs_Cone)


def off_volume(solid: Data) -> float:
    """Return by how much more than by their chords triangles enclose another volume than the solid, in its parts."""
    corners = np.array(solid["vertices"])[np.array(solid["faces"])]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    volume = float(np.einsum("ij,ij->", corners[:, 0] - corners[0, 0], across)) / 6.0
    allowed = solid["off"] * float(np.linalg.norm(across, axis=1).sum()) + SAME_OF_SIZE * solid["volume"]
    off = abs(volume - solid["volume"])
    return off / float(solid["volume"]) if off > allowed else 0.0


def _triangles(solid: Any, faces: list[Any], *, within: bool = False) -> Data:
    """Return triangles; ``within``: those that there are are made anew, with corners within faces."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.IMeshTools import IMeshTools_Parameters
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    # triangles as near to the surface as its size asks for
    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box)
    size = float(np.sqrt(box.SquareExtent()))
    wanted = IMeshTools_Parameters()
    wanted.Deflection, wanted.Angle = CHORD_OF_SIZE * size, 0.999 * 2.0 * np.pi / CHORDS_OF_CIRCLE
    wanted.InternalVerticesMode = within or any(_is_ball(face) for face in faces)  # a cylinder needs none
    wanted.ControlSurfaceDeflection = wanted.InternalVerticesMode
    if within:
        BRepTools.Clean_s(solid)
    BRepMesh_IncrementalMesh(solid, wanted)
    # the corners of each face by themselves
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
    # corners that faces share are one
    _, kept, same = np.unique(
        np.round(np.array(points) / (1e-8 * size)), axis=0, return_index=True, return_inverse=True
    )
    corners = same.ravel()[np.array(triangles)]
    distinct = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    return {
        "vertices": np.array(points)[kept].tolist(),
        "faces": corners[distinct].tolist(),
        "off": max(_off(face) for face in faces),
    }
