"""Where on an arc another rim is nearest: all such places, also two that are about to be one."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose.kernels.algebra.record import empty_rows
from cagepose.kernels.shapes.features import RIM, Feature
from cagepose.kernels.shapes.rims import SEARCHED, feet_on


def arc(center: tuple, axis: np.ndarray, toward: np.ndarray, radius: float) -> Feature:
    made = empty_rows(Feature, 1)[0]
    made.kind, made.length = RIM, radius
    for k in range(3):
        made.point[k], made.direction[k], made.toward[k] = center[k], axis[k], toward[k]
    return made


def sampled_feet(center: tuple, axis: np.ndarray, radius: float) -> list[float]:
    """Angles along the arc of the unit circle about x where its distance from another circle is least."""
    angles = np.linspace(-SEARCHED, SEARCHED, 200_001)
    seen = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1) - np.array(center)
    height = seen @ axis
    distance = np.hypot(height, np.linalg.norm(seen - height[:, None] * axis, axis=1) - radius)
    inner = (distance[1:-1] < distance[:-2]) & (distance[1:-1] <= distance[2:])
    return list(angles[1:-1][inner])


@pytest.mark.parametrize(
    ("center", "axis", "radius"),
    [
        ((0.6403, 0.1647, 0.0864), (0.24, 0.058, 0.969), 0.35),
        ((0.6239, 0.029, 0.0419), (0.109, 0.021, 0.994), 0.38),
        ((-1.1179, 0.2036, -0.1289), (-0.059, 0.012, 0.998), 2.14),
        ((0.2835, -0.1084, 0.0633), (0.083, -0.035, 0.996), 0.7),
    ],
)
def test_feet_that_lie_near_each_other_are_found(center, axis, radius):
    """In one section of the arc the distance's slope dips beyond zero, and leads one way at both ends."""
    across = np.array(axis) / np.linalg.norm(axis)
    feet = feet_on(
        arc((0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 1.0),
        arc(center, across, np.cross([0.0, 1.0, 0.0], across), radius),
    )
    told = sampled_feet(center, across, radius)
    assert feet.n_feet == len(told)
    assert [feet.first, feet.last][: len(told)] == pytest.approx(told, abs=1e-4)
