"""As many meetings as there is memory for are known, or none of them; a tip of many faces stands on a point."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Cage, Convex, Load, Object, Pose, Scene, run
from cagepose.kernels.boundary.touching import empty_meetings


def tip(n_sides: int) -> Convex:
    """A pyramid that stands on its tip."""
    around = np.linspace(0.0, 2.0 * np.pi, n_sides, endpoint=False) + 0.1
    rim = np.column_stack([0.3 * np.cos(around), 0.3 * np.sin(around), np.ones(n_sides)])
    return Convex(np.vstack([np.zeros(3), rim]))


def test_meetings_for_which_there_is_no_room_are_not_taken_for_fewer():
    points = [np.array([x, y, 0.0]) for x in (-1.0, -0.5, 0.0, 0.5, 1.0) for y in (-0.2, 0.2)]
    asked = Asked([Box((4.0, 1.0, 1.0), Pose((0.0, 0.0, 0.5)))], points, 1e-9)
    for n_rows in range(1, len(points) + 1):
        asked.found = empty_meetings(len(asked.held.own.features), n_rows)
        assert asked.place(Pose()).used[0] == (len(points) if n_rows == len(points) else -1)


@pytest.mark.parametrize("n_sides", [6, 13, 40])
def test_a_tip_of_many_faces_on_a_point_falls_over(n_sides):
    held = Object(shapes=[tip(n_sides)], center_of_gravity_m=(0.01, 0.0, 0.7))
    scene = Scene(held, Cage(np.zeros((1, 3))), [Load("weight", gravity=(0.0, 0.0, -1.0))], friction_coefficient=0.3)
    assert run(scene).verdict == "escapes"
