"""Contacts that slide stay on their faces, however far they slide."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, run
from quasistatic.paths import gap_of, path_of, rows_at
from quasistatic.steps import run_with_steps

MM = 1e-3


def greatest_gap(scene, phase, points):
    """The greatest distance of the points from the faces they start on, over the path, in touch tolerances."""
    rows = rows_at(scene, phase.start_pose, scene.touch_m, points)
    assert {scene.cage.names[row[0]] for row in rows} == set(points)
    return max(abs(gap_of(scene, pose, row)) for pose in path_of(phase) for row in rows) / scene.touch_m


def plate_on_three_points(load, friction, metric, more_points=()):
    """A plate 400 x 60 x 6 mm, its lower face on three points; the cage's stops come after them."""
    points = [(-70, 0, 0), (70, 20, 0), (70, -20, 0), *more_points]
    held = Object([Box(np.array((400, 60, 6)) * MM)], pose=Pose(np.array((-50.0, 0.0, 3.0)) * MM))
    return Scene(held, Cage(np.array(points) * MM), [load], friction_coefficient=friction, metric=metric)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("kind", ["slope", "push"])
def test_a_plate_slides_100_mm_against_friction_and_stays_on_its_points(kind, metric):
    """mu = 0.5 < tan 40 deg = 0.84; or gravity and a level force of three times the weight, 1 mm above the points.
    The plate's end, 200 mm ahead of its middle, meets two stops 100 mm on.
    """
    slope = math.radians(40.0)
    if kind == "slope":
        load = Load("slope", gravity=(math.sin(slope), 0.0, -math.cos(slope)))
    else:
        load = Load("push", force=Force((0.9, 0.0, -1.0), (0.0, 0.0, 0.0)))
    scene = plate_on_three_points(load, 0.5, metric, [(250, 20, 2), (250, -20, 2)])
    result = run(scene, method="quasistatic")
    phase = result.phases[0]
    assert phase.events[0].rule == "slide"
    assert result.pose.position_m == pytest.approx((50e-3, 0.0, 3e-3), abs=1e-12)
    assert greatest_gap(scene, phase, ("C1", "C2", "C3")) <= 1.0


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("turn_step_rad", [0.02, 0.002])
def test_a_plate_that_turns_as_it_slides_stays_on_its_points(turn_step_rad, metric):
    """A weight of 1, and a level push of 0.6 at the height of the points, so that it does not tip, 60 mm from the
    middle: above the friction of 0.2. The plate slides aside and yaws; while all three points carry, all stay on it.
    """
    held = Object([Box(np.array((400, 60, 6)) * MM)], pose=Pose(np.array((-10.0, 0.0, 3.0)) * MM), mass_kg=1.0)
    push = Force((0, 1, 0), np.array((60, 0, -3)) * MM, 0.6)
    points = np.array([(-70, 0, 0), (70, 20, 0), (70, -20, 0)]) * MM
    load = Load("push", gravity=(0, 0, -1), force=push)
    scene = Scene(held, Cage(points), [load], friction_coefficient=0.2, metric=metric)
    phase = run_with_steps(scene, turn_step_rad).phases[0]
    assert phase.events[0].rule == "slide"
    rows = rows_at(scene, phase.start_pose, scene.touch_m)
    assert len(rows) == 3
    poses = phase.events[0].path
    assert np.abs([gap_of(scene, pose, row) for pose in poses for row in rows]).max() <= scene.touch_m
    assert len(poses) >= 2
    assert poses[-1].euler_zyx[0] > 0.03
    tilt = [np.hypot(*pose.euler_zyx[1:]) for pose in poses]
    assert max(tilt) <= 1e-9


@pytest.mark.parametrize("friction", [None, 0.02, 0.1])
@pytest.mark.parametrize("turn_step_rad", [0.02, 0.002])
def test_a_bar_that_rolls_in_a_groove_slides_on_both_faces(turn_step_rad, friction):
    """A square bar on its edge between points s = 10 mm apart, tilted by 20 deg: both faces slide over the points while
    it rolls back, each by a few millimetres, and bend the path. All four gaps stay closed, as long as the points carry.
    """
    s, turn = 10.0, math.radians(20.0)
    edge = -0.5 * s * np.array([math.sin(2.0 * turn), 0.0, math.cos(2.0 * turn)])
    center = edge + 20.0 / math.sqrt(2.0) * np.array([math.sin(turn), 0.0, math.cos(turn)])
    points = np.array([(x * s / 2.0, y, 0.0) for x in (-1, 1) for y in (-20, 20)])
    held = Object(
        [Box(np.array((20.0, 60.0, 20.0)) * MM)], pose=Pose(center * MM, euler_zyx=(0.0, math.pi / 4.0 + turn, 0.0))
    )
    scene = Scene(held, Cage(points * MM), [Load("g", gravity=(0, 0, -1))], friction_coefficient=friction)
    phase = run_with_steps(scene, turn_step_rad).phases[0]
    assert phase.events[0].rule == "slide"
    assert greatest_gap(scene, phase, ("C1", "C2", "C3", "C4")) <= 1.0
