"""Convex pieces of a body, and the arrays in which kernels take them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.union.pieces import NO_PLANE, Piece, PieceEdge, PieceFace, Pieces
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.volume import BOX_SIGNS

IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ConvexPiece:
    """A convex polyhedron in the frame of its body.

    Attributes
    ----------
    hull
        Its edges and loops of corners; it must have a volume.
    vertices_m
        Its corners, (n, 3), metres.
    normals
        Unit outward normals of its faces, (n_faces, 3).
    part
        Index of the part that it belongs to.
    """

    hull: Hull
    vertices_m: FloatArray
    normals: FloatArray
    part: int


def piece_of_hull(hull: Hull, pose_body_hull: Pose, part: int) -> ConvexPiece:
    """Return a hull that spans a volume as a piece of its body."""
    turn = pose_body_hull.rotation.T
    return ConvexPiece(hull, pose_body_hull.transform(hull.vertices_m), hull.normals @ turn, part)


def piece_of_box(box: Box, part: int) -> ConvexPiece:
    """Return a box as a piece of its body."""
    unit = hull_of(BOX_SIGNS)
    return ConvexPiece(unit, box.corners_object(), unit.normals @ box.pose_object_box.rotation.T, part)


def packed(pieces: Sequence[ConvexPiece]) -> Pieces:
    """Return pieces as kernels take them; their faces have no planes yet."""
    topologies = [_topology_of(piece.hull) for piece in pieces]
    rows = np.zeros(len(pieces), dtype_of(Piece))
    rows["part"] = [piece.part for piece in pieces]
    first_vertex = _spans(rows, "vertex", [len(piece.vertices_m) for piece in pieces])
    _spans(rows, "edge", [len(topology.edges) for topology in topologies])
    first_face = _spans(rows, "face", [len(topology.n_corners) for topology in topologies])
    vertices = np.concatenate([piece.vertices_m for piece in pieces])
    rows["low"] = np.minimum.reduceat(vertices, first_vertex)
    rows["high"] = np.maximum.reduceat(vertices, first_vertex)
    edges = np.zeros(rows["last_edge"][-1], dtype_of(PieceEdge))
    shifts = np.stack([first_vertex, first_vertex, first_face, first_face], axis=1)
    of_edges = np.concatenate([topology.edges + shift for topology, shift in zip(topologies, shifts, strict=True)])
    edges["start"], edges["end"], edges["left"], edges["right"] = of_edges.T
    corners = np.concatenate([topology.corners + v for topology, v in zip(topologies, first_vertex, strict=True)])
    return Pieces(rows, vertices, edges, _faces(pieces, topologies, vertices, corners), corners)


def _faces(
    pieces: Sequence[ConvexPiece], topologies: Sequence[_Topology], vertices: FloatArray, corners: IntArray
) -> NDArray[np.void]:
    n_corners = np.concatenate([topology.n_corners for topology in topologies])
    faces = np.zeros(len(n_corners), dtype_of(PieceFace))
    last = np.cumsum(n_corners)
    faces["first_corner"], faces["last_corner"], faces["plane"] = last - n_corners, last, NO_PLANE
    faces["piece"] = np.repeat(np.arange(len(pieces)), [len(topology.n_corners) for topology in topologies])
    faces["normal"] = np.concatenate([piece.normals for piece in pieces])
    around = vertices[corners]
    faces["middle"] = np.add.reduceat(around, last - n_corners) / n_corners[:, None]
    away = np.linalg.norm(around - np.repeat(faces["middle"], n_corners, axis=0), axis=1)
    faces["reach"] = np.maximum.reduceat(away, last - n_corners)
    return faces


def _spans(rows: NDArray[np.void], name: str, counts: Sequence[int]) -> IntArray:
    """Write which rows are whose; return the first of each piece."""
    last = np.cumsum(np.array(counts, np.int64))
    first: IntArray = last - counts
    rows[f"first_{name}"], rows[f"last_{name}"] = first, last
    return first


@dataclass(frozen=True, eq=False)
class _Topology:
    """Edges (start, end, left, right) of a hull, its loops one behind the other, and how long each is."""

    edges: IntArray
    corners: IntArray
    n_corners: IntArray


@lru_cache(maxsize=64)
def _topology_of(hull: Hull) -> _Topology:
    left: dict[tuple[int, int], int] = {}
    for index, loop in enumerate(hull.faces):
        left.update(dict.fromkeys(zip(loop, (*loop[1:], loop[0]), strict=True), index))
    edges = [(start, end, left[start, end], left[end, start]) for start, end in hull.edges.tolist()]
    corners = [corner for loop in hull.faces for corner in loop]
    n_corners = [len(loop) for loop in hull.faces]
    return _Topology(np.array(edges, np.int64), np.array(corners, np.int64), np.array(n_corners, np.int64))
