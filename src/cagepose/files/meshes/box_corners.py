"""Corners that are those of a box: `box_of_corners`."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from cagepose.files.meshes.tolerances import SINGLE_PRECISION
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.pose import Pose
from cagepose.model.volume import BOX_SIGNS


def box_of_corners(corners_m: FloatArray) -> Box | None:
    """Return the box whose corners (8, 3), metres, are given in any order; None: they are no box's."""
    if len(corners_m) != len(BOX_SIGNS):
        return None
    sides = corners_m[1:] - corners_m[0]
    allowed_m = SINGLE_PRECISION * float(np.linalg.norm(sides, axis=1).max())
    for three in combinations(range(len(sides)), 3):
        edges = sides[list(three)]
        lengths = np.linalg.norm(edges, axis=1)
        if lengths.min() <= allowed_m:
            continue
        axes = _ordered(unit_rows(edges))
        size = np.abs(axes @ edges.T).max(axis=1)
        turn = np.stack([axes[0], axes[1], np.cross(axes[0], axes[1])])
        middle = corners_m.mean(axis=0)
        expected = middle + BOX_SIGNS * size / 2.0 @ turn
        apart = np.linalg.norm(corners_m[:, None] - expected, axis=2)
        if apart.min(axis=1).max() <= allowed_m and len(set(apart.argmin(axis=1).tolist())) == len(corners_m):
            return Box(size, Pose(middle, euler_zyx=_angles(turn.T)))
    return None


def _ordered(axes: FloatArray) -> FloatArray:
    """Return three unit vectors in the order and with the signs in which they are nearest to x, y and z."""
    order: list[int] = []
    for axis in range(3):
        left = [row for row in range(3) if row not in order]
        order.append(max(left, key=lambda row: abs(float(axes[row, axis]))))
    chosen = axes[order]
    signed: FloatArray = chosen * np.where(chosen.diagonal() < 0.0, -1.0, 1.0)[:, None]
    return signed


def _angles(rotation: FloatArray) -> tuple[float, float, float]:
    """Return yaw, pitch and roll of a rotation whose x axis is not along z."""
    pitch = math.asin(max(-1.0, min(1.0, -float(rotation[2, 0]))))
    return math.atan2(rotation[1, 0], rotation[0, 0]), pitch, math.atan2(rotation[2, 1], rotation[2, 2])
