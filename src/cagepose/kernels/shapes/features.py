"""Parts as features: vertices, edges and faces of a convex core, rounded by a radius.

A sphere is one vertex, a capsule two and the edge between them, a box or any hull all three kinds; the radius is added
on all sides. Of each feature is known where its outward normals are, and where it ends: by half-spaces, its fences.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.vector import Vector, plus, row
from cagepose.kernels.native.kernel import kernel

VERTEX, EDGE, FACE = 0, 1, 2
"""Kinds of features."""


class Features(NamedTuple):
    """The features of one body, in its own frame or in the world.

    Attributes
    ----------
    kinds, parts
        Of each, (n,): what it is, and the part of the body that it belongs to.
    points
        The vertex, one end of the edge, or a point of the face, of the core, (n, 3), metres.
    directions
        Unit vector along an edge, outward normal of a face, (n, 3); zero for a vertex.
    lengths
        Of edges, (n,), metres.
    radii
        Of the part, (n,), metres.
    first_fences, fences, bounds
        Half-spaces x . fence <= bound, (n_fences, 3) and (n_fences,); those of a feature begin at its place in
        ``first_fences``, (n + 1,). Of a vertex and of an edge they hold its outward normals x (all bounds zero), of a
        face its points x, as seen from ``points``.
    """

    kinds: IntArray
    parts: IntArray
    points: FloatArray
    directions: FloatArray
    lengths: FloatArray
    radii: FloatArray
    first_fences: IntArray
    fences: FloatArray
    bounds: FloatArray


@kernel
def place_features(features: Features, position: Vector, quaternion: Quaternion, placed: Features) -> None:
    """Write points, directions and fences as they are in the world with the body at a pose; all else is given."""
    for i in range(len(features.kinds)):
        point = plus(position, rotated(quaternion, row(features.points, i)))
        direction = rotated(quaternion, row(features.directions, i))
        for k in range(3):
            placed.points[i, k], placed.directions[i, k] = point[k], direction[k]
    for f in range(len(features.bounds)):
        fence = rotated(quaternion, row(features.fences, f))
        for k in range(3):
            placed.fences[f, k] = fence[k]


def copied(features: Features) -> Features:
    """Return features with arrays of their own where `place_features` writes (plain Python)."""
    return features._replace(
        points=np.array(features.points), directions=np.array(features.directions), fences=np.array(features.fences)
    )
