"""What slides in a hollow edge strays beyond it, and is met there; beyond a sharp edge there is nothing."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.kernels.algebra.motion import Motion

STEP = [
    Box((2.0, 2.0, 1.0), Pose((0.0, 0.0, -0.5))),
    Box((1.0, 2.0, 2.0), Pose((-1.5, 0.0, 0.0))),
    Box((1.0, 2.0, 1.0), Pose((2.5, 0.0, -1.0))),
]
"""A floor whose top is at z = 0, sharp at x = 1, with a wall that rises at x = -1; and, lower, one beside it."""
UP = Motion((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0, (0.0, 0.0, 0.0))
HEIGHT = 1e-3


def first(x: float, reach_m: float) -> float:
    """When the top, which rises, meets a point above it."""
    return Asked(STEP, [np.array([x, 0.1, HEIGHT])], 1e-9).first(UP, 0.1, near_depth_m=reach_m).amount


@pytest.mark.parametrize("beyond", [1e-8, 1e-4])
def test_a_contact_counts_beyond_a_hollow_end_as_far_as_it_may_stray(beyond):
    assert first(-1.0 - beyond, 2e-4) == pytest.approx(HEIGHT, rel=1e-9)


@pytest.mark.parametrize("beyond", [1e-8, 1e-4])
def test_no_contact_counts_beyond_a_sharp_end(beyond):
    assert first(1.0 + beyond, 2e-4) == np.inf
    assert first(1.0 - beyond, 2e-4) == pytest.approx(HEIGHT, rel=1e-9)
