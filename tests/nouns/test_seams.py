"""Bridges over seams: they lie within the two boxes, over the whole of their common area."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Pose
from cagepose.nouns.seams import PlacedBox, seam_bridges

TOUCH = 1e-9


def placed(size, position=(0, 0, 0), **orientation):
    pose = Pose(position, **orientation)
    return PlacedBox(np.array(size, dtype=float) / 2.0, pose.position_m, pose.rotation)


def spans(bridge):
    low, high = bridge.position - bridge.half_size, bridge.position + bridge.half_size
    return np.array([low, high]).T


def test_a_block_on_a_plate_is_bridged_over_its_foot():
    """Foot 1 x 2 at x = 1: from the middle of the block's lower half (the plate is 1 thick, the block 3 high)."""
    (bridge,) = seam_bridges([placed((6, 6, 1), (0, 0, -0.5)), placed((1, 2, 3), (1, 0, 1.5))], TOUCH)
    assert_allclose(spans(bridge), [(0.5, 1.5), (-1, 1), (-0.5, 0.5)], atol=1e-12)


def test_an_overhang_is_bridged_only_where_both_are():
    (bridge,) = seam_bridges([placed((2, 2, 2), (0, 0, -1)), placed((2, 2, 2), (1.5, 0, 1))], TOUCH)
    assert_allclose(spans(bridge)[:2], [(0.5, 1.0), (-1, 1)], atol=1e-12)


def test_a_block_turned_about_the_seam_is_bridged_if_it_stands_wholly_on_the_plate():
    plate = placed((6, 6, 1), (0, 0, -0.5))
    turned = placed((1, 2, 3), (1, 0, 1.5), euler_zyx=(0.7, 0, 0))
    (bridge,) = seam_bridges([plate, turned], TOUCH)
    assert_allclose(np.sort(bridge.half_size), np.sort((0.5, 1.0, 0.5)), atol=1e-12)
    assert seam_bridges([plate, placed((1, 2, 3), (3, 0, 1.5), euler_zyx=(0.7, 0, 0))], TOUCH) == []


@pytest.mark.parametrize("apart", [-1e-6, 1e-6])
def test_boxes_that_overlap_or_stand_apart_need_no_bridge(apart):
    assert seam_bridges([placed((2, 2, 2)), placed((2, 2, 2), (2 + apart, 0, 0))], TOUCH) == []


def test_boxes_that_meet_in_an_edge_have_no_common_face():
    assert seam_bridges([placed((2, 2, 2)), placed((2, 2, 2), (2, 2, 0))], TOUCH) == []


def test_a_bridge_is_the_same_seen_from_any_frame():
    rng = np.random.default_rng(1)
    frame = Pose(rng.normal(size=3), rng.normal(size=4))
    boxes = [placed((6, 6, 1), (0, 0, -0.5)), placed((1, 2, 3), (1, 0, 1.5))]
    seen = [PlacedBox(b.half_size, frame.transform(b.position), frame.rotation @ b.rotation) for b in boxes]
    (plain,), (turned,) = seam_bridges(boxes, TOUCH), seam_bridges(seen, TOUCH)
    assert_allclose(turned.half_size, plain.half_size, atol=1e-12)
    assert_allclose(turned.position, frame.transform(plain.position), atol=1e-12)
