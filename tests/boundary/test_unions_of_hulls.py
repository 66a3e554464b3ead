"""Unions of hulls that overlap at random, or lie flush with gaps, asked by points beside their faces and edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from boundary.boundary_checks import faces_at, faults_of_surface
from boundary.drawn_hulls import SIZE_M, cut, drawn_hull, drawn_pieces
from boundary.same_features import differences
from cagepose import Pose
from cagepose.model.boundary.convex_pieces import ConvexPiece, piece_of_hull
from cagepose.model.boundary.trimmed import TrimmedUnion
from cagepose.model.boundary.union import union_of

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
    return [piece_of_hull(piece, Pose(), int(rng.integers(2))) for piece in pieces if rng.random() < 0.6] or _flush(rng)


KINDS = {"overlapping": _overlapping, "flush, with gaps": _flush}


def _heights(pieces: list[ConvexPiece], places: FloatArray) -> FloatArray:
    """How far places are outside of each piece, at least, (n_pieces, n_places): below zero inside."""
    found = []
    for piece in pieces:
        corners = piece.vertices_m[[face[0] for face in piece.hull.faces]]
        found.append((places @ piece.normals.T - np.einsum("ij,ij->i", corners, piece.normals)).max(axis=1))
    return np.array(found)


@pytest.mark.parametrize("kind", KINDS)
def test_a_place_on_a_piece_is_in_a_face_if_the_place_before_it_is_outside_of_all(kind: str, cases: Cases) -> None:
    n_asked = 0
    for case in range(cases(20, 1500)):
        rng = np.random.default_rng((case, 5))
        pieces = KINDS[kind](rng)
        boundary = union_of(pieces, TOUCH_M)
        assert not faults_of_surface(boundary, TOUCH_M), case
        for piece in pieces:
            for face, normal in zip(piece.hull.faces, piece.normals, strict=True):
                place = rng.dirichlet(np.ones(len(face))) @ piece.vertices_m[list(face)]
                before = _heights(pieces, (place + STEP_M * normal)[None])
                if np.abs(before).min() > 0.1 * STEP_M:
                    n_asked += 1
                    n_expected = int((before > 0.0).all())
                    assert len(faces_at(boundary, place, normal, TOUCH_M)) == n_expected, case
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
        for start, end in [*lines, *zip(edges.starts_m, edges.ends_m, strict=True)]:
            place = start + rng.uniform(0.05, 0.95) * (end - start)
            expected = _edges_around(pieces, place, end - start)
            if expected is not None:
                n_asked += 1
                assert len(_edges_at(boundary, place)) == expected, case
    assert n_asked > 0


def _edges_around(pieces: list[ConvexPiece], place: FloatArray, along: FloatArray) -> int | None:
    """How many runs of less than half a ring around a place are inside; None: that is not clear."""
    first = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    second = np.cross(along, first)
    ring = np.outer(np.cos(angles := 2.0 * np.pi * np.arange(N_AROUND) / N_AROUND), first / np.linalg.norm(first))
    ring += np.outer(np.sin(angles), second / np.linalg.norm(second))
    solid, wider = ((_heights(pieces, place + step * ring) < 0.0).any(axis=0) for step in (STEP_M, 10.0 * STEP_M))
    if (solid != wider).any():
        return None
    begins = np.flatnonzero(solid & ~np.roll(solid, 1))
    widths = [int(np.argmin(np.roll(solid, -begin))) for begin in begins]
    gaps = [int(np.argmax(np.roll(solid, -begin - width))) for begin, width in zip(begins, widths, strict=True)]
    if min([*widths, *gaps], default=N_AROUND) < 4 or any(abs(width - N_AROUND / 2) < 4 for width in widths):
        return None
    return sum(width < N_AROUND / 2 for width in widths)


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
