"""Seeded random scenes: boxes that may be turned and overlap, cage points around them, one or two loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, SceneError


def random_pose(rng: np.random.Generator, spread: float) -> Pose:
    """A pose with any orientation and a position within ``spread`` of the origin."""
    return Pose(rng.uniform(-spread, spread, 3), rng.normal(size=4))


def random_object(rng: np.random.Generator, n_boxes: int) -> Object:
    """Boxes of 2 to 20 mm near the origin; half of them aligned, half of them turned; some flush with each other."""
    boxes = []
    for _ in range(n_boxes):
        size = np.round(rng.uniform(0.002, 0.020, 3), 3)
        position = np.round(rng.uniform(-0.010, 0.010, 3), 3)
        boxes.append(Box(size, Pose(position, rng.normal(size=4)) if rng.random() < 0.5 else Pose(position)))
    pose = random_pose(rng, 0.005) if rng.random() < 0.5 else Pose()
    center = rng.uniform(-0.005, 0.005, 3)
    return Object(boxes, center, pose=pose)


def random_points(rng: np.random.Generator, held: Object, n_points: int) -> np.ndarray:
    """Points outside of the object, near its surface more often than far away; some are mirrored twins (ties)."""
    points: list[np.ndarray] = []
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


def random_direction(rng: np.random.Generator) -> np.ndarray:
    """Often along an axis, where ties and grazing live."""
    if rng.random() < 0.5:
        direction = np.zeros(3)
        direction[rng.integers(3)] = rng.choice([-1.0, 1.0])
        return direction
    return rng.normal(size=3)


def random_scene(rng: np.random.Generator) -> Scene:
    """1 to 6 boxes, 3 to 24 points, gravity, a push, or both one after the other."""
    held = random_object(rng, int(rng.integers(1, 7)))
    points = random_points(rng, held, int(rng.integers(3, 25)))
    gravity = Load("gravity", gravity=random_direction(rng))
    push = Load("push", force=Force(random_direction(rng), rng.uniform(-0.015, 0.015, 3)))
    loads = [[gravity], [push], [gravity, push]][rng.integers(3)]
    return Scene(held, Cage(points), loads, name="random")


def random_scenes(n_scenes: float, seed: int) -> Iterator[Scene]:
    """Yield ``n_scenes`` scenes, or without end; the same ones for the same seed.

    A draw that is refused at the door (a point in the seam between two flush boxes) is drawn again.
    """
    rng = np.random.default_rng(seed)
    n_drawn = 0
    while n_drawn < n_scenes:
        try:
            scene = random_scene(rng)
        except SceneError:
            continue
        n_drawn += 1
        yield scene
