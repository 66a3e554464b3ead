"""Rests on a plane: closed forms, symmetries, Goldberg's estimates, and runs."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from cagepose.cli.app import main
from cagepose.errors import SceneError
from cagepose.files.scene_file import load_scene
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.hull import Hull, hull_of
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Sphere
from cagepose.questions.resting import resting_poses
from cagepose.runs.many import run_many
from cagepose.runs.variation import Variation
from questions.goldberg import goldberg_shares

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def spread_downs(n: int, random: np.random.Generator) -> FloatArray:
    downs = random.normal(size=(n, 3))
    return downs / np.linalg.norm(downs, axis=1, keepdims=True)


def drawn_hull(random: np.random.Generator, n_corners: int) -> Convex:
    return Convex(random.normal(size=(n_corners, 3)) * (0.03, 0.03, 0.02))


def shares_found(part: Object, hull: Hull) -> FloatArray:
    """The probability of each face of a hull, (n_faces,)."""
    shares = np.zeros(len(hull.faces))
    for pose in resting_poses(part).poses:
        face = int(np.argmax(hull.normals @ pose.down_object))
        assert hull.normals[face] @ pose.down_object > 1.0 - 1e-12
        shares[face] += pose.probability
    return shares


def test_a_box_rests_on_each_face_as_often_as_the_face_is_wide_seen_from_its_middle() -> None:
    """The solid angle of a rectangle a x b seen from its box's middle: 4 arctan(ab / (c d)), d the diagonal."""
    size = np.array([0.01, 0.02, 0.03])
    poses = resting_poses(Object([Box(size)])).poses
    assert len(poses) == 6
    for pose in poses:
        axis = int(np.argmax(np.abs(pose.down_object)))
        a, b = np.delete(size, axis)
        solid = 4.0 * math.atan(a * b / (size[axis] * math.sqrt(size @ size)))
        assert pose.probability == pytest.approx(solid / (4.0 * math.pi), abs=1e-12)
        assert pose.height_m == pytest.approx(size[axis] / 2.0, rel=1e-12)
        assert pose.margin_m == pytest.approx(min(a, b) / 2.0, rel=1e-12)
        assert pose.rise_m == pytest.approx((math.hypot(size[axis], min(a, b)) - size[axis]) / 2.0, rel=1e-9)
        assert pose.rolls == "no"
        lowest = pose.pose.transform(np.array(list(product((-0.5, 0.5), repeat=3))) * size)
        assert lowest[:, 2].min() == pytest.approx(0.0, abs=1e-15)
        assert np.abs(pose.pose.transform(np.zeros(3))[:2]).max() < 1e-15


def test_a_cylinder_lies_on_its_side_in_a_row_of_poses_or_stands_on_an_end() -> None:
    radius, length = 0.01, 0.04
    found = resting_poses(Object(shapes=[Cylinder(radius, length)]))
    side, *ends = found.poses
    assert not found.is_exact
    assert len(ends) == 2
    assert side.rolls == "about an axis"
    assert np.abs(side.axis_object) == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)
    assert (side.height_m, side.margin_m) == pytest.approx((radius, length / 2.0))
    assert side.rise_m == pytest.approx(math.hypot(radius, length / 2.0) - radius)
    share = (1.0 - length / 2.0 / math.hypot(radius, length / 2.0)) / 2.0
    for end in ends:
        assert end.rolls == "no"
        assert end.probability == pytest.approx(share, abs=1e-3)
        assert (end.height_m, end.margin_m) == pytest.approx((length / 2.0, radius))
        assert end.rise_m == pytest.approx(math.hypot(radius, length / 2.0) - length / 2.0, rel=1e-3)


def test_a_cone_lies_along_its_side_at_the_height_of_its_centre_over_that() -> None:
    radius, length = 0.02, 0.04
    side, base = resting_poses(Object(shapes=[Cone(radius, 0.0, length)])).poses
    slant = math.hypot(radius, length)
    assert side.rolls == "about an axis"
    assert np.abs(side.axis_object) == pytest.approx((0.0, 0.0, 1.0), abs=1e-6)
    assert side.height_m == pytest.approx(0.75 * length * radius / slant, rel=1e-8)
    assert side.margin_m == pytest.approx(slant - 0.75 * length * length / slant, rel=1e-6)
    assert (base.height_m, base.margin_m) == pytest.approx((length / 4.0, radius))
    assert base.probability == pytest.approx((1.0 - length / 4.0 / math.hypot(radius, length / 4.0)) / 2.0, abs=1e-3)


