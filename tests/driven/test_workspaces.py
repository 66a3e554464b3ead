"""Scenes of the same shapes share memory for a run only where what acts and what is driven takes as much of it."""

from __future__ import annotations

import pytest

import cagepose
from cagepose import Box, Cage, CageBody, Drive, Load, Object, Pose, Scene, Spring

DOWN = (0.0, 0.0, -9.81)


def carried(*springs: Spring, legs: int = 1) -> Scene:
    """A block that a shelf carries up by 0.1 m in so many legs, with springs between them."""
    block = Object([Box((0.02, 0.04, 0.02))], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    shelf = CageBody("shelf", shapes=[Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "top")])
    drive = {"shelf": [Drive((0, 0, 0.1 / legs))] * legs}
    load = Load("carry", gravity=DOWN, springs=springs, drive=drive)
    return Scene(block, Cage(bodies=[shelf]), [load], friction_coefficient=0.3)


def test_a_scene_with_more_springs_or_legs_runs_after_one_with_fewer() -> None:
    pulls = [Spring((0, 0, 0), (0, 0, -0.05 * k), 1000.0, 7.0, of="shelf") for k in (1, 2, 3)]
    for springs, legs in (((), 1), (pulls[:1], 1), (pulls, 1), ((), 5), (pulls, 4)):
        run = cagepose.run(carried(*springs, legs=legs))
        assert run.pose.position_m == pytest.approx((0.0, 0.0, 0.11), abs=1e-8)
        carries = sum(contact.force_normal_n or 0.0 for contact in run.contacts)
        assert carries == pytest.approx(9.81 + 7.0 * len(springs), rel=1e-9)
