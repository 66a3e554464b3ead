"""An ellipsoid as a hull with round edges: `rounded_hull`.

An ellipsoid is the body of all places within its least radius of curvature from a smaller one, whose hull by points of
its surface is that much nearer to it than a hull of the ellipsoid itself would be.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.model.checks import FloatArray

CHORDS = 24
"""Of a full circle of a ball whose corners, 146, are those of the hull."""


class RoundedHull(NamedTuple):
    """Corners (n, 3) and the radius around them, and how far the ellipsoid reaches beyond both, metres."""

    core_m: FloatArray
    radius_m: float
    off_m: float


def rounded_hull(semi_axes_m: FloatArray) -> RoundedHull:
    """Return a hull within an ellipsoid, (3,), that touches it at the ends of its axes."""
    ball = Triangles.of(manifold3d().Manifold.sphere(1.0, CHORDS)).vertices
    directions = _unit(ball)  # those along the axes among them
    places, normals = semi_axes_m * directions, _unit(directions / semi_axes_m)
    radius_m = float(semi_axes_m.min() ** 2 / semi_axes_m.max())
    core = places - radius_m * normals
    size = float(np.abs(core).max())
    hull = Triangles.of(manifold3d().Manifold.hull_points(core / size))
    a, b, c = np.moveaxis(hull.vertices[hull.faces], 1, 0)
    across = _unit(np.cross(b - a, c - a))  # where a hull within a convex body is farthest from it
    reach = np.linalg.norm(across * semi_axes_m, axis=1)
    off_m = float((reach - (across @ core.T).max(axis=1) - radius_m).max())
    return RoundedHull(core, radius_m, off_m)


def _unit(vectors: FloatArray) -> FloatArray:
    found: FloatArray = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    return found