def test_a_ball_rests_anyhow_and_a_weighted_one_in_one_pose() -> None:
    (anyhow,) = resting_poses(Object(shapes=[Sphere(0.01)])).poses
    assert (anyhow.rolls, anyhow.axis_object, anyhow.probability) == ("all ways", None, pytest.approx(1.0))
    assert math.isinf(anyhow.rise_m)
    weight = np.array([0.0003, 0.0001, 0.002])
    (upright,) = resting_poses(Object(shapes=[Sphere(0.01)], center_of_gravity_m=weight)).poses
    assert upright.rolls == "no"
    assert upright.down_object == pytest.approx(weight / np.linalg.norm(weight), abs=1e-3)
    assert upright.height_m == pytest.approx(0.01 - np.linalg.norm(weight), rel=1e-6)


def test_a_weighted_roller_lies_with_its_weight_below() -> None:
    weight = np.array([0.0003, 0.0001, 0.0])
    side = resting_poses(Object(shapes=[Cylinder(0.01, 0.04)], center_of_gravity_m=weight)).poses[0]
    assert side.rolls == "no"
    assert side.down_object == pytest.approx(weight / np.linalg.norm(weight), abs=1e-3)
    assert side.height_m == pytest.approx(0.01 - np.linalg.norm(weight), rel=1e-6)


def test_a_capsule_has_one_row() -> None:
    (side,) = resting_poses(Object(shapes=[Capsule(0.01, 0.04)])).poses
    assert side.rolls == "about an axis"
    assert (side.height_m, side.margin_m) == pytest.approx((0.01, 0.02))


def test_rests_of_hulls_are_nearly_goldbergs_and_on_the_same_faces(cases: Callable[[int, int], int]) -> None:
    """Goldberg's estimate lets a part whose centre of gravity is over a face end there, without asking through which
    corners it gets there; where each corner stands above its own cell, the two are one."""
    random = np.random.default_rng(48)
    n_same = 0
    for _ in range(cases(20, 400)):
        shape = drawn_hull(random, int(random.integers(4, 12)))
        part = Object(shapes=[shape])
        hull = hull_of(shape.vertices_m)
        shares, theirs = shares_found(part, hull), goldberg_shares(hull, part.center_of_gravity_m)
        assert ((shares > 0.0) == (theirs > 0.0)).all()
        assert np.abs(shares - theirs).max() < 0.15
        n_same += np.abs(shares - theirs).max() < 1e-9
    assert n_same > 0


def test_runs_from_any_orientation_end_in_these_poses_as_often(cases: Callable[[int, int], int]) -> None:
    """All runs of all hulls together within five standard deviations, each face of each hull counted."""
    random = np.random.default_rng(49)
    square, variance = 0.0, 0.0
    for _ in range(cases(3, 100)):
        shape = drawn_hull(random, int(random.integers(5, 16)))
        counted, shares = (
            shares_of_runs(shape, spread_downs(100, random)),
            shares_found(Object(shapes=[shape]), hull_of(shape.vertices_m)),
        )
        assert counted[shares == 0.0].sum() == 0.0
        assert shares.sum() == pytest.approx(1.0, abs=1e-12)
        assert np.abs(counted - shares).max() < 5.0 * math.sqrt(0.25 / 100)
        square += float(((counted - shares) ** 2).sum())
        variance += float((shares * (1.0 - shares)).sum()) / 100
    assert square < 2.0 * variance


