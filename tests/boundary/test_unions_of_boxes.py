"""Unions of boxes with whole-numbered corners against a grid of cells: turned, shifted, up to 60 of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from boundary.boundary_checks import areas, faces_at, faults_of_surface, n_faces_at, volume
from boundary.box_grid import Box, cells_of, drawn_boxes, edges_of, n_regions, squares_of, vertices_of
from cagepose import Box as Block
from cagepose import Pose
from cagepose.model.boundary.convex_pieces import piece_of_box
from cagepose.model.boundary.trimmed import TrimmedUnion
from cagepose.model.boundary.union import union_of
from cagepose.model.volume import union_moments

CELL_M = 0.0137
TOUCH_M = 1e-10
Cases = Callable[[int, int], int]
KINDS = {
    "along the axes": (2, 9, 5, False, 0.0),
    "turned": (2, 9, 5, True, 0.0),
    "turned, edge on edge": (2, 9, 3, True, 0.0),
    "turned, shifted by 1e-14 m": (2, 9, 3, True, 1e-14),
    "turned, shifted by 1e-13 m": (2, 9, 4, True, 1e-13),
    "turned, shifted by 1e-12 m": (2, 9, 3, True, 1e-12),
    "up to 60": (10, 61, 9, True, 1e-13),
}
"""Least and greatest number of boxes, cells along each axis, whether they are turned, and shifts."""


def _blocks(rng: np.random.Generator, boxes: list[Box], turn: Pose, shift_m: float) -> list[Block]:
    blocks = []
    for low, high in boxes:
        middle = turn.transform((np.array(low) + high) / 2.0 * CELL_M) + shift_m * rng.standard_normal(3)
        blocks.append(Block((np.array(high) - low) * CELL_M, Pose(middle, turn.quaternion_wxyz)))
    return blocks


def _on_grid(places_m: np.ndarray, turn: Pose, slack_m: float) -> list[tuple[int, ...]]:
    """Places as whole numbers of cells; they must be whole within the slack."""
    cells = turn.inverse_transform(places_m) / CELL_M
    whole = np.round(cells)
    assert np.abs(cells - whole).max(initial=0.0) <= slack_m / CELL_M
    return [tuple(place) for place in whole.astype(int).tolist()]


def _axes(vectors: np.ndarray, turn: Pose) -> list[tuple[int, ...]]:
    along = vectors @ turn.rotation
    assert np.abs(along - np.round(along)).max(initial=0.0) <= 1e-9
    return [tuple(vector) for vector in np.round(along).astype(int).tolist()]


def _edges(boundary: TrimmedUnion, turn: Pose, slack_m: float) -> list[tuple[tuple[int, ...], ...]]:
    edges = boundary.edges
    starts, ends = _on_grid(edges.starts_m, turn, slack_m), _on_grid(edges.ends_m, turn, slack_m)
    first, second = (_axes(edges.normals[:, k], turn) for k in (0, 1))
    return [
        (*sorted((start, end)), *sorted((one, other)))
        for start, end, one, other in zip(starts, ends, first, second, strict=True)
    ]


def _wrong(boundary: TrimmedUnion, boxes: list[Box], blocks: list[Block], turn: Pose, slack_m: float) -> list[str]:
    """What differs from the grid of cells."""
    cells, faults = cells_of(boxes), faults_of_surface(boundary, TOUCH_M)
    found = _edges(boundary, turn, slack_m)
    if len(found) != len({*found}) or {*found} != edges_of(cells):
        faults.append("edges")
    places = _on_grid(boundary.vertices.places_m, turn, slack_m)
    if len(places) != len({*places}) or {*places} != vertices_of(cells):
        faults.append("vertices")
    squares = squares_of(cells)
    if len(boundary.faces.normals) != n_regions(squares):
        faults.append("regions")
    if abs(areas(boundary).sum() / CELL_M**2 - len(squares)) > 1e-8 * len(squares):
        faults.append("area")
    axes, senses, full = (np.array(column) for column in zip(*squares, strict=True))
    normals = senses[:, None] * turn.rotation.T[axes]
    places = turn.transform((full - 0.5 + 0.5 * senses[:, None] * np.eye(3)[axes]) * CELL_M)
    if (n_faces_at(boundary, places, normals, TOUCH_M) != 1).any():
        faults.append("a square of the surface is not in one face")
    if len(faces_at(boundary, places[0], normals[0], TOUCH_M)) != 1:
        faults.append("a square of the surface is not in one face to the kernel")
    moments = union_moments(
        np.array([block.size_m for block in blocks]) / 2.0,
        np.array([block.pose_object_box.position_m for block in blocks]),
        np.array([block.pose_object_box.rotation for block in blocks]),
    )
    if abs(volume(boundary) / moments.volume_m3 - 1.0) > 1e-8:
        faults.append("volume")
    return faults


@pytest.mark.parametrize("kind", KINDS)
def test_a_union_of_boxes_is_what_a_grid_of_cells_says(kind: str, cases: Cases) -> None:
    least, greatest, size, is_turned, shift_m = KINDS[kind]
    n_cases = cases(6, 400) if greatest > 20 else cases(40, 5000)
    for case in range(n_cases):
        rng = np.random.default_rng((case, len(kind)))
        boxes = drawn_boxes(rng, int(rng.integers(least, greatest)), size)
        turn = Pose((0.0, 0.0, 0.0), rng.standard_normal(4)) if is_turned else Pose()
        blocks = _blocks(rng, boxes, turn, shift_m)
        boundary = union_of([piece_of_box(block, 0) for block in blocks], TOUCH_M)
        assert not _wrong(boundary, boxes, blocks, turn, 1e-15 + 1e-15 * bool(is_turned) + 20 * shift_m), case
