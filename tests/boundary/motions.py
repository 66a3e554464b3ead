"""Random travels, turns and screws, where they lead, and how exactly what is met on the way has to be told."""

from __future__ import annotations

import math

import numpy as np

from cagepose import Pose
from cagepose.kernels.algebra.motion import Motion

TOUCH = 1e-9
"""Fraction of the size of the greater body, as in runs."""
TOLERANCE = 4.0
"""Touch tolerances: how deep parts may be where nothing was met, and how far apart where something was."""


def after(motion: Motion, pose: Pose, amount: float) -> Pose:
    """A pose after an amount of a motion: a turn about the axis that stays, and a travel along it."""
    center, velocity = np.array(motion.center), np.array(motion.velocity)
    if motion.rate == 0.0:
        return Pose(pose.position_m + velocity * amount, pose.quaternion_wxyz)
    axis, angle = np.array(motion.axis), motion.rate * amount
    through = center + np.cross(axis, velocity) / motion.rate
    turn = Pose((0, 0, 0), (math.cos(angle / 2.0), *(math.sin(angle / 2.0) * axis)))
    position = through + turn.transform(pose.position_m - through) + axis * (axis @ velocity) * amount
    return Pose(position, (turn @ Pose((0, 0, 0), pose.quaternion_wxyz)).quaternion_wxyz)


def motion_of(center: np.ndarray, velocity: np.ndarray, rate: float, axis: np.ndarray) -> Motion:
    return Motion(tuple(center.tolist()), tuple(velocity.tolist()), rate, tuple(axis.tolist()))


def random_direction(rng: np.random.Generator) -> np.ndarray:
    if rng.random() < 0.4:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)


def random_motion(rng: np.random.Generator, pose: Pose, towards: np.ndarray, size: float) -> Motion:
    kind = rng.choice(["travel", "turn", "screw"])
    center, velocity, axis, rate = pose.position_m, np.zeros(3), np.zeros(3), 0.0
    if kind != "turn":
        aimed = towards + rng.normal(size=3) * 0.3 * size
        velocity = aimed if rng.random() < 0.5 else random_direction(rng) * size
    if kind != "travel":
        axis, rate = random_direction(rng), float(rng.uniform(0.1, 2.0))
    if kind == "turn":
        center = center + rng.normal(size=3) * size * rng.choice([0.0, 1.0])
    return motion_of(center, velocity, rate, axis)


def leaves(motion: Motion, meetings) -> bool:
    """Whether a motion leads away at all places where parts touch, clearly."""
    for row in meetings.rows[: meetings.used[0]]:
        away = np.array(motion.velocity) + np.cross(
            motion.rate * np.array(motion.axis), row["place"] - np.array(motion.center)
        )
        if away @ row["normal"] > -1e-5 * np.linalg.norm(away):
            return False
    return True


def random_offset(rng: np.random.Generator) -> np.ndarray:
    """Any direction, or along an axis, a diagonal, ..."""
    if rng.random() < 0.6:
        return rng.normal(size=3)
    return rng.choice([-1.0, 0.0, 1.0], 3) + np.array((0.0, 1e-9, 0.0))
