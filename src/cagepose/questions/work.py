"""The work that a load has done on the object at a pose: `Work`, `work_of`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.run import Motion


@dataclass(frozen=True)
class Work:
    """Forces (n, 3) in the world, newtons, at points (n, 3) of the object, metres."""

    forces: FloatArray
    points: FloatArray

    @property
    def size_n(self) -> float:
        return float(np.linalg.norm(self.forces, axis=1).sum())

    def potential(self, pose: Pose) -> float:
        return -float((self.forces * pose.transform(self.points)).sum())

    def highest(self, before: Pose, motion: Motion) -> tuple[float, float]:
        """Return the greatest potential during a motion from a pose, and the share of the motion at which it is."""
        places = before.transform(self.points)
        here = -float((self.forces * places).sum())
        if motion.direction_world is not None:
            rise = -motion.distance_m * float(self.forces.sum(axis=0) @ motion.direction_world)
            return (here + rise, 1.0) if rise > 0.0 else (here, 0.0)
        assert motion.axis_world is not None
        assert motion.through_world is not None
        # Of a turn by an angle a, the potential is here + even (1 - cos a) - odd sin a.
        arms = places - motion.through_world
        across = np.cross(motion.axis_world, arms)
        odd = float((self.forces * across).sum())
        even = -float((self.forces * np.cross(motion.axis_world, across)).sum())
        angles = [0.0, motion.angle_rad]
        extreme = math.atan2(odd, even) % math.pi
        angles += [angle for angle in (extreme, extreme + math.pi) if angle < motion.angle_rad]
        values = [here + even * (1.0 - math.cos(angle)) - odd * math.sin(angle) for angle in angles]
        best = int(np.argmax(values))
        return values[best], angles[best] / motion.angle_rad


def work_of(scene: Scene, load: Load, pose: Pose) -> Work | None:
    """Return the work of a load of weight and forces that keep their direction, with the object at a pose when it
    begins; None: it is more than these, and has no potential.
    """
    if load.moments or load.springs or load.drive or load.press or not all(push.has_potential for push in load.pushes):
        return None
    weighed = scaled_load(scene, load)
    points = np.array([scene.object.center_of_gravity_m, *(push.at_object(pose) for push in load.pushes)])
    return Work(np.array([weighed.gravity, *weighed.forces]).reshape(-1, 3), points)
