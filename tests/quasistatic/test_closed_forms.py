"""Rests of the mechanics that a page of trigonometry gives, too."""

from __future__ import annotations

import math

import numpy as np
import pytest

from audit.geometry import farthest_move
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, run
from quasistatic.paths import RESTS, path_of

MM = 1e-3


def scene_of(boxes, points_mm, load, *, center_mm=None, pose=None, friction=None, metric="release"):
    """Boxes as (size, position) in mm, points in mm."""
    held = Object(
        [Box(np.array(size) * MM, Pose(np.array(at) * MM)) for size, at in boxes],
        None if center_mm is None else np.array(center_mm) * MM,
        pose=pose,
    )
    return Scene(held, Cage(np.array(points_mm) * MM), [load], friction_coefficient=friction, metric=metric)


def gravity(x=0.0, y=0.0, z=-1.0):
    return Load("gravity", gravity=(x, y, z))


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("slope_deg", [5.0, 20.0, 45.0])
@pytest.mark.parametrize("beside", [1e-4, 1e-6])
def test_a_block_on_three_points_slides_if_friction_is_below_the_tangent_of_the_slope(beside, slope_deg, metric):
    """Balance along and across the slope: friction m g sin t <= mu m g cos t, so mu = tan t is the limit. No tipping:
    the vertical through the centre of gravity, 5 mm up, meets the slope 5 tan t <= 5 mm ahead, inside the triangle.
    """
    slope = math.radians(slope_deg)
    points = [(-8, 0, 0), (8, 8, 0), (8, -8, 0)]
    load = gravity(math.sin(slope), 0.0, -math.cos(slope))
    block = [((20, 20, 10), (0, 0, 5))]
    above, below = ((1.0 + sign * beside) * math.tan(slope) for sign in (1, -1))
    held = run(scene_of(block, points, load, friction=above, metric=metric), method="quasistatic")
    assert held.verdict in RESTS
    assert farthest_move(held.scene, held.pose, Pose()) <= 1e-12
    slides = run(scene_of(block, points, load, friction=below, metric=metric), method="quasistatic")
    first = slides.phases[0].events[0]
    assert first.rule == "slide"
    moved = first.path[0].position_m
    assert np.cross(moved, (1, 0, 0)) == pytest.approx(0.0, abs=1e-12)
    assert moved[0] > 0.0
    assert farthest_move(slides.scene, first.path[0], Pose(moved)) <= 1e-12


def test_a_tall_block_tips_at_any_friction():
    """15 mm up, at 45 deg, the vertical through the centre of gravity leaves the triangle, whose edge is 8 mm ahead."""
    scene = scene_of(
        [((20, 20, 30), (0, 0, 15))], [(-8, 0, 0), (8, 8, 0), (8, -8, 0)], gravity(1.0, 0.0, -1.0), friction=5.0
    )
    first = run(scene, method="quasistatic").phases[0].events[0]
    assert first.rule == "pivot"
    assert first.contacts in (("C2", "C3"), ())


@pytest.mark.parametrize(("across_mm", "along_mm"), [(10.0, 4.0), (10.0, 8.0), (6.0, 9.0)])
def test_two_points_hold_a_slab_by_friction_as_the_wedge_rule_says(across_mm, along_mm):
    """A slab w across; C1 below it, C2 above and d further along. Lifted at C1, it would turn about C2 and open C1.
    About C2, forces N at C1 turn it back by mu N w (friction) and on by N d: balance needs mu >= d / w.
    """
    points = [(0, 0, 0), (along_mm, 0, across_mm)]
    load = Load("lift", force=Force((0, 0, 1), (0.0, 0.0, 0.0)))
    for factor, holds in ((1.01, True), (0.99, False)):
        scene = scene_of(
            [((60, 20, across_mm), (0, 0, across_mm / 2))], points, load, friction=factor * along_mm / across_mm
        )
        result = run(scene, method="quasistatic")
        if holds:
            assert result.verdict in RESTS
            assert farthest_move(scene, result.pose, Pose()) <= 1e-12
        else:
            assert result.phases[0].events[0].rule in ("slide", "pivot")


