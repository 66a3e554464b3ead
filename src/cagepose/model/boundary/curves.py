"""The curves in which the regions of a surface of triangles meet: lines, arcs, and chains of short edges."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.sides import IntArray, starts_and_ends
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE, TORUS, Surface

LINE, ARC, CHAIN = "line", "arc", "chain"
ALONG_AXIS = 1e-6
"""Sine between a plane's normal and an axis; with less they are parallel."""
WIDEST_PIECE = math.radians(61.0)
"""An arc is divided into pieces that are no wider."""


class Curve(NamedTuple):
    """Where two regions meet, from one place where it may turn to the next.

    Attributes
    ----------
    kind
        "line", "arc" or "chain" of straight edges.
    nodes
        Vertices along it, (n,); the first is the last of one that is closed. The region to its left is ``left``.
    left, right
        Regions.
    sides
        The side of a triangle of the left region between each two nodes, (n - 1,).
    center_m, axis, radius_m
        Of an arc, which leads counter-clockwise about its axis.
    """

    kind: str
    nodes: IntArray
    left: int
    right: int
    sides: IntArray
    center_m: FloatArray
    axis: FloatArray
    radius_m: float

    @property
    def is_closed(self) -> bool:
        return bool(self.nodes[0] == self.nodes[-1])

    def tangent(self, place_m: FloatArray) -> FloatArray:
        """Return the unit vector along an arc at a place of it, (3,)."""
        found = np.cross(self.axis, place_m - self.center_m)
        unit: FloatArray = found / np.linalg.norm(found)
        return unit

    def at(self, shares: FloatArray, vertices_m: FloatArray) -> FloatArray:
        """Return places of an arc at shares of its way, (n, 3)."""
        across = vertices_m[self.nodes[0]] - self.center_m
        across = across - (across @ self.axis) * self.axis
        angles = (shares * width_of(self, vertices_m))[:, None]
        places: FloatArray = self.center_m + np.cos(angles) * across + np.sin(angles) * np.cross(self.axis, across)
        return places


class Borders(NamedTuple):
    """Sides of triangles where regions meet, and what follows each where nothing else begins there; -1: nothing."""

    sides: IntArray
    following: IntArray


def curves_of(
    vertices_m: FloatArray,
    triangles: IntArray,
    twins: IntArray,
    regions: IntArray,
    surfaces: Sequence[Surface],
    flat_m: float,
) -> list[Curve]:
    """Return all curves, each once.

    Parameters
    ----------
    vertices_m, triangles
        The surface, (n, 3) and (m, 3).
    twins
        See `cagepose.model.sides.twins_of`.
    regions
        Which region each triangle is in, (m,).
    surfaces
        On which each region lies.
    flat_m
        What is this near to a curve is on it, metres.
    """
    borders = _borders(vertices_m, triangles, twins, regions)
    region = np.repeat(regions, 3)
    starts, ends = starts_and_ends(triangles)
    following = dict(zip(borders.sides.tolist(), borders.following.tolist(), strict=True))
    begins = set(borders.sides.tolist()) - set(borders.following.tolist())
    found, seen = list[Curve](), set[int]()
    for first in (*sorted(begins), *borders.sides.tolist()):
        if first in seen or region[first] > region[twins[first]]:
            continue
        chain, at = list[int](), first
        while at >= 0 and at not in seen:
            seen.add(at)
            chain.append(at)
            at = following[at]
        sides = np.array(chain)
        nodes = np.append(starts[sides], ends[sides[-1]])
        left, right = int(region[first]), int(region[twins[first]])
        found.append(_curve(vertices_m, nodes, left, right, sides, surfaces, flat_m))
    return found


def _borders(vertices_m: FloatArray, triangles: IntArray, twins: IntArray, regions: IntArray) -> Borders:
    """Return the borders of regions; two of one region follow each other where nothing but these two and their twins
    meets.
    """
    starts, _ = starts_and_ends(triangles)
    region = np.repeat(regions, 3)
    sides = np.flatnonzero(region != region[twins])
    n_out = np.bincount(starts[sides], minlength=len(vertices_m))
    by_place = sides[np.argsort(starts[sides], kind="stable")]
    one, other = by_place[n_out[starts[by_place]] == 2].reshape(-1, 2).T
    goes_on = (region[one] == region[twins[other]]) & (region[other] == region[twins[one]])
    one, other = one[goes_on], other[goes_on]
    following = np.full(len(starts), -1, np.int64)
    following[twins[other]], following[twins[one]] = one, other
    return Borders(sides, following[sides])


