"""The pairwise stability test (R3) and its axes, on plates whose answer can be seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Object, Pose
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.collision.boxes import empty_placed_boxes, place_boxes_at
from cagepose.kernels.collision.turn import key_of_angle
from cagepose.kernels.outcome.trace import NONE, TURN
from cagepose.kernels.stepwise.support import PointLoad, SupportRules, driven_axis, pairwise_stability
from cagepose.model.geometry import boxes_and_points

DOWN = (0.0, 0.0, -1.0)
RULES = SupportRules(1e-3, key_of_angle(math.pi / 10000.0), key_of_angle(1e-9), 1e-6)
TOLERANCES = kernel_tolerances(10.0, 1e-9)
SQUARE = [(1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (-1.0, -1.0, 0.0), (-1.0, 1.0, 0.0)]


def stability(points, load_point, *, direction=DOWN, pose=None, contacts=None):
    """Test a plate 6 x 6 x 1 whose bottom lies on the plane z = 0, loaded at ``load_point``."""
    frame = pose or Pose()
    geometry = boxes_and_points(Object([Box((6, 6, 1))]), Cage(points, pose=frame), [])
    placement = empty_placed_boxes(geometry)
    place_boxes_at(geometry, *(frame @ Pose((0, 0, 0.5))).as_tuples(), placement)
    load = PointLoad(tuple((frame.rotation @ direction).tolist()), tuple(frame.transform(load_point).tolist()))
    chosen = np.arange(len(points)) if contacts is None else np.array(contacts)
    return pairwise_stability(geometry, placement, chosen, len(chosen), load, 2, 3, RULES, TOLERANCES)


@pytest.mark.parametrize("load_point", [(0, 0, 1), (0.9, 0.9, 3), (-0.99, 0.5, 0.1)])
def test_a_load_over_the_support_is_held(load_point):
    step = stability(SQUARE, load_point)
    assert (step.motion, step.rule) == (NONE, 3)


@pytest.mark.parametrize(
    ("load_point", "axis"),
    [((2, 0, 1), (0, 1, 0)), ((-2, 0, 1), (0, -1, 0)), ((0, 2, 1), (-1, 0, 0)), ((0, -2, 1), (1, 0, 0))],
)
def test_a_load_beyond_an_edge_turns_about_that_edge(load_point, axis):
    step = stability([*SQUARE, (2.9, 0, -2), (-2.9, 0, -2), (0, 2.9, -2), (0, -2.9, -2)], load_point, contacts=range(4))
    assert (step.motion, step.rule) == (TURN, 2)
    assert_allclose(step.along, axis, atol=1e-15)


def test_of_two_free_axes_the_one_farther_from_the_load_is_taken():
    """Beyond the corner C1 its two edges are free, C1 blocks the diagonal; C1 C2 is farther from the load."""
    step = stability(SQUARE, (1.5, 2.5, 1))
    assert math.dist((1.5, 2.5), (1, -1)) > math.dist((1.5, 2.5), (-1, 1))
    assert step.motion == TURN
    assert_allclose(step.along, (0, 1, 0), atol=1e-15)


@pytest.mark.parametrize("contacts", [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1]])
def test_equal_sums_take_the_lowest_point_indices_in_whatever_order_they_touched(contacts):
    """Beyond the corner C1, as far from C2 as from C4: C1 C2 wins over C1 C4."""
    step = stability(SQUARE, (2.5, 2.5, 1), contacts=contacts)
    assert_allclose(step.along, (0, 1, 0), atol=1e-15)


def test_the_answer_does_not_depend_on_the_frame():
    rng = np.random.default_rng(4)
    for load_point in ((0.3, 0.2, 1.0), (2.0, 0.4, 1.0)):
        plain = stability(SQUARE, load_point)
        frame = Pose(rng.uniform(-5, 5, 3), rng.normal(size=4))
        turned = stability(SQUARE, load_point, pose=frame)
        assert turned.motion == plain.motion
        assert_allclose(turned.along, frame.rotation @ plain.along, atol=1e-12)


def test_a_driven_axis_turns_with_the_load():
    """A weight at +x of the y axis turns about +y, with moment 2 over the distance sqrt(5)."""
    load = PointLoad(DOWN, (2.0, 0.0, 0.0))
    for one, other in (((0.0, 1.0, 0.0), (0.0, -1.0, 0.0)), ((0.0, -1.0, 0.0), (0.0, 1.0, 0.0))):
        axis, relative_moment = driven_axis(one, other, load, 1e-9)
        assert_allclose(axis, (0, 1, 0))
        assert relative_moment == pytest.approx(2.0 / math.sqrt(5.0), rel=1e-15)


@pytest.mark.parametrize("rounding", [0.0, 1e-15, -1e-15])
def test_a_tie_is_decided_the_same_way_whatever_the_rounding(rounding):
    load = PointLoad(DOWN, (rounding, 0.0, 2.0))
    axis, relative_moment = driven_axis((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), load, 1e-9)
    assert_allclose(axis, (0, 1, 0))
    assert relative_moment < 1e-14
