"""Triangles of a solid of Open CASCADE, and the surfaces that they stand for: `triangles_of`. All in millimetres."""

from __future__ import annotations

from dataclasses import astuple
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.files.step.open_cascade import each, moments_of, xyz
from cagepose.files.step.surfaces import farthest_off, one_of_each, surface_of_face
from cagepose.files.step.tolerances import SAME_OF_SIZE, SAME_PLACE
from cagepose.model.checks import FloatArray
from cagepose.model.sides import open_sides
from cagepose.model.surfaces import Surface

Data = dict[str, Any]

CHORDS_OF_CIRCLE = 64
"""Chords of a full circle at least."""
FARTHEST_APART = 1e-3
"""Fraction of the size. Corners along one edge of two faces are one if they are no farther apart."""
FARTHEST_OFF = 1e-4
"""Fraction of the size. A face whose corners are farther off its surface is flat facets: edges that a program wrote as
splines, such as helices, may be that far off."""
NEAR_ENOUGH = 1e-6
"""Millimetres: how near the foot of a place on a surface is found."""
CHORD_OF_SIZE = 1e-2
"""How far triangles may be from the surface, where that is less than `CHORDS_OF_CIRCLE` gives."""


def triangles_of(solid: Any, *, within: bool = False) -> Data:
    """Return the triangles of a solid, and what they stand for, see `cagepose.files.step.solids.read_step`; and how far
    they are ``off`` at most, and their middles ``off_middles``. ``within``: those that there are are made anew, with
    corners within faces.

    Raises
    ------
    ValueError
        There are none of one of its faces.
    """
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box)
    size = float(np.sqrt(box.SquareExtent()))
    faces = _meshed(solid, size, within=within)
    # the corners of each face by themselves
    points, triangles = list[FloatArray](), list[NDArray[np.int64]]()
    surfaces, n_points = list[Surface | None](), [0]
    for face in faces:
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        turn, order = place.Transformation(), (1, 3, 2) if face.Orientation() == TopAbs_REVERSED else (1, 2, 3)
        nodes = (mesh.Node(index).Transformed(turn) for index in range(1, mesh.NbNodes() + 1))
        own = np.array([(node.X(), node.Y(), node.Z()) for node in nodes])
        listed = (mesh.Triangle(index) for index in range(1, mesh.NbTriangles() + 1))
        corners = np.array([[triangle.Value(corner) - 1 for corner in order] for triangle in listed])
        its = surface_of_face(face, own[corners])
        is_near = its is not None and np.abs(its.heights(own[corners])).max() <= FARTHEST_OFF * size
        surfaces.append(its if is_near else None)
        points.append(own)
        triangles.append(n_points[-1] + corners)
        n_points.append(n_points[-1] + len(own))
    # those that faces share are one
    places = np.concatenate(points)
    same = _at_one_place(places, _shared(faces, n_points, places), SAME_PLACE * size)
    kept, number = np.unique(same, return_inverse=True)
    joined = number.ravel()[np.concatenate(triangles)]
    distinct = (joined != np.roll(joined, 1, axis=1)).all(axis=1)
    known, which = one_of_each(surfaces, size)
    on, vertices, corners = np.repeat(which, [len(one) for one in triangles])[distinct], places[kept], joined[distinct]
    return {
        "vertices": vertices.tolist(),
        "faces": corners.tolist(),
        "is_closed": len(open_sides(corners)) == 0,
        "off": max(_off(face) for face in faces),
        "known": [astuple(surface) for surface in known],
        "on": on.tolist(),
        "off_middles": farthest_off(known, on, vertices[corners].mean(axis=1)),
        "off_surfaces": farthest_off(known, on, vertices[corners]),
        "off_others": max((_off(face) for face, found in zip(faces, which, strict=True) if found < 0), default=0.0),
    }


def _shared(faces: list[Any], n_points: list[int], places: FloatArray) -> list[tuple[int, int]]:
    """Return pairs of corners that are one, as they are the same along an edge that two faces share, or that one has on
    both sides; and all corners of an edge that is but a point.
    """
    from OCP.BRep import BRep_Tool
    from OCP.TopLoc import TopLoc_Location

    found, first_of_edges = list[tuple[int, int]](), dict[int, list[int]]()
    apart = FARTHEST_APART * float(np.ptp(places, axis=0).max())
    for face, first in zip(faces, n_points, strict=False):
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, place)
        for edge in each("Edge", face):
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge, mesh, place)
            if polygon is None:
                continue
            nodes = [first + polygon.Node(index) - 1 for index in range(1, polygon.NbNodes() + 1)]
            if BRep_Tool.Degenerated_s(edge):
                found += [(nodes[0], node) for node in nodes[1:]]
                continue
            others = first_of_edges.setdefault(hash(edge), nodes)
            if len(others) == len(nodes):
                ways = nodes, nodes[::-1]
                off = [np.abs(places[others] - places[way]).max() for way in ways]
                if min(off) <= apart:
                    found += [
                        pair for pair in zip(others, ways[int(np.argmin(off))], strict=True) if pair[0] != pair[1]
                    ]
    return found


