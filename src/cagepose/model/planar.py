"""The plane that a part moves in, where a mechanism is thought of in the plane: `Planar`."""

from __future__ import annotations

from typing import Literal

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose

Planar = Literal["xy", "xz", "yz"]
"""Two axes of the world: the part travels along these and turns about the third one, and nothing else."""
AXES = "xyz"
LEAST_TILT = 1e-9
"""Radians. A cage that is tilted by less out of a plane is not, but for rounding."""


def normal_axis(planar: Planar) -> int:
    """Return which axis of the world is across a plane: 0, 1 or 2."""
    return next(axis for axis, name in enumerate(AXES) if name not in planar)


def held_freedoms(planar: Planar | None) -> FloatArray:
    """Return 1 for each freedom that a plane holds, else 0, (6,): travel along x, y and z of the world, and turns about
    them.
    """
    held = np.zeros(6)
    if planar is not None:
        normal = normal_axis(planar)
        held[[axis if axis == normal else 3 + axis for axis in range(3)]] = 1.0
    return held


def tilt(planar: Planar, pose: Pose) -> float:
    """Return by how much a pose tilts the normal of a plane, radians."""
    normal = normal_axis(planar)
    across = np.linalg.norm(np.delete(pose.rotation[:, normal], normal))
    return float(np.arctan2(across, pose.rotation[normal, normal]))
