"""How the object hangs on the world in a MuJoCo model: by a free joint, or in a plane by slides and a hinge.

The slide across the plane is there and kept at zero: where contacts have friction in a direction in which nothing can
move, MuJoCo's solver for friction gives up, and what sticks creeps.
"""

from __future__ import annotations

from collections.abc import Callable
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray
from cagepose.model.planar import AXES, normal_axis
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

Numbers = Callable[[ArrayLike], str]
"""Writes numbers as text."""


class ObjectJoints:
    """The joints of a scene's object, whose coordinates in a plane count from its start pose."""

    def __init__(self, scene: Scene) -> None:
        self._start = scene.object.pose_world_object
        self._normal = None if scene.planar is None else normal_axis(scene.planar)

    def add_to(self, body: Element, numbers: Numbers) -> None:
        """Write the joints into a body of MJCF."""
        if self._normal is None:
            SubElement(body, "freejoint", name="object")
            return
        axes = [numbers(axis) for axis in self._start.rotation]  # as the object sees the world's
        for name, axis in zip(AXES, axes, strict=True):
            SubElement(body, "joint", name=f"object along {name}", type="slide", axis=axis)
        name = AXES[self._normal]
        SubElement(body, "joint", name=f"object about {name}", type="hinge", axis=axes[self._normal])

    def hold(self, root: Element) -> None:
        """Write what keeps the object in its plane into the root of a model."""
        if self._normal is not None:
            SubElement(SubElement(root, "equality"), "joint", joint1=f"object along {AXES[self._normal]}")

    def coordinates(self, pose: Pose) -> FloatArray:
        """Return the coordinates of a pose: position and quaternion, (7,), or three ways and an angle, (4,)."""
        if self._normal is None:
            return np.concatenate([pose.position_m, pose.quaternion_wxyz])
        turn = (pose @ self._start.inverse()).quaternion_wxyz
        return np.append(pose.position_m - self._start.position_m, 2.0 * np.arctan2(turn[1 + self._normal], turn[0]))

    def pose(self, coordinates: ArrayLike) -> Pose:
        """Return the pose at some coordinates."""
        found = np.asarray(coordinates, dtype=np.float64)
        if self._normal is None:
            return Pose(found[:3], found[3:7])
        half, turn = 0.5 * found[3], np.zeros(4)
        turn[0], turn[1 + self._normal] = np.cos(half), np.sin(half)
        turned = Pose(quaternion_wxyz=turn) @ self._start
        return Pose(self._start.position_m + found[:3], turned.quaternion_wxyz)

    def speeds(self, rates: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how fast the object's origin moves, in the world, and how fast the object turns, in its frame, from
        the rates of the coordinates and how it is turned, (3, 3).
        """
        if self._normal is None:
            return rates[:3].copy(), rates[3:6].copy()
        return rates[:3].copy(), rates[3] * turn[self._normal]
