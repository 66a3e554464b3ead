"""The boundary of a body within a closed surface of triangles: those that lie in one plane are one face."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.cones import find_cones
from cagepose.kernels.union.flat_regions import THIN, find_flat_regions
from cagepose.kernels.union.loops import NONE, Border, Loop, find_loops
from cagepose.model.boundary.regions import FacePlanes, regions_of
from cagepose.model.boundary.trimmed import Edges, TrimmedUnion, Vertices
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.sides import starts_and_ends, twins_of

SHARP = 1e-9
"""Sine of the angle between faces. Edges of less are smooth."""

IntArray = NDArray[np.int64]


class FlatRegions(NamedTuple):
    """Triangles that hang together and lie in one plane.

    Attributes
    ----------
    of_triangles
        Which region each triangle is in, (m,).
    normals, offsets
        Of each region, the unit normal and normal . x, (n, 3) and (n,).
    parts
        That each region is of, (n,).
    """

    of_triangles: IntArray
    normals: FloatArray
    offsets: FloatArray
    parts: IntArray


class Tangents(NamedTuple):
    """Edges as seen from one of their ends: at which vertex, along which unit vector, whether they are hollow, and of
    which part.
    """

    places: IntArray
    directions: FloatArray
    is_hollow: NDArray[np.bool_]
    parts: IntArray


def union_of_triangles(vertices_m: FloatArray, triangles: IntArray, parts: IntArray, flat_m: float) -> TrimmedUnion:
    """Return the boundary of a body, which need not be convex.

    Corners and edges that lie within faces, and corners that lie within straight edges, are none. Hollow and smooth
    edges are none either, but they bound faces, and the cones of normals at their ends.

    Parameters
    ----------
    vertices_m
        (n, 3), metres.
    triangles
        Of a closed surface, counter-clockwise seen from outside, (m, 3).
    parts
        That each triangle belongs to, (m,).
    flat_m
        What is this near to a plane or a line is in it, metres.
    """
    twins = twins_of(vertices_m, triangles)
    flat = flat_regions(vertices_m, triangles, parts, twins, flat_m)
    starts, ends = starts_and_ends(triangles)
    region = np.repeat(flat.of_triangles, 3)
    is_border = region != region[twins]
    sides = np.flatnonzero(is_border)
    first, last = _joined(vertices_m, sides, starts, ends, region, twins, flat_m)
    own, beside = region[first], region[twins[last]]
    begin, end = starts[first], ends[last]
    directions = unit_rows(vertices_m[end] - vertices_m[begin])
    sine = np.einsum("ij,ij->i", np.cross(flat.normals[own], flat.normals[beside]), directions)
    is_edge = (sine > SHARP) & (first < twins[last])
    planes = np.stack([own, beside], axis=1)[is_edge]
    edges = Edges(
        vertices_m[begin[is_edge]],
        vertices_m[end[is_edge]],
        directions[is_edge],
        flat.normals[planes],
        planes,
        flat.parts[planes],
    )
    borders = np.zeros(len(first), dtype_of(Border))
    borders["start"], borders["end"], borders["direction"] = vertices_m[begin], vertices_m[end], directions
    borders["inward"] = np.cross(flat.normals[own], directions)
    borders["start_node"], borders["end_node"], borders["face"] = begin, end, own
    borders = borders[np.argsort(own, kind="stable")]
    loops = np.zeros(len(borders), dtype_of(Loop))
    n_loops, n_open = find_loops(flat.normals, borders, loops)
    planes_of = FacePlanes(flat.normals, flat.offsets, np.arange(len(flat.normals)), flat.parts)
    faces = regions_of(planes_of, borders, loops[:n_loops])
    shortest = np.full(len(vertices_m), np.inf)
    lengths = np.linalg.norm(edges.ends_m - edges.starts_m, axis=1)
    np.minimum.at(shortest, np.concatenate([begin[is_edge], end[is_edge]]), np.tile(lengths, 2))
    is_none = _is_within_faces(borders, flat.normals, len(vertices_m))
    tangents = Tangents(begin, directions, sine < -SHARP, flat.parts[own])
    corners = cones_at(tangents, vertices_m, shortest, is_none)
    return TrimmedUnion(corners, edges, faces, n_open)


def flat_regions(
    vertices_m: FloatArray, triangles: IntArray, parts: IntArray, twins: IntArray, flat_m: float
) -> FlatRegions:
    """Return the flat regions of a surface; parameters as above.

    They are found twice: from the planes of the largest triangles, and then from those that the first regions have as a
    whole, which tell them better.
    """
    corners = vertices_m[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(areas, axis=1)
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    is_thin = sizes <= THIN * flat_m * longest
    normals = areas / np.maximum(sizes, np.finfo(float).tiny)[:, None]
    middles = corners.mean(axis=1)
    offsets = np.einsum("ij,ij->i", normals, middles)
    beside, (waiting, firsts, found) = twins.reshape(-1, 3) // 3, np.zeros((3, len(triangles)), np.int64)
    order = np.lexsort((-sizes, is_thin))
    for is_last in (False, True):
        n_regions = find_flat_regions(
            order, beside, corners, areas, is_thin, parts, normals, offsets, flat_m, waiting, firsts, found
        )
        seeds = firsts[:n_regions].copy()
        n_of = np.bincount(found, minlength=n_regions)
        if is_last or len(seeds) == len(order):
            break
        total = np.stack([np.bincount(found, areas[:, k], minlength=n_regions) for k in range(3)], axis=1)
        weights = np.einsum("ij,ij->i", areas, normals[seeds][found])
        several = (n_of > 1) & (np.einsum("ij,ij->i", total, normals[seeds]) > 0.0)
        merged, chosen = seeds[several], unit_rows(total[several])
        spans = np.stack([np.bincount(found, weights * middles[:, k], minlength=n_regions) for k in range(3)], axis=1)
        whole = np.bincount(found, weights, minlength=n_regions)
        normals[merged] = chosen
        offsets[merged] = np.einsum("ij,ij->i", chosen, spans[several]) / whole[several]
        by_size = np.argsort(-np.linalg.norm(total, axis=1), kind="stable")
        order = np.concatenate([seeds[by_size], np.setdiff1d(order, seeds)])
    return FlatRegions(found, normals[seeds], offsets[seeds], parts[seeds])


def _joined(
    vertices_m: FloatArray,
    sides: IntArray,
    starts: IntArray,
    ends: IntArray,
    region: IntArray,
    twins: IntArray,
    flat_m: float,
) -> tuple[IntArray, IntArray]:
    """Return the first and the last side of each border, where those that follow each other in a line are joined."""
    by_place = sides[np.argsort(starts[sides], kind="stable")]
    n_out = np.bincount(starts[sides], minlength=len(vertices_m))
    one, other = by_place[n_out[starts[by_place]] == 2].reshape(-1, 2).T  # a single line leads through
    goes_on = (region[one] == region[twins[other]]) & (region[other] == region[twins[one]])
    one, other = one[goes_on], other[goes_on]
    following = np.arange(len(starts))
    following[twins[other]], following[twins[one]] = one, other
    last = _followed(following)
    first_of_chain = np.minimum(twins[last[other]], twins[last[one]])
    start, end = vertices_m[ends[last[other]]], vertices_m[ends[last[one]]]
    lengths = np.maximum(np.linalg.norm(end - start, axis=1), np.finfo(float).tiny)
    ways, arms = (end - start) / lengths[:, None], vertices_m[starts[one]] - start
    along = np.einsum("ij,ij->i", arms, ways)
    off = np.linalg.norm(arms - along[:, None] * ways, axis=1)
    is_bent = (following[last[one]] != last[one]) | (off > flat_m) | (along <= 0.0) | (along >= lengths)
    is_bent = np.isin(first_of_chain, first_of_chain[is_bent])
    following[twins[other[is_bent]]], following[twins[one[is_bent]]] = twins[other[is_bent]], twins[one[is_bent]]
    is_first = np.ones(len(starts), np.bool_)
    is_first[one[~is_bent]] = is_first[other[~is_bent]] = False
    first = sides[is_first[sides]]
    return first, _followed(following)[first]


def _followed(following: IntArray) -> IntArray:
    """Return the last side of each chain, given which side follows each; the last one follows itself."""
    last = following
    for _ in range(len(following).bit_length()):
        further = last[last]
        if (further == last).all():
            break
        last = further
    return last


def _is_within_faces(borders: NDArray[np.void], normals: FloatArray, n_vertices: int) -> NDArray[np.bool_]:
    """Return at which vertices a face takes up more than half a turn, (n_vertices,)."""
    before = np.flatnonzero(borders["following"] != NONE)
    directions, following = np.ascontiguousarray(borders["direction"]), borders["following"][before]
    turns = np.cross(directions[before], directions[following])
    is_hollow = np.einsum("ij,ij->i", turns, normals[borders["face"][before]]) < -SHARP
    found = np.zeros(n_vertices, np.bool_)
    found[borders["end_node"][before[is_hollow]]] = True
    return found


def cones_at(
    tangents: Tangents, vertices_m: FloatArray, shortest_m: FloatArray, is_none: NDArray[np.bool_]
) -> Vertices:
    """Return the convex corners; of each vertex, ``shortest_m`` is the length of the shortest convex edge there, and
    ``is_none`` says that it is no corner.

    All edges lead to one side of a corner's planes, hollow ones too. The body lies to that side if those that bound the
    cone of its normals are convex; at the tip of a pit it lies to the other one.
    """
    if len(tangents.places) == 0:
        empty = np.zeros(0, np.int64)
        return Vertices(np.zeros((0, 3)), empty, empty, np.zeros((0, 3)), np.zeros(0))
    order = np.argsort(tangents.places, kind="stable")
    places, n_tangents = np.unique(tangents.places[order], return_counts=True)
    lasts, directions = np.cumsum(n_tangents), tangents.directions[order]
    room = int(n_tangents.max()) + 3
    is_bound = np.zeros(len(directions), np.bool_)
    find_cones(lasts, directions, np.zeros((2, room, 3)), np.zeros((2, room), np.int64), is_bound)
    firsts = lasts - n_tangents
    is_pit = np.bitwise_or.reduceat(is_bound & tangents.is_hollow[order], firsts)
    n_bounding = np.add.reduceat(is_bound, firsts, dtype=np.int64)
    is_corner = (n_bounding > 0) & ~is_pit & ~is_none[places]
    is_kept = is_bound & np.repeat(is_corner, n_tangents)
    of_part, at = np.minimum.reduceat(tangents.parts[order], firsts), places[is_corner]
    return Vertices(vertices_m[at], of_part[is_corner], n_bounding[is_corner], directions[is_kept], shortest_m[at])
