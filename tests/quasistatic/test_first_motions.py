"""How a motion starts: the axis of a released rod, free fall, and flight without an obstacle."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, run
from cagepose.runs.run import motion_between
from quasistatic.paths import RESTS, path_of
from quasistatic.steps import run_with_steps

MM = 1e-3
GRAVITY = Load("gravity", gravity=(0, 0, -1))


def rod_on_a_point(c_mm, d_mm, metric, friction=None):
    """A level rod 100 x 4 x 2 mm along x, on one point under its lower face, c and d mm from its middle."""
    held = Object([Box(np.array((100, 4, 2)) * MM)])
    points = np.array([(c_mm, d_mm, -1.0), (0, 0, -500), (9, 0, -500)]) * MM
    return Scene(held, Cage(points), [GRAVITY], metric=metric, friction_coefficient=friction)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize(("c_mm", "d_mm"), [(20.0, 1.0), (40.0, 1.5), (-5.0, -1.0), (30.0, 0.2)])
def test_a_released_rod_turns_about_the_axis_of_its_inertia(c_mm, d_mm, metric):
    """Without friction the point pushes up by N (weight 1) at r = (c, d, -1 mm): moment N (d, -c, 0), so the rod turns
    with N (d / kx^2, -c / ky^2, 0) and its middle falls with N - 1. The contact stays: N (1 + d^2 / kx^2 + c^2 / ky^2)
    = 1. Released, kx^2 = (b^2 + h^2) / 12 and ky^2 = (l^2 + h^2) / 12, and the axis is nearly the rod's own: up to
    75 deg off the moment. Drag has one radius for all axes, sqrt(trace / 3), and turns about the moment.

    One step of 1e-6 rad; its constant twist is the motion at rest, but for what one step bends.
    """
    squares = np.array([4.0**2 + 2.0**2, 100.0**2 + 2.0**2, 100.0**2 + 4.0**2]) / 12.0
    kx2, ky2 = squares[:2] if metric == "release" else np.full(2, squares.sum() / 3.0)
    normal_force = 1.0 / (1.0 + d_mm**2 / kx2 + c_mm**2 / ky2)
    spin = normal_force * np.array([d_mm / kx2, -c_mm / ky2, 0.0])
    per_radian_mm = (normal_force - 1.0) / np.linalg.norm(spin)

    result = run_with_steps(rod_on_a_point(c_mm, d_mm, metric), turn_step_rad=1e-6)
    first = result.phases[0].events[0]
    motion = motion_between(result.phases[0].start_pose, first.path[0], np.zeros(3), result.scene.size_m)
    assert motion.axis_world == pytest.approx(spin / np.linalg.norm(spin), abs=1e-5)
    fall_mm = first.path[0].position_m[2] / MM
    assert fall_mm / motion.angle_rad == pytest.approx(per_radian_mm, rel=1e-5)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize(("c_mm", "d_mm"), [(20.0, 1.0), (-5.0, -1.0)])
def test_a_sticking_point_turns_it_about_the_inertia_at_the_point(c_mm, d_mm, metric):
    """With friction that holds the point still, the rod turns about it with K_P^-1 of the weight's moment about it:
    K_P = K + |r|^2 1 - r r', r from the point to the middle, moment r x (0, 0, -1).
    """
    squares = np.array([4.0**2 + 2.0**2, 100.0**2 + 2.0**2, 100.0**2 + 4.0**2]) / 12.0
    inertia = np.diag(squares if metric == "release" else np.full(3, squares.sum() / 3.0))
    r = np.array([-c_mm, -d_mm, 1.0])
    spin = np.linalg.solve(inertia + r @ r * np.eye(3) - np.outer(r, r), np.cross(r, (0.0, 0.0, -1.0)))

    result = run_with_steps(rod_on_a_point(c_mm, d_mm, metric, friction=20.0), turn_step_rad=1e-6)
    first = result.phases[0].events[0]
    assert first.rule == "pivot"
    motion = motion_between(result.phases[0].start_pose, first.path[0], np.zeros(3), result.scene.size_m)
    assert motion.kind == "turn"
    assert motion.axis_world == pytest.approx(spin / np.linalg.norm(spin), abs=1e-5)
    away = np.array((c_mm, d_mm, -1.0)) * MM - motion.through_world
    assert np.cross(away, motion.axis_world) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("gap_mm", [1e-3, 0.5, 7.0])
@pytest.mark.parametrize("friction", [None, 0.3])
def test_a_free_fall_is_as_long_as_the_gap(gap_mm, friction, metric):
    points = np.array([(-8, 0, 0), (8, 8, 0), (8, -8, 0)]) * MM
    held = Object([Box(np.array((20, 20, 10)) * MM)], pose=Pose(np.array((0.0, 0.0, 5.0 + gap_mm)) * MM))
    scene = Scene(held, Cage(points), [GRAVITY], friction_coefficient=friction, metric=metric)
    result = run(scene, method="quasistatic")
    fall, rest = result.phases[0].events
    assert (fall.rule, fall.motion.kind, rest.rule) == ("free", "travel", "held")
    assert fall.motion.direction_world == pytest.approx((0.0, 0.0, -1.0), abs=1e-12)
    assert fall.motion.distance_m == pytest.approx(gap_mm * MM, abs=1e-12 * scene.size_m)
    assert set(fall.hit) == {"C1", "C2", "C3"}
    assert result.verdict == "rests"
    assert result.pose.position_m == pytest.approx((0.0, 0.0, 5.0 * MM), abs=1e-12 * scene.size_m)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("at_mm", [(0, 0, 0), (0, 3, 0), (4, -2, 5), (-5, 1, 0)])
def test_what_is_pushed_away_from_the_cage_escapes(at_mm, metric):
    """A force, off the centre of gravity or not, and every point is behind: nothing can be met, and the run says so."""
    points = np.array([(-30, y, z) for y in (-5, 5) for z in (-5, 5)]) * MM
    push = Load("push", force=Force((1, 0, 0), np.array(at_mm) * MM))
    result = run(Scene(Object([Box(np.full(3, 10.0) * MM)]), Cage(points), [push], metric=metric), method="quasistatic")
    assert result.verdict == "escapes"
    (event,) = result.phases[0].events
    assert (event.rule, event.motion.kind, event.motion.distance_m) == ("escapes", "travel", np.inf)
    assert event.motion.direction_world.tolist() == [1, 0, 0]


@pytest.mark.parametrize("metric", ["release", "drag"])
def test_a_force_off_the_centre_turns_it_in_flight(metric):
    """From rest a force F at r moves a cube with F and turns it with r x F / k^2, k^2 = a^2 / 6, whatever the metric:
    while it turns by an angle, its middle goes k^2 / |r| for each radian (r across F), here 100 / 6 / 4 mm.
    """
    points = np.array([(60, y, z) for y in (-4, 4) for z in (-4, 4)]) * MM
    push = Load("push", force=Force((1, 0, 0), np.array((0.0, 4.0, 0.0)) * MM))
    scene = Scene(Object([Box(np.full(3, 10.0) * MM)]), Cage(points), [push], metric=metric)
    result = run_with_steps(scene, turn_step_rad=1e-3)
    first = result.phases[0].events[0].path[0]
    motion = motion_between(scene.object.pose_world_object, first, np.zeros(3), scene.size_m)
    assert motion.axis_world == pytest.approx((0.0, 0.0, -1.0), abs=1e-9)
    assert np.linalg.norm(first.position_m) / motion.angle_rad == pytest.approx(100.0 / 6.0 / 4.0 * MM, rel=1e-6)
    flight = path_of(result.phases[0])
    assert all(pose.position_m[0] >= before.position_m[0] for before, pose in itertools.pairwise(flight))
    assert result.verdict in (*RESTS, "escapes")
    assert math.isfinite(result.pose.position_m[0])
