"""Rests of cylinders and cones, and of parts in round holes, that can be worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Capsule,
    Cone,
    Cylinder,
    Force,
    Hole,
    Load,
    Moment,
    Object,
    Pose,
    Run,
    Scene,
    Sphere,
    run,
)
from cagepose.model.hole import Chamfer
from cagepose.runs.critical import with_critical_friction

DOWN = (0.0, 0.0, -1.0)


def end_of(held: Object, around: list, loads: list[Load], friction: float = 0.0) -> Run:
    solids = [part for part in around if not isinstance(part, Hole)]
    holes = [part for part in around if isinstance(part, Hole)]
    return run(Scene(held, Cage(shapes=solids, holes=holes), loads, friction_coefficient=friction))


def block(depth: float = 0.1) -> Box:
    return Box((0.2, 0.2, depth), Pose((0.0, 0.0, -depth / 2.0)), name="block")


def peg_on_the_bottom(wide: float, narrow: float, depth: float, friction: float = 0.0) -> Run:
    """A round peg that stands in a round hole, its top pushed sideways and down; in a random direction."""
    length = 4.0 * depth
    angle = 7.0 * narrow / wide
    push = Force((math.cos(angle), math.sin(angle), -0.3), at_m=(0.0, 0.0, length / 2.0))
    held = Object(shapes=[Cylinder(narrow / 2.0, length, name="peg")], pose=Pose((0.0, 0.0, length / 2.0 - depth)))
    hole = Hole(wide / 2.0, depth, in_=["block"], name="hole")
    return end_of(held, [block(2.0 * depth), hole], [Load("push", forces=[push])], friction)


def tilt_of(result: Run) -> float:
    axis = result.pose.rotation[:, 2]
    return math.atan2(float(np.hypot(axis[0], axis[1])), float(axis[2]))


def test_a_peg_that_stands_in_a_hole_tilts_by_its_play(cases, say) -> None:
    """D cos t - (F - d sin t) sin t = d: the raised point of its bottom edge touches the wall, its side the rim."""
    rng = np.random.default_rng(1)
    worst, n_pegs = 0.0, cases(40, 200)
    for _ in range(n_pegs):
        narrow = float(rng.uniform(0.004, 0.03))
        wide, depth = narrow * (1.0 + float(rng.uniform(0.0005, 0.03))), narrow * float(rng.uniform(0.6, 2.5))
        result = peg_on_the_bottom(wide, narrow, depth)
        assert result.verdict == "rests", (wide, narrow, depth)
        t = tilt_of(result)
        slope = wide * math.sin(t) + depth * math.cos(t) - narrow * math.sin(2.0 * t)
        left = wide * math.cos(t) - (depth - narrow * math.sin(t)) * math.sin(t) - narrow
        worst = max(worst, abs(math.degrees(left / slope)))
    assert worst < 1e-9
    say(f"{n_pegs} pegs in holes: tilts at most {worst:.1e} deg from D cos t - (F - d sin t) sin t = d")


@pytest.mark.parametrize("half_angle_deg", [20.0, 45.0, 75.0])
def test_a_cylinder_lies_in_a_v_of_two_plates(half_angle_deg: float) -> None:
    half_angle, radius, thickness = math.radians(half_angle_deg), 0.01, 0.004
    plates = []
    for side in (1.0, -1.0):
        turned = Pose(euler_zyx=(0.0, 0.0, side * (math.pi / 2.0 - half_angle)))
        plates.append(Box((0.2, 0.1, thickness), turned @ Pose((0.0, side * 0.05, -thickness / 2.0))))
    lying = Pose((0.0, 0.003, 0.08), euler_zyx=(0.0, math.pi / 2.0, 0.0))
    result = end_of(Object(shapes=[Cylinder(radius, 0.05)], pose=lying), plates, [Load("weight", gravity=DOWN)])
    assert result.verdict == "rests"
    assert result.pose.position_m[2] == pytest.approx(radius / math.sin(half_angle), abs=1e-10)
    forces = dict.fromkeys(("box1", "box2"), 0.0)
    for contact in result.contacts:
        forces[contact.point] += contact.force_normal_n or 0.0
    assert list(forces.values()) == pytest.approx([1.0 / (2.0 * math.sin(half_angle))] * 2, rel=1e-9)


@pytest.mark.parametrize("radius", [0.0061, 0.01, 0.05])
def test_a_ball_lies_on_the_rim_of_a_hole(radius: float) -> None:
    """Its centre is sqrt(r^2 - R^2) above the rim."""
    rim = 0.006
    ball = Object(shapes=[Sphere(radius)], pose=Pose((0.3 * rim, -0.1 * rim, 1.1 * radius)))
    hole = Hole(rim, 0.05, in_=["block"])
    result = end_of(ball, [block(), hole], [Load("weight", gravity=DOWN)])
    assert result.verdict == "rests"
    assert result.pose.position_m == pytest.approx((0.0, 0.0, math.sqrt(radius**2 - rim**2)), abs=1e-9 * 0.2)


@pytest.mark.parametrize("direction_deg", [0.0, 3.0, 18.0, 22.5, 27.0, 31.0, 45.0, 63.0, 137.0])
@pytest.mark.parametrize(
    ("share", "verdict"), [(0.999, "rests"), (0.9999999, "rests"), (1.00001, "tips"), (1.001, "tips")]
)
def test_a_standing_cylinder_tips_where_its_weight_leaves_the_rim(
    direction_deg: float, share: float, verdict: str
) -> None:
    """In any direction, not only over the vertices of its rim."""
    radius, angle = 0.01, math.radians(direction_deg)
    center = (share * radius * math.cos(angle), share * radius * math.sin(angle), 0.0)
    can = Object(shapes=[Cylinder(radius, 0.03)], center_of_gravity_m=center, pose=Pose((0.0, 0.0, 0.015)))
    result = end_of(can, [block()], [Load("weight", gravity=DOWN)], 0.3)
    assert result.verdict == "rests"
    assert (tilt_of(result) < 1e-9) == (verdict == "rests")
    assert tilt_of(result) < 1e-9 or tilt_of(result) == pytest.approx(math.pi / 2.0, abs=1e-6)


@pytest.mark.parametrize("direction_deg", [0.0, 22.5, 100.0])
def test_the_friction_of_a_pushed_can_is_the_push_over_its_weight_until_it_tips(direction_deg: float) -> None:
    """W mu >= F, and F h <= W r, h the height of the push: also between octagon and circle."""
    radius, height = 0.03, 0.1
    direction = math.radians(direction_deg)
    for share in (0.5, 0.97, 1.001):
        part = share * radius / height
        push = Force((math.cos(direction), math.sin(direction), 0.0), (0, 0, 0), 10.0 * part)
        can = Object(shapes=[Cylinder(radius, 2 * height)], pose=Pose((0, 0, height)), mass_kg=1.0)
        load = Load("both", gravity=(0, 0, -10.0), force=push)
        result = with_critical_friction(end_of(can, [Box((0.4, 0.4, 0.02), Pose((0, 0, -0.01)), "floor")], [load], 1.0))
        if share < 1.0:
            assert result.verdict == "rests"
            assert result.phases[0].proof.critical_friction == pytest.approx(part, rel=1e-9)
        else:
            assert result.verdict != "rests" or tilt_of(result) > 1.0


@pytest.mark.parametrize("shape", [Cylinder(0.01, 0.03), Cone(0.01, 0.004, 0.03), Cone(0.01, 0.0, 0.03)])
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_what_stands_on_a_slope_tips_at_the_angle_of_its_rim(shape, share: float) -> None:
    """tan(al) = R / h, h the height of the centre of gravity."""
    held = Object(shapes=[shape])
    height = float(held.center_of_gravity_m[2]) + 0.015
    slope = share * math.atan2(0.01, height)
    floor = Pose(euler_zyx=(0.4, slope, 0.0))
    plate = Box((0.4, 0.4, 0.02), floor @ Pose((0.0, 0.0, -0.01)))
    standing = Object(shapes=[shape], pose=floor @ Pose((0.0, 0.0, 0.015), euler_zyx=(0.17, 0.0, 0.0)))
    result = end_of(standing, [plate], [Load("weight", gravity=DOWN)], 3.0)
    stays = float(result.pose.rotation[:, 2] @ floor.rotation[:, 2]) > 1.0 - 1e-12
    assert stays == (share < 1.0)


def first_touch(pin, e: float, hole: Hole) -> float:
    """How deep the lowest point of a pin is in a hole when it touches first, going straight down beside the axis."""
    held = Object(shapes=pin, pose=Pose((e, 0.0, 0.2)))
    result = end_of(held, [block(), hole], [Load("in", forces=[Force(DOWN, (0.0, 0.0, 0.0))])])
    return result.phases[0].events[0].motion.distance_m - 0.2


@pytest.mark.parametrize("offset", [0.0, 0.0005, 0.0013])
def test_a_tapered_pin_touches_the_rim_at_its_depth(offset: float) -> None:
    """With a flat tip at (R - e - rt) / tan(be), with a round one at rt + (R - e - rt / cos(be)) / tan(be)."""
    radius, tip, angle, length = 0.006, 0.003, math.radians(12.0), 0.03
    hole = Hole(radius, 0.05, in_=["block"])
    flat = Cone(tip, tip + length * math.tan(angle), length, Pose((0.0, 0.0, length / 2.0)))
    assert first_touch([flat], offset, hole) == pytest.approx((radius - offset - tip) / math.tan(angle), abs=1e-10)
    low, bottom = tip * (1.0 - math.sin(angle)), tip * math.cos(angle)
    side = Cone(bottom, bottom + length * math.tan(angle), length, Pose((0.0, 0.0, low + length / 2.0)))
    pin = [Sphere(tip, Pose((0.0, 0.0, tip))), side]
    depth = tip + (radius - offset - tip / math.cos(angle)) / math.tan(angle)
    assert first_touch(pin, offset, hole) == pytest.approx(depth, abs=1e-10)


def test_a_pin_touches_the_chamfer_and_then_the_wall() -> None:
    """A flat pin beside the axis meets the chamfer where this is as wide, slides down it, and goes in."""
    radius, pin, offset = 0.006, 0.0055, 0.0015
    chamfer = Chamfer(0.002, math.radians(30.0))
    hole = Hole(radius, 0.03, chamfer, in_=["block"])
    held = Object(shapes=[Cylinder(pin, 0.04, Pose((0.0, 0.0, 0.02)))], pose=Pose((offset, 0.0, 0.02)))
    result = end_of(held, [block(), hole], [Load("in", forces=[Force(DOWN, at_m=(0.0, 0.0, 0.001))])])
    touch = (radius + chamfer.width_m - offset - pin) / math.tan(chamfer.angle_rad)
    assert result.phases[0].events[0].motion.distance_m - 0.02 == pytest.approx(touch, abs=1e-10)
    assert result.verdict == "rests"
    assert result.pose.position_m[2] == pytest.approx(-0.03, abs=1e-9)


def test_a_peg_wedges_where_the_cones_of_friction_see_each_other() -> None:
    """Under a moment that turns it upright, the least friction that holds is tan(atan(L / D) + t)."""
    wide, narrow, depth = 0.01206, 0.012, 0.009
    low, high = 0.0, 0.02
    for _ in range(200):
        t = 0.5 * (low + high)
        low, high = (t, high) if wide * math.cos(t) - depth * math.sin(t) > narrow else (low, t)
    length = 0.03
    corner = Pose((-wide / 2.0, 0.0, -depth)) @ Pose(euler_zyx=(0.0, t, 0.0))
    pose = corner @ Pose((narrow / 2.0, 0.0, length / 2.0))
    held = Object(shapes=[Cylinder(narrow / 2.0, length)], pose=pose, mass_kg=1.0)
    hole = Hole(wide / 2.0, 0.02, in_=["block"])
    scene = Scene(
        held,
        Cage(shapes=[block()], holes=[hole]),
        [Load("upright", moments=[Moment((0.0, -1.0, 0.0), 1.0)])],
        friction_coefficient=0.9,
    )
    result = with_critical_friction(run(scene))
    found = result.phases[0].proof.critical_friction
    assert found == pytest.approx(math.tan(math.atan2(depth, wide) + t), rel=1e-4)


@pytest.mark.parametrize(
    "part", [Cylinder(0.005, 0.01), Sphere(0.005), Capsule(0.005, 0.01)], ids=lambda part: part.kind
)
@pytest.mark.parametrize("direction", [(-1, 0), (1, 0), (-1, 0.001), (1, 0.01), (-1, -0.001)])
def test_a_part_that_lies_at_the_wall_of_a_bore_is_pushed_along_it_and_not_through(part, direction) -> None:
    """Where it starts it touches the wall, and the push is along that: it slides around to where the wall faces it."""
    bore = Hole(0.0051, 0.012, in_=["block"], pose_body_shape=Pose((0, 0, 0.006)), name="bore")
    across = Force((*direction, 0), (0, 0, 0))
    held = Object(shapes=[part], pose=Pose((0, -0.0001, 0)))
    result = end_of(held, [Box((0.1, 0.1, 0.012), name="block"), bore], [Load("push", force=across)])
    assert result.verdict == "rests"
    ended = result.pose.position_m[:2]
    assert ended == pytest.approx(0.0001 * np.array(direction) / np.hypot(*direction), abs=1e-9)
