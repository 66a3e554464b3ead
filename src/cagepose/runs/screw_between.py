"""The one motion that leads from a pose to another: a travel, a turn or a screw (Chasles)."""

from __future__ import annotations

import math

import numpy as np

from cagepose.model.pose import Pose
from cagepose.runs.run import Motion

HARDLY_TURNS_RAD = 1e-12
"""A smaller turn between two poses is rounding."""
HARDLY = 1e-9
"""A travel along the axis, or what a turn moves over the object's size, is rounding below this fraction of the way."""


def motion_between(start: Pose, end: Pose, center_object_m: np.ndarray, size_m: float) -> Motion | None:
    """Return the motion from ``start`` to ``end``; None: they are one pose.

    ``center_object_m``: a point of the object, (3,), whose way is measured; it sets what counts as rounding.
    ``size_m``: how far the object's points are apart at most, or more.
    """
    before, after = start.transform(center_object_m), end.transform(center_object_m)
    way = after - before
    turn = (end @ start.inverse()).quaternion_wxyz
    vector = turn[1:] * math.copysign(1.0, turn[0])
    sine = float(np.linalg.norm(vector))
    angle = 2.0 * math.atan2(sine, abs(float(turn[0])))
    distance = float(np.linalg.norm(way))
    if angle <= HARDLY_TURNS_RAD or angle * size_m <= HARDLY * distance:
        if distance == 0.0:
            return None
        return Motion("travel", way / distance, None, None, distance, 0.0)
    axis = vector / sine
    rise = float(axis @ way)
    across = way - rise * axis
    through = before + 0.5 * across + np.cross(axis, across) / (2.0 * math.tan(0.5 * angle))
    is_turn = abs(rise) <= HARDLY * distance
    return Motion("turn" if is_turn else "screw", None, axis, through, 0.0 if is_turn else rise, angle)