@pytest.mark.parametrize("friction", [None, 0.5])
@pytest.mark.parametrize("metric", ["release", "drag"])
def test_a_peg_touches_both_rims_of_its_hole(friction, metric):
    """A peg of diameter D in a hole w wide; rims C1 .. C4, H apart along the hole. Pushed at its far end it turns by t
    until it touches two rims crosswise: w cos t + H sin t = D across the peg, and the rims lie l apart along it, with
    D cos t - l sin t = w across the hole. With friction it need not reach the end of the hole (C5) for that.
    """
    d, w, h = 10.0, 10.4, 30.0
    rims = [(side * w / 2.0, y, x) for side in (-1, 1) for y in (-6, 6) for x in (-h / 2.0, h / 2.0)]
    walls = [(0, side * 10.2, z) for side in (-1, 1) for z in (-10, 10)]
    ends = [(0, 0, -61), (0, 0, 61)]
    scene = scene_of(
        [((d, 20, 120), (0, 0, 0))],
        rims + walls + ends,
        Load("push", force=Force((1, 0, 0), np.array((0, 0, 55)) * MM)),
        friction=friction,
        metric=metric,
    )
    result = run(scene, method="quasistatic")
    assert result.verdict in RESTS
    radius = math.hypot(w, h)
    turn = math.acos(d / radius) - math.acos(w / radius)  # w cos t - h sin t = d, t as far as the play goes
    normal = result.pose.rotation[:, 0]
    found = math.atan2(-normal[2], normal[0])
    assert found == pytest.approx(turn, rel=1e-9)
    along = h * math.cos(turn) + w * math.sin(turn)
    assert d * math.cos(turn) + along * math.sin(turn) == pytest.approx(w, rel=1e-12)


def groove(apart_mm, turn_rad, *, friction=None, metric="release", side_mm=20.0):
    """A square bar, 60 mm long, on its edge between two pairs of points ``apart_mm`` from each other, rolled by
    ``turn_rad``.

    Both faces touch, so the edge lies on the circle that has the points' distance s as its diameter, at 2 phi from the
    bottom: E = s/2 (-sin 2 phi, -cos 2 phi) for a roll by phi that takes the centre of gravity to the right.
    """
    s = apart_mm * MM
    edge = 0.5 * s * np.array([-math.sin(2.0 * turn_rad), 0.0, -math.cos(2.0 * turn_rad)])
    level = side_mm * MM / math.sqrt(2.0)
    center = edge + level * np.array([math.sin(turn_rad), 0.0, math.cos(turn_rad)])
    points = [(x * apart_mm / 2.0, y, 0.0) for x in (-1, 1) for y in (-20, 20)]
    # 45 deg about y sets it on its edge; a roll by phi takes z to x: a turn by +phi about y.
    pose = Pose(center, euler_zyx=(0.0, math.pi / 4.0 + turn_rad, 0.0))
    return scene_of(
        [((side_mm, 60, side_mm), (0, 0, 0))], points, gravity(), pose=pose, friction=friction, metric=metric
    )


def roll_of(pose):
    """How far the bar has rolled from its symmetric pose, modulo a quarter turn, radians."""
    x = pose.rotation[:, 0]
    return (math.atan2(-x[2], x[0]) - math.pi / 4.0 + math.pi / 4.0) % (math.pi / 2.0) - math.pi / 4.0


