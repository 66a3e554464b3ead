"""Curves that are no lines or circles, as where two cylinders cross, as short arcs: `halved`, `in_arcs`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cagepose.model.boundary.curves import ARC, CHAIN, LINE, Curve
from cagepose.model.boundary.surface_regions import Regions
from cagepose.model.checks import FloatArray
from cagepose.model.finer import onto
from cagepose.model.sides import IntArray
from cagepose.model.surfaces import Surface

ALONG = np.array((0.21, 0.79))
"""Shares of the way along an arc through three places of a curve where it is about farthest from that."""
STRAIGHT = 2.0
"""In what is flat: an edge that its curve is no farther from is straight."""


def exact_beside(curve: Curve, regions: Regions) -> list[Surface]:
    """Return the surfaces beside a curve that are exact; facets beside it end somewhere near the other one."""
    return [regions.surfaces[region] for region in (curve.left, curve.right) if regions.is_exact[region]]


def in_arcs(curve: Curve, vertices_m: FloatArray, regions: Regions, flat_m: float) -> list[Curve]:
    """Return a chain as arcs, one for each edge, through its ends and a place of its surfaces between them; other
    curves as they are.
    """
    if curve.kind != CHAIN:
        return [curve]
    start, end = vertices_m[curve.nodes[:-1]], vertices_m[curve.nodes[1:]]
    chord, seen = end - start, onto((start + end) / 2.0, exact_beside(curve, regions)) - start
    normal = np.cross(seen, chord)
    square, length = (np.einsum("ij,ij->i", one, one) for one in (normal, chord))
    found = list[Curve]()
    for k in range(len(chord)):
        piece = curve._replace(kind=LINE, nodes=curve.nodes[k : k + 2], sides=curve.sides[k : k + 1])
        if square[k] > (STRAIGHT * flat_m) ** 2 * length[k]:
            # the centre of the circle through three places, seen from the first
            toward = length[k] * np.cross(normal[k], seen[k]) - (seen[k] @ seen[k]) * np.cross(normal[k], chord[k])
            toward = toward / (2.0 * square[k])
            axis, radius = normal[k] / math.sqrt(square[k]), float(np.linalg.norm(toward))
            piece = piece._replace(kind=ARC, center_m=start[k] + toward, axis=axis, radius_m=radius)
        found.append(piece)
    return found


def off_chain(curve: Curve, vertices_m: FloatArray, regions: Regions, flat_m: float) -> FloatArray:
    """Return how far each arc of a chain is from the curve in which its surfaces cross, metres, (n - 1,)."""
    known, found = exact_beside(curve, regions), np.zeros(len(curve.nodes) - 1)
    for k, piece in enumerate(in_arcs(curve, vertices_m, regions, flat_m)):
        if piece.kind == ARC:
            places = piece.at(ALONG, vertices_m)
            found[k] = max(float(np.abs(surface.heights(places)).max()) for surface in known)
    return found


def halved(
    chains: Sequence[Curve],
    vertices_m: FloatArray,
    triangles: IntArray,
    on: IntArray,
    regions: Regions,
    flat_m: float,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return vertices, triangles and what these stand for with those edges of chains halved, at a place of
    their surfaces, whose arcs are not on them yet.
    """
    middles, of_sides = list[FloatArray](), dict[tuple[int, int], int]()
    for curve in chains:
        for k in np.flatnonzero(off_chain(curve, vertices_m, regions, flat_m) > flat_m).tolist():
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