def _at_one_place(places: FloatArray, pairs: list[tuple[int, int]], near: float) -> NDArray[np.int64]:
    """Return of each corner the first that it is one with: by pairs, or as it is as near."""
    _, first, same = np.unique(np.round(places / near), axis=0, return_index=True, return_inverse=True)
    found: list[int] = first[same.ravel()].tolist()

    def root(corner: int) -> int:
        while found[corner] != corner:
            found[corner] = found[found[corner]]
            corner = found[corner]
        return corner

    for one, other in pairs:
        low, high = sorted((root(one), root(other)))
        found[high] = low
    return np.array([root(corner) for corner in range(len(found))])


def _meshed(solid: Any, size: float, *, within: bool) -> list[Any]:
    """Return the faces of a solid, of which triangles have been made as near to the surface as its size asks for."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.IMeshTools import IMeshTools_Parameters
    from OCP.TopLoc import TopLoc_Location

    for attempt in (solid, None):
        tried = _divided(solid) if attempt is None else attempt
        faces = [*each("Face", tried)]
        wanted = IMeshTools_Parameters()
        wanted.Deflection, wanted.Angle = CHORD_OF_SIZE * size, 0.999 * 2.0 * np.pi / CHORDS_OF_CIRCLE
        wanted.InternalVerticesMode = within or any(_is_ball(face) for face in faces)  # a cylinder needs none
        wanted.ControlSurfaceDeflection = wanted.InternalVerticesMode
        if within:
            BRepTools.Clean_s(tried)
        BRepMesh_IncrementalMesh(tried, wanted)
        lost = [face for face in faces if BRep_Tool.Triangulation_s(face, TopLoc_Location()) is None]
        if not lost:
            return faces
    x, y, z = moments_of(lost[0], of_surface=True).CentreOfMass().Coord()
    where = f"has a face at ({x:.5g}, {y:.5g}, {z:.5g}) mm"
    raise ValueError(f"{where} that Open CASCADE cannot make triangles of; repair it, or export it again")


def _divided(solid: Any) -> Any:
    """Return a solid whose round faces are divided into quarters. Some programs write whole cones in ways that Open
    CASCADE makes no triangles of.
    """
    from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideAngle

    work = ShapeUpgrade_ShapeDivideAngle(0.5 * np.pi, solid)
    work.Perform()
    return work.Result()


def _off(face: Any) -> float:
    """Return how far the triangles of a face are off at most: the sagitta of their chords, along and across; of another
    surface, see `_off_middles`.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_Cone, GeomAbs_Cylinder, GeomAbs_Plane, GeomAbs_Sphere, GeomAbs_Torus

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
        return _off_middles(face)
    return float(radii * (1.0 - np.cos(np.pi / CHORDS_OF_CIRCLE)))


def _off_middles(face: Any) -> float:
    """Return how far the middles of a face's triangles and of their sides are from its surface. What Open CASCADE tells
    of that (`Deflection`) is what it was asked for, up to fifty times as much.
    """
    from OCP.BRep import BRep_Tool
    from OCP.gp import gp_Pnt, gp_Pnt2d
    from OCP.ShapeAnalysis import ShapeAnalysis_Surface
    from OCP.TopLoc import TopLoc_Location

    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    turn, surface = place.Transformation(), ShapeAnalysis_Surface(BRep_Tool.Surface_s(face))
    numbers = range(1, mesh.NbNodes() + 1)
    nodes = np.array([xyz(mesh.Node(number).Transformed(turn)) for number in numbers])
    places = np.array([(mesh.UVNode(number).X(), mesh.UVNode(number).Y()) for number in numbers])
    listed = (mesh.Triangle(number) for number in range(1, mesh.NbTriangles() + 1))
    corners = np.array([[triangle.Value(corner) - 1 for corner in (1, 2, 3)] for triangle in listed])
    sides = np.unique(np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])), axis=0)
    farthest = 0.0
    for ends in (corners, sides):
        for middle, near in zip(nodes[ends].mean(axis=1), places[ends].mean(axis=1), strict=True):
            surface.NextValueOfUV(gp_Pnt2d(*near), gp_Pnt(*middle), NEAR_ENOUGH)
            farthest = max(farthest, surface.Gap())
    return farthest


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
