"""The family of unions of boxes, turned and overlapping, with points around them: ties, seams and grazing."""

from __future__ import annotations

import numpy as np

from audit.case import FloatArray
from audit.draws import Rng
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene


def union(rng: Rng) -> Scene:
    """1 to 6 boxes, 3 to 24 points, gravity, a push, or both one after the other; without friction."""
    held = _object(rng, int(rng.integers(1, 7)))
    points = _points(rng, held, int(rng.integers(3, 25)))
    gravity = Load("gravity", gravity=_direction(rng))
    push = Load("push", force=Force(_direction(rng), rng.uniform(-0.015, 0.015, 3)))
    loads = [[gravity], [push], [gravity, push]][rng.integers(3)]
    return Scene(held, Cage(points), loads, name="random")


def _object(rng: Rng, n_boxes: int) -> Object:
    """Boxes of 2 to 20 mm near the origin; half of them aligned, half of them turned; some flush with each other."""
    boxes = []
    for _ in range(n_boxes):
        size = np.round(rng.uniform(0.002, 0.020, 3), 3)
        position = np.round(rng.uniform(-0.010, 0.010, 3), 3)
        boxes.append(Box(size, Pose(position, rng.normal(size=4)) if rng.random() < 0.5 else Pose(position)))
    pose = Pose(rng.uniform(-0.005, 0.005, 3), rng.normal(size=4)) if rng.random() < 0.5 else Pose()
    center = rng.uniform(-0.005, 0.005, 3)
    return Object(boxes, center, pose=pose)


def _points(rng: Rng, held: Object, n_points: int) -> FloatArray:
    """Points outside of the object, near its surface more often than far away; some are mirrored twins (ties)."""
    points: list[FloatArray] = []
    while len(points) < n_points:
        if points and rng.random() < 0.2:
            candidate = points[-1] * rng.choice([-1.0, 1.0], 3)
        elif rng.random() < 0.5:
            box = held.boxes[rng.integers(len(held.boxes))]
            on_box = rng.uniform(-0.5, 0.5, 3) * box.size_m
            axis = rng.integers(3)
            on_box[axis] = rng.choice([-0.5, 0.5]) * box.size_m[axis] + rng.choice([-1.0, 1.0]) * rng.choice(
                [0.0, 1e-5, 1e-3]
            )
            candidate = held.pose_world_object.transform(box.pose_object_box.transform(on_box))
        else:
            candidate = rng.uniform(-0.025, 0.025, 3)
        outside = all(
            (
                np.abs(box.pose_object_box.inverse_transform(held.pose_world_object.inverse_transform(candidate)))
                - box.size_m / 2.0
            ).max()
            >= -1e-12
            for box in held.boxes
        )
        apart = all(np.linalg.norm(candidate - point) > 1e-6 for point in points)
        if outside and apart:
            points.append(candidate)
    return np.array(points)


def _direction(rng: Rng) -> FloatArray:
    """Often along an axis, where ties and grazing live."""
    if rng.random() < 0.5:
        direction = np.zeros(3)
        direction[rng.integers(3)] = rng.choice([-1.0, 1.0])
        return direction
    return rng.normal(size=3)
