"""Curves that are no lines or circles, as where two cylinders cross, as short arcs: `halved`, `with_arcs`.

Each edge of such a chain is two arcs that have the tangents of the curve at its ends, and one in the middle (a biarc,
Bolton, "Biarc curves", Computer-Aided Design 7, 1975): a corner between them would be felt where a part rolls over it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.model.boundary.curves import ARC, CHAIN, LINE, Curve
from cagepose.model.boundary.surface_regions import Regions
from cagepose.model.checks import FloatArray
from cagepose.model.finer import onto
from cagepose.model.sides import IntArray
from cagepose.model.surfaces import Surface

ALONG = np.array((0.21, 0.5, 0.79))
"""Shares of the way along an arc where it is about farthest from the curve that it stands for."""
STRAIGHT = 2.0
"""In what is near: an edge that its curve is no farther from is straight."""
LEAST_SINE = 1e-3
"""Of the angle between two surfaces: with less, the tangent of the curve in which they cross is not told."""


class Circle(NamedTuple):
    """That an arc is on, counter-clockwise about its axis."""

    center_m: FloatArray
    axis: FloatArray
    radius_m: float


def exact_beside(curve: Curve, regions: Regions) -> list[Surface]:
    """Return the surfaces beside a curve that are exact; facets beside it end somewhere near the other one."""
    return [regions.surfaces[region] for region in (curve.left, curve.right) if regions.is_exact[region]]


def with_arcs(
    curves: Sequence[Curve], vertices_m: FloatArray, regions: Regions, near_m: float
) -> tuple[list[Curve], FloatArray]:
    """Return curves with each edge of a chain as an arc or two, and vertices with the places where two of them meet."""
    found, places = list[Curve](), list[FloatArray]()
    for curve in curves:
        if curve.kind != CHAIN:
            found.append(curve)
            continue
        for k in range(len(curve.sides)):
            nodes = [int(curve.nodes[k]), int(curve.nodes[k + 1])]
            edge = curve._replace(kind=LINE, nodes=np.array(nodes), sides=curve.sides[k : k + 1])
            middle, circles = _arcs(vertices_m[nodes], exact_beside(curve, regions), near_m)
            if middle is not None:
                nodes.insert(1, len(vertices_m) + len(places))
                places.append(middle)
            arcs = [edge._replace(kind=ARC, **circle._asdict()) for circle in circles]
            found += [arc._replace(nodes=np.array(nodes[n : n + 2])) for n, arc in enumerate(arcs)] or [edge]
    return found, np.concatenate([vertices_m, np.array(places).reshape(-1, 3)])


def _arcs(ends_m: FloatArray, surfaces: Sequence[Surface], near_m: float) -> tuple[FloatArray | None, list[Circle]]:
    """Return the circles of an edge between two places of its surfaces, and where two of them meet. Without circles it
    is straight: one between flat facets, and that of a hollow side, as of a hole, whose ends lie on both sides of what
    rolls over them.
    """
    if not surfaces or any(surface.radius_m < 0.0 for surface in surfaces):
        return None, []
    start, end = ends_m
    seen = onto(ends_m.mean(axis=0, keepdims=True), surfaces)[0] - start
    chord = end - start
    length = float(np.linalg.norm(chord))
    if float(np.linalg.norm(np.cross(seen, chord))) <= STRAIGHT * near_m * length:
        return None, []
    tangents = _tangents(ends_m, surfaces)
    if tangents is None:
        return None, [_circle_through(start, seen, chord)]
    first, last = tangents
    along = float(chord @ (first + last))
    far = length**2 / (along + math.sqrt(along**2 + 2.0 * (1.0 - float(first @ last)) * length**2))
    middle = 0.5 * (start + end + far * (first - last))
    return middle, [_circle(start, first, middle), _circle(end, last, middle)]


def _tangents(ends_m: FloatArray, surfaces: Sequence[Surface]) -> tuple[FloatArray, FloatArray] | None:
    """Return the unit vectors along a curve at both ends of an edge of it; None: surfaces do not tell."""
    if len(surfaces) < 2:
        return None
    one, other = surfaces
    ways = np.cross(one.normals(ends_m), other.normals(ends_m))
    sizes = np.linalg.norm(ways, axis=1, keepdims=True)
    if sizes.min() < LEAST_SINE:
        return None
    first, last = ways / sizes
    chord = ends_m[1] - ends_m[0]
    return math.copysign(1.0, float(first @ chord)) * first, math.copysign(1.0, float(last @ chord)) * last


def _circle(place: FloatArray, tangent: FloatArray, other: FloatArray) -> Circle:
    """Return the circle through a place, along a unit vector there, and through another place."""
    seen = other - place
    across = seen - (seen @ tangent) * tangent
    size = float(np.linalg.norm(across))
    out, radius = across / size, float(seen @ seen) / (2.0 * size)
    return Circle(place + radius * out, np.cross(tangent, out), radius)


def _circle_through(start: FloatArray, seen: FloatArray, chord: FloatArray) -> Circle:
    """Return the circle through a place and two others that are seen from there, the last one at the chord's end."""
    normal = np.cross(seen, chord)
    square = float(normal @ normal)
    toward = (chord @ chord) * np.cross(normal, seen) - (seen @ seen) * np.cross(normal, chord)
    toward = toward / (2.0 * square)
    return Circle(start + toward, normal / math.sqrt(square), float(np.linalg.norm(toward)))


