"""A scene in the plane beside the same one between a floor and a lid, with all six freedoms."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Cylinder, Load, Moment, Object, Pose, Scene, Spring, run
from cagepose.runs.run import AT_REST
from planar.floor_and_lid import drawn_pair

SEEDS = (1, 2, 4, 5, 9, 14, 17, 19, 21, 22, 23, 24, 30, 31)
SAME = 1e-9
"""In sizes of the scene, radians and loads."""
SAME_WAY = 1e-3
"""The same where friction holds the plate on its way, which two runs follow by different steps."""


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_plate_in_the_plane_does_as_between_a_floor_and_a_lid(seed, friction):
    pair = drawn_pair(seed, friction)
    one, other = run(pair.planar), run(pair.between_walls)
    assert [phase.verdict for phase in one.phases] == [phase.verdict for phase in other.phases]
    for phase, same in zip(one.phases, other.phases, strict=True):
        assert phase.pose.position_m[1] == 0.0
        assert phase.proof.stability == same.proof.stability
        if phase.verdict not in AT_REST:
            continue
        allowed = SAME_WAY if phase.proof.needs_friction else SAME
        away = np.abs(phase.pose.position_m - same.pose.position_m).max() / one.scene.size_m
        assert away <= allowed
        assert np.abs(phase.pose.quaternion_wxyz - same.pose.quaternion_wxyz).max() <= allowed
        theirs = {contact.point: contact for contact in same.contacts if contact.point not in ("floor", "lid")}
        ours = {contact.point: contact for contact in phase.contacts}
        assert set(ours) == set(theirs)
        for name, contact in ours.items():
            assert contact.force_normal_n == pytest.approx(theirs[name].force_normal_n, abs=100.0 * allowed)


@pytest.mark.parametrize("seed", [100, 101, 103, 106, 107, 110])
def test_so_do_round_parts_with_springs_and_moments(seed):
    rng = np.random.default_rng(seed)
    on_side = (0.0, 0.0, 0.5 * np.pi)
    round_end = Cylinder(0.012, 0.01, Pose((0.02, 0.0, 0.005), euler_zyx=on_side))
    start = Pose((0.0, 0.0, 0.06), euler_zyx=(0.0, rng.uniform(-1.0, 1.0), 0.0))
    held = Object([Box((0.04, 0.01, 0.02))], shapes=[round_end], pose=start, mass_kg=1.0)
    shapes = [
        Cylinder(0.010, 0.05, Pose((-0.03, 0.0, 0.0), euler_zyx=on_side)),
        Cylinder(0.015, 0.05, Pose((0.03, 0.0, -0.004), euler_zyx=on_side)),
        *(Box((0.01, 0.05, 0.1), Pose((x, 0.0, 0.0))) for x in (-0.09, 0.09)),
    ]
    walls = [Box((1.0, 0.01, 1.0), Pose((0.0, y, 0.0))) for y in (-0.01, 0.01)]
    spring = Spring((0.01, 0.0, 0.0), (rng.uniform(-0.05, 0.05), 0.0, -0.05), 200.0, preload_n=2.0)
    turning = Moment((0.0, 1.0, 0.0), rng.uniform(0.001, 0.05))
    loads = [Load("weight", gravity=(0.0, 0.0, -9.81), springs=[spring], moments=[turning])]
    one = run(Scene(held, Cage([], shapes=shapes), loads, planar="xz"))
    other = run(Scene(held, Cage([], shapes=[*shapes, *walls]), loads))
    assert (one.verdict, one.phases[0].proof.stability) == ("rests", "stable")
    assert (other.verdict, other.phases[0].proof.stability) == ("rests", "stable")
    assert np.abs(one.pose.position_m - other.pose.position_m).max() <= SAME * one.scene.size_m
    assert np.abs(one.pose.quaternion_wxyz - other.pose.quaternion_wxyz).max() <= SAME