def _curve(
    vertices_m: FloatArray,
    nodes: IntArray,
    left: int,
    right: int,
    sides: IntArray,
    surfaces: Sequence[Surface],
    flat_m: float,
) -> Curve:
    none = np.zeros(3)
    chain = Curve(CHAIN, nodes, left, right, sides, none, none, 0.0)
    one, other = surfaces[left], surfaces[right]
    if len(nodes) == 2 and one.kind == PLANE and other.kind == PLANE:  # as of most edges, where there are facets
        return chain._replace(kind=LINE)
    places = vertices_m[nodes]
    if nodes[0] != nodes[-1] and _is_straight(places, flat_m):
        middle = (places[:1] + places[-1:]) / 2.0
        off = max(abs(float(surface.heights(middle)[0])) for surface in (one, other))
        turned = max(_turned(surface, places) for surface in (one, other))
        return chain._replace(kind=LINE) if max(off, turned) <= 2.0 * flat_m else chain
    return _around_axis(chain, places, one, other, flat_m) or _across_tube(chain, places, one, other, flat_m) or chain


def _around_axis(chain: Curve, places: FloatArray, one: Surface, other: Surface, flat_m: float) -> Curve | None:
    """Return a curve as an arc, if all of its places are at one height and one distance from an axis about which both
    surfaces are the same all around.
    """
    axis = _common_axis(one, other, flat_m)
    if axis is None or not (one.is_round or other.is_round):
        return None
    origin, way = axis
    seen = places - origin
    along = seen @ way
    across = seen - np.outer(along, way)
    away = np.linalg.norm(across, axis=1)
    if max(np.ptp(along), np.ptp(away)) > 2.0 * flat_m or away.min() <= 4.0 * flat_m:
        return None
    center = origin + _height(one, other, origin, way, float(along.mean())) * way
    radius = _radius(one, other, center, float(away.mean()))
    turn = float(np.einsum("ij,ij->i", np.cross(across[:-1], across[1:]), np.broadcast_to(way, across[1:].shape)).sum())
    return chain._replace(kind=ARC, center_m=center, axis=math.copysign(1.0, turn) * way, radius_m=radius)


def _across_tube(chain: Curve, places: FloatArray, one: Surface, other: Surface, flat_m: float) -> Curve | None:
    """Return a curve as an arc, if it is one of a circle of a torus's tube."""
    tori = [surface for surface in (one, other) if surface.kind == TORUS]
    if not tori:
        return None
    origin, axis = np.array(tori[0].point_m), np.array(tori[0].axis)
    seen = places - origin
    across = seen - np.outer(seen @ axis, axis)
    out = across[np.linalg.norm(across, axis=1).argmax()]
    for surface in (one, other):  # which tells its plane, if one of them does
        if surface.kind in (PLANE, CYLINDER, CONE) and abs(float(axis @ np.array(surface.axis))) <= ALONG_AXIS:
            out = math.copysign(1.0, float(out @ np.cross(surface.axis, axis))) * np.cross(surface.axis, axis)
    out = out / np.linalg.norm(out)
    way, center = np.cross(out, axis), origin + tori[0].core_m * out
    arms = places - center
    off = np.abs(np.linalg.norm(arms, axis=1) - abs(tori[0].radius_m))
    if max(float(np.abs(arms @ way).max()), float(off.max())) > 2.0 * flat_m:
        return None
    turn = float(np.einsum("ij,j->i", np.cross(arms[:-1], arms[1:]), way).sum())
    way = math.copysign(1.0, turn) * way
    return chain._replace(kind=ARC, center_m=center, axis=way, radius_m=abs(tori[0].radius_m))


def _is_straight(places_m: FloatArray, flat_m: float) -> bool:
    way = places_m[-1] - places_m[0]
    length = float(np.linalg.norm(way))
    if length <= flat_m or len(places_m) == 2:
        return length > flat_m
    seen = places_m - places_m[0]
    along = seen @ way / length
    off = np.linalg.norm(seen - np.outer(along / length, way), axis=1)
    return bool(off.max() <= flat_m and (np.diff(along) > 0.0).all())


