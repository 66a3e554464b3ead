"""Mechanisms in the plane whose answers are known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, play, run, with_critical_friction

WEIGHT = Load("weight", gravity=(0.0, 0.0, -9.81))


def critical_friction(scene: Scene) -> float:
    found = with_critical_friction(run(scene)).phases[-1].proof.critical_friction
    assert found is not None
    return found


@pytest.mark.parametrize("planar", ["xy", "xz", "yz"])
def test_a_block_stays_on_a_slope_up_to_its_angle_of_friction(planar):
    """In each plane: the slope is turned about the third axis."""
    along, up = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}[planar]
    slope, sizes = math.radians(20.0), (np.full(3, 0.02), np.full(3, 0.02))
    sizes[0][along], sizes[1][along] = 0.05, 0.5
    normal = 3 - along - up
    spin = np.eye(3)[normal] * slope
    turned = Pose(euler_zyx=tuple(spin[::-1]))
    way = turned.rotation[:, up]
    block = Object([Box(tuple(sizes[0]))], pose=Pose(0.0200001 * way, turned.quaternion_wxyz), mass_kg=1.0)
    floor = Cage([], shapes=[Box(tuple(sizes[1]), turned)])
    loads = [Load("weight", gravity=tuple(-9.81 * np.eye(3)[up]))]
    scene = Scene(block, floor, loads, friction_coefficient=0.5, planar=planar)
    found = run(scene)
    assert (found.verdict, found.phases[0].proof.stability) == ("rests", "stable")
    assert critical_friction(scene) == pytest.approx(math.tan(slope), rel=1e-9)
    slides = run(scene.changed(friction_coefficient=0.36)).phases[0]
    assert slides.verdict == "escapes"
    assert slides.pose.position_m[normal] == 0.0


@pytest.mark.parametrize("angle_deg", [40.0, 55.0, 70.0])
def test_a_ladder_needs_the_friction_at_which_both_its_ends_slip(angle_deg):
    """The forces at both ends, at the angle of friction from their normals, meet above the centre of gravity (x = g):
    (b - g) t^2 + h t - g = 0 for t = tan(angle of friction), its ends b apart along the floor and h along the wall.
    """
    angle, length, thickness = math.radians(angle_deg), 1.0, 0.02
    corners = np.array([(-0.5 * length, -0.5 * thickness), (0.5 * length, -0.5 * thickness)])
    rotation = np.array([(math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))])
    foot, head = corners @ rotation.T
    b, h = head - foot
    g = -foot[0]
    needed = (-h + math.sqrt(h * h + 4.0 * (b - g) * g)) / (2.0 * (b - g))
    start = Pose((-head[0], 0.0, -foot[1]), euler_zyx=(0.0, -angle, 0.0))
    ladder = Object([Box((length, 0.05, thickness))], pose=start, mass_kg=1.0)
    walls = [Box((4.0, 1.0, 1.0), Pose((0.0, 0.0, -0.5)), "floor"), Box((1.0, 1.0, 4.0), Pose((0.5, 0.0, 0.0)), "wall")]
    scene = Scene(ladder, Cage([], shapes=walls), [WEIGHT], friction_coefficient=1.05 * needed, planar="xz")
    assert run(scene).verdict in ("rests", "may rest")
    assert critical_friction(scene) == pytest.approx(needed, rel=1e-9)
    slips = run(scene.changed(friction_coefficient=0.95 * needed)).phases[0]
    assert slips.events[0].motion is not None
    assert abs(slips.pose.position_m[1]) < 1e-15


@pytest.mark.parametrize("lever", [0.05, 0.1, 0.3])
def test_a_peg_that_is_pulled_off_its_middle_jams_in_its_hole_from_half_the_length_over_the_lever(lever):
    """N l = F e and 2 mu N = F: mu = l / 2 e, as of a drawer, at the two places that it leans on."""
    length, width = 0.04, 0.01
    peg = Object([Box((0.4, 0.01, width))], mass_kg=1.0)
    guides = Cage([(-0.5 * length, 0.0, 0.5 * width), (0.5 * length, 0.0, -0.5 * width)])
    pull = Load("pull", force=Force((1.0, 0.0, 0.0), (0.0, 0.0, lever), magnitude_n=5.0))
    scene = Scene(peg, guides, [pull], friction_coefficient=1.0, planar="xz")
    assert critical_friction(scene) == pytest.approx(0.5 * length / lever, rel=1e-9)


def test_a_plate_shares_its_weight_between_two_pins_by_the_law_of_the_lever():
    plate = Object([Box((0.1, 0.005, 0.03))], pose=Pose((0.0, 0.0, 0.0151)), mass_kg=1.0)
    found = run(Scene(plate, Cage([(-0.04, 0.0, 0.0), (0.01, 0.0, 0.0)]), [WEIGHT], planar="xz"))
    assert (found.verdict, found.phases[0].proof.undetermined) == ("rests", ("x",))
    forces = {contact.point: contact.force_normal_n for contact in found.contacts}
    assert forces == pytest.approx({"C1": 9.81 * 0.2, "C2": 9.81 * 0.8}, rel=1e-12)


def test_a_pin_in_a_slot_turns_until_it_is_wedged():
    """W cos t - l sin t = w, of a pin w wide in guides that are W apart and l long."""
    wide, length, pin = 0.0105, 0.03, 0.01
    guides = Cage([(x, 0.0, z) for x in (-0.5 * length, 0.5 * length) for z in (-0.5 * wide, 0.5 * wide)])
    scene = Scene(Object([Box((0.2, 0.01, pin))]), guides, [WEIGHT], planar="xz")
    found = play(scene, search_s=0.0)
    assert tuple(found.freedoms) == ("x", "z", "pitch")
    assert found.freedoms["x"].high.is_open
    turn = found.freedoms["pitch"].high.exact
    assert turn is not None
    assert wide * math.cos(turn) - length * math.sin(turn) == pytest.approx(pin, abs=1e-12)
    assert found.freedoms["z"].low.exact == pytest.approx(-0.5 * (wide - pin), abs=1e-12)


def test_what_could_only_leave_across_its_plane_is_caged():
    beside = [(x, 0.0, z) for x in (-0.0101, 0.0101) for z in (-0.008, 0.008)]
    ring = Cage([*beside, (0.0, 0.0, -0.0101), (0.0, 0.0, 0.0101)])
    block = Object([Box((0.02, 0.01, 0.02))])
    in_plane = play(Scene(block, ring, [WEIGHT], planar="xz"), search_s=0.0)
    assert in_plane.verdict == "caged"
    for ends in in_plane.freedoms.values():
        for end in (ends.low, ends.high):
            assert end.certified is not None
            assert end.exact is not None
            assert 0.0 < abs(end.exact) <= abs(end.certified) < 1.2 * abs(end.exact)
    assert play(Scene(block, ring, [WEIGHT]), search_s=1.0).verdict == "escapes"
