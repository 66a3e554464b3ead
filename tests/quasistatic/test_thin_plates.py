"""Thin plates beside each other: the far edges of one are no deeper in the other than it is thick."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Pose, Scene, run

CARD = (0.094, 0.064, 0.0007)
FLOOR = Box((2.0, 2.0, 0.1), Pose((0.0, 0.0, -0.55)), name="floor")


def test_a_card_that_slides_off_another_one_ends_flat_on_the_floor(cases):
    """It falls onto the lower edge of one in the air, three degrees less steep, and slides down along it."""
    rng = np.random.default_rng(11)
    steep, less_steep = math.radians(80.0), math.radians(77.0)
    for _ in range(cases(8, 200)):
        aside, away, up = rng.uniform(-0.01, 0.01), rng.uniform(0.0028, 0.0034), rng.uniform(0.0, 0.005)
        standing = Box(CARD, Pose((aside, away, -0.005), euler_zyx=(0.0, 0.0, less_steep)), name="card")
        held = Object([Box(CARD)], pose=Pose((0.0, 0.0, up), euler_zyx=(0.0, 0.0, steep)))
        weight = Load("weight", gravity=(0.0, 0.0, -9.81))
        done = run(Scene(held, Cage(shapes=[standing, FLOOR]), [weight], friction_coefficient=0.3))
        assert done.verdict == "rests"
        assert done.pose.position_m[2] == pytest.approx(-0.5 + CARD[2] / 2, abs=1e-9)
