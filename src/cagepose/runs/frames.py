"""The frames of a compiled run: cage and object are each seen from a middle of their own.

So neither a cage far from the world's origin nor an object drawn far from its own costs digits, or tells in the result.
"""

from __future__ import annotations

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.trace import Trace
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene


class Frames:
    """The cage is seen from the mean of its points, the object from ``middle_object`` (3,), metres."""

    def __init__(self, scene: Scene, middle_object: FloatArray) -> None:
        self.origin_world = scene.cage.points_world().mean(axis=0)
        self.middle_object = middle_object

    def geometry(self, scene: Scene) -> Geometry:
        return scene.geometry._replace(
            box_positions=scene.geometry.box_positions - self.middle_object,
            points_world=scene.geometry.points_world - self.origin_world,
        )

    def inward(self, pose: Pose) -> tuple[Vector, Quaternion]:
        """Return the object's pose as the kernels take it."""
        return as_vector(pose.transform(self.middle_object) - self.origin_world), pose.as_tuples()[1]

    def outward(self, trace: Trace, event: int) -> Pose:
        """Return the object's pose in the world after an event."""
        happening = trace.rows[event]
        turned = Pose(quaternion_wxyz=happening.quaternion)
        middle_world = happening.position + self.origin_world
        return Pose(middle_world - turned.transform(self.middle_object), happening.quaternion)


def middle_of_boxes(scene: Scene) -> FloatArray:
    """Return the mean of the boxes' centres in the object's frame, (3,), metres."""
    middle: FloatArray = scene.geometry.box_positions[: scene.geometry.n_own_boxes].mean(axis=0)
    return middle


def touching_names(scene: Scene, chosen: np.ndarray) -> tuple[str, ...]:
    """Return the names of the cage points that a mask (n_points,) chooses."""
    return tuple(scene.cage.names[index] for index in np.nonzero(chosen)[0])
