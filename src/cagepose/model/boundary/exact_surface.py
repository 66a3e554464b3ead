"""The boundary of a body whose triangles stand for planes, cylinders, cones, spheres and tori: `exact_block`.

A region of triangles on one surface is a face, trimmed by the curves in which it meets others. A curve is a line, an
arc, or, as where two cylinders cross, a chain of short arcs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.loops import Border, Loop, find_loops
from cagepose.model.boundary.blocks import Block
from cagepose.model.boundary.chains import exact_beside, halved, on_surfaces, with_arcs
from cagepose.model.boundary.curves import ARC, CHAIN, LINE, Curve, curves_of, pieces_of
from cagepose.model.boundary.regions import FacePlanes, regions_of
from cagepose.model.boundary.round_features import ball_of, circle_of, is_within_caps, side_of, tip_of
from cagepose.model.boundary.surface_corners import corners_of
from cagepose.model.boundary.surface_regions import Regions, regions_on
from cagepose.model.boundary.trimmed import Edges, Faces, TrimmedUnion
from cagepose.model.boundary.tubes import ends_inner_tube, torus_of, tube_part
from cagepose.model.boundary.union_block import union_block, with_rows
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.facets import FLAT, Facets
from cagepose.model.sides import IntArray, twins_of
from cagepose.model.surfaces import PLANE, SPHERE, TORUS, Surface

SMOOTH = 1e-7
"""Sine of the angle between faces beside a curve. With less, one goes over into the other smoothly."""
IN_PLANE = 1.0 - 1e-6
"""Cosine between the axis of an arc and the normal of a face that it bounds."""
HALVINGS = 4
"""How often edges of chains are halved at most: each time, their arcs are an eighth as far off."""


class Piece(NamedTuple):
    """A straight piece of a curve, or one of an arc with less than half a turn, with its region to the left.

    Attributes
    ----------
    start, end
        Vertices.
    curve
        Which one it is of.
    """

    start: int
    end: int
    curve: int


class ExactSurface(NamedTuple):
    """A surface of triangles with its regions, and the curves in which these meet.

    Attributes
    ----------
    vertices_m, triangles, twins
        See `Facets` and `cagepose.model.sides.twins_of`. Behind the corners of triangles are places between two arcs.
    on
        Which surface of its shape each triangle was told to stand for, (m,); -1: none.
    regions, curves
        See there.
    sines
        Of each curve, of the angle between the faces beside it: above zero where it is convex.
    """

    vertices_m: FloatArray
    triangles: IntArray
    twins: IntArray
    on: IntArray
    regions: Regions
    curves: list[Curve]
    sines: list[float]


def exact_block(shape: Facets, number: int) -> Block:
    """Return the features of a body, in the frame of its shape's body; ``number`` is that of the part."""
    surface = surface_of(shape)
    edges, borders = _edges(surface, number), _pieces(surface)
    faces, n_open = _faces(surface, borders, number)
    union = TrimmedUnion(corners_of(surface, number), edges, faces, n_open)
    rows = [
        circle_of(surface, index, number)
        for index, curve in enumerate(surface.curves)
        if curve.kind == ARC and (surface.sines[index] > SMOOTH or ends_inner_tube(surface, curve))
    ]
    for region, face in enumerate(surface.regions.surfaces):
        if face.kind == SPHERE:
            rows.append(ball_of(surface, region, number))
        elif face.kind == TORUS:
            rows.append(torus_of(surface, region, number))
        elif face.is_round:
            rows.append(side_of(surface, region, borders[region], number))
            rows += tip_of(surface, region, number)
    return with_rows(union_block(union, frozenset((number,))), rows)


def surface_of(shape: Facets) -> ExactSurface:
    """Return a surface with its curves in the frame of its body. A ball or a torus that anything but circles trims, or
    one with a notch, or a hollow one, stays facets. Those of the last few shapes are remembered: of a file it is asked
    what is exact, and then a scene is built.
    """
    return _surface_of(_Placed((shape.form, *shape.pose_body_shape.key), shape))


@dataclass(frozen=True)
class _Placed:
    """A shape that equals all others of its form at its place."""

    key: tuple[object, ...]
    shape: Facets = field(compare=False)


