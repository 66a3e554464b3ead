"""Random cubes that springs, a weight and a force press among points on all sides."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, Force, Load, Moment, Object, Pose, Scene, Spring

G = 9.81


def cube(edge_m: float = 0.04, mass_kg: float | None = 1.0, pose: Pose | None = None) -> Object:
    return Object([Box((edge_m,) * 3)], mass_kg=mass_kg, pose=pose)


def sprung(random: np.random.Generator, friction: float = 0.0, n_springs: int = 3, *, turned: bool = False) -> Scene:
    """A scene; ``turned``: a moment and a force that follows the object act, too."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    points = [
        axis * (0.02 + random.uniform(0.0005, 0.003)) + np.where(axis == 0.0, random.uniform(-0.015, 0.015, 3), 0.0)
        for axis in axes
        for _ in range(2)
    ]
    springs = [
        Spring(
            random.uniform(-0.02, 0.02, 3),
            random.uniform(-0.1, 0.1, 3),
            10 ** random.uniform(1, 3),
            float(random.normal()),
        )
        for _ in range(n_springs)
    ]
    forces = [Force(random.normal(size=3), random.uniform(-0.02, 0.02, 3), random.uniform(1, 5)) for _ in range(2)]
    moments = []
    if turned:
        forces.append(Force(random.normal(size=3), random.uniform(-0.02, 0.02, 3), random.uniform(1, 5), follows=True))
        moments = [Moment(random.normal(size=3), 0.02, follows=follows) for follows in (False, True)]
    load = Load("all", gravity=(0, 0, -G), forces=forces, moments=moments, springs=springs)
    return Scene(cube(), Cage(points), [load], friction_coefficient=friction)
