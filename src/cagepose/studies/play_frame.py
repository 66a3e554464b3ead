"""The frame of play: the cage's axes, its origin amid the cage's points, the object as it stands at the start."""

from __future__ import annotations

import math

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

FREEDOMS = ("x", "y", "z", "roll", "pitch", "yaw")
"""Displacement of the object's origin and ZYX angles, both from the start, in the cage's axes."""


class PlayFrame:
    """A scene as the kernels of play take it.

    Attributes
    ----------
    geometry
        Boxes at the start and cage points, both in this frame.
    length_m
        Distance of the farthest cage point from the middle: a turn by a radian is compared with a travel by this.
    pose_frame_object
        The object's start.
    """

    def __init__(self, scene: Scene) -> None:
        points_world = scene.cage.points_world()
        self._pose_world_frame = Pose(points_world.mean(axis=0), scene.cage.pose_world_cage.quaternion_wxyz)
        points = self._pose_world_frame.inverse_transform(points_world)
        self.pose_frame_object = self._pose_world_frame.inverse() @ scene.object.pose_world_object
        self.geometry = scene.geometry._replace(
            box_positions=self.pose_frame_object.transform(scene.geometry.box_positions),
            box_rotations=self.pose_frame_object.rotation @ scene.geometry.box_rotations,
            points_world=points,
        )
        farthest = float(np.linalg.norm(points, axis=1).max())
        self.length_m = farthest if farthest > 0.0 else scene.size_m

    def outward(self, position: Vector, quaternion: Quaternion) -> Pose:
        """Return the object's pose in the world after a motion in this frame."""
        return self._pose_world_frame @ Pose(position, quaternion) @ self.pose_frame_object

    def motion(self, twist: FloatArray) -> Pose:
        """Return the motion after a twist (t / length_m, w), (6,), as the theory writes it: R = exp(w)."""
        spin = np.asarray(twist[3:], dtype=np.float64)
        angle = float(np.linalg.norm(spin))
        part = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
        return Pose(self.length_m * twist[:3], np.array([math.cos(0.5 * angle), *(part * spin)]))

    def to_world(self, vector: Vector) -> np.ndarray:
        """Turn a vector of this frame into the world's axes."""
        turned: np.ndarray = self._pose_world_frame.rotation @ np.array(vector)
        return turned

    def from_world(self, vectors: FloatArray) -> FloatArray:
        """Turn vectors of the world, (n, 3), into this frame's axes."""
        turned: FloatArray = vectors @ self._pose_world_frame.rotation
        return turned

    def point_to_world(self, point: Vector) -> np.ndarray:
        """Return a point of this frame in the world."""
        return self._pose_world_frame.transform(np.array(point))
