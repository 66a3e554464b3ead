"""The places of the object that are nearest to what holds it."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Object, Pose
from cagepose.model.shapes import Capsule, Sphere
from cagepose.runs.driven_cage import cage_at_start
from cagepose.views.viewer.surface import nearest_on_object


def test_points_and_shapes_of_a_cage_find_the_nearest_part() -> None:
    parts = [Box((0.02, 0.02, 0.02), Pose((-0.02, 0, 0))), Sphere(0.01, Pose((0.02, 0, 0)))]
    held = Object(shapes=parts, center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.eye(3) * 1e-5)
    pin = Capsule(0.003, 0.04, Pose((0.04, 0, 0)), "pin")
    cage = Cage([(-0.02, 0, 0.015), (0.02, 0, 0.013)], shapes=[pin], pose=Pose((0, 0, 0.001)))
    found = nearest_on_object(held, Pose((0, 0, 0.001)), cage_at_start(cage))
    assert found.parts.tolist() == [0, 1, 1]
    assert found.feet_world == pytest.approx(np.array([(-0.02, 0, 0.011), (0.02, 0, 0.011), (0.03, 0, 0.001)]))
    assert found.places_world == pytest.approx(np.array([(-0.02, 0, 0.016), (0.02, 0, 0.014), (0.037, 0, 0.001)]))
    assert found.normals_world == pytest.approx(np.array([(0, 0, 1), (0, 0, 1), (1, 0, 0)]), abs=1e-12)
    again = nearest_on_object(held, Pose((0, 0, 0.001)), cage_at_start(cage), [2, 0])
    assert again.parts.tolist() == [1, 0]
