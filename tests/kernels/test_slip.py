"""Slip: angles to the load and the number of independent normals (R4, R6 to R8)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose.kernels.stepwise.slip import independent_normals
from cagepose.kernels.stepwise.touching import load_angle


def independent(normals):
    n = len(normals)
    return independent_normals(np.arange(n), n, np.array(normals, dtype=float), 1e-6)


@pytest.mark.parametrize("angle_rad", [0.0, 1e-9, 0.1, math.pi / 2, math.pi - 1e-9, math.pi])
def test_the_angle_to_the_load_keeps_its_digits_at_both_ends(angle_rad):
    """acos of the dot product would lose half of the digits near 0 and pi."""
    found = load_angle((math.cos(angle_rad), math.sin(angle_rad), 0.0), (1.0, 0.0, 0.0))
    assert found == pytest.approx(angle_rad, abs=1e-15)


@pytest.mark.parametrize(
    ("normals", "count"),
    [
        ([(0, 0, 1)], 1),
        ([(0, 0, 1), (0, 0, 1), (0, 0, -1)], 1),
        ([(0, 0, 1), (0, 1, 0)], 2),
        ([(0, 0, 1), (0, 1, 0), (0, 0.6, 0.8), (0, -1, 0)], 2),
        ([(0, 0, 1), (0, 1, 0), (1, 0, 0)], 3),
        ([(0, 0, 1), (0, 0, -1), (0, 1, 0), (0.6, 0, 0.8)], 3),
    ],
)
def test_opposite_normals_are_one_direction_and_coplanar_ones_two(normals, count):
    assert independent(normals)[0] == count


def test_a_hair_of_misalignment_is_no_new_direction():
    for sine, count in ((1e-7, 1), (1e-5, 2)):
        assert independent([(0, 0, 1), (0, sine, math.sqrt(1 - sine**2))])[0] == count
        assert independent([(0, 0, 1), (0, 1, 0), (sine, 0, math.sqrt(1 - sine**2))])[0] == count + 1


def test_the_direction_left_by_two_normals_is_across_both():
    rng = np.random.default_rng(0)
    for _ in range(20):
        one, other = (vector / np.linalg.norm(vector) for vector in rng.normal(size=(2, 3)))
        count, across = independent([one, other, -one])
        assert count == 2
        assert_allclose([np.dot(across, one), np.dot(across, other), np.linalg.norm(across)], [0, 0, 1], atol=1e-14)
