"""Seeded random scenes in which one or two boxes are caged: points beside every face, at small gaps."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, Load, Object, Pose, Scene

MM = 1e-3
LOADS = (Load("gravity", gravity=(0, 0, -1)),)


def caged_scene(rng: np.random.Generator) -> Scene:
    """A box of 10 to 50 mm with three to five points beside each face, 0.01 to 0.2 mm away; sometimes a second box."""
    size = rng.uniform(10, 50, 3)
    boxes = [Box(size * MM)]
    points = []
    for axis in range(3):
        for side in (-1, 1):
            for _ in range(rng.integers(3, 6)):
                point = rng.uniform(-0.4, 0.4, 3) * size
                point[axis] = side * (size[axis] / 2 + rng.uniform(0.01, 0.2))
                points.append(point)
    if rng.random() < 0.3:  # inside the first one, but for a rim that stands out below its points
        boxes.append(Box(size * (0.3, 0.3, 1) * MM, Pose((0, 0, -0.4 * size[2] * MM))))
        points = [p for p in points if p[2] > -size[2] / 2]
        points += [np.array([x, y, -0.9 * size[2] - 0.1]) for x in (-1, 1) for y in (-1, 0.5)]
    turn = Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4))
    world = turn.transform(np.array(points) * MM)
    cage = Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4))
    return Scene(Object(boxes, pose=turn), Cage(cage.inverse_transform(world), pose=cage), LOADS)