def off_edges(curve: Curve, vertices_m: FloatArray, regions: Regions, near_m: float) -> FloatArray:
    """Return how far the arcs of each edge of a chain are from its surfaces, metres, (n - 1,)."""
    arcs, vertices = with_arcs([curve], vertices_m, regions, near_m)
    found = np.zeros(len(curve.sides))
    edges = {int(side): k for k, side in enumerate(curve.sides)}
    for arc in arcs:
        if arc.kind == ARC:
            places = arc.at(ALONG, vertices)
            off = max(float(np.abs(surface.heights(places)).max()) for surface in exact_beside(curve, regions))
            found[edges[int(arc.sides[0])]] = max(found[edges[int(arc.sides[0])]], off)
    return found


def on_surfaces(chains: Sequence[Curve], vertices_m: FloatArray, regions: Regions) -> FloatArray:
    """Return vertices with those between the ends of chains moved onto their surfaces: files have them nearly there."""
    moved = vertices_m.copy()
    for curve in chains:
        nodes = curve.nodes[:-1] if curve.is_closed else curve.nodes[1:-1]
        moved[nodes] = onto(vertices_m[nodes], exact_beside(curve, regions))
    return moved


def halved(
    chains: Sequence[Curve],
    vertices_m: FloatArray,
    triangles: IntArray,
    on: IntArray,
    regions: Regions,
    near_m: float,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return vertices, triangles and what these stand for with those edges of chains halved, at a place of
    their surfaces, whose arcs are not as near to them yet.
    """
    middles, of_sides = list[FloatArray](), dict[tuple[int, int], int]()
    for curve in chains:
        for k in np.flatnonzero(off_edges(curve, vertices_m, regions, near_m) > near_m).tolist():
            start, end = sorted(curve.nodes[k : k + 2].tolist())
            of_sides[start, end] = len(vertices_m) + len(middles)
            middle = vertices_m[[start, end]].mean(axis=0, keepdims=True)
            middles.append(onto(middle, exact_beside(curve, regions))[0])
    if not middles:
        return vertices_m, triangles, on
    found, stand_for = list[tuple[int, int, int]](), list[int]()
    for corners, surface in zip(triangles.tolist(), on.tolist(), strict=True):
        parts = _divided(corners, of_sides)
        found += parts
        stand_for += [surface] * len(parts)
    return np.concatenate([vertices_m, middles]), np.array(found, np.int64), np.array(stand_for, np.int64)


def _divided(corners: Sequence[int], middles: dict[tuple[int, int], int]) -> list[tuple[int, int, int]]:
    """Return the triangles into which one is divided by what halves its sides."""
    a, b, c = corners
    for _ in range(3):
        middle = middles.get((min(a, b), max(a, b)))
        if middle is not None:
            return [*_divided((a, middle, c), middles), *_divided((middle, b, c), middles)]
        a, b, c = b, c, a
    return [(a, b, c)]