@pytest.mark.parametrize("apart_mm", [4.0, 6.0, 10.0, 14.0])
@pytest.mark.parametrize("friction", [None, 0.4])
def test_a_bar_in_perfect_balance_in_a_groove_stays(apart_mm, friction):
    scene = groove(apart_mm, 0.0, friction=friction)
    result = run(scene, method="quasistatic")
    assert result.verdict == "rests"
    assert farthest_move(scene, result.pose, scene.object.pose_world_object) <= 1e-12


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("turn_deg", [3.0, -5.0, 12.0])
@pytest.mark.parametrize("apart_mm", [8.0, 10.0, 14.0])
def test_a_tilted_bar_rolls_back_if_it_is_low(apart_mm, turn_deg, metric):
    """Height of the centre of gravity: -s/2 cos 2 phi + L cos phi, curvature 2 s - L at phi = 0. L = 14.14 mm here:
    stable from s = 7.07 mm on; the only minimum within cos phi > L / 2 s (34 deg, 45 deg and all).
    """
    scene = groove(apart_mm, math.radians(turn_deg), metric=metric)
    result = run(scene, method="quasistatic")
    assert result.verdict == "rests"
    assert roll_of(result.pose) == pytest.approx(0.0, abs=1e-9)
    height = (-0.5 * apart_mm + 20.0 / math.sqrt(2.0)) * MM
    assert result.pose.position_m == pytest.approx((0.0, 0.0, height), abs=1e-9 * scene.size_m)


@pytest.mark.parametrize("turn_deg", [2.0, -4.0])
@pytest.mark.parametrize("apart_mm", [4.0, 6.0])
def test_a_tilted_bar_rolls_off_if_it_is_high(apart_mm, turn_deg):
    """2 s < L: the balance is a maximum, and from 2 deg the bar leaves it the way it leans."""
    scene = groove(apart_mm, math.radians(turn_deg))
    result = run(scene, method="quasistatic")
    rolls = [roll_of(pose) for pose in path_of(result.phases[0])[:5]]
    assert (np.diff(rolls) * math.copysign(1.0, turn_deg) > 0.0).all()
    assert result.verdict != "rests" or abs(roll_of(result.pose)) > math.radians(abs(turn_deg))


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("center_mm", [(8.0, 0.0, -40.0), (9.0, 2.0, -30.0), (-3.0, -2.5, -60.0), (15.0, 4.0, -45.0)])
def test_a_hook_swings_until_its_weight_hangs_below_the_point(center_mm, metric):
    """A hook over one point with friction that never lets it slip: the pendulum stops with its centre of gravity
    vertically below the contact, (0, 0, 0), at the distance that it had from it.
    """
    boxes = [((20, 10, 4), (0, 0, 2)), ((4, 10, 60), (12, 0, -26)), ((30, 10, 10), (6, 0, -60))]
    scene = scene_of(boxes, [(0, 0, 0)], gravity(), center_mm=center_mm, friction=3.0, metric=metric)
    result = run(scene, method="quasistatic")
    assert result.verdict in RESTS
    below = result.center_of_gravity_world
    assert below[:2] == pytest.approx(0.0, abs=1e-9 * scene.size_m)
    assert below[2] == pytest.approx(-np.linalg.norm(center_mm) * MM, rel=1e-9)


def test_the_sample_frictionless():
    """The cube of the stepwise sample with its centre of gravity exactly over the line C1-C4 wedges at 45 deg in the
    groove between them: 5 sqrt 2 up from the edge, which hangs 4 mm below the points. 1 um beside it, on one side it
    falls, on the other it comes to rest on four points.
    """
    points = [(4, 4, 0), (4, -4, 0), (-4, -4, 0), (-4, 4, 0)]
    cube = [((10, 10, 10), (0, 0, 0))]

    def ended(aside_mm):
        at = Pose(np.array([2.0, 4.0, 10.0]) * MM)
        return run(scene_of(cube, points, gravity(), center_mm=(0, aside_mm, 0), pose=at), method="quasistatic")

    assert np.array([0, 4, 3.0711]) == pytest.approx(ended(0.0).center_of_gravity_world / MM, abs=5e-5)
    verdicts = {ended(aside).verdict: ended(aside) for aside in (-0.001, 0.001)}
    assert set(verdicts) == {"rests", "escapes"}
    rest = verdicts["rests"]
    assert np.degrees(rest.pose.euler_zyx) == pytest.approx((-31.24, -34.20, 47.18), abs=1e-2)
    assert len(rest.phases[0].events[-1].contacts) == 4
