"""Bridges over seams: they lie within the two boxes, over the whole of their common area."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Pose
from cagepose.model.seams import PlacedBox, close_seams

TOUCH = 1e-9


def placed(size, position=(0, 0, 0), **orientation):
    pose = Pose(position, **orientation)
    return PlacedBox(np.array(size, dtype=float) / 2.0, pose.position_m, pose.rotation)


def bridges_of(boxes, touch_m):
    return close_seams(boxes, touch_m).bridges


def spans(bridge):
    low, high = bridge.position - bridge.half_size, bridge.position + bridge.half_size
    return np.array([low, high]).T


def test_a_block_on_a_plate_is_bridged_over_its_foot():
    """Foot 1 x 2 at x = 1: from the middle of the block's lower half (the plate is 1 thick, the block 3 high)."""
    (bridge,) = bridges_of([placed((6, 6, 1), (0, 0, -0.5)), placed((1, 2, 3), (1, 0, 1.5))], TOUCH)
    assert_allclose(spans(bridge), [(0.5, 1.5), (-1, 1), (-0.5, 0.5)], atol=1e-12)


def test_an_overhang_is_bridged_only_where_both_are():
    (bridge,) = bridges_of([placed((2, 2, 2), (0, 0, -1)), placed((2, 2, 2), (1.5, 0, 1))], TOUCH)
    assert_allclose(spans(bridge)[:2], [(0.5, 1.0), (-1, 1)], atol=1e-12)


def test_a_block_turned_about_the_seam_is_bridged_if_it_stands_wholly_on_the_plate():
    plate = placed((6, 6, 1), (0, 0, -0.5))
    turned = placed((1, 2, 3), (1, 0, 1.5), euler_zyx=(0.7, 0, 0))
    (bridge,) = bridges_of([plate, turned], TOUCH)
    assert_allclose(np.sort(bridge.half_size), np.sort((0.5, 1.0, 0.5)), atol=1e-12)
    assert bridges_of([plate, placed((1, 2, 3), (3, 0, 1.5), euler_zyx=(0.7, 0, 0))], TOUCH) == []


@pytest.mark.parametrize("apart", [-1e-6, 1e-6])
def test_boxes_that_overlap_or_stand_apart_need_no_bridge(apart):
    assert bridges_of([placed((2, 2, 2)), placed((2, 2, 2), (2 + apart, 0, 0))], TOUCH) == []


def test_boxes_that_meet_in_an_edge_have_no_common_face():
    assert bridges_of([placed((2, 2, 2)), placed((2, 2, 2), (2, 2, 0))], TOUCH) == []


def test_a_bridge_is_the_same_seen_from_any_frame():
    rng = np.random.default_rng(1)
    frame = Pose(rng.normal(size=3), rng.normal(size=4))
    boxes = [placed((6, 6, 1), (0, 0, -0.5)), placed((1, 2, 3), (1, 0, 1.5))]
    seen = [PlacedBox(b.half_size, frame.transform(b.position), frame.rotation @ b.rotation) for b in boxes]
    (plain,), (turned,) = bridges_of(boxes, TOUCH), bridges_of(seen, TOUCH)
    assert_allclose(turned.half_size, plain.half_size, atol=1e-12)
    assert_allclose(turned.position, frame.transform(plain.position), atol=1e-12)


@pytest.mark.parametrize("tilt", [1e-12, 1e-8, 1e-6])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_bridge_between_boxes_that_are_hardly_parallel_stays_within_them(tilt, axis):
    """Euler angles with six decimals are good to 1e-8 rad; a bridge that stuck out would be a false surface."""
    angles = np.zeros(3)
    angles[axis] = tilt
    boxes = [placed((10, 10, 10), (-5, 0, 0)), placed((10, 10, 10), (5, 0, 0), euler_zyx=angles)]
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    for bridge in bridges_of(boxes, TOUCH):
        corners = bridge.position + (signs * bridge.half_size) @ bridge.rotation.T
        gaps = [(np.abs((corners - box.position) @ box.rotation) - box.half_size).max(axis=1) for box in boxes]
        assert np.min(gaps, axis=0).max() <= 1e-11


def test_a_block_whose_outline_crosses_that_of_its_plates_is_told():
    """It stands over the joint of two plates, turned by 30 deg: no bridge lies within it and one of them."""
    plates = [placed((20, 40, 4), (-10, 0, -2)), placed((20, 40, 4), (10, 0, -2))]
    block = placed((10, 10, 6), (0, 0, 3), euler_zyx=(np.pi / 6, 0, 0))
    assert close_seams([*plates, block], TOUCH).open_pairs == [(0, 2), (1, 2)]
    assert close_seams([placed((40, 40, 4), (0, 0, -2)), block], TOUCH).open_pairs == []


def test_a_grid_of_blocks_keeps_only_the_bridges_that_it_needs():
    grid = [placed((1, 1, 1), (x, y, z)) for x in range(3) for y in range(3) for z in range(2)]
    bridges = bridges_of(grid, TOUCH)
    for outer in bridges:
        for inner in bridges:
            apart = np.abs(inner.position - outer.position) + inner.half_size - outer.half_size
            assert inner is outer or apart.max() > 1e-12
