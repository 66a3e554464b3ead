"""Families without play: slots, and plates between opposite points, whose ending is known by hand."""

from __future__ import annotations

import numpy as np

from audit.draws import MM, Rng, any_turn, build, friction, push, weight
from cagepose import Box, Cage, Load, Object, Pose, Scene

STOP_AHEAD_MM = 3.0


def slot(rng: Rng) -> Scene:
    """A block between pairs of points that leave it exactly its own width in one to three directions."""
    size = np.round(rng.uniform(10, 60, 3), int(rng.integers(0, 4)))
    points = []
    for axis in rng.permutation(3)[: int(rng.integers(1, 4))]:
        for _ in range(int(rng.integers(1, 4))):
            low = rng.uniform(-0.45, 0.45, 3) * size
            high = low + (rng.uniform(-0.05, 0.05, 3) * size if rng.random() < 0.3 else 0.0)
            low[axis], high[axis] = -size[axis] / 2, size[axis] / 2
            points += [low, high]
    for axis in range(3):
        stop = rng.uniform(-0.4, 0.4, 3) * size
        stop[axis] = rng.choice([-1.0, 1.0]) * (size[axis] / 2 + rng.choice([0.0, 0.5, 2.0]))
        points.append(stop)
    loads = [weight(), push(rng, size / 2)][int(rng.integers(2)) :]
    pose = any_turn(rng) if rng.random() < 0.5 else Pose()
    return build([(size, np.zeros(3))], np.array(points), loads, friction(rng), pose=pose)


def open_plate(rng: Rng) -> Scene:
    """A smooth plate on a slope, pinched without play by one to four opposite pairs, nothing ahead: it slides out."""
    size, pairs = _plate(rng, int(rng.integers(1, 5)))
    heading = rng.uniform(0, 2 * np.pi)
    center = np.array([*rng.uniform(-0.3, 0.3, 2) * size[:2], 0.0])
    down = _down_the_slope(rng, np.array([np.cos(heading), np.sin(heading)]))
    return _plate_scene(rng, size, center, pairs, np.empty((0, 3)), down)


def stopped_plate(rng: Rng) -> Scene:
    """The same with two stops 3 mm ahead, one on each side of the centre of gravity: it comes to rest there.

    Of pairs there are three or four around the middle, which hold any tilting moment; or one or two with the centre
    of gravity over them at the end, so that there is none.
    """
    n_pairs = int(rng.integers(1, 5))
    size, pairs = _plate(rng, n_pairs)
    if n_pairs >= 3:
        angles = 2 * np.pi * (np.arange(n_pairs) + rng.uniform(-0.2, 0.2, n_pairs)) / n_pairs
        pairs = 0.3 * np.column_stack([np.cos(angles), np.sin(angles)]) * size[:2]
        center = np.array([*rng.uniform(-0.3, 0.3, 2) * size[:2], 0.0])
    else:
        center = np.array([*(rng.dirichlet(np.ones(n_pairs)) @ pairs - (STOP_AHEAD_MM, 0.0)), 0.0])
    sides = center[1] + np.array([-1.0, 1.0]) * rng.uniform(0.05, 0.15, 2) * size[1]
    stops = np.array([[size[0] / 2 + STOP_AHEAD_MM, y, 0.0] for y in sides])
    return _plate_scene(rng, size, center, pairs, stops, _down_the_slope(rng, np.array([1.0, 0.0])))


def _plate(rng: Rng, n_pairs: int) -> tuple[np.ndarray, np.ndarray]:
    """Size in millimetres, and the places of the pairs."""
    size = np.round([rng.uniform(40, 120), rng.uniform(30, 80), rng.uniform(2, 12)], 1)
    return size, rng.uniform(-0.35, 0.35, (n_pairs, 2)) * size[:2]


def _down_the_slope(rng: Rng, heading: np.ndarray) -> np.ndarray:
    return np.array([*heading * 10 ** rng.uniform(-3, 0), -1.0])


def _plate_scene(
    rng: Rng, size: np.ndarray, center: np.ndarray, pairs: np.ndarray, stops: np.ndarray, down: np.ndarray
) -> Scene:
    pinch = [[x, y, side * size[2] / 2] for x, y in pairs for side in (-1, 1)]
    turn = Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4)) if rng.random() < 0.5 else Pose()
    held = Object([Box(size * MM, name="plate")], center * MM, pose=turn)
    points = turn.transform(np.vstack([pinch, stops]) * MM)
    return Scene(held, Cage(points), [Load("weight", gravity=turn.rotation @ down)], friction_coefficient=0.0)