@lru_cache(maxsize=16)
def _surface_of(placed: _Placed) -> ExactSurface:
    shape = placed.shape
    surfaces = [surface.changed(1.0, shape.pose_body_shape) for surface in shape.surfaces]
    first = np.array([*(surfaces.index(surface) for surface in surfaces), -1])
    found = _without_lost(shape.nodes_body(), shape.triangles, first[shape.on], surfaces, shape.flat_m)
    near_m = FLAT * float(np.ptp(found.vertices_m, axis=0).max())
    for _ in range(HALVINGS):
        chains = [curve for curve in found.curves if curve.kind == CHAIN and exact_beside(curve, found.regions)]
        found = found._replace(vertices_m=on_surfaces(chains, found.vertices_m, found.regions))
        finer = halved(chains, found.vertices_m, found.triangles, found.on, found.regions, near_m)
        if len(finer[0]) == len(found.vertices_m):
            break
        found = _without_lost(*finer, surfaces, shape.flat_m)
    regions = found.regions
    curves, vertices_m = with_arcs(found.curves, found.vertices_m, regions, near_m)
    sines = _sines_beside(vertices_m, curves, regions.surfaces)
    return found._replace(vertices_m=vertices_m, curves=curves, sines=sines)


def _without_lost(
    vertices_m: FloatArray, triangles: IntArray, on: IntArray, surfaces: Sequence[Surface], flat_m: float
) -> ExactSurface:
    """Return a surface with its regions and curves, without sines; balls and tori that are none of our features are
    facets.
    """
    # what corners are off surfaces that are known, those of the other triangles are not off theirs
    flat_of_others_m = FLAT * float(np.ptp(vertices_m, axis=0).max()) if surfaces else flat_m
    twins = twins_of(vertices_m, triangles)
    kept = np.array([not (surface.kind in (SPHERE, TORUS) and surface.radius_m < 0.0) for surface in surfaces])
    while True:
        known = np.where(kept[on] & (on >= 0), on, -1)
        regions = regions_on(vertices_m, triangles, twins, surfaces, known, flat_of_others_m)
        curves = curves_of(vertices_m, triangles, twins, regions.of_triangles, regions.surfaces, flat_m)
        lost = {
            regions.surfaces[region]
            for curve in curves
            if curve.kind != ARC
            for region in (curve.left, curve.right)
            if regions.surfaces[region].kind in (SPHERE, TORUS)
        }
        found = ExactSurface(vertices_m, triangles, twins, on, regions, curves, [])
        if not lost:
            balls = [region for region, face in enumerate(regions.surfaces) if face.kind == SPHERE]
            lost = {regions.surfaces[region] for region in balls if not is_within_caps(found, region)}
            tori = [region for region, face in enumerate(regions.surfaces) if face.kind == TORUS]
            lost |= {regions.surfaces[region] for region in tori if tube_part(found, region) is None}
        if not lost:
            return found
        kept &= np.array([surface not in lost for surface in surfaces])


def _sines_beside(vertices_m: FloatArray, curves: Sequence[Curve], surfaces: Sequence[Surface]) -> list[float]:
    """Return what `_sine_beside` does of each curve; of the many short edges between flat facets, all at once."""
    flat = np.array([surface.kind == PLANE for surface in surfaces], bool)
    sines = np.zeros(len(curves))
    sides = np.array([(curve.left, curve.right) for curve in curves], np.int64).reshape(-1, 2)
    short = [k for k, curve in enumerate(curves) if curve.kind == LINE and len(curve.nodes) == 2]
    short = [k for k in short if flat[sides[k]].all()]
    if short:
        normals = np.array([surface.axis for surface in surfaces])[sides[short]]
        start, end = vertices_m[np.array([curves[k].nodes for k in short])].swapaxes(0, 1)
        sines[short] = np.einsum("ij,ij->i", np.cross(normals[:, 0], normals[:, 1]), unit_rows(end - start))
    for index in sorted(set(range(len(curves))) - set(short)):
        sines[index] = _sine_beside(vertices_m, curves[index], surfaces)
    found: list[float] = sines.tolist()
    return found


def _sine_beside(vertices_m: FloatArray, curve: Curve, surfaces: Sequence[Surface]) -> float:
    """Return the least sine between the faces beside a curve, in size, with its sign."""
    start, end = vertices_m[curve.nodes[:-1]], vertices_m[curve.nodes[1:]]
    middles = (start + end) / 2.0
    ways = unit_rows(end - start)
    if curve.kind == ARC:
        middles = curve.at(np.array([0.5]), vertices_m)
        ways = curve.tangent(middles[0])[None]
    one, other = surfaces[curve.left].normals(middles), surfaces[curve.right].normals(middles)
    sines = np.einsum("ij,ij->i", np.cross(one, other), ways)
    return float(sines[np.abs(sines).argmin()]) if (sines > 0.0).all() or (sines < 0.0).all() else 0.0


