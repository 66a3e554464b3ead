"""Parts as CAD builds them, step by step: each with its solid of Open CASCADE, its twin of our primitives, and a
function that says how far outside points are. Millimetres, but that twins are in metres, as all of ours.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cagepose import Box, Chamfer, Cone, Convex, Cylinder, Hole, Pose, Shape, Sphere
from cagepose.model.pose import turn_from_z

Vector = tuple[float, float, float]
Level = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Part:
    """One solid.

    Attributes
    ----------
    solid
        Of Open CASCADE.
    twin
        Shapes that are it together, named "0", "1", ..., and holes in them; empty: none of ours are.
    level
        Of points, (n, 3): below zero within, and at most as far from zero as the surface is.
    """

    solid: Any
    twin: tuple[Shape, ...]
    level: Level

    def __add__(self, other: Part) -> Part:
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
        from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain

        joined = ShapeUpgrade_UnifySameDomain(BRepAlgoAPI_Fuse(self.solid, other.solid).Shape())
        joined.Build()
        twin = (*self.twin, *other.twin) if self.twin and other.twin else ()
        return Part(joined.Shape(), _numbered(twin), lambda at: np.minimum(self.level(at), other.level(at)))

    def __sub__(self, other: Part) -> Part:
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

        cut = BRepAlgoAPI_Cut(self.solid, other.solid).Shape()
        return Part(cut, (), lambda at: np.maximum(self.level(at), -other.level(at)))

    def __and__(self, other: Part) -> Part:
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Common

        both = BRepAlgoAPI_Common(self.solid, other.solid).Shape()
        return Part(both, (), lambda at: np.maximum(self.level(at), other.level(at)))

    def as_twin(self, *parts: Part) -> Part:
        """Return the part with the twin of others that are it together."""
        return replace(self, twin=_numbered(tuple(shape for part in parts for shape in part.twin)))

    def bored(
        self, mouth: Vector, into: Vector, radius: float, depth: float, flare: tuple[float, float] | None = None
    ) -> Part:
        """Return it with a hole in all of its shapes; ``flare``: how much wider its mouth is, and the angle."""
        way = np.array(into)
        removed, chamfer = bar(mouth, into, radius, depth), None
        if flare:
            width, angle = flare
            high, chamfer = width / math.tan(angle), Chamfer(1e-3 * width, angle)
            removed = removed + cone(mouth, into, radius + width, radius, high)
        names = [shape.name for shape in self.twin if not isinstance(shape, Hole)]
        pose = Pose(1e-3 * np.array(mouth), turn_from_z(-way))
        hole = Hole(1e-3 * radius, 1e-3 * depth, chamfer, names, pose)
        return replace(self - removed, twin=_numbered((*self.twin, hole)))

    def rounded(self, radius: float, is_meant: Callable[[np.ndarray], bool] = lambda _: True) -> Any:
        """Return the solid with those edges round whose middle is meant."""
        from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

        made = BRepFilletAPI_MakeFillet(self.solid)
        for edge in self._edges(is_meant):
            made.Add(radius, edge)
        return made.Shape()

    def chamfered(self, width: float, is_meant: Callable[[np.ndarray], bool] = lambda _: True) -> Any:
        """Return the solid with those edges chamfered whose middle is meant."""
        from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer

        made = BRepFilletAPI_MakeChamfer(self.solid)
        for edge in self._edges(is_meant):
            made.Add(width, edge)
        return made.Shape()

    def _edges(self, is_meant: Callable[[np.ndarray], bool]) -> list[Any]:
        from OCP.BRepAdaptor import BRepAdaptor_Curve
        from OCP.TopAbs import TopAbs_EDGE
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS

        found, explorer = {}, TopExp_Explorer(self.solid, TopAbs_EDGE)
        while explorer.More():
            edge = TopoDS.Edge(explorer.Current())
            curve = BRepAdaptor_Curve(edge)
            point = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2.0)
            if is_meant(np.array([point.X(), point.Y(), point.Z()]).round(6)):
                found[hash(edge)] = edge
            explorer.Next()
        return list(found.values())


def _numbered(shapes: tuple[Shape, ...]) -> tuple[Shape, ...]:
    """Return shapes of several parts, each with holes behind what they are in, with new names."""
    found: list[Shape] = []
    names: dict[str, str] = {}
    for shape in shapes:
        if isinstance(shape, Hole):
            found.append(shape.cut_out_of([names[name] for name in shape.in_]).renamed(f"hole {len(found)}"))
        else:
            names[shape.name] = f"{len(found)}"
            found.append(shape.renamed(names[shape.name]))
    return tuple(found)


def box(low: Vector, high: Vector) -> Part:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    bottom, top = np.array(low, float), np.array(high, float)
    middle, half = (bottom + top) / 2.0, (top - bottom) / 2.0
    solid = BRepPrimAPI_MakeBox(gp_Pnt(*bottom.tolist()), gp_Pnt(*top.tolist())).Shape()
    twin = Box(2e-3 * half, Pose(1e-3 * middle), "0")
    return Part(solid, (twin,), lambda at: (np.abs(at - middle) - half).max(axis=1))


def _axes(at: Vector, along: Vector) -> Any:
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return gp_Ax2(gp_Pnt(*map(float, at)), gp_Dir(*map(float, along)))


def _middle(at: Vector, along: Vector, length: float) -> Pose:
    way = np.array(along, float) / np.linalg.norm(along)
    return Pose(1e-3 * (np.array(at) + length / 2.0 * way), turn_from_z(way))


def bar(at: Vector, along: Vector, radius: float, length: float) -> Part:
    """Return a cylinder from a place along a way."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    solid = BRepPrimAPI_MakeCylinder(_axes(at, along), radius, length).Shape()
    twin = Cylinder(1e-3 * radius, 1e-3 * length, _middle(at, along, length), "0")
    return Part(solid, (twin,), _turned(at, along, radius, radius, length))


