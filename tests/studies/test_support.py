"""The view along a load: who stands where, and whether the load's line passes within the contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Load, Object, Pose, Scene, run
from cagepose.paper.cases import sample_scene
from cagepose.studies.support import convex_hull, load_view


def test_gravity_along_minus_z_is_seen_from_above():
    view = load_view(run(sample_scene(), method="stepwise"), 0)
    assert_allclose(view.right_world, (1, 0, 0), atol=1e-15)
    assert_allclose(view.up_world, (0, 1, 0), atol=1e-15)


def test_the_samples_centre_of_gravity_lies_in_its_triangle():
    """Triangle (4,4), (-4,4), (-4,-4); the CoG (-0.170615, 1.340603) is (1.340603 + 0.170615)/sqrt(2) off y = x."""
    view = load_view(run(sample_scene(), method="stepwise"), 0)
    assert {tuple(corner) for corner in (view.polygon * 1000).round(9).tolist()} == {(4, 4), (-4, 4), (-4, -4)}
    assert_allclose(view.load_point * 1000, (-0.170615, 1.340603), atol=5e-7)
    assert view.margin_m * 1000 == pytest.approx(1.511218 / math.sqrt(2), abs=1e-6)


@pytest.mark.parametrize(("cog_x_mm", "margin_mm"), [(1.0, 3.0), (-3.0, 1.0)])
def test_the_margin_is_the_distance_from_the_nearest_side(cog_x_mm, margin_mm):
    """A plate on four points at x, y = +-4 mm: 4 mm less |x| to the nearest side, in any frame."""
    frame = Pose(quaternion_wxyz=(0.3, 0.5, -0.2, 0.7))
    held = Object([Box((0.02, 0.02, 0.002))], (cog_x_mm * 1e-3, 0, 0), pose=frame @ Pose((0, 0, 0.001)))
    points = [(0.004, 0.004, 0), (0.004, -0.004, 0), (-0.004, -0.004, 0), (-0.004, 0.004, 0)]
    scene = Scene(held, Cage(points, pose=frame), [Load("weight", gravity=frame.rotation @ (0, 0, -1.0))])
    assert load_view(run(scene, method="stepwise"), 0).margin_m == pytest.approx(margin_mm * 1e-3, abs=1e-9)


def test_the_hull_of_random_points_holds_them_all_and_turns_left():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(60, 2))
    hull = convex_hull(points)
    sides = np.roll(hull, -1, axis=0) - hull
    turns = np.cross(np.c_[sides, np.zeros(len(sides))], np.c_[np.roll(sides, -1, axis=0), np.zeros(len(sides))])
    assert (turns[:, 2] > 0.0).all()
    for corner, side in zip(hull, sides, strict=True):
        to_points = points - corner
        assert (side[0] * to_points[:, 1] - side[1] * to_points[:, 0] >= -1e-12).all()