def _pieces(surface: ExactSurface) -> list[list[Piece]]:
    """Return the pieces around each region, with it to the left."""
    found: list[list[Piece]] = [[] for _ in surface.regions.surfaces]
    for index, curve in enumerate(surface.curves):
        for first, last in pieces_of(curve, surface.vertices_m):
            start, end = int(curve.nodes[first]), int(curve.nodes[last])
            found[curve.left].append(Piece(start, end, index))
            found[curve.right].append(Piece(end, start, index))
    return found


def _edges(surface: ExactSurface, number: int) -> Edges:
    """Return the straight convex edges."""
    starts, ends, planes = list[int](), list[int](), list[tuple[int, int]]()
    for curve in surface.curves:
        if curve.kind != ARC:
            for first, last in pieces_of(curve, surface.vertices_m):
                starts.append(int(curve.nodes[first]))
                ends.append(int(curve.nodes[last]))
                planes.append((curve.left, curve.right))
    begin, end = surface.vertices_m[starts], surface.vertices_m[ends]
    directions = unit_rows(end - begin) if starts else np.zeros((0, 3))
    normals = np.zeros((len(starts), 2, 3))
    for row, (pair, middle) in enumerate(zip(planes, (begin + end) / 2.0, strict=True)):
        for side in range(2):
            normals[row, side] = surface.regions.surfaces[pair[side]].normals(middle[None])[0]
    sines = np.einsum("ij,ij->i", np.cross(normals[:, 0], normals[:, 1]), directions)
    chosen = sines > SMOOTH
    beside = np.array(planes, np.int64).reshape(-1, 2)[chosen]
    parts = np.full(beside.shape, number)
    return Edges(begin[chosen], end[chosen], directions[chosen], normals[chosen], beside, parts)


def _faces(surface: ExactSurface, pieces: Sequence[Sequence[Piece]], number: int) -> tuple[Faces, int]:
    """Return the flat faces, and how many of their borders lead nowhere."""
    flat = [k for k, face in enumerate(surface.regions.surfaces) if face.kind == PLANE]
    normals = np.array([surface.regions.surfaces[k].axis for k in flat]).reshape(-1, 3)
    offsets = np.array([np.dot(surface.regions.surfaces[k].axis, surface.regions.surfaces[k].point_m) for k in flat])
    of = [(face, piece) for face, k in enumerate(flat) for piece in pieces[k]]
    borders = np.zeros(len(of), dtype_of(Border))
    face = np.array([face for face, _ in of], np.int64)
    starts, ends = ([getattr(piece, name) for _, piece in of] for name in ("start", "end"))
    begin, end = surface.vertices_m[starts], surface.vertices_m[ends]
    borders["start"], borders["end"], borders["face"] = begin, end, face
    borders["start_node"], borders["end_node"] = starts, ends
    if len(of) > 0:
        borders["direction"] = unit_rows(end - begin)
        borders["inward"] = np.cross(normals[face], borders["direction"])
    borders["curvature"] = [_curvature(surface, piece, normals[which]) for which, piece in of]
    loops = np.zeros(len(borders), dtype_of(Loop))
    n_loops, n_open = find_loops(normals, borders, loops) if len(of) > 0 else (0, 0)
    loops = loops[:n_loops]
    _, first, of_face = np.unique(borders["face"][loops["first"]], return_index=True, return_inverse=True)
    loops["region"] = first[of_face.reshape(-1)]  # a region hangs together: all of its loops are around one face
    sides = FacePlanes(normals, offsets, np.arange(len(flat)), np.full(len(flat), number))
    return regions_of(sides, borders, loops), n_open


def _curvature(surface: ExactSurface, piece: Piece, normal: FloatArray) -> float:
    """Return the curvature of a piece with its face to the left, see `kernels.union.loops.Border`."""
    curve = surface.curves[piece.curve]
    if curve.kind != ARC or abs(float(normal @ curve.axis)) < IN_PLANE:  # over a facet it rises above that
        return 0.0
    start, end = surface.vertices_m[piece.start], surface.vertices_m[piece.end]
    inward = np.cross(normal, end - start)
    return math.copysign(1.0 / curve.radius_m, float(inward @ (curve.center_m - start)))
