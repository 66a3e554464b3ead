"""The boundary of a union of convex pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.arcs import CONVEX, Arc
from cagepose.kernels.union.candidates import find_pairs
from cagepose.kernels.union.fans import NO_ROOM, find_arcs
from cagepose.kernels.union.lines import empty_fan_work
from cagepose.kernels.union.pieces import Pieces, Plane, find_planes
from cagepose.kernels.union.vertices import find_groups, merge_places, settle_vertices
from cagepose.model.boundary.convex_pieces import ConvexPiece, packed
from cagepose.model.boundary.corners import vertices_of
from cagepose.model.boundary.pieces_apart import boundary_apart
from cagepose.model.boundary.regions import faces_of
from cagepose.model.boundary.trimmed import Edges, TrimmedUnion, joined
from cagepose.model.checks import FloatArray
from cagepose.model.near_pairs import near_pairs

TILT_RAD = 1e-6
"""Faces of different pieces at this angle can be flush: Euler angles are often written with six decimals."""
ALONG = np.array((0.4127, 0.5309, 0.7401))
"""A direction across which few places of ordinary parts lie: the sweep over places goes along it."""
SAME_END_OF_LENGTH = 1e-9
"""Of the shortest edge: an end that is nearer to a vertex is at it."""

Rows = NDArray[np.void]
IntArray = NDArray[np.int64]


def union_of(pieces: Sequence[ConvexPiece], touch_m: float) -> TrimmedUnion:
    """Return the boundary of a union of pieces.

    Parameters
    ----------
    pieces
        At least one. One that is apart from all others comes out as it is, to the last digit of its vertices and
        normals.
    touch_m
        What is this close is at one place, above zero, metres: faces of different pieces whose corners are this close
        to one plane, at an angle of at most `TILT_RAD` to each other, are flush, and lie on the plane of the largest.
    """
    if len(pieces) == 1:
        return boundary_apart(pieces)
    every: Any = packed(pieces)
    groups = np.zeros(len(pieces), np.int64)
    find_groups(np.argsort(every.pieces["low"][:, 0]), touch_m, every, groups)
    firsts, sizes = np.unique(groups, return_counts=True)
    alone = set(firsts[sizes == 1].tolist())
    found = []
    if alone:
        found.append(boundary_apart([pieces[k] for k in sorted(alone)]))
    for first in firsts[sizes > 1].tolist():
        found.append(_of_group([pieces[k] for k in np.flatnonzero(groups == first).tolist()], touch_m))
    return joined(found)


def _of_group(pieces: Sequence[ConvexPiece], touch_m: float) -> TrimmedUnion:
    """Return the boundary of pieces that may meet."""
    rows: Any = packed(pieces)
    planes, n_planes = _planes_of(rows, touch_m, TILT_RAD)
    settle_vertices(touch_m, rows, planes)
    arcs = _arcs_of(rows, planes, n_planes, touch_m)
    places = np.concatenate([rows.vertices, arcs["start"], arcs["end"]])
    keys, nodes = places @ ALONG, np.zeros(len(places), np.int64)
    n_vertices = len(rows.vertices)
    slacks = np.concatenate([np.full(n_vertices, touch_m), *arcs["slacks"].T])
    merge_places(np.argsort(keys), keys, 2.0 * slacks, places, nodes)
    ends = nodes[n_vertices:].reshape(2, -1).T
    arcs["start"], arcs["end"] = places[ends[:, 0]], places[ends[:, 1]]
    is_long = ends[:, 0] != ends[:, 1]
    return _boundary(rows, planes, arcs[is_long], ends[is_long], nodes[:n_vertices], touch_m)


def _boundary(rows: Pieces, planes: Rows, arcs: Rows, ends: IntArray, nodes: IntArray, touch_m: float) -> TrimmedUnion:
    convex = arcs[arcs["kind"] == CONVEX]
    oriented = 2 * convex["planes"] + (convex["sides"] < 0.0)
    of_sides = [rows_of_sides[:, ::-1] for rows_of_sides in (convex["normals"], oriented, convex["parts"])]
    edges = Edges(convex["start"], convex["end"], convex["direction"], *of_sides)
    faces, n_open = faces_of(planes, arcs, ends)
    vertices = vertices_of(rows, planes, nodes, touch_m)
    return TrimmedUnion(replace(vertices, shortest_m=_shortest_at(vertices.places_m, edges)), edges, faces, n_open)


def _shortest_at(places: FloatArray, edges: Edges) -> FloatArray:
    """Return the length of the shortest edge that starts or ends at each place, (n,); inf: none does."""
    lengths = np.linalg.norm(edges.ends_m - edges.starts_m, axis=1)
    everywhere = np.concatenate([places, edges.starts_m, edges.ends_m])
    slack = SAME_END_OF_LENGTH * float(lengths.min(initial=0.0))
    ends = near_pairs(everywhere - slack, everywhere + slack, between=len(places))
    shortest = np.full(len(places), np.inf)
    np.minimum.at(shortest, ends[:, 0], np.tile(lengths, 2)[ends[:, 1] - len(places)])
    return shortest


def _planes_of(rows: Any, touch_m: float, tilt_rad: float) -> tuple[Rows, int]:
    planes = np.zeros(len(rows.faces), dtype_of(Plane))
    order = np.argsort(-rows.faces["reach"], kind="stable")
    n_planes = find_planes(order, touch_m, tilt_rad, rows, planes)
    return planes, n_planes


def _arcs_of(rows: Pieces, planes: Rows, n_planes: int, touch_m: float) -> Rows:
    """Return the runs of material around all lines of two planes."""
    pairs = np.zeros(32 * len(rows.edges), np.int64)
    n_pairs = find_pairs(touch_m, rows, planes, n_planes, pairs)
    if n_pairs > len(pairs):
        pairs = np.zeros(n_pairs, np.int64)
        find_pairs(touch_m, rows, planes, n_planes, pairs)
    pairs = np.unique(pairs[:n_pairs])
    cosines = np.einsum("ij,ij->i", planes["normal"][pairs // n_planes], planes["normal"][pairs % n_planes])
    order = np.argsort(np.abs(cosines), kind="stable")
    middle, reach_m = _ball(rows.vertices)
    work = empty_fan_work(len(rows.pieces), len(rows.faces))
    n_room = 4 * len(rows.edges)
    while True:
        arcs, is_done = np.zeros(n_room, dtype_of(Arc)), np.zeros(len(pairs), np.bool_)
        n_arcs = find_arcs(
            pairs, order, n_planes, tuple(middle.tolist()), reach_m, touch_m, rows, planes, is_done, work, arcs
        )
        if n_arcs != NO_ROOM:
            return arcs[:n_arcs]
        n_room *= 2


def _ball(vertices: FloatArray) -> tuple[FloatArray, float]:
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    return middle, float(np.linalg.norm(vertices - middle, axis=1).max())
