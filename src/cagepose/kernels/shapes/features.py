"""Parts as features: vertices, edges, faces and round rims of a core, rounded by a radius.

A sphere is one vertex, a capsule two and the edge between them, a box or any hull all three kinds; the radius is added
on all sides. A cylinder is an edge with a radius, two round faces and two rims, and on a cone the radius of the edge
changes along it. Of each feature is known where its outward normals are, and where it ends: by its fences.

A hole is a bar of negative radius: what lies a radius against the outward normal from its axis is its wall.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, minus, norm, plus, scaled, times, vector_from
from cagepose.kernels.native.kernel import kernel

VERTEX, EDGE, FACE, RIM = 0, 1, 2, 3
"""Kinds of features. A round rim is a row of arcs with a vertex at each of their ends: as a vertex it touches what
lies flat on it. An edge or another rim may be nearest to an arc at two places: so each arc is two features."""
SOLID, PIERCED, HOLE = 0, 1, 2
"""Kinds of parts: convex; convex but for its holes; the walls and rims of a hole that other parts have."""
INSIDE, OUTSIDE = 1.0, -1.0
"""Sides of a round fence."""


class Feature:
    """A vertex, an edge, a face or an arc of a rim, in the frame of its body or in the world; a record.

    Attributes
    ----------
    kind
        See above.
    point
        The vertex, one end of the edge, a point of the face, or the centre of the rim, of the core, metres.
    direction
        Unit vector along an edge, outward normal of a face; of a rim that of the flat end that it bounds.
        A vertex at the end of arcs has that of their rim.
    toward
        Of a rim: unit vector that its arc's middle, or the vertex, has as the outward normal along the flat end. Of a
        sector of a hole's slanted wall: the same in its middle.
    length
        Of an edge, metres; radius of a rim, below zero that of a hole. A vertex at the end of arcs has that of them.
    radius
        Added on all sides, metres; below zero: of a hole.
    taper
        Outward normals of an edge make this sine with the plane across it: its radius shrinks by as much a metre.
        Of a rim: that of the round side below it, as seen along its own direction.
    end_taper
        Of a rim: that of what is above it, 1: a flat end.
    is_second
        Of a rim: whether the last place on its arc where another feature is nearest counts, if there is more than one;
        else it is the first one.
    arc_before, arc_after
        Of a vertex at the end of arcs: these features. Of an arc: those next to it.
    twin_arc
        Of an arc whose first place counts: the feature that it is, too, whose last one does; and of that: the first.
        -1: none of these is.
    first_fence, last_fence
        Its fences, the last one not included.
    """

    kind: int
    point: Annotated[FloatArray, 3]
    direction: Annotated[FloatArray, 3]
    toward: Annotated[FloatArray, 3]
    length: float
    radius: float
    taper: float
    end_taper: float
    is_second: bool
    arc_before: int
    arc_after: int
    twin_arc: int
    first_fence: int
    last_fence: int


class Fence:
    """A half-space x . direction <= bound, or what is inside or outside of a circle; a record.

    Those of a vertex and of an edge hold its outward normals x, those of a face its points x, as seen from
    `Feature.point`. Around a circle, ``direction`` leads to its middle, metres, and ``bound`` is its radius.

    Attributes
    ----------
    circle
        INSIDE or OUTSIDE of one; zero: a half-space.
    """

    direction: Annotated[FloatArray, 3]
    bound: float
    circle: float


class ShapePart:
    """One part of a body; a record.

    Attributes
    ----------
    kind
        See above.
    first, first_face, last
        Its features: vertices, rims of bars, edges, those of holes, then faces that all of it is behind, the last one
        not included.
    middle, reach
        A ball around it, metres.
    least_length
        Length of its shortest edge, metres; inf: it has none.
    """

    kind: int
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
def out_of_fence(fence: Fence, x: Vector) -> Vector:
    """Return the unit vector across a fence, out of what it holds."""
    direction = vector_from(fence.direction)
    if fence.circle == 0.0:
        return direction
    seen = minus(x, direction)
    return scaled(seen, fence.circle / norm(seen))


@kernel
def is_bar(feature: Feature) -> bool:
    """Whether an edge or a rim is none of a hole."""
    return feature.length > 0.0 and feature.radius >= 0.0


@kernel
def is_of_mouth(feature: Feature) -> bool:
    """Whether a feature is an arc of a hole's rim."""
    return feature.kind == RIM and feature.length < 0.0


@kernel
def is_end(feature: Feature) -> bool:
    """Whether a part may end in a feature, along some direction: it is a vertex, or the rim of a bar."""
    return feature.kind == VERTEX or (feature.kind == RIM and is_bar(feature) and not feature.is_second)


@kernel
def height_of_end(feature: Feature, origin: Vector, normal: Vector) -> float:
    """Return how far a vertex, or the rim that an arc belongs to, leads along a unit normal, as seen from a place."""
    height = dot(minus(vector_from(feature.point), origin), normal) + feature.radius
    if feature.kind == RIM:
        height += feature.length * norm(cross(vector_from(feature.direction), normal))
    return height


@kernel
def place_feature(shapes: Shapes, i: int, position: Vector, rotation: Matrix, placed: Shapes) -> None:
    """Write one feature as it is in the world with its body at a pose."""
    feature = shapes.features[i]
    point = plus(position, times(rotation, vector_from(feature.point)))
    direction = times(rotation, vector_from(feature.direction))
    write_feature(feature, point, direction, times(rotation, vector_from(feature.toward)), placed.features[i])
    for f in range(feature.first_fence, feature.last_fence):
        write_fence(shapes.fences[f], times(rotation, vector_from(shapes.fences[f].direction)), placed.fences[f])


@kernel
def write_feature(feature: Feature, point: Vector, direction: Vector, toward: Vector, out: Feature) -> None:
    """Write a feature with another place and other directions."""
    out.kind, out.length, out.radius, out.taper = feature.kind, feature.length, feature.radius, feature.taper
    out.end_taper, out.first_fence, out.last_fence = feature.end_taper, feature.first_fence, feature.last_fence
    out.is_second, out.twin_arc = feature.is_second, feature.twin_arc
    out.arc_before, out.arc_after = feature.arc_before, feature.arc_after
    for k in range(3):
        out.point[k], out.direction[k], out.toward[k] = point[k], direction[k], toward[k]


@kernel
def write_fence(fence: Fence, direction: Vector, out: Fence) -> None:
    """Write a fence with another direction."""
    out.bound, out.circle = fence.bound, fence.circle
    for k in range(3):
        out.direction[k] = direction[k]


@kernel
def beyond_fence(fence: Fence, x: Vector) -> float:
    """Return how far a normal or a point is beyond a fence; below zero: within it."""
    direction = vector_from(fence.direction)
    if fence.circle == 0.0:
        return dot(direction, x) - fence.bound
    return fence.circle * (norm(minus(x, direction)) - fence.bound)


@kernel
def place_part(shapes: Shapes, which: int, position: Vector, rotation: Matrix, placed: Shapes) -> None:
    """Write one part as it is in the world, without its features."""
    part, there = shapes.parts[which], placed.parts[which]
    there.kind = part.kind
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