def shares_of_runs(shape: Convex, downs: FloatArray) -> FloatArray:
    """The share of runs onto a floor that end on each face of a hull, from downs (n, 3), (n_faces,)."""
    part = Object(shapes=[shape], pose=Pose((0.0, 0.0, 0.2)))
    floor = Box((1.0, 1.0, 0.1), pose_object_box=Pose((0.0, 0.0, -0.05)), name="floor")
    scene = Scene(part, Cage(shapes=[floor]), [Load("weight", gravity=(0, 0, -9.81))], metric="drag")
    starts = [Pose(quaternion_wxyz=turn_from_z(-down) * (1, -1, -1, -1)) for down in downs]
    ended = run_many(
        scene,
        Variation(
            object_position_m=np.tile((0.0, 0.0, 0.2), (len(downs), 1)),
            object_euler_zyx=np.array([start.euler_zyx for start in starts]),
        ),
    )
    hull = hull_of(shape.vertices_m)
    down = np.array([-Pose(quaternion_wxyz=q).rotation[2] for q in ended.quaternion_wxyz[:, 0]])
    cosines = down @ hull.normals.T
    assert (ended.verdict == "rests").all()
    assert cosines.max(axis=1).min() > 1.0 - 1e-9
    return np.bincount(np.argmax(cosines, axis=1), minlength=len(hull.faces)) / len(downs)


def test_a_turned_moved_and_grown_part_rests_as_before() -> None:
    random = np.random.default_rng(50)
    corners = random.normal(size=(9, 3)) * 0.02
    turn = Pose(random.normal(size=3), random.normal(size=4))
    before = resting_poses(Object(shapes=[Convex(corners)])).poses
    after = resting_poses(Object(shapes=[Convex(3.0 * turn.transform(corners))])).poses
    assert len(before) == len(after)
    for one, other in zip(before, after, strict=True):
        assert other.probability == pytest.approx(one.probability, abs=1e-9)
        assert other.down_object == pytest.approx(turn.rotation @ one.down_object, abs=1e-9)
        assert (other.height_m, other.margin_m, other.rise_m) == pytest.approx(
            (3.0 * one.height_m, 3.0 * one.margin_m, 3.0 * one.rise_m)
        )


def test_touching_parts_are_named() -> None:
    part = Object(
        [Box((0.02, 0.02, 0.005), name="head")], shapes=[Cylinder(0.004, 0.06, Pose((0, 0, 0.0325)), "shank")]
    )
    on = {pose.touching for pose in resting_poses(part).poses}
    assert ("head",) in on
    assert ("head", "shank") in on


def test_a_centre_of_gravity_outside_is_refused() -> None:
    with pytest.raises(SceneError, match="does not lie within the hull"):
        resting_poses(Object([Box((0.01, 0.01, 0.01))], center_of_gravity_m=(0.0, 0.0, 0.02)))


def test_a_bolt_lies_on_each_flat_of_its_head_not_in_a_row() -> None:
    """Its shank is round, but to roll on it must be raised over a corner of the head."""
    across, height, radius, length = 0.016, 0.0064, 0.005, 0.04
    angles = [math.pi / 3.0 * side for side in range(6)]
    corner = across / math.sqrt(3.0)
    corners = [(corner * math.cos(a), corner * math.sin(a), z) for a in angles for z in (0.0, height)]
    shank = Cylinder(radius, length, Pose((0.0, 0.0, -length / 2.0)), "shank")
    part = Object(shapes=[Convex(corners, name="head"), shank])
    found = resting_poses(part).poses
    assert [pose.rolls for pose in found] == ["no"] * 8
    above_end = length + part.center_of_gravity_m[2]

    def height_on(out: float) -> float:
        lean = math.atan2(out - radius, length)
        return radius * math.cos(lean) + above_end * math.sin(lean)

    for pose in found[:6]:
        assert pose.touching == ("head", "shank")
        assert pose.height_m == pytest.approx(height_on(across / 2.0), rel=1e-6)
        assert pose.rise_m == pytest.approx(height_on(corner) - height_on(across / 2.0), rel=1e-3)
        assert pose.probability == pytest.approx(sum(one.probability for one in found[:6]) / 6.0, abs=2e-3)


def test_two_sides_between_which_something_round_would_rest_on_points_are_two_poses() -> None:
    """A hull of points on crossed bars, or on three balls, would rest on edge; the round parts fall to a side."""
    bars = [Cylinder(0.005, 0.06, Pose(euler_zyx=(yaw, math.pi / 2.0, 0.0))) for yaw in (0.0, math.pi / 2.0)]
    flat = resting_poses(Object(shapes=bars, center_of_gravity_m=(0.0, 0.0, 0.0))).poses[:2]
    balls = [Sphere(0.005, Pose((0.02 * math.cos(a), 0.02 * math.sin(a), 0.0))) for a in (0.0, 2.0, 4.0)]
    for one, other in (flat, resting_poses(Object(shapes=balls, center_of_gravity_m=(0.0, 0.0, 0.0))).poses):
        assert (one.rolls, other.rolls) == ("no", "no")
        assert one.down_object @ other.down_object == pytest.approx(-1.0)
        assert one.height_m == pytest.approx(0.005, rel=1e-6)
        assert one.probability == pytest.approx(other.probability, abs=5e-3)


