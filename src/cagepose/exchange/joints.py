"""How the object hangs on the world in a MuJoCo model: by a free joint, or in a plane by two slides and a hinge."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray
from cagepose.model.planar import AXES, normal_axis
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

FREE, SLIDE, HINGE = "freejoint", "slide", "hinge"


class Joint(NamedTuple):
    """A joint's name and kind, and its axis in the object's frame, (3,); a free one has none."""

    name: str
    kind: str
    axis: FloatArray | None


class ObjectJoints:
    """The joints of a scene's object, whose coordinates in a plane count from its start pose."""

    def __init__(self, scene: Scene) -> None:
        self._start = scene.object.pose_world_object
        self._normal = None if scene.planar is None else normal_axis(scene.planar)
        self._along = [axis for axis in range(3) if axis != self._normal]

    def listed(self) -> list[Joint]:
        """Return the joints in the order of their coordinates."""
        if self._normal is None:
            return [Joint("object", FREE, None)]
        slides = [Joint(f"object along {AXES[axis]}", SLIDE, self._in_object(axis)) for axis in self._along]
        return [*slides, Joint(f"object about {AXES[self._normal]}", HINGE, self._in_object(self._normal))]

    def add_to(self, body: Element, numbers: Callable[[ArrayLike], str]) -> None:
        """Write the joints into a body of MJCF; ``numbers`` writes numbers as text."""
        for joint in self.listed():
            if joint.axis is None:
                SubElement(body, FREE, name=joint.name)
            else:
                SubElement(body, "joint", name=joint.name, type=joint.kind, axis=numbers(joint.axis))

    def coordinates(self, pose: Pose) -> FloatArray:
        """Return the coordinates of a pose: position and quaternion, (7,), or two ways and an angle, (3,)."""
        if self._normal is None:
            return np.concatenate([pose.position_m, pose.quaternion_wxyz])
        way = (pose.position_m - self._start.position_m)[self._along]
        turn = (pose @ self._start.inverse()).quaternion_wxyz
        return np.append(way, 2.0 * np.arctan2(turn[1 + self._normal], turn[0]))

    def pose(self, coordinates: ArrayLike) -> Pose:
        """Return the pose at some coordinates."""
        found = np.asarray(coordinates, dtype=np.float64)
        if self._normal is None:
            return Pose(found[:3], found[3:7])
        position = self._start.position_m.copy()
        position[self._along] += found[:2]
        half, turn = 0.5 * found[2], np.zeros(4)
        turn[0], turn[1 + self._normal] = np.cos(half), np.sin(half)
        return Pose(position, (Pose(quaternion_wxyz=turn) @ self._start).quaternion_wxyz)

    def speeds(self, rates: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how fast the object's origin moves, in the world, and how fast the object turns, in its frame, from
        the rates of the coordinates and how it is turned, (3, 3).
        """
        if self._normal is None:
            return rates[:3].copy(), rates[3:6].copy()
        velocity, spin = np.zeros(3), np.zeros(3)
        velocity[self._along], spin[self._normal] = rates[:2], rates[2]
        return velocity, turn.T @ spin

    def _in_object(self, axis: int) -> FloatArray:
        return np.asarray(self._start.rotation[axis])
