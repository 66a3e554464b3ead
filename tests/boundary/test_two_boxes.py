"""Two or three boxes, by hand: what is flush is one, and what only touches along an edge or in a place is two."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.boundary_checks import faces_at, faults_of_surface
from cagepose import Box, Pose
from cagepose.model.boundary.convex_pieces import piece_of_box
from cagepose.model.boundary.trimmed import TrimmedUnion
from cagepose.model.boundary.union import union_of

TOUCH_M = 1e-9
SHIFTS_M = (0.0, 1e-14, -1e-14, 1e-12, -1e-12, 3e-10, -3e-10)


def _union(*boxes: tuple[tuple[float, ...], tuple[float, ...]], parts: tuple[int, ...] | None = None) -> TrimmedUnion:
    """Of boxes from one corner to the opposite one, of one part or of the parts given."""
    blocks = [Box(np.subtract(high, low), Pose(np.add(low, high) / 2.0)) for low, high in boxes]
    owners = parts or (0,) * len(blocks)
    found = union_of([piece_of_box(block, part) for block, part in zip(blocks, owners, strict=True)], TOUCH_M)
    assert not faults_of_surface(found, TOUCH_M)
    return found


def _counts(boundary: TrimmedUnion) -> tuple[int, int, int]:
    return len(boundary.vertices.places_m), len(boundary.edges.starts_m), len(boundary.faces.normals)


UNIT = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


@pytest.mark.parametrize("shift", SHIFTS_M)
def test_flush_boxes_of_one_size_are_one_box(shift: float) -> None:
    assert _counts(_union(UNIT, ((1.0 + shift, shift, -shift), (2.0, 1.0, 1.0)))) == (8, 12, 6)


@pytest.mark.parametrize("shift", SHIFTS_M)
def test_a_box_inside_another_is_no_feature(shift: float) -> None:
    for low in (0.25, shift):  # clear of the faces, and with three faces on them
        assert _counts(_union(UNIT, ((low,) * 3, (0.75,) * 3))) == (8, 12, 6)


@pytest.mark.parametrize("shift", SHIFTS_M)
def test_boxes_that_share_an_edge_have_two_edges_there(shift: float) -> None:
    found = _union(UNIT, ((1.0 + shift, 1.0, 0.0), (2.0, 2.0, 1.0)))
    vertical = np.abs(found.edges.directions[:, 2]) > 0.5
    at_line = np.abs(found.edges.starts_m[:, :2] - 1.0).max(axis=1) < TOUCH_M
    assert np.count_nonzero(vertical & at_line) == 2
    assert _counts(found)[0] == 12, "material lies along both senses at the ends of the edge: no vertices"
    assert len(found.edges.starts_m) == 24


@pytest.mark.parametrize("shift", SHIFTS_M)
def test_boxes_that_share_a_vertex_have_none_there(shift: float) -> None:
    found = _union(UNIT, ((1.0 + shift, 1.0, 1.0), (2.0, 2.0, 2.0)))
    assert _counts(found) == (14, 24, 12)


@pytest.mark.parametrize("shift", SHIFTS_M)
def test_a_flush_box_on_the_middle_of_edges_leaves_their_ends(shift: float) -> None:
    found = _union(UNIT, ((1.0 + shift, 0.25, 0.0), (2.0, 0.75, 1.0)))
    n_of_length = {1.0: 4 + 4 + 2 + 4 + 2, 0.25: 4, 0.5: 2}
    assert _counts(found) == (12, sum(n_of_length.values()), 5 + 2 + 1 + 2)
    lengths = np.linalg.norm(found.edges.ends_m - found.edges.starts_m, axis=1).round(6)
    assert {length: np.count_nonzero(lengths == length) for length in n_of_length} == n_of_length
    on_line = np.abs(found.vertices.places_m - (1.0, 0.25, 0.0)).max(axis=1) < 1e-6
    assert not on_line.any(), "a concave edge leads on there"


def test_each_part_keeps_its_own_region_of_a_flush_face() -> None:
    found = _union(UNIT, ((1.0, 0.0, 0.0), (3.0, 1.0, 1.0)), parts=(7, 2))
    up = found.faces.normals[:, 2] > 0.5
    assert sorted(found.faces.parts[up]) == [2, 7]
    assert len({*found.faces.planes[up].tolist()}) == 1
    assert found.faces.is_convex.all()
    along = np.abs(found.edges.directions[:, 0]) > 0.5
    assert sorted(map(tuple, found.edges.parts[along].tolist())) == [(2, 2)] * 4 + [(7, 7)] * 4
    for x, part in ((0.5, 7), (2.0, 2)):
        (face,) = faces_at(found, np.array((x, 0.5, 1.0)), np.array((0.0, 0.0, 1.0)), TOUCH_M)
        assert found.faces.parts[face] == part


def test_where_two_parts_have_a_face_in_common_it_is_the_first_ones() -> None:
    found = _union(((0.0, 0.0, 0.0), (2.0, 1.0, 1.0)), ((1.0, 0.0, 0.0), (3.0, 1.0, 1.0)), parts=(1, 0))
    for x, part in ((0.5, 1), (1.5, 0), (2.5, 0)):
        (face,) = faces_at(found, np.array((x, 0.5, 1.0)), np.array((0.0, 0.0, 1.0)), TOUCH_M)
        assert found.faces.parts[face] == part


def test_a_face_with_a_block_on_it_has_an_inner_loop_and_is_not_convex() -> None:
    found = _union(UNIT, ((0.25, 0.25, 0.5), (0.75, 0.75, 2.0)))
    top = found.faces.normals[:, 2] > 0.5
    assert sorted(found.faces.n_borders[top].tolist()) == [4, 8]
    assert found.faces.is_convex[top].tolist() == [n == 4 for n in found.faces.n_borders[top].tolist()]
    up = np.array((0.0, 0.0, 1.0))
    at = {x: len(faces_at(found, np.array((x, 0.5, 1.0)), up, TOUCH_M)) for x in (0.1, 0.25, 0.5, 0.75, 1.0, 1.1)}
    assert at == {0.1: 1, 0.25: 1, 0.5: 0, 0.75: 1, 1.0: 1, 1.1: 0}


@pytest.mark.parametrize("tilt", [1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 5e-7])
def test_boxes_turned_by_the_rounding_of_an_angle_are_flush(tilt: float) -> None:
    pose = Pose((1.5, 0.5, 0.5), euler_zyx=(tilt, -tilt, tilt / 2.0))
    pieces = [piece_of_box(Box((1.0, 1.0, 1.0), at), 0) for at in (Pose((0.5, 0.5, 0.5)), pose)]
    found = union_of(pieces, TOUCH_M)
    assert not faults_of_surface(found, TOUCH_M)
    assert _counts(found) == (8, 12, 6)