def cone(at: Vector, along: Vector, first: float, last: float, length: float) -> Part:
    """Return a cone from a place along a way, with its radius there and at its end."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    solid = BRepPrimAPI_MakeCone(_axes(at, along), first, last, length).Shape()
    twin = Cone(1e-3 * first, 1e-3 * last, 1e-3 * length, _middle(at, along, length), "0")
    return Part(solid, (twin,), _turned(at, along, first, last, length))


def _turned(at: Vector, along: Vector, first: float, last: float, length: float) -> Level:
    way, start = np.array(along, float) / np.linalg.norm(along), np.array(at, float)
    slope = (last - first) / length

    def level(points: np.ndarray) -> np.ndarray:
        heights = (points - start) @ way
        across = np.linalg.norm(points - start - heights[:, None] * way, axis=1)
        beside = (across - first - slope * heights) / math.hypot(1.0, slope)
        return np.maximum(beside, np.abs(heights - length / 2.0) - length / 2.0)

    return level


def ball(at: Vector, radius: float) -> Part:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    solid = BRepPrimAPI_MakeSphere(gp_Pnt(*map(float, at)), radius).Shape()
    twin = Sphere(1e-3 * radius, Pose(1e-3 * np.array(at)), "0")
    return Part(solid, (twin,), lambda points: np.linalg.norm(points - np.array(at), axis=1) - radius)


def prism(corners: Any, low: float, high: float, axis: int = 2) -> Part:
    """Return a prism over a convex polygon, counter-clockwise in x and y (or y and z, or z and x, by its axis)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Pnt, gp_Vec

    flat = np.array(corners, float)
    order = [(1, 2, 0), (2, 0, 1), (0, 1, 2)][axis]
    ends = [np.zeros((len(flat), 3)) for _ in (low, high)]
    for end, height in zip(ends, (low, high), strict=True):
        end[:, order[0]], end[:, order[1]], end[:, order[2]] = flat[:, 0], flat[:, 1], height
    outline = BRepBuilderAPI_MakePolygon()
    for corner in ends[0].tolist():
        outline.Add(gp_Pnt(*corner))
    outline.Close()
    way = gp_Vec(*(ends[1] - ends[0])[0].tolist())
    solid = BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), way).Shape()
    sides = np.roll(flat, -1, axis=0) - flat
    normals = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1)[:, None]
    offsets = np.einsum("ij,ij->i", normals, flat)

    def level(points: np.ndarray) -> np.ndarray:
        beside = (points[:, order[:2]] @ normals.T - offsets).max(axis=1)
        return np.maximum(beside, np.abs(points[:, axis] - (low + high) / 2.0) - (high - low) / 2.0)

    return Part(solid, (Convex(1e-3 * np.concatenate(ends), 0.0, None, "0"),), level)


def hexagon(across: float) -> np.ndarray:
    """Return the corners of a hexagon with two flats across x."""
    angles = np.radians(60.0 * np.arange(6) + 30.0)
    return across / math.sqrt(3.0) * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def write_step(part: Part, path: Path) -> None:
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(part.solid, STEPControl_AsIs)
    writer.Write(str(path))


def write_stl(part: Part, path: Path) -> None:
    """Write triangles whose corners are on the surface, 64 around a circle."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.StlAPI import StlAPI_Writer

    BRepMesh_IncrementalMesh(part.solid, 1.0, False, 2.0 * math.pi / 64.0, False)
    writer = StlAPI_Writer()
    writer.ASCIIMode = False
    writer.Write(part.solid, str(path))
