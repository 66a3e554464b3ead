"""Where on the object's surface a point of the world is nearest to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.nouns.checks import FloatArray
from cagepose.nouns.parts import Object
from cagepose.nouns.pose import Pose


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
    n_points = len(points_world)
    gaps = np.full(n_points, np.inf)
    nearest = Nearest(np.zeros((n_points, 3)), np.zeros((n_points, 3)), np.zeros(n_points, dtype=np.int64))
    for index, box in enumerate(held.boxes):
        pose_world_box = pose @ box.pose_object_box
        points, half = pose_world_box.inverse_transform(points_world), box.size_m / 2.0
        beyond = np.abs(points) - half
        axes, rows = beyond.argmax(axis=1), np.arange(n_points)
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        gap = np.where(outside > 0.0, outside, beyond[rows, axes])
        sides = np.where(points[rows, axes] < 0.0, -1.0, 1.0)
        feet, normals = np.clip(points, -half, half), np.zeros((n_points, 3))
        feet[rows, axes] = sides * half[axes]
        normals[rows, axes] = sides
        closer = gap < gaps
        gaps[closer] = gap[closer]
        nearest.feet_world[closer] = pose_world_box.transform(feet)[closer]
        nearest.normals_world[closer] = (normals @ pose_world_box.rotation.T)[closer]
        nearest.boxes[closer] = index
    return nearest
