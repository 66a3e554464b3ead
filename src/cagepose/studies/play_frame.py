"""The frame of play: the cage's axes, its origin amid the cage's points, the object as it stands at the start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cagepose.kernels.algebra.pose import Quaternion, quaternion_about
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.play.goal import PITCH, ROLL, SHIFT, YAW, Goal
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.planar import held_freedoms
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

FREEDOMS = ("x", "y", "z", "roll", "pitch", "yaw")
"""Displacement of the object's origin and ZYX angles, both from the start, in the cage's axes."""
N_LENGTHS = 3
"""So many of them are lengths."""


class PlayFrame:
    """A scene as the kernels of play take it.

    Attributes
    ----------
    length_m
        The length of the scene: distance of the farthest cage point from the middle. A turn by a radian is compared
        with a travel by this.
    geometry
        Boxes at the start and cage points, both in this frame, lengths of the scene.
    held
        1 for each freedom that is held, else 0, (6,); of no others than the scene's unless they are given.
    pose_frame_object
        The object's start, metres.
    """

    def __init__(self, scene: Scene, held: FloatArray | None = None) -> None:
        points_world = scene.cage.points_world()
        self._pose_world_frame = Pose(points_world.mean(axis=0), scene.cage.pose_world_cage.quaternion_wxyz)
        points = self._pose_world_frame.inverse_transform(points_world)
        farthest = float(np.linalg.norm(points, axis=1).max())
        self.length_m = farthest if farthest > 0.0 else scene.size_m
        self.pose_frame_object = self._pose_world_frame.inverse() @ scene.object.pose_world_object
        self.held = held_freedoms(scene.planar) if held is None else held  # such a cage is not tilted
        self.geometry = scene.boxes._replace(
            half_sizes=scene.boxes.half_sizes / self.length_m,
            box_positions=self.from_object(scene.boxes.box_positions),
            box_rotations=self.pose_frame_object.rotation @ scene.boxes.box_rotations,
            points_world=points / self.length_m,
        )

    def from_object(self, points_object: ArrayLike) -> FloatArray:
        """Return where points of the object, (n, 3) metres in its frame, are at the start, lengths of the scene."""
        points: FloatArray = self.pose_frame_object.transform(points_object) / self.length_m
        return points

    def vectors_from_world(self, vectors: FloatArray) -> FloatArray:
        """Turn vectors of the world, (n, 3), into this frame's axes."""
        turned: FloatArray = vectors @ self._pose_world_frame.rotation
        return turned

    def vector_to_world(self, vector: ArrayLike) -> FloatArray:
        turned: FloatArray = self._pose_world_frame.rotation @ np.asarray(vector)
        return turned

    def point_to_world(self, point: FloatArray) -> FloatArray:
        """Return a point of this frame, lengths of the scene, in the world, metres."""
        return self._pose_world_frame.transform(self.length_m * point)

    def pose_after(self, position: ArrayLike, quaternion: ArrayLike) -> Pose:
        """Return the object's pose in the world after a motion in this frame, lengths of the scene."""
        motion = Pose(self.length_m * np.asarray(position), quaternion)
        return self._pose_world_frame @ motion @ self.pose_frame_object


def motion_after(twist: FloatArray) -> tuple[Vector, Quaternion]:
    """Return the motion after a twist (t, w), (6,), as the theory writes it: R = exp(w)."""
    angle = float(np.linalg.norm(twist[3:]))
    axis = twist[3:] / angle if angle > 0.0 else np.zeros(3)
    return as_vector(twist[:3]), quaternion_about(as_vector(axis), angle)


def range_goals(frame: PlayFrame, shifts: Sequence[tuple[FloatArray, FloatArray]] = ()) -> Rows[Goal]:
    """Return two goals, the least and the greatest value, for each freedom and each further shift: a point of the
    object and a direction in the cage.
    """
    lengths = [(np.zeros(3), axis) for axis in np.eye(N_LENGTHS)]
    angles = [(np.zeros(3), np.zeros(3))] * 3
    points, directions = zip(*lengths, *angles, *shifts, strict=True)
    made = empty_rows(Goal, 2 * len(points))
    columns = np.asarray(made)
    columns["kind"] = np.repeat([*[SHIFT] * N_LENGTHS, ROLL, PITCH, YAW, *[SHIFT] * len(shifts)], 2)
    columns["sign"] = np.tile([-1.0, 1.0], len(points))
    columns["starts"][:, 0] = np.repeat(frame.from_object(points), 2, axis=0)
    columns["directions"][:, 0] = np.repeat(directions, 2, axis=0)
    return made
