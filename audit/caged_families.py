"""Families in which points stand around a part on all sides, so that it has play and cannot get out."""

from __future__ import annotations

import math

import numpy as np

from audit.case import FloatArray
from audit.draws import MM, Rng, friction
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene

GRAVITY = (Load("gravity", gravity=(0, 0, -1)),)


def caged(rng: Rng) -> Scene:
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
    return Scene(Object(boxes, pose=turn), Cage(cage.inverse_transform(world), pose=cage), GRAVITY)


def caged_seams(rng: Rng) -> Scene:
    """Points near edges and seams and in notches, at gaps of a thousandth to a fifth of a box; any size and turn."""
    size = rng.uniform(5, 50, 3)
    if rng.random() < 0.3:
        size[rng.integers(3)] *= 10 ** rng.uniform(-1.5, 1.5)
    scale = 10.0 ** rng.uniform(-6, 3)
    widest = min(1.0, size.min() / 5) * 10 ** rng.uniform(-3, 0)
    near = 1 - 10 ** rng.uniform(-3, -0.5)
    points = _beside(rng, size, widest, near, 5)
    boxes = [(size, Pose())]
    for _ in range(rng.integers(0, 4)):
        if rng.random() < 0.5:  # flush with the first: a seam
            other, axis = size.copy(), rng.integers(3)
            pose = Pose(np.eye(3)[axis] * size[axis])
        else:
            other = size * rng.uniform(0.1, 1.2, 3)
            pose = Pose(rng.uniform(-0.8, 0.8, 3) * size, rng.normal(size=4) if rng.random() < 0.5 else None)
        inside = (np.abs(pose.inverse_transform(points)) < other / 2).all(axis=1)
        if inside.sum() <= len(points) // 2:
            points = points[~inside]
            boxes.append((other, pose))
    for other, pose in boxes[1:]:
        more = pose.transform(_beside(rng, other, widest, near, 2))
        is_out = [(np.abs(place.inverse_transform(more)) > edges / 2).any(axis=1) for edges, place in boxes]
        points = np.vstack([points, more[np.all(is_out, axis=0)]])
    turn = Pose(rng.uniform(-20, 20, 3) * scale, rng.normal(size=4))
    cage = Pose(rng.uniform(-20, 20, 3) * scale, rng.normal(size=4))
    parts = [Box(edges * scale, Pose(pose.position_m * scale, pose.quaternion_wxyz)) for edges, pose in boxes]
    world = turn.transform(points * scale)
    return Scene(Object(parts, pose=turn), Cage(cage.inverse_transform(world), pose=cage), GRAVITY)


def pushed_block(rng: Rng, mu: float | None = None) -> Scene:
    """A block between 8 to 18 points on its six sides, play 0.1 to 1 mm; weight and a push somewhere in one phase.

    A coefficient of friction that is given is not drawn.
    """
    size = rng.uniform(20, 60, 3)
    faces = [*range(6), *rng.integers(0, 6, rng.integers(2, 13))]
    points = rng.uniform(-0.45, 0.45, (len(faces), 3)) * size
    for point, face in zip(points, faces, strict=True):
        axis = face // 2
        point[axis] = (1 if face % 2 else -1) * (size[axis] / 2 + rng.uniform(0.1, 1))
    push = Force(rng.normal(size=3), rng.uniform(-0.4, 0.4, 3) * size * MM)
    load = Load("push", gravity=(0, 0, -1), force=push)
    coefficient = friction(rng) if mu is None else mu
    return Scene(Object([Box(size * MM)]), Cage(points * MM), [load], friction_coefficient=coefficient)


def _beside(rng: Rng, size: FloatArray, widest: float, near: float, most: int) -> FloatArray:
    """One to ``most`` - 1 points before each face, many of them near an edge."""
    points = []
    for axis in range(3):
        for side in (-1, 1):
            for _ in range(rng.integers(1, most)):
                point = rng.uniform(-near, near, 3) * size / 2
                if rng.random() < 0.4:
                    along = (axis + rng.integers(1, 3)) % 3
                    point[along] = math.copysign(near * size[along] / 2, point[along])
                point[axis] = side * (size[axis] / 2 + rng.uniform(1e-3, 1) * widest)
                points.append(point)
    return np.array(points)
