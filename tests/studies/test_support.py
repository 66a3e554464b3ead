"""The view along a load: who stands where, and whether the load's line passes within the contacts."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from audit.caged_families import pushed_block
from audit.families import make_case
from cagepose import Box, Cage, Load, Object, Pose, Scene, load_scene, run
from cagepose.model.shapes import Capsule, Cylinder
from cagepose.paper.cases import sample_scene
from cagepose.runs.judge import judge_pose
from cagepose.studies.support import convex_hull, load_view
from cagepose.studies.support_region import support_region
from cagepose.studies.tolerances import DISTANCE_OF_CORNER
from mapped_scenes import mapped


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


def region_of(a_run, phase=0):
    view = load_view(a_run, phase)
    found = support_region(a_run, phase, view, 10.0)
    assert found is not None
    return view, found


def test_on_level_ground_without_friction_the_support_region_is_the_polygon_of_the_contacts():
    held = Object([Box((0.1, 0.08, 0.02))], (0.005, -0.01, 0.0), pose=Pose((0, 0, 0.01)))
    points = [(0.04, 0.03, 0), (-0.03, 0.035, 0), (-0.045, -0.02, 0), (0.01, -0.03, 0), (0.0, 0.0, 0)]
    view, found = region_of(run(Scene(held, Cage(points), [Load("weight", gravity=(0, 0, -1))])))
    assert_allclose(found.corners, view.polygon, atol=1e-9)
    assert found.margin_m == pytest.approx(view.margin_m, abs=1e-9)


def test_a_ladder_may_be_climbed_up_to_where_its_ends_slip():
    """Points at the foot (x = 0.5) and the head (x = -0.5, 1.732 above), both rough: N = 1 / (1 + mu^2) below, mu N at
    the head. Moments about the foot: the weight goes as far as mu N (1.732 + mu 1.0) away from it.
    """
    scene = load_scene(Path(__file__).parents[2] / "scenes" / "ladder.yaml")
    mu, height = scene.friction_coefficient, 2 * 0.8660254037844386
    away = mu / (1 + mu * mu) * (height + mu * 1.0)
    view, found = region_of(run(scene))
    x, y = found.corners.T
    assert (x.max(), x.min()) == pytest.approx((0.5, 0.5 - away), rel=1e-5)
    assert (y.max(), y.min()) == pytest.approx((0.18, -0.18), rel=1e-5)
    assert found.margin_m == pytest.approx(view.load_point[0] - x.min(), rel=1e-4)


def test_a_plate_with_holes_is_supported_within_its_three_rests():
    """At (-30, 40), (-30, -40) and (50, 0) mm; the longer sides pass 2000 / sqrt(8000) mm from the middle."""
    view, found = region_of(run(load_scene(Path(__file__).parents[2] / "scenes" / "plate-on-pins.yaml")))
    assert sorted((found.corners * 1000).round(6).tolist()) == [[-30, -40], [-30, 40], [50, 0]]
    assert found.margin_m * 1000 == pytest.approx(2000 / math.sqrt(8000), abs=1e-6)
    assert_allclose(view.load_point, 0.0, atol=1e-12)


def test_a_bar_that_sticks_out_between_two_rollers_is_supported_ahead_of_them():
    """Rollers below at x = 100 mm and above at x = -100, as wide as the bar, 20 mm to each side. A weight at x presses
    on them with (x + 100) / 200 and (x - 100) / 200, which bears it as far as 20 (F + G) = 0.2 x to the side.
    """
    rollers = [
        Capsule(0.008, 0.06, Pose(place, euler_zyx=(0, 0, math.pi / 2)))
        for place in ((0.1, 0, -0.013), (-0.1, 0, 0.013))
    ]
    bar = Object([Box((0.4, 0.04, 0.01))], (0.13, 0, 0))
    scene = Scene(bar, Cage(shapes=rollers), [Load("weight", gravity=(0, 0, -1))])
    _, found = region_of(run(scene))
    assert found.margin_m == pytest.approx(0.2 * 0.13 / math.sqrt(1.04), rel=1e-6)
    x, y = found.corners.T
    assert_allclose(x.min(), 0.1, rtol=1e-6)
    assert_allclose(np.sort(y[x < 0.1 + 1e-9]), (-0.02, 0.02), rtol=1e-6)


def test_corners_of_a_region_without_end_are_as_near_to_it_as_is_told(monkeypatch):
    """A plate pinched by three points on a slope of 40 deg; its round edge by three times as many directions."""
    turned = Pose(euler_zyx=(0, math.radians(40), 0))
    cage = Cage([(0.03, 0.02, -0.01), (0.03, -0.02, -0.01), (-0.03, 0.0, 0.01)], pose=turned)
    plate, loads = Object([Box((0.2, 0.1, 0.02))], (0.05, 0, 0), pose=turned), [Load("weight", gravity=(0, 0, -1))]
    slides = Scene(plate, cage, loads, friction_coefficient=0.3)
    pinched = replace(run(Scene(plate, cage, loads, friction_coefficient=5.0)), scene=slides)
    view, found = region_of(pinched)
    monkeypatch.setattr("cagepose.studies.support_region.N_DIRECTIONS", 360)
    finer = region_of(pinched)[1].corners - view.load_point
    sides = np.roll(finer, -1, axis=0) - finer
    outward = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1)[:, None]
    corners = found.corners - view.load_point
    near = corners[np.linalg.norm(corners, axis=1) < 5.0]
    outside = ((near[:, None] - finer) * outward).sum(axis=2).max(axis=1)
    assert (outside < DISTANCE_OF_CORNER * np.maximum(np.linalg.norm(near, axis=1), 0.04)).all()
    assert len(near) > 50


def test_without_friction_a_slope_supports_nothing():
    turned = Pose(euler_zyx=(0, math.radians(10), 0))
    feet = [(x, y, 0) for x in (-0.04, 0.04) for y in (-0.03, 0.03)]
    held = Object([Box((0.1, 0.08, 0.04))], pose=turned @ Pose((0, 0, 0.02)))
    loads = [Load("weight", gravity=(0, 0, -1))]
    smooth, rough = (Scene(held, Cage(feet, pose=turned), loads, friction_coefficient=mu) for mu in (0.1, 0.3))
    held_once = run(rough)
    slides = replace(held_once, scene=smooth)  # the same pose, with less friction
    assert region_of(slides)[1].margin_m == -math.inf
    assert len(region_of(slides)[1].corners) == 0
    assert region_of(held_once)[1].margin_m > 0.02


def test_a_weight_is_balanced_just_inside_the_region_and_not_just_outside(cases):
    """Blocks between points, centres of gravity across the region's edge, by the kernels' own equilibrium."""
    random, n_asked = np.random.default_rng(8), 0
    for _ in range(cases(12, 400)):
        pushed = pushed_block(random, 0.3)
        held = pushed.object
        scene = Scene(held, pushed.cage, [Load("weight", gravity=(0, 0, -1))], friction_coefficient=0.3)
        a_run = run(scene)
        if a_run.verdict not in ("rests", "may rest"):
            continue
        view, found = region_of(a_run)
        assert found.margin_m > -1e-9 * scene.size_m  # it is at rest
        if math.isinf(found.margin_m):
            continue
        middle = found.corners.mean(axis=0)
        for corner in found.corners[:: max(1, len(found.corners) // 4)]:
            if np.abs(corner - view.load_point).max() > 5.0:
                continue
            for share, is_in in ((0.99, True), (1.02, False)):
                place = middle + share * (corner - middle)
                if np.linalg.norm(corner - middle) < 0.02 * scene.size_m:
                    continue
                shift = (place - view.load_point) @ np.stack([view.right_world, view.up_world])
                center = held.center_of_gravity_m + a_run.pose.rotation.T @ shift
                moved = Scene(Object(held.boxes, center), scene.cage, scene.loads, friction_coefficient=0.3)
                proof, _ = judge_pose(moved, a_run.pose, 0, 0.3)
                assert (proof.verdict != "moves") == is_in
                n_asked += 1
    assert n_asked > 50


def test_a_region_does_not_depend_on_where_down_is(cases):
    """The same blocks between points, with the world turned about them: down is along no axis any more."""
    random, n_asked = np.random.default_rng(9), 0
    for _ in range(cases(25, 400)):
        pushed = pushed_block(random, 0.3)
        weight = [Load("weight", gravity=(0, 0, -1))]
        plain = Scene(pushed.object, pushed.cage, weight, friction_coefficient=0.3)
        a_run = run(plain)
        if a_run.verdict not in ("rests", "may rest"):
            continue
        frame, order = Pose((0.0, 0.0, 0.0), random.normal(size=4)), np.arange(len(plain.cage.names))
        turned = run(mapped(plain, frame=frame, scale=1.0, flip=np.ones(3), order=order))
        expected, found = (region_of(one)[1].margin_m for one in (a_run, turned))
        n_asked += 1
        assert found == pytest.approx(expected, abs=DISTANCE_OF_CORNER * plain.size_m)
    assert n_asked > 10


def test_a_load_that_leans_against_every_axis_has_its_region_too():
    """An ordinary part on its edge: 1.43653 mm beyond its region by a linear program with 720 rays a cone."""
    a_run = run(make_case("ordinary", 4).scene)
    view = load_view(a_run, 1)
    found = support_region(a_run, 1, view, 10.0 * a_run.scene.size_m)
    assert found is not None
    assert found.margin_m == pytest.approx(-1.43653e-3, rel=2e-4)


def test_a_can_is_supported_within_all_of_its_rim():
    """On level ground without friction by its circle, of which a run lists eight places: 128 are 0.03 % within it."""
    radius, off = 0.06, math.hypot(0.03, 0.01)
    can = Object(shapes=[Cylinder(radius, 0.15)], center_of_gravity_m=(0.03, 0.01, 0.0), pose=Pose((0, 0, 0.075)))
    table = Box((0.4, 0.4, 0.1), Pose((0, 0, -0.05)))
    view, found = region_of(run(Scene(can, Cage(shapes=[table]), [Load("weight", gravity=(0, 0, -1))])))
    assert found.margin_m == pytest.approx(radius - off, abs=4e-4 * radius)
    assert view.margin_m == pytest.approx(found.margin_m, abs=1e-9)
    assert_allclose(np.linalg.norm(found.corners, axis=1), radius, rtol=1e-9)


@pytest.mark.parametrize("euler", [(0.3, 0.2, 0.0), (0.7, -0.4, 0.5), (-0.5, 0.1, -0.8), (1.0, 0.6, 0.3)])
def test_points_that_pinch_a_smooth_plate_on_a_slope_support_it_nowhere(euler):
    """Above and below it they make moments without end, but no force along the slope."""
    turned = Pose(euler_zyx=euler)
    pairs = ((-0.03, 0.02), (0.02, -0.01), (0.01, 0.03))
    points = [place for x, y in pairs for place in ((x, y, -0.01), (x + 0.003, y, 0.01))]
    held = Object([Box((0.1, 0.08, 0.02))], pose=turned)
    loads = [Load("weight", gravity=(0, 0, -1))]
    smooth, rough = (Scene(held, Cage(points, pose=turned), loads, friction_coefficient=mu) for mu in (0.0, 5.0))
    slides = replace(run(rough), scene=smooth)
    assert region_of(slides)[1].margin_m == -math.inf
