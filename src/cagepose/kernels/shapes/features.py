"""Parts as features: vertices, edges and faces of a convex core, rounded by a radius.

A sphere is one vertex, a capsule two and the edge between them, a box or any hull all three kinds; the radius is added
on all sides. Of each feature is known where its outward normals are, and where it ends: by half-spaces, its fences.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Matrix, Vector, plus, times, vector_from
from cagepose.kernels.native.kernel import kernel

VERTEX, EDGE, FACE = 0, 1, 2
"""Kinds of features."""


class Feature:
    """A vertex, an edge or a face, in the frame of its body or in the world; a record.

    Attributes
    ----------
    kind
        See above.
    point
        The vertex, one end of the edge, or a point of the face, of the core, metres.
    direction
        Unit vector along an edge, outward normal of a face.
    length
        Of an edge, metres.
    radius
        Added on all sides, metres.
    first_fence, last_fence
        Its fences, the last one not included.
    """

    kind: int
    point: Annotated[FloatArray, 3]
    direction: Annotated[FloatArray, 3]
    length: float
    radius: float
    first_fence: int
    last_fence: int


class Fence:
    """A half-space x . direction <= bound; a record.

    Those of a vertex and of an edge hold its outward normals x (the bound is zero), those of a face its points x, as
    seen from `Feature.point`.
    """

    direction: Annotated[FloatArray, 3]
    bound: float


class ShapePart:
    """One convex part of a body; a record.

    Attributes
    ----------
    first, first_face, last
        Its features: vertices and edges, then faces, the last one not included.
    middle, reach
        A ball around it, metres.
    least_length
        Length of its shortest edge, metres; inf: it has none.
    """

    first: int
    first_face: int
    last: int
    middle: Annotated[FloatArray, 3]
    reach: float
    least_length: float


class Shapes(NamedTuple):
    """The parts of one body, with all their features and fences."""

    parts: Rows[ShapePart]
    features: Rows[Feature]
    fences: Rows[Fence]


NO_SHAPES = Shapes(empty_rows(ShapePart, 0), empty_rows(Feature, 0), empty_rows(Fence, 0))
"""A body without parts."""


def copied(shapes: Shapes) -> Shapes:
    """Return shapes with memory of their own (plain Python)."""
    return Shapes(*[np.array(rows) for rows in shapes])


@kernel
def place_feature(shapes: Shapes, i: int, position: Vector, rotation: Matrix, placed: Shapes) -> None:
    """Write one feature as it is in the world with its body at a pose."""
    feature = shapes.features[i]
    point = plus(position, times(rotation, vector_from(feature.point)))
    write_feature(feature, point, times(rotation, vector_from(feature.direction)), placed.features[i])
    for f in range(feature.first_fence, feature.last_fence):
        fence = times(rotation, vector_from(shapes.fences[f].direction))
        write_fence(fence, shapes.fences[f].bound, placed.fences[f])


@kernel
def write_feature(feature: Feature, point: Vector, direction: Vector, out: Feature) -> None:
    """Write a feature with another place and direction."""
    out.kind, out.length, out.radius = feature.kind, feature.length, feature.radius
    out.first_fence, out.last_fence = feature.first_fence, feature.last_fence
    for k in range(3):
        out.point[k], out.direction[k] = point[k], direction[k]


@kernel
def write_fence(direction: Vector, bound: float, out: Fence) -> None:
    out.bound = bound
    for k in range(3):
        out.direction[k] = direction[k]


@kernel
def place_part(shapes: Shapes, which: int, position: Vector, rotation: Matrix, placed: Shapes) -> None:
    """Write one part as it is in the world, without its features."""
    part, there = shapes.parts[which], placed.parts[which]
    there.first, there.first_face, there.last = part.first, part.first_face, part.last
    there.reach, there.least_length = part.reach, part.least_length
    middle = plus(position, times(rotation, vector_from(part.middle)))
    for k in range(3):
        there.middle[k] = middle[k]


@kernel
def place_shapes(shapes: Shapes, position: Vector, quaternion: Quaternion, placed: Shapes) -> None:
    """Write all parts and features as they are in the world with their body at a pose."""
    rotation = matrix_from_quaternion(quaternion)
    for which in range(len(shapes.parts)):
        place_part(shapes, which, position, rotation, placed)
        place_features(shapes, which, position, rotation, placed)


@kernel
def place_features(shapes: Shapes, which: int, position: Vector, rotation: Matrix, placed: Shapes) -> None:
    """Write the features of one part as they are in the world with their body at a pose."""
    for i in range(shapes.parts[which].first, shapes.parts[which].last):
        place_feature(shapes, i, position, rotation, placed)
