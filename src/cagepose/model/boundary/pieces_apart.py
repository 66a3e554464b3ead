"""The boundary of pieces that are all apart: their own vertices, edges and faces, written in their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.loops import Border
from cagepose.model.boundary.convex_pieces import ConvexPiece
from cagepose.model.boundary.trimmed import Edges, Faces, TrimmedUnion, Vertices
from cagepose.model.checks import FloatArray, unit_rows

IntArray = NDArray[np.int64]
Loops = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, eq=False)
class _Plan:
    """Which numbers of a convex polyhedron its features are made of: the same for all with such edges and faces.

    Attributes
    ----------
    edges
        Start, end, the face to the left and that to the right of each, (n_edges, 4).
    leaving
        The edges at one vertex after another, and whether they start there, (n, 2).
    n_leaving
        How many there are at each vertex.
    borders
        The edges around one face after another, in the order of its loop, and whether it is to their left, (n, 2).
    corners
        The vertices around one face after another, in the order of the hull.
    n_borders
        How many each face has, of both.
    """

    edges: IntArray
    leaving: IntArray
    n_leaving: IntArray
    borders: IntArray
    corners: IntArray
    n_borders: IntArray


@lru_cache(maxsize=64)
def _plan_of(n_vertices: int, edges: bytes, faces: Loops) -> _Plan:
    pairs = [tuple(pair) for pair in np.frombuffer(edges, np.int64).reshape(-1, 2).tolist()]
    sides = [list(zip(loop, (*loop[1:], loop[0]), strict=True)) for loop in faces]
    left = {side: index for index, loop in enumerate(sides) for side in loop}
    of_pair = {pair: index for index, pair in enumerate(pairs)}
    leaving = [
        [(index, int(pair[0] == vertex)) for index, pair in enumerate(pairs) if vertex in pair]
        for vertex in range(n_vertices)
    ]
    borders = []
    for loop in sides:
        around = [(of_pair[side], 1) if side in of_pair else (of_pair[side[::-1]], 0) for side in loop]
        first = around.index(min(around))
        borders.append(around[first:] + around[:first])
    return _Plan(
        np.array([(start, end, left[start, end], left[end, start]) for start, end in pairs], np.int64),
        np.array([one for each in leaving for one in each], np.int64),
        np.array([len(each) for each in leaving], np.int64),
        np.array([one for each in borders for one in each], np.int64),
        np.array([corner for loop in faces for corner in loop], np.int64),
        np.array([len(each) for each in borders], np.int64),
    )


def boundary_apart(pieces: Sequence[ConvexPiece]) -> TrimmedUnion:
    """Return the boundary of pieces that are all apart: plans say what their numbers are for, so nothing is sought."""
    plans = [_plan_of(len(each.vertices_m), each.hull.edges.tobytes(), each.hull.faces) for each in pieces]
    n_vertices, n_edges, n_faces = (
        np.cumsum([0, *counts])
        for counts in (
            [len(piece.vertices_m) for piece in pieces],
            [len(plan.edges) for plan in plans],
            [len(plan.n_borders) for plan in plans],
        )
    )
    places = np.concatenate([piece.vertices_m for piece in pieces])
    normals = np.concatenate([piece.normals for piece in pieces])
    numbers = np.array([piece.part for piece in pieces])
    start, end, left, right = np.concatenate(
        [plan.edges + np.array((v, v, f, f)) for plan, v, f in zip(plans, n_vertices[:-1], n_faces[:-1], strict=True)]
    ).T
    leaving, is_start = _shifted([plan.leaving for plan in plans], n_edges)
    borders, is_left = _shifted([plan.borders for plan in plans], n_edges)
    n_leaving = np.concatenate([plan.n_leaving for plan in plans])
    n_borders = np.concatenate([plan.n_borders for plan in plans])
    starts, ends = places[start], places[end]
    chords = ends - starts
    lengths, directions = np.linalg.norm(chords, axis=1), unit_rows(chords)
    part_of_edge = np.repeat(numbers, np.diff(n_edges))
    edges = Edges(
        starts,
        ends,
        directions,
        np.stack([normals[left], normals[right]], axis=1),
        2 * np.stack([left, right], axis=1),
        np.stack([part_of_edge] * 2, axis=1),
    )
    vertices = Vertices(
        places,
        np.repeat(numbers, np.diff(n_vertices)),
        n_leaving,
        _tangents(normals[left], normals[right], chords)[leaving] * np.where(is_start, 1.0, -1.0)[:, None],
        np.minimum.reduceat(lengths[leaving], np.cumsum(n_leaving) - n_leaving),
    )
    face_of_border = np.repeat(np.arange(len(normals)), n_borders)
    rows = np.zeros(len(borders), dtype_of(Border))
    is_along = is_left.astype(np.bool_)[:, None]
    rows["start"] = np.where(is_along, starts[borders], ends[borders])
    rows["end"] = np.where(is_along, ends[borders], starts[borders])
    rows["direction"] = np.where(is_along, directions[borders], -directions[borders])
    rows["inward"] = _cross(normals[face_of_border], directions[borders]) * np.where(is_along, 1.0, -1.0)
    rows["start_node"] = np.where(is_left, start[borders], end[borders])
    rows["end_node"] = np.where(is_left, end[borders], start[borders])
    rows["face"] = face_of_border
    first = np.cumsum(n_borders) - n_borders
    corners = np.concatenate([plan.corners + v for plan, v in zip(plans, n_vertices[:-1], strict=True)])
    middles = np.add.reduceat(places[corners], first) / n_borders[:, None]
    faces = Faces(
        normals,
        np.einsum("ij,ij->i", normals, middles),
        2 * np.arange(len(normals)),
        np.repeat(numbers, np.diff(n_faces)),
        np.ones(len(normals), np.bool_),
        n_borders,
        rows,
    )
    return TrimmedUnion(vertices, edges, faces, 0)


def _shifted(indices: Sequence[IntArray], n_before: IntArray) -> tuple[IntArray, IntArray]:
    """Return the two columns of indices, the first of them among those of all pieces."""
    counts = [len(each) for each in indices]
    which, flags = np.concatenate(indices).T
    return which + np.repeat(n_before[:-1], counts), flags


def _tangents(left: FloatArray, right: FloatArray, chords: FloatArray) -> FloatArray:
    """Return unit vectors along edges in which faces with these normals cross, (n, 3)."""
    along = _cross(left, right)
    x, y, z = along.T
    sense = np.copysign(1.0, x * chords[:, 0] + y * chords[:, 1] + z * chords[:, 2])
    found: FloatArray = along * (sense / np.sqrt(x * x + y * y + z * z))[:, None]
    return found


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the cross products of rows, (n, 3): as NumPy's, in half the time."""
    (a, b, c), (x, y, z) = one.T, other.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)
