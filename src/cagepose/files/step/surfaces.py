"""The surfaces of a STEP file's faces as ours: `surface_of_face`. Millimetres throughout."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from cagepose.files.step.open_cascade import xyz
from cagepose.files.step.tolerances import SAME_OF_SIZE, SAME_PLACE
from cagepose.model.checks import FloatArray
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE, TORUS, Surface

ASLANT = 0.9
"""Cosine between axes that are asked no further whether they are one: to cross them takes ten times as long."""
SAMPLES, FARTHEST_OF_SIZE = 9, 100.0
"""Places of what is turned about an axis that tell whether it is an arc; and its radius, in its chord, at most."""


def surface_of_face(face: Any, corners: FloatArray) -> Surface | None:
    """Return the surface of a face, whose triangles have ``corners``, (n, 3, 3), counter-clockwise seen from outside;
    None: it is none of ours.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import (
        GeomAbs_Cone,
        GeomAbs_Cylinder,
        GeomAbs_Plane,
        GeomAbs_Sphere,
        GeomAbs_SurfaceOfRevolution,
        GeomAbs_Torus,
    )

    adaptor = BRepAdaptor_Surface(face)
    kind = adaptor.GetType()
    if kind == GeomAbs_Plane:
        plane = adaptor.Plane()
        found = Surface(PLANE, xyz(plane.Location()), xyz(plane.Axis().Direction()))
    elif kind == GeomAbs_Cylinder:
        cylinder = adaptor.Cylinder()
        found = Surface(CYLINDER, xyz(cylinder.Location()), xyz(cylinder.Axis().Direction()), cylinder.Radius())
    elif kind == GeomAbs_Cone:
        found = _cone(adaptor.Cone(), corners)
    elif kind == GeomAbs_Sphere:
        ball = adaptor.Sphere()
        found = Surface(SPHERE, xyz(ball.Location()), (0.0, 0.0, 0.0), ball.Radius())
    elif kind == GeomAbs_Torus:
        ring = adaptor.Torus()
        place, axis = xyz(ring.Location()), xyz(ring.Axis().Direction())
        found = Surface(TORUS, place, axis, ring.MinorRadius(), core_m=ring.MajorRadius())
    else:
        arc = _turned_arc(adaptor) if kind == GeomAbs_SurfaceOfRevolution else None
        if arc is None:
            return None
        found = arc
    return _facing_out(found, corners)


def _turned_arc(adaptor: Any) -> Surface | None:
    """Return the torus of an arc that is turned about an axis, as Open CASCADE writes those that are wider than their
    circle; None: what is turned is no arc.
    """
    axis = adaptor.AxeOfRevolution()
    place, way = np.array(xyz(axis.Location())), np.array(xyz(axis.Direction()))
    along = np.linspace(adaptor.FirstVParameter(), adaptor.LastVParameter(), SAMPLES)
    seen = np.array([xyz(adaptor.BasisCurve().Value(at)) for at in along]) - place
    heights = seen @ way
    away = np.linalg.norm(seen - np.outer(heights, way), axis=1)
    middle = float(heights.mean())
    sums = np.stack([2.0 * away, 2.0 * (heights - middle), np.ones(SAMPLES)], axis=1)
    core, rise, rest = np.linalg.lstsq(sums, away**2 + (heights - middle) ** 2, rcond=None)[0].tolist()
    square = rest + core**2 + rise**2
    if core <= 0.0 or square <= 0.0:
        return None
    radius = float(np.sqrt(square))
    off = np.abs(np.hypot(away - core, heights - middle - rise) - radius).max()
    if radius > FARTHEST_OF_SIZE * float(np.hypot(np.ptp(away), np.ptp(heights))) or off > SAME_PLACE * radius:
        return None
    x, y, z = (place + (middle + rise) * way).tolist()
    u, v, w = way.tolist()
    return Surface(TORUS, (x, y, z), (u, v, w), radius, core_m=core)


def _cone(cone: Any, corners: FloatArray) -> Surface:
    """Return a cone with its point where its triangles are widest."""
    place, axis = xyz(cone.Location()), xyz(cone.Axis().Direction())
    heights = (corners.reshape(-1, 3) - np.array(place)) @ np.array(axis)
    slope = float(np.tan(cone.SemiAngle()))
    radii = cone.RefRadius() + slope * heights
    widest = int(np.abs(radii).argmax())
    sign = float(np.sign(radii[widest]))
    point = np.array(place) + heights[widest] * np.array(axis)
    x, y, z = point.tolist()
    return Surface(CONE, (x, y, z), axis, abs(float(radii[widest])), sign * slope)


def _facing_out(surface: Surface, corners: FloatArray) -> Surface:
    """Return a surface whose normals are on the side of those of its triangles."""
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.einsum("ij,ij->", areas, surface.normals(corners.mean(axis=1)))
    if facing >= 0.0:
        return surface
    if surface.kind == PLANE:
        x, y, z = (-np.array(surface.axis)).tolist()
        return replace(surface, axis=(x, y, z))
    return replace(surface, radius_m=-surface.radius_m)


def one_of_each(surfaces: list[Surface | None], size: float) -> tuple[list[Surface], list[int]]:
    """Return different surfaces, and which of them each of the given ones is, -1: none. Cylinders that CAD has divided
    are one, and so are faces in one plane.
    """
    found, which = list[Surface](), list[int]()
    for surface in surfaces:
        if surface is None:
            which.append(-1)
            continue
        same = next((k for k, other in enumerate(found) if _are_one(surface, other, size)), len(found))
        if same == len(found):
            found.append(surface)
        which.append(same)
    return found, which


def _are_one(one: Surface, other: Surface, size: float) -> bool:
    if one.kind != other.kind or (one.radius_m < 0.0) != (other.radius_m < 0.0):
        return False
    slack = SAME_OF_SIZE * size
    between = np.array(other.point_m) - np.array(one.point_m)
    axis, along = np.array(one.axis), float(np.dot(one.axis, other.axis))
    if one.kind == SPHERE:
        return float(np.linalg.norm(between)) <= slack and abs(one.radius_m - other.radius_m) <= slack
    if abs(along) < ASLANT or float(np.linalg.norm(np.cross(one.axis, other.axis))) > SAME_OF_SIZE:
        return False
    if one.kind == PLANE:
        return along > 0.0 and abs(float(between @ axis)) <= slack
    height = float(between @ axis)
    if one.kind == TORUS:
        sizes = max(abs(one.radius_m - other.radius_m), abs(one.core_m - other.core_m))
        return max(float(np.linalg.norm(between)), sizes) <= slack
    off = float(np.linalg.norm(between - height * axis))
    slope = other.slope if along > 0.0 else -other.slope
    radius = abs(one.radius_m) + one.slope * height
    return off <= slack and abs(radius - abs(other.radius_m)) <= slack and abs(one.slope - slope) <= SAME_OF_SIZE


def farthest_off(surfaces: list[Surface], on: FloatArray, places: FloatArray) -> float:
    """Return how far places of triangles, (n, 3) or (n, 3, 3), are from the surface that each is on, at most."""
    off = [np.abs(surface.heights(places[on == k])).max(initial=0.0) for k, surface in enumerate(surfaces)]
    return float(max(off, default=0.0))
