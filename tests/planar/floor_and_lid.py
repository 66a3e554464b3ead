"""Plates among points, in the plane and between a floor and a lid without friction that fit exactly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene

THICKNESS_M = 0.01


class Pair(NamedTuple):
    """One scene twice."""

    planar: Scene
    between_walls: Scene


def drawn_pair(seed: int, friction: float) -> Pair:
    """Return a plate of two boxes that falls onto three to five points, and is pushed then."""
    rng = np.random.default_rng(seed)
    first = Box((rng.uniform(0.02, 0.05), THICKNESS_M, rng.uniform(0.02, 0.05)))
    place = Pose((rng.uniform(-0.01, 0.01), 0.0, rng.uniform(-0.01, 0.01)), euler_zyx=(0.0, rng.uniform(-1, 1), 0.0))
    second = Box((rng.uniform(0.01, 0.03), THICKNESS_M, rng.uniform(0.01, 0.06)), place)
    start = Pose((rng.uniform(-0.01, 0.01), 0.0, 0.12), euler_zyx=(0.0, rng.uniform(-0.5, 0.5), 0.0))
    plate = Object([first, second], pose=start, mass_kg=1.0)
    n = int(rng.integers(3, 6))
    under = zip(np.sort(rng.uniform(-0.06, 0.06, n)), rng.uniform(-0.02, 0.0, n), strict=True)
    points = [*((x, 0.0, z) for x, z in under), (-0.08, 0.0, 0.02), (0.08, 0.0, 0.02)]
    weight = (0.0, 0.0, -9.81)
    push = Force((1.0, 0.0, 0.2), (0.0, 0.0, 0.005), magnitude_n=rng.uniform(1.0, 8.0))
    loads = [Load("weight", gravity=weight), Load("push", gravity=weight, force=push)]
    walls = [
        Box((1.0, 0.01, 1.0), Pose((0.0, side * 0.5 * (THICKNESS_M + 0.01), 0.0)), name)
        for side, name in ((-1.0, "floor"), (1.0, "lid"))
    ]
    return Pair(
        Scene(plate, Cage(points), loads, friction_coefficient=friction, planar="xz"),
        Scene(
            plate,
            Cage(points, shapes=walls),
            loads,
            friction_coefficient=friction,
            friction_of={"floor": 0.0, "lid": 0.0},
        ),
    )
