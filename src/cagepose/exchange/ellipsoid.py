"""An ellipsoid as a hull with round edges: `rounded_hull`.

An ellipsoid is the body of all places within its least radius of curvature from a smaller one, whose hull by points of
its surface is that much nearer to it than a hull of the ellipsoid itself would be.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.model.checks import FloatArray

CHORDS, CHORDS_ASKED = 24, 256
"""Of a full circle of a ball: for the corners, 146; and for the directions in which it is asked what they are off."""


class RoundedHull(NamedTuple):
    """Corners (n, 3) and the radius around them, and how far the ellipsoid reaches beyond both, metres."""

    core_m: FloatArray
    radius_m: float
    off_m: float


def rounded_hull(semi_axes_m: FloatArray) -> RoundedHull:
    """Return a hull within an ellipsoid, (3,), that touches it at the ends of its axes."""
    places = semi_axes_m * _directions(CHORDS)
    normals = _directions(CHORDS) / semi_axes_m
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    radius_m = float(semi_axes_m.min() ** 2 / semi_axes_m.max())
    core = places - radius_m * normals
    asked = _directions(CHORDS_ASKED)
    reach = np.linalg.norm(asked * semi_axes_m, axis=1)
    off_m = float((reach - (asked @ core.T).max(axis=1) - radius_m).max())
    return RoundedHull(core, radius_m, off_m)


def _directions(chords: int) -> FloatArray:
    """Return unit vectors all around, those along the axes among them."""
    found: FloatArray = Triangles.of(manifold3d().Manifold.sphere(1.0, chords)).vertices
    found /= np.linalg.norm(found, axis=1)[:, None]
    return found
