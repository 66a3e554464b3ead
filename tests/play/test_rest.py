"""Rests straight from the polytope, against the quasistatic method and against statics."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from audit.caged_families import caged
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, load_scene, run
from cagepose.studies.play_rest import PressedPoint, play_rests
from rails import exact_tilt_deg, rail_scene

MM = 1e-3
SCENES = Path(__file__).resolve().parents[2] / "scenes"


def unbalanced(scene: Scene, pose: Pose, load: Load, forces: tuple[PressedPoint, ...]) -> np.ndarray:
    """Force and moment about the origin that are left at a pose; forces push along -n of the nearest face."""
    points = scene.cage.points_world()
    total = np.zeros(6)
    pulls = []
    if load.gravity_world is not None:
        down = load.gravity_world / np.linalg.norm(load.gravity_world)
        pulls.append((down, pose.transform(scene.object.center_of_gravity_m)))
    if load.force is not None:
        pulls.append((load.force.direction, pose.transform(load.force.at_object_m)))
    for pressed in forces:
        point = points[scene.cage.names.index(pressed.point)]
        box = next(box for box in scene.object.boxes if box.name == pressed.box)
        q = box.pose_object_box.inverse_transform(pose.inverse_transform(point))
        axis = int(np.argmax(np.abs(q) - box.size_m / 2))
        normal = pose.rotation @ box.pose_object_box.rotation[:, axis] * math.copysign(1.0, q[axis])
        pulls.append((-pressed.force_n * normal, point))
    for force, at in pulls:
        total += np.append(force, np.cross(at, force) / scene.size_m)
    return total


@pytest.mark.parametrize("name", ["rail-pitch", "rail-yaw", "rail-roll"])
def test_the_pushed_rail_rests_where_the_quasistatic_method_brings_it(name):
    scene = load_scene(SCENES / f"{name}.yaml")
    rest, pushed = play_rests(scene)[1], run(scene, "quasistatic").phases[1]
    assert rest.undetermined == ()
    assert rest.pose_world_object.position_m == pytest.approx(pushed.pose.position_m, abs=1e-10)
    assert rest.pose_world_object.euler_zyx == pytest.approx(pushed.pose.euler_zyx, abs=1e-10)
    # Second order: turns of 0.006 rad over 92 mm.
    assert rest.linear_pose_world_object.position_m == pytest.approx(pushed.pose.position_m, abs=0.01 * MM)
    assert rest.linear_pose_world_object.euler_zyx == pytest.approx(pushed.pose.euler_zyx, abs=2e-5)
    assert unbalanced(scene, rest.pose_world_object, scene.loads[1], rest.exact_forces) == pytest.approx(0, abs=1e-8)
    stop = {force.point: force.force_n for force in rest.exact_forces}["C13"]
    known = {contact.point: contact.force_normal_n for contact in pushed.contacts}["C13"]
    assert stop == pytest.approx(known, rel=1e-9)  # of the roller's forces, several choices balance


def test_the_weight_of_the_rail_leaves_y_and_yaw_open_and_tilts_it_by_the_play():
    """By hand: 0.5 mm down at the rear, 0.5 mm up at the front: 0.5/91.5 rad; y and yaw up to 0.53 and 0.53/91.5."""
    scene = rail_scene()
    rest = play_rests(scene)[0]
    assert rest.linear_pose_world_object.euler_zyx == pytest.approx((0, math.atan(0.5 / 91.5), 0), abs=1e-6)
    assert math.degrees(rest.pose_world_object.euler_zyx[1]) == pytest.approx(exact_tilt_deg(1.0, 183.0), rel=1e-4)
    ranges = {freedom.name: (freedom.low, freedom.high) for freedom in rest.undetermined}
    assert list(ranges) == ["x", "y", "yaw"]  # level: no part of the weight along x
    assert ranges["x"] == pytest.approx((-1 * MM, 1 * MM))
    assert ranges["y"] == pytest.approx((-0.53 * MM, 0.53 * MM))
    assert ranges["yaw"] == pytest.approx((-0.53 / 91.5, 0.53 / 91.5))


def test_the_lever_of_the_weight_is_that_of_a_beam_on_two_supports():
    """Load at 100 on supports at -91.5 and 91.5: (100 + 91.5) / 183 in front, and the rest, negative, behind."""
    rest = play_rests(rail_scene())[0]
    front = sum(force.force_n for force in rest.forces if force.point in {"C5", "C7"})
    rear = sum(force.force_n for force in rest.forces if force.point in {"C2", "C4"})
    assert (front, rear) == pytest.approx((191.5 / 183, 8.5 / 183), rel=1e-9)


def test_rests_of_random_scenes_balance_and_agree_with_the_quasistatic_method(cases):
    rng = np.random.default_rng(12)
    n_compared, n_scenes = 0, cases(20, 40)
    for _ in range(n_scenes):
        scene = caged(rng)
        (rest,) = play_rests(scene)
        assert rest.pose_world_object is not None
        assert unbalanced(scene, rest.pose_world_object, scene.loads[0], rest.exact_forces) == pytest.approx(
            0, abs=1e-6
        )
        ended = run(scene, "quasistatic")
        if ended.verdict != "rests" or ended.phases[0].proof.undetermined or rest.undetermined:
            continue
        center = scene.object.center_of_gravity_m
        depth = (rest.pose_world_object.transform(center) - ended.pose.transform(center))[2]
        assert depth < 1e-9  # no rest lies lower than the one that has done all work
        if depth > -1e-9:
            assert rest.pose_world_object.position_m == pytest.approx(ended.pose.position_m, abs=1e-8)
            known = {contact.point: contact.force_normal_n for contact in ended.phases[0].contacts}
            for force in rest.exact_forces:
                assert force.force_n == pytest.approx(known[force.point], abs=1e-5)
            n_compared += 1
    assert n_compared >= n_scenes // 3


def test_a_weight_and_a_push_act_together_in_newtons():
    """1 kg on two points 60 mm apart, pushed down with 10 N over the left one: it carries 10 N more than the other."""
    xs = (-30, 30)
    below = [(x, y, -10.1) for x in xs for y in (-5, 5)]
    around = [(x, y, 10.1) for x in xs for y in (-5, 5)]
    sides = [(x, side * 10.1, 0) for x in xs for side in (-1, 1)] + [(side * 50.1, 0, 0) for side in (-1, 1)]
    scene = Scene(
        Object([Box(np.array([100, 20, 20]) * MM)], mass_kg=1.0),
        Cage(np.array([*below, *around, *sides]) * MM),
        [Load("both", gravity=(0, 0, -9.81), force=Force((0, 0, -1), np.array([-30, 0, 0]) * MM, 10.0))],
    )
    (rest,) = play_rests(scene)
    assert rest.in_newtons
    assert rest.linear_pose_world_object.position_m == pytest.approx((0, 0, -0.1 * MM), abs=1e-12)
    carried = {force.point: force.force_n for force in rest.forces}
    left = carried.get("C1", 0) + carried.get("C2", 0)
    right = carried.get("C3", 0) + carried.get("C4", 0)
    assert (left, right) == pytest.approx((10 + 4.905, 4.905), rel=1e-9)


def test_a_load_that_meets_nothing_has_no_rest():
    points = [(side * 10.1, y, 0) for side in (-1, 1) for y in (-5, 5)]
    scene = Scene(Object([Box(np.full(3, 20 * MM))]), Cage(np.array(points) * MM), [Load("weight", gravity=(0, 0, -1))])
    (rest,) = play_rests(scene)
    assert rest.linear_pose_world_object is None
    assert rest.pose_world_object is None
    assert rest.forces == rest.exact_forces == ()
