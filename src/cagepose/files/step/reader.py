"""What a STEP file holds, as Open CASCADE tells it in this process: `read_here`. Millimetres throughout."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from cagepose.files.step.fillets import without_fillets
from cagepose.files.step.open_cascade import each, moments_of, xyz
from cagepose.files.step.tolerances import SAME_OF_SIZE
from cagepose.files.step.triangles import off_volume, triangles_of
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex

Data = dict[str, Any]

NO_NAME = re.compile(r"Open CASCADE STEP translator.*|SOLID|COMPOUND|=>\[[\d:]+\]|")
"""What Open CASCADE writes, or says, where there is no name."""
ACROSS = 2.0
"""How far the middles of triangles may be off, in what these may be: others lead across the inside of a round part."""
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


def read_here(path: str, *, fillets: bool = True) -> Data:
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
    most_fillets = 0 if fillets else MOST_FILLETS
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
    measures = {"volume": abs(mass.Mass()), **_measures(solid, mass)}
    core = _rounded(faces, mass)
    if core is not None:
        return {**measures, **core}  # to make triangles of a ball takes 0.3 s
    found = {**measures, **triangles_of(solid)}
    found["off_volume"] = off_volume(found)
    leads_across = found["off_middles"] > ACROSS * found["off"]  # as where holes cross round walls at times
    if found["off_volume"] > 0.0 or leads_across:
        found |= triangles_of(solid, within=True)
        found["off_volume"] = off_volume(found)
    sharp = without_fillets(solid, faces, most_fillets) if most_fillets > 0 else None
    if sharp is not None:
        try:
            without = triangles_of(sharp.solid)
        except ValueError:  # it stays as it is
            return found
        without["volume"] = abs(moments_of(sharp.solid).Mass())
        found |= {"sharp": without, "n_fillets": sharp.n_faces, "radius": sharp.radius}
    return found


def _measures(solid: Any, mass: Any) -> Data:
    """Return the ``center`` of a solid, its ``gyration``, inertia by volume about the center (3, 3), and the ``low``
    and ``high`` corners of the box around it.
    """
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(solid, box, False, False)
    return {
        "center": xyz(mass.CentreOfMass()),
        "gyration": (_inertia(mass) / mass.Mass()).tolist(),
        "low": xyz(box.CornerMin()),
        "high": xyz(box.CornerMax()),
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
            centers.append(xyz(ball.Location()))
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
        and np.abs(found.centroid_m - xyz(mass.CentreOfMass())).max() <= SAME_OF_SIZE * size
        and np.abs(of_core - inertia).max() <= SAME_OF_SIZE * size**2
    )
    return {"core": core.tolist(), "radius": radii[0]} if is_it else None
