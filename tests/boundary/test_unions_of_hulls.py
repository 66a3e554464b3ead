"""Unions of hulls that overlap at random, or lie flush with gaps, asked by points beside their faces and edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from boundary.boundary_checks import faces_at, faults_of_surface, n_faces_at
from boundary.drawn_hulls import SIZE_M, cut, drawn_hull, drawn_pieces
from boundary.same_features import differences
from cagepose import Pose
from cagepose.model.boundary.convex_pieces import ConvexPiece, piece_of_hull
from cagepose.model.boundary.trimmed import TrimmedUnion
from cagepose.model.boundary.union import union_of
from cagepose.model.hull import hull_of

FloatArray = NDArray[np.float64]
Cases = Callable[[int, int], int]
TOUCH_M = 1e-9 * SIZE_M
STEP_M = 1e-5 * SIZE_M
N_AROUND = 96


def _overlapping(rng: np.random.Generator) -> list[ConvexPiece]:
    return drawn_pieces(rng, int(rng.integers(2, 7)))


def _flush(rng: np.random.Generator) -> list[ConvexPiece]:
    """About half of the pieces of a hull: edges end on faces, and some pieces share no more than an edge."""
    pieces = cut(drawn_hull(rng), int(rng.integers(4, 12)), rng)
    kept = [(corners, int(rng.integers(2))) for corners in pieces if rng.random() < 0.6]
    return [piece_of_hull(hull_of(corners), Pose(), part) for corners, part in kept] or _flush(rng)


KINDS = {"overlapping": _overlapping, "flush, with gaps": _flush}


class Planes:
    """The planes of the faces of pieces, one piece after the other."""

    def __init__(self, pieces: list[ConvexPiece]) -> None:
        corners = np.concatenate([piece.vertices_m[[face[0] for face in piece.hull.faces]] for piece in pieces])
        self.normals = np.concatenate([piece.normals for piece in pieces])
        self.offsets_m = np.einsum("ij,ij->i", corners, self.normals)
        n_faces = np.array([len(piece.normals) for piece in pieces])
        self.firsts = np.cumsum(n_faces) - n_faces

    def above(self, places: FloatArray) -> FloatArray:
        """How far places (..., 3) are above each plane, (..., n_planes)."""
        return places @ self.normals.T - self.offsets_m

    def outside(self, above: FloatArray) -> FloatArray:
        """How far places are outside of each piece, at least, (..., n_pieces): below zero inside."""
        return np.maximum.reduceat(above, self.firsts, axis=-1)


@pytest.mark.parametrize("kind", KINDS)
def test_a_place_on_a_piece_is_in_a_face_if_the_place_before_it_is_outside_of_all(kind: str, cases: Cases) -> None:
    n_asked = 0
    for case in range(cases(20, 1500)):
        rng = np.random.default_rng((case, 5))
        pieces = KINDS[kind](rng)
        boundary = union_of(pieces, TOUCH_M)
        assert not faults_of_surface(boundary, TOUCH_M), case
        faces = [(piece, face) for piece in pieces for face in piece.hull.faces]
        places = np.array([rng.dirichlet(np.ones(len(face))) @ piece.vertices_m[list(face)] for piece, face in faces])
        planes = Planes(pieces)
        before = planes.outside(planes.above(places + STEP_M * planes.normals))
        is_clear = np.abs(before).min(axis=1) > 0.1 * STEP_M
        n_asked += int(is_clear.sum())
        is_outer = (before > 0.0).all(axis=1)
        n_found = n_faces_at(boundary, places, planes.normals, TOUCH_M)
        assert (n_found == is_outer)[is_clear].all(), case
        for asked in np.flatnonzero(is_clear)[:1]:
            assert len(faces_at(boundary, places[asked], planes.normals[asked], TOUCH_M)) == is_outer[asked], case
    assert n_asked > 0


@pytest.mark.parametrize("kind", KINDS)
def test_convex_edges_are_where_less_than_half_a_ring_around_them_is_inside(kind: str, cases: Cases) -> None:
    n_asked = 0
    for case in range(cases(20, 1500)):
        rng = np.random.default_rng((case, 6))
        pieces = KINDS[kind](rng)
        boundary = union_of(pieces, TOUCH_M)
        edges = boundary.edges
        lines = [(piece.vertices_m[a], piece.vertices_m[b]) for piece in pieces for a, b in piece.hull.edges]
        starts, ends = np.array([*lines, *zip(edges.starts_m, edges.ends_m, strict=True)]).transpose(1, 0, 2)
        places = starts + rng.uniform(0.05, 0.95, (len(starts), 1)) * (ends - starts)
        for place, expected in zip(places, _edges_around(Planes(pieces), places, ends - starts), strict=True):
            if expected is not None:
                n_asked += 1
                assert len(_edges_at(boundary, place)) == expected, case
    assert n_asked > 0


def _edges_around(planes: Planes, places: FloatArray, along: FloatArray) -> list[int | None]:
    """How many runs of less than half a ring around each place are inside; None: that is not clear."""
    first = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    second = np.cross(along, first)
    angles = 2.0 * np.pi * np.arange(N_AROUND) / N_AROUND
    axes = np.stack([ways / np.linalg.norm(ways, axis=1)[:, None] for ways in (first, second)], axis=1)
    rings = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ (axes @ planes.normals.T)
    above = planes.above(places)[:, None]
    solid, wider = ((planes.outside(above + step * rings) < 0.0).any(axis=2) for step in (STEP_M, 10.0 * STEP_M))
    return [
        _sharp_runs(inside) if is_clear else None
        for inside, is_clear in zip(solid, (solid == wider).all(axis=1), strict=True)
    ]


def _sharp_runs(solid: NDArray[np.bool_]) -> int | None:
    """How many runs of places in a ring that are inside are less than half of it; None: that is not clear."""
    changes = np.flatnonzero(solid != np.roll(solid, 1))
    lengths = np.diff(changes, append=changes[:1] + N_AROUND)
    widths = lengths[solid[changes]]
    if lengths.min(initial=N_AROUND) < 4 or (np.abs(widths - N_AROUND / 2) < 4).any():
        return None
    return int((widths < N_AROUND / 2).sum())


def _edges_at(boundary: TrimmedUnion, place: FloatArray) -> list[int]:
    edges = boundary.edges
    arms = place - edges.starts_m
    along = np.einsum("ij,ij->i", arms, edges.directions)
    off = np.linalg.norm(arms - along[:, None] * edges.directions, axis=1)
    lengths = np.linalg.norm(edges.ends_m - edges.starts_m, axis=1)
    return np.flatnonzero((off <= 10.0 * TOUCH_M) & (along > 0.0) & (along < lengths)).tolist()


@pytest.mark.parametrize("kind", KINDS)
def test_the_order_of_pieces_changes_no_feature(kind: str, cases: Cases) -> None:
    for case in range(cases(20, 1500)):
        rng = np.random.default_rng((case, 7))
        pieces = KINDS[kind](rng)
        one = union_of(pieces, TOUCH_M)
        other = union_of([pieces[k] for k in rng.permutation(len(pieces))], TOUCH_M)
        assert not differences(one, other, 1e-9 * SIZE_M), case
