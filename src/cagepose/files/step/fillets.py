"""A solid of Open CASCADE without its hollow roundings, which no shape of ours has: `without_fillets`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cagepose.files.step.open_cascade import each, moments_of, xyz
from cagepose.files.step.tolerances import LEAST_TAKEN, TANGENT_RAD

WIDEST = 0.97 * np.pi
"""Angle around a fillet: what is rounder joins walls that do not meet, as the end of a slot does."""


MOST_FACES = 100
"""Faces of one solid: 72 take 0.4 s, 288 take 7 s."""


class Sharp(NamedTuple):
    """A solid whose hollow roundings are left out, how many faces they had, and their greatest radius."""

    solid: Any
    n_faces: int
    radius: float


def without_fillets(solid: Any, faces: list[Any], most: int) -> Sharp | None:
    """Return a solid whose walls go on to where they meet in their hollow corners; None: it has no fillets there, has
    more than ``most`` or `MOST_FACES` faces of them, or Open CASCADE cannot take them away.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Defeaturing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepLib import BRepLib

    BRepLib.EncodeRegularity_s(solid, TANGENT_RAD)
    fillets = [(face, radius) for face in faces if (radius := _hollow_radius(face)) and _joins_smoothly(face)]
    if not 0 < len(fillets) <= min(most, MOST_FACES):
        return None
    work = BRepAlgoAPI_Defeaturing()
    work.SetShape(solid)
    for face, _ in fillets:
        work.AddFaceToRemove(face)
    work.Build()
    if not work.IsDone():
        return None
    found = next(each("Solid", work.Shape()), None)
    if found is None or not BRepCheck_Analyzer(found).IsValid():
        return None
    after, before = (abs(moments_of(one).Mass()) for one in (found, solid))
    if after > (1.0 - LEAST_TAKEN) * before:  # some that meet are left as they are
        return None
    return Sharp(found, len(fillets), max(radius for _, radius in fillets))


def _hollow_radius(face: Any) -> float:
    """Return the radius of a face that is hollow and part of a round; 0: it is another."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cylinder, GeomAbs_Sphere, GeomAbs_Torus
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.TopAbs import TopAbs_REVERSED

    surface = BRepAdaptor_Surface(face)
    u, v = surface.FirstUParameter(), surface.FirstVParameter()
    wide, high = surface.LastUParameter() - u, surface.LastVParameter() - v
    kind = surface.GetType()
    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(u + wide / 2.0, v + high / 2.0, point, along_u, along_v)
    place, out = np.array(xyz(point)), np.cross(xyz(along_u), xyz(along_v))
    out = -out if face.Orientation() == TopAbs_REVERSED else out
    if kind == GeomAbs_Cylinder:
        ball, angle = surface.Cylinder(), wide
        axis, middle, radius = np.array(xyz(ball.Axis().Direction())), np.array(xyz(ball.Location())), ball.Radius()
        middle += ((place - middle) @ axis) * axis
    elif kind == GeomAbs_Sphere:
        ball, angle = surface.Sphere(), min(wide, high)
        middle, radius = np.array(xyz(ball.Location())), ball.Radius()
    elif kind == GeomAbs_Torus:
        ball, angle = surface.Torus(), high
        axis, middle = np.array(xyz(ball.Axis().Direction())), np.array(xyz(ball.Location()))
        arm, radius = place - middle, ball.MinorRadius()
        arm -= (arm @ axis) * axis
        middle += ball.MajorRadius() * arm / np.linalg.norm(arm)
    else:
        return 0.0
    return float(radius) if angle < WIDEST and out @ (place - middle) < 0.0 else 0.0


def _joins_smoothly(face: Any) -> bool:
    """Whether a face goes on without an edge at two of its sides."""
    from OCP.BRep import BRep_Tool
    from OCP.GeomAbs import GeomAbs_C0

    smooth = [
        edge
        for edge in each("Edge", face)
        if not BRep_Tool.Degenerated_s(edge)
        and not BRep_Tool.IsClosed_s(edge, face)
        and BRep_Tool.MaxContinuity_s(edge) != GeomAbs_C0
    ]
    return len(smooth) >= 2