def test_two_unlike_balls_on_a_rod_roll_about_their_line() -> None:
    balls = [Sphere(0.01, Pose((-0.02, 0.0, 0.0))), Sphere(0.006, Pose((0.02, 0.0, 0.0)))]
    (row,) = resting_poses(Object(shapes=balls, center_of_gravity_m=(-0.011, 0.0, 0.0))).poses
    assert row.rolls == "about an axis"
    assert row.axis_object == pytest.approx((1.0, 0.0, 0.0), abs=1e-4)
    assert row.height_m == pytest.approx(0.01 - 0.009 * 0.1, rel=1e-6)
    assert row.probability == pytest.approx(1.0)


def test_a_face_on_whose_edge_the_centre_of_gravity_stands_takes_no_rise_to_tip() -> None:
    """A block that leans by 45 deg, as wide as it is high."""
    corners = np.array([(x + z, y, z) for x, y, z in product((0.0, 0.02), (-0.01, 0.01), (0.0, 0.02))])
    poses = resting_poses(Object(shapes=[Convex(corners)])).poses
    on_edge = [pose for pose in poses if abs(pose.down_object[2]) > 0.99]
    assert len(on_edge) == 2
    for pose in on_edge:
        assert (pose.margin_m, pose.rise_m) == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.0, abs=1e-12))
    assert poses[0].rise_m == pytest.approx(0.01 - 0.01 / math.sqrt(2.0))


def test_a_rounded_plate_stands_on_its_narrow_sides_where_these_are_flat() -> None:
    """66 x 2 x 142 mm and a radius of 3 mm about it: the flat of a narrow side is 2 mm wide, and over its edge the
    centre of gravity is raised to sqrt(33^2 + 1) + 3 mm.
    """
    corners = np.array(list(product((-0.033, 0.033), (-0.001, 0.001), (-0.071, 0.071))))
    poses = resting_poses(Object(shapes=[Convex(corners, 0.003)])).poses
    assert [pose.height_m for pose in poses] == pytest.approx([0.004, 0.004, 0.036, 0.036, 0.074, 0.074])
    for pose in poses[2:]:
        assert pose.margin_m == pytest.approx(0.001)
        half = pose.height_m - 0.003
        assert pose.rise_m == pytest.approx(math.hypot(half, 0.001) - half, rel=0.01)


def test_the_command_prints_a_row_for_each_pose_and_the_document_has_the_same(
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = SCENES / "gripper.yaml"
    assert main(["ask", "resting", str(path), "--plane"]) == 0
    shown = capsys.readouterr().out
    assert main(["ask", "resting", str(path), "--plane", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = resting_poses(load_scene(path).object).poses
    assert len(document["poses"]) == len(found) == 6
    for told, pose in zip(document["poses"], found, strict=True):
        assert told["probability"] == pose.probability
        assert told["height"] == pytest.approx(1000.0 * pose.height_m)
        assert told["touching"] == list(pose.touching)
        assert f"{100.0 * pose.probability:.4g} %" in shown


def test_the_command_refuses_a_centre_of_gravity_outside(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["ask", "resting", str(SCENES / "ladder.yaml"), "--plane", "--set", "object.center_of_gravity[0]=9000"]
    assert main(arguments) == 2
    assert capsys.readouterr().err.startswith("object.center_of_gravity: does not lie within the hull")


@pytest.mark.parametrize("radius_mm", [6.0, 14.0])
def test_six_balls_lie_on_three_of_them_in_eight_ways(radius_mm: float) -> None:
    """By symmetry, each as often. From one to the next the way leads over the top of a ball, far above both."""
    balls = [Sphere(1e-3 * radius_mm, Pose(0.02 * side * np.eye(3)[axis])) for axis in range(3) for side in (-1, 1)]
    found = resting_poses(Object(shapes=balls, center_of_gravity_m=(0, 0, 0))).poses
    assert [pose.probability for pose in found] == pytest.approx([0.125] * 8, abs=0.004)