def _turned(surface: Surface, places_m: FloatArray) -> float:
    """Return how far around a surface it is from the first of some places to the last one, metres. A chord may lead
    around it and be as near to it as a line that lies on it.
    """
    if not surface.is_round:
        return 0.0
    first, last = surface.normals(places_m[[0, -1]])
    return abs(surface.radius_m) * float(np.linalg.norm(last - first))


def _common_axis(one: Surface, other: Surface, flat_m: float) -> tuple[FloatArray, FloatArray] | None:
    """Return a point and a unit vector of the axis about which both surfaces are the same all around; None: there is
    none.
    """
    turned = [surface for surface in (one, other) if surface.kind in (CYLINDER, CONE, TORUS)]
    balls = [surface for surface in (one, other) if surface.kind == SPHERE]
    planes = [surface for surface in (one, other) if surface.kind == PLANE]
    if turned:
        point, axis = np.array(turned[0].point_m), np.array(turned[0].axis)
    elif balls and planes:
        point, axis = np.array(balls[0].point_m), np.array(planes[0].axis)
    elif len(balls) == 2:
        point = np.array(balls[0].point_m)
        axis = np.array(balls[1].point_m) - point
        size = float(np.linalg.norm(axis))
        if size <= flat_m:
            return None
        axis = axis / size
    else:
        return None
    for surface in (*turned[1:], *planes):
        if float(np.linalg.norm(np.cross(axis, surface.axis))) > ALONG_AXIS:
            return None
    for surface in (*turned[1:], *balls):
        seen = np.array(surface.point_m) - point
        if float(np.linalg.norm(seen - (seen @ axis) * axis)) > flat_m:
            return None
    return point, axis


def _height(one: Surface, other: Surface, origin: FloatArray, way: FloatArray, along: float) -> float:
    """Return the height of an arc above a point of its axis: that of a plane where there is one, else the given one, or
    that at which a torus has the radius of a cylinder.
    """
    for surface in (one, other):
        if surface.kind == PLANE:
            normal = np.array(surface.axis)
            return float((np.array(surface.point_m) - origin) @ normal / (way @ normal))
    for torus, side in ((one, other), (other, one)):
        if torus.kind == TORUS and side.kind == CYLINDER:
            level = float((np.array(torus.point_m) - origin) @ way)
            rise = math.sqrt(max(0.0, torus.radius_m**2 - (abs(side.radius_m) - torus.core_m) ** 2))
            return level + math.copysign(rise, along - level)
    return along


def _radius(one: Surface, other: Surface, center_m: FloatArray, away: float) -> float:
    """Return the radius of an arc about a point: that of its surface, else a given one."""
    for surface in (one, other):
        if surface.kind in (CYLINDER, CONE):
            return surface.radius_at(center_m)
    for surface in (one, other):
        if surface.kind == TORUS:
            rise = float((center_m - np.array(surface.point_m)) @ np.array(surface.axis))
            half = math.sqrt(max(0.0, surface.radius_m**2 - rise**2))
            return surface.core_m + math.copysign(half, away - surface.core_m)
    return away


def pieces_of(curve: Curve, vertices_m: FloatArray) -> list[tuple[int, int]]:
    """Return indices of nodes from which and to which pieces of a curve lead: a line is one, and an arc has two or
    more, if it has as many edges, of at most 61 degrees.
    """
    last = len(curve.nodes) - 1
    if curve.kind == LINE:
        return [(0, last)]
    angles = np.concatenate([[0.0], np.cumsum(_steps(curve, vertices_m))])
    n_pieces = max(2, math.ceil(float(angles[-1]) / WIDEST_PIECE - 1e-9))
    ends = np.unique(np.abs(angles[:, None] - angles[-1] * np.arange(n_pieces + 1) / n_pieces).argmin(axis=0))
    return list(zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True))


def width_of(curve: Curve, vertices_m: FloatArray) -> float:
    """Return how far around an arc leads, radians."""
    if curve.is_closed:
        return 2.0 * math.pi
    return float(_steps(curve, vertices_m).sum())


def _steps(curve: Curve, vertices_m: FloatArray) -> FloatArray:
    """Return the angles between neighbouring nodes of an arc, radians."""
    seen = vertices_m[curve.nodes] - curve.center_m
    across = np.einsum("ij,j->i", np.cross(seen[:-1], seen[1:]), curve.axis)
    angles: FloatArray = np.arctan2(across, np.einsum("ij,ij->i", seen[:-1], seen[1:]))
    return angles
