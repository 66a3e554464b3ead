"""Features of shapes in the world: NumPy places them all at once where kernels do it one by one."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Pose, load_scene
from cagepose.kernels.shapes.features import copied, place_shapes
from cagepose.model.features import placed_shapes
from cagepose.model.geometry import cage_shapes
from our_scenes import SCENES


@pytest.mark.parametrize("name", ["chuck", "drawer", "plate-on-pins", "rollers"])
def test_all_at_once_gives_what_the_kernel_gives(name: str) -> None:
    scene = load_scene(next(path for path in SCENES if path.stem == name))
    shapes, pose = cage_shapes(scene.object, scene.cage), Pose((0.1, -0.2, 0.3), euler_zyx=(0.4, -0.5, 0.6))
    one_by_one = copied(shapes)
    place_shapes(shapes, *pose.as_tuples(), one_by_one)
    for found, expected in zip(placed_shapes(shapes, pose), one_by_one, strict=True):
        for field in found.dtype.names:  # type: ignore[attr-defined]
            assert np.allclose(found[field], expected[field], rtol=0.0, atol=1e-15), field
