"""Pose algebra: group axioms, closed forms, and scipy as an independent oracle."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cagepose.kernels.algebra import pose

quaternion_about, rotated = pose.quaternion_about, pose.rotated


def random_quaternion(rng):
    q = rng.normal(size=4)
    return tuple((q / np.linalg.norm(q)).tolist())


def scipy_rotation(q):
    return Rotation.from_quat([q[1], q[2], q[3], q[0]])


@pytest.mark.parametrize("seed", range(5))
def test_quaternions_are_a_group(seed):
    rng = np.random.default_rng(seed)
    p, q, r = (random_quaternion(rng) for _ in range(3))
    product = pose.quaternion_product
    assert_allclose(product(product(p, q), r), product(p, product(q, r)), atol=1e-15)
    assert_allclose(product(q, (1.0, 0.0, 0.0, 0.0)), q, atol=1e-15)
    assert_allclose(product(q, (q[0], -q[1], -q[2], -q[3])), (1.0, 0.0, 0.0, 0.0), atol=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_rotations_agree_with_scipy(seed):
    rng = np.random.default_rng(seed)
    q, vector = random_quaternion(rng), tuple(rng.normal(size=3).tolist())
    oracle = scipy_rotation(q)
    assert_allclose(rotated(q, vector), oracle.apply(vector), atol=1e-14)
    assert_allclose(pose.matrix_from_quaternion(q), oracle.as_matrix(), atol=1e-15)
    assert_allclose(pose.euler_zyx_from_quaternion(q), oracle.as_euler("ZYX"), atol=1e-13)


def test_a_quarter_turn_about_z_takes_x_to_y():
    assert_allclose(
        rotated(quaternion_about((0.0, 0.0, 1.0), math.pi / 2), (1.0, 0.0, 0.0)), (0.0, 1.0, 0.0), atol=1e-15
    )


def test_euler_angles_survive_the_round_trip(cases):
    rng = np.random.default_rng(7)
    for _ in range(cases(500, 2000)):
        yaw, roll = rng.uniform(-math.pi, math.pi, 2)
        pitch = rng.uniform(-1.57, 1.57)
        back = pose.euler_zyx_from_quaternion(pose.quaternion_from_euler_zyx(yaw, pitch, roll))
        assert_allclose(back, (yaw, pitch, roll), atol=1e-12)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_at_the_pole_the_rotation_survives_though_yaw_and_roll_merge(pitch):
    q = pose.quaternion_from_euler_zyx(0.4, pitch, 0.3)
    yaw, back_pitch, roll = pose.euler_zyx_from_quaternion(q)
    assert roll == 0.0
    assert_allclose(back_pitch, pitch, atol=1e-7)
    again = pose.quaternion_from_euler_zyx(yaw, back_pitch, roll)
    assert abs(np.dot(q, again)) == pytest.approx(1.0, abs=1e-12)


def test_small_angles_keep_their_digits():
    """Rail angles are 1e-3 rad and must be right to 1e-10 of that; asin or acos near their ends would not be."""
    back = pose.euler_zyx_from_quaternion(pose.quaternion_from_euler_zyx(1e-7, -2e-7, 3e-7))
    assert_allclose(back, (1e-7, -2e-7, 3e-7), rtol=1e-9)


def test_a_turn_leaves_its_axis_in_place_and_a_screw_moves_along_it():
    through, along = (1.0, 2.0, 3.0), (0.0, 0.6, 0.8)
    on_axis = tuple(np.add(through, np.multiply(along, 5.0)).tolist())
    position, _ = pose.moved_pose(on_axis, (1.0, 0.0, 0.0, 0.0), along, through, 0.0, 1.2)
    assert_allclose(position, on_axis, atol=1e-14)
    position, _ = pose.moved_pose(on_axis, (1.0, 0.0, 0.0, 0.0), along, through, 0.5, 1.2)
    assert_allclose(position, np.add(on_axis, np.multiply(along, 0.5)), atol=1e-14)


def test_two_half_motions_make_the_whole():
    rng = np.random.default_rng(3)
    axis = rng.normal(size=3)
    along = tuple((axis / np.linalg.norm(axis)).tolist())
    through, start = tuple(rng.normal(size=3).tolist()), tuple(rng.normal(size=3).tolist())
    q = random_quaternion(rng)
    whole = pose.moved_pose(start, q, along, through, 0.3, 1.0)
    half = pose.moved_pose(*pose.moved_pose(start, q, along, through, 0.15, 0.5), along, through, 0.15, 0.5)
    assert_allclose(half[0], whole[0], atol=1e-14)
    assert_allclose(half[1], whole[1], atol=1e-15)
