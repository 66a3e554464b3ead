"""What linearising leaves out, (7.8), and angles from rotation vectors, (7.10): no sample passes its bound."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.play.certificate import Certificate, angle_bound
from cagepose.kernels.play.goal import PITCH, ROLL, YAW, Goal
from cagepose.kernels.play.remainder import gap_left_out, turning_left_out


def samples(rng: np.random.Generator, size: np.ndarray, n: int) -> np.ndarray:
    """Vectors with |x_k| <= size_k, half of them at corners, where the bounds are nearly reached."""
    inside = rng.uniform(-1, 1, (n, len(size)))
    inside[::2] = np.sign(inside[::2])
    return inside * size


def unit(rng: np.random.Generator) -> np.ndarray:
    vector = np.eye(3)[rng.integers(3)] if rng.random() < 0.3 else rng.normal(size=3)
    return vector / np.linalg.norm(vector)


@pytest.mark.parametrize("largest_turn", [0.01, 0.5])
def test_no_gap_differs_from_the_linear_one_by_more_than_its_bound(largest_turn, cases):
    rng = np.random.default_rng(1)
    shares = []
    for _ in range(cases(100, 400)):
        n, arm = unit(rng), rng.uniform(-1, 1, 3)
        travel, turn = rng.uniform(0, 0.3, 3) * rng.integers(0, 2, 3), rng.uniform(0, largest_turn, 3)
        above, size = gap_left_out(tuple(n), tuple(arm), tuple(travel), tuple(turn))
        t, w = samples(rng, travel, 200), samples(rng, turn, 200)
        exact = Rotation.from_rotvec(w).inv().apply(arm - t) @ n - n @ arm
        linear = -(t @ n + w @ np.cross(arm, n))
        assert (exact - linear).max() <= above
        assert np.abs(exact - linear).max() <= size
        shares.append((exact - linear).max() / above)
    assert max(shares) > 0.8  # it could not be much smaller


@pytest.mark.parametrize("largest_turn", [0.01, 0.5])
def test_no_point_goes_farther_than_its_linear_way_by_more_than_its_bound(largest_turn, cases):
    rng = np.random.default_rng(2)
    shares = []
    for _ in range(cases(100, 400)):
        a, arm, turn = unit(rng), rng.uniform(-1, 1, 3), rng.uniform(0, largest_turn, 3)
        above, size = turning_left_out(tuple(a), tuple(arm), tuple(turn))
        w = samples(rng, turn, 200)
        left_out = (Rotation.from_rotvec(w).apply(arm) - arm - np.cross(w, arm)) @ a
        assert left_out.max() <= above
        assert np.abs(left_out).max() <= size
        shares.append(left_out.max() / above)
    assert max(shares) > 0.8


def test_no_rotation_vector_within_the_extents_has_a_larger_angle(cases):
    rng = np.random.default_rng(3)
    certificate, goal = empty_record(Certificate), empty_record(Goal)
    shares = []
    for _ in range(cases(100, 400)):
        low, high = -rng.uniform(0, 0.5, 3), rng.uniform(0, 0.5, 3)
        certificate.least[3:], certificate.greatest[3:] = low, high
        certificate.turn[:] = np.maximum(-low, high)
        w = samples(rng, np.ones(3), 200) * 0.5 * (high - low) + 0.5 * (high + low)
        angles = Rotation.from_rotvec(w).as_euler("ZYX")
        for kind, column in ((YAW, 0), (PITCH, 1), (ROLL, 2)):
            for sign in (-1.0, 1.0):
                goal.kind, goal.sign = kind, sign
                bound = angle_bound(goal, certificate)
                assert (sign * angles[:, column]).max() <= bound
                shares.append((sign * angles[:, column]).max() / bound)
    assert max(shares) > 0.8
