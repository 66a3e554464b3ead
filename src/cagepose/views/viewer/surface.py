"""Where on the object's surface a point of the world is nearest to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.pose import Pose


class Nearest(NamedTuple):
    """The place of the surface that is nearest to each of n points.

    Attributes
    ----------
    feet_world
        Those places, (n, 3), metres.
    normals_world
        Outward unit normals of their faces, (n, 3).
    boxes
        Indices of their boxes, (n,).
    """

    feet_world: FloatArray
    normals_world: FloatArray
    boxes: np.ndarray


def nearest_on_object(held: Object, pose: Pose, points_world: FloatArray) -> Nearest:
    """Return the nearest place on the object, at ``pose``, to each of ``points_world`` (n, 3), metres.

    Of a point inside, the place is on the nearest face of the box in which it lies deepest.
    """
    turns = np.array([box.pose_object_box.rotation for box in held.boxes])
    middles = np.array([box.pose_object_box.position_m for box in held.boxes])
    halves = np.array([box.size_m for box in held.boxes])[:, None, :] / 2.0
    points = (
        pose.inverse_transform(points_world) - middles[:, None, :]
    ) @ turns  # (n_boxes, n, 3), in each box's frame
    beyond = np.abs(points) - halves
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=2)
    gaps = np.where(outside > 0.0, outside, beyond.max(axis=2))
    boxes, each = gaps.argmin(axis=0), np.arange(len(points_world))
    axes = beyond[boxes, each].argmax(axis=1)
    sides = np.where(points[boxes, each, axes] < 0.0, -1.0, 1.0)
    feet, normals = np.clip(points, -halves, halves)[boxes, each], np.zeros((len(points_world), 3))
    feet[each, axes] = sides * halves[boxes, 0, axes]
    normals[each, axes] = sides
    feet_object = np.einsum("nij,nj->ni", turns[boxes], feet) + middles[boxes]
    normals_object = np.einsum("nij,nj->ni", turns[boxes], normals)
    return Nearest(pose.transform(feet_object), normals_object @ pose.rotation.T, boxes)
