"""A boundary as rows of features, and those features at a pose.

A part need not be convex: it is known by what can touch. A vertex and an edge have outward normals where the material
beside them is convex; a face ends at its bounds. A radius is added on all sides: a sphere is a vertex with a radius, a
capsule a line with one. The round side of a cylinder or a cone is a line with a radius and without bounds: all normals
around it count, unless borders trim it. With a radius below zero it is the wall of a hole.

Bounds stay in the frame of the body, and what is asked of them is turned into that frame: that is one normal and one
place for a pair of features, where each of them may have a dozen bounds.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import (
    Matrix,
    Vector,
    minus,
    plus,
    row,
    times,
    transposed_times,
    vector_from,
)
from cagepose.kernels.boundary.tree import FACES, VERTICES, Node, PlacedBox, placed_box
from cagepose.kernels.native.kernel import kernel

VERTEX, LINE, FACE, CIRCLE = 0, 1, 2, 3
"""Kinds of features."""
HALF_SPACE, INSIDE, OUTSIDE, SEGMENT = 0, 1, 2, 3
"""Kinds of bounds."""
HULL, TURNED = 0, 1
"""Kinds of covers."""


class Feature:
    """A vertex, a straight edge, a round edge or a flat face; a record.

    Attributes
    ----------
    kind
        See above.
    part
        Which part of its body it is of: that has a name and a friction of its own.
    point
        The vertex, the start of a line, the centre of a circle, or a point of a face, metres.
    direction
        Unit vector along a line, the axis of a circle, or the outward normal of a face.
    toward
        Of a circle and of a hole's wall: unit vector across its axis that angles are measured from, right-handed about
        the axis. Of a face with segments: one in its plane, along which rays lead. Of a
        ball, from its centre to a place of it; zero: the centre is in the body.
    length
        Of a line, metres: of the side of a cone, along the axis between where the normals of its ends meet it. The
        radius of a circle.
    radius
        Added on all sides, metres; of the side of a cone, at its start. Below zero: a line is the axis of a hole.
    taper
        Sine that the outward normals of a line make with the plane across it: its radius shrinks by as much a metre.
    low, high
        The outward normals of a circle are cos(psi) outward + sin(psi) axis with psi between these, radians. Of a side
        that borders trim, ``low`` is the angle of one of its generators.
    start, width
        The arc of a circle: angles from ``start`` to ``start + width``, radians; a width of 2 pi: all of it. Of a
        generator of a side that borders trim: heights along the axis, metres, between which it is on the side.
    first_bound, last_bound
        Its bounds, the last one not included.
    least
        Length of the shortest edge at a vertex or of a line, the radius of a circle, metres; inf: there is none. Of the
        tip of a cone, the radius of its wide end. What touches along it is told by the touch tolerance up to a tilt of
        one over the other.
    first_cover, last_cover
        What may cover it, in `Boundary.cover_list`, the last one not included.
    """

    kind: int
    part: int
    point: Annotated[FloatArray, 3]
    direction: Annotated[FloatArray, 3]
    toward: Annotated[FloatArray, 3]
    length: float
    radius: float
    taper: float
    low: float
    high: float
    start: float
    width: float
    first_bound: int
    last_bound: int
    least: float
    first_cover: int
    last_cover: int


class Bound:
    """One of the bounds of a feature, in the frame of its body; a record.

    Those of a vertex and of a line hold its outward normals x, those of a face its points x as seen from
    `Feature.point`. A feature is within all of its half-spaces and circles; and if it has segments, these are the
    borders that a ray out of it crosses an odd number of times. Segments of a round side are those of its chart, with
    the side to their left: angle about its axis from `Feature.toward` on, radians, within half a turn, and height along
    the axis, metres; each spans less than half a turn.

    Attributes
    ----------
    kind
        HALF_SPACE: x . direction <= limit. INSIDE, OUTSIDE of a circle: ``direction`` leads to its centre, metres, and
        ``limit`` is its radius. SEGMENT: from ``direction`` to ``end``, metres; an arc of less than half a turn with
        the curvature ``limit``, above zero where it leads around what lies to its left.
    """

    kind: int
    direction: Annotated[FloatArray, 3]
    end: Annotated[FloatArray, 3]
    limit: float


class BodyPart:
    """One part of a body: it has a name, and a friction of its own; a record.

    Attributes
    ----------
    body
        Which of several bodies in one memory it is of.
    middle, reach
        A ball around it, in the frame of the body, metres.
    point
        Of a single point, the feature that it is; else -1.
    """

    body: int
    middle: Annotated[FloatArray, 3]
    reach: float
    point: int


class Cover:
    """A convex solid of a body, or a part of what a hole takes away; a record.

    Attributes
    ----------
    kind
        HULL: what lies within half-spaces, and no farther than a radius from there. TURNED: a straight line turned
        about an axis, between flat ends.
    point
        Of a hull, what its bounds are seen from; of what is turned, the middle of its first end; in the frame of the
        body, metres.
    axis
        Unit vector from the first to the second end.
    radius, other_radius
        Of a hull, what is added on all sides; of what is turned, of its two ends, metres.
    length
        From end to end, metres.
    reach
        No point of it is farther from ``point``, metres.
    first_bound, last_bound
        Of a hull: its half-spaces and its edges, which are segments; the last one not included.
    first_opening, last_opening
        Which covers take material away from it, in `Boundary.cover_list`.
    touch_m
        What is this close touches, metres.
    """

    kind: int
    point: Annotated[FloatArray, 3]
    axis: Annotated[FloatArray, 3]
    radius: float
    other_radius: float
    length: float
    reach: float
    first_bound: int
    last_bound: int
    first_opening: int
    last_opening: int
    touch_m: float


class Boundary(NamedTuple):
    """The features of one body, and the trees that find those that are near; or of several bodies, see `Bodies`.

    Attributes
    ----------
    parts
        Those of the body.
    features
        Vertices first, then lines and circles, then faces.
    bounds
        Theirs, and those of the covers.
    covers, cover_list
        What may cover features, or takes away from what does; and their indices, one range after the other.
    nodes
        The trees, see `cagepose.kernels.boundary.tree`.
    planes
        Of each face normal, height above the origin with its radius, shortest edge, and the two corners of the box
        around it, (11, n_features), in the frame of the body: in this order a processor works out how far a vertex is
        from several faces at once.
    """

    parts: Rows[BodyPart]
    features: Rows[Feature]
    bounds: Rows[Bound]
    covers: Rows[Cover]
    cover_list: IntArray
    nodes: Rows[Node]
    planes: FloatArray


NO_BOUNDARY = Boundary(
    empty_rows(BodyPart, 0),
    empty_rows(Feature, 0),
    empty_rows(Bound, 0),
    empty_rows(Cover, 0),
    np.zeros(0, np.int64),
    empty_rows(Node, 3),
    np.zeros((11, 0)),
)
"""A body without features."""


class Bodies(NamedTuple):
    """Several bodies in one memory, one after the other.

    Attributes
    ----------
    own
        All parts and features of them, each in the frame of its body; indices are those of this memory, but nodes know
        each other by their places among those of one body.
    first_nodes
        Where the trees of each body begin, and where those of the last one end, (n_bodies + 1,).
    """

    own: Boundary
    first_nodes: IntArray


class Placing(NamedTuple):
    """Memory for bodies at poses of their own, (n_bodies, 4, 3); see `PlacedBoundary`."""

    features: Rows[Feature]
    is_placed: NDArray[np.bool_]
    boxes: FloatArray
    is_boxed: NDArray[np.bool_]
    poses: FloatArray


class PlacedBoundary(NamedTuple):
    """A boundary at a pose. Features are placed when they are asked for, as most are far from everything.

    Attributes
    ----------
    own
        In the frame of the body: of this one alone.
    features
        In the world, of those that have been asked for: points and directions.
    is_placed
        Whose have been, (n_features,).
    boxes, is_boxed
        Middles and half edges of the boxes of the world around the nodes of its trees, (n_nodes, 2, 3), metres; and of
        which of them they are known, (n_nodes,).
    pose
        Position, and the rows of the rotation matrix, (4, 3).
    """

    own: Boundary
    features: Rows[Feature]
    is_placed: NDArray[np.bool_]
    boxes: FloatArray
    is_boxed: NDArray[np.bool_]
    pose: FloatArray


def empty_placing(own: Boundary, n_bodies: int = 1) -> Placing:
    """Return memory for bodies at poses (plain Python)."""
    n_features, n_nodes = len(own.features), len(own.nodes)
    return Placing(
        empty_rows(Feature, n_features),
        np.zeros(n_features, np.bool_),
        np.zeros((n_nodes, 2, 3)),
        np.zeros(n_nodes, np.bool_),
        np.zeros((n_bodies, 4, 3)),
    )


def empty_placed(own: Boundary) -> PlacedBoundary:
    """Return a body with memory for a pose (plain Python)."""
    memory = empty_placing(own)
    return PlacedBoundary(own, memory.features, memory.is_placed, memory.boxes, memory.is_boxed, memory.poses[0])


@kernel
def placed_in(own: Boundary, memory: Placing) -> PlacedBoundary:
    """Return a body as it is placed in memory of its own."""
    return PlacedBoundary(own, memory.features, memory.is_placed, memory.boxes, memory.is_boxed, memory.poses[0])


@kernel
def number_of_bodies(bodies: Bodies) -> int:
    return len(bodies.first_nodes) - 1


@kernel
def body_of(bodies: Bodies, memory: Placing, which: int) -> PlacedBoundary:
    """Return one of several bodies as it is placed in some memory."""
    if len(bodies.first_nodes) == 2:  # of one alone nothing has to be cut, which takes as long as to place a feature
        return placed_in(bodies.own, memory)
    own, first, last = bodies.own, bodies.first_nodes[which], bodies.first_nodes[which + 1]
    return PlacedBoundary(
        Boundary(own.parts, own.features, own.bounds, own.covers, own.cover_list, own.nodes[first:last], own.planes),
        memory.features,
        memory.is_placed,
        memory.boxes[first:last],
        memory.is_boxed[first:last],
        memory.poses[which],
    )


@kernel
def features_of(own: Boundary) -> tuple[int, int]:
    """Return the first feature of a body, and the one behind its last: what its trees hold."""
    return own.nodes[VERTICES].first, own.nodes[FACES].last


@kernel
def place_boundary(body: PlacedBoundary, position: Vector, quaternion: Quaternion) -> None:
    """Place a boundary at a pose."""
    place_turned(body, position, matrix_from_quaternion(quaternion))


@kernel
def place_turned(body: PlacedBoundary, position: Vector, rotation: Matrix) -> None:
    """Place a boundary at a pose that is given with a rotation matrix."""
    for k in range(3):
        body.pose[0, k] = position[k]
        for j in range(3):
            body.pose[1 + j, k] = rotation[j][k]
    first, last = features_of(body.own)
    body.is_placed[first:last] = False
    body.is_boxed[:] = False


@kernel
def box_of(body: PlacedBoundary, node: int) -> PlacedBox:
    """Return the box of the world around a node."""
    box = body.boxes[node]
    if not body.is_boxed[node]:
        body.is_boxed[node] = True
        placed = placed_box(body.own.nodes[node], position_of(body), rotation_of(body))
        for k in range(3):
            box[0, k], box[1, k] = placed.middle[k], placed.half[k]
    return PlacedBox((box[0, 0], box[0, 1], box[0, 2]), (box[1, 0], box[1, 1], box[1, 2]))


@kernel
def position_of(body: PlacedBoundary) -> Vector:
    return row(body.pose, 0)


@kernel
def rotation_of(body: PlacedBoundary) -> Matrix:
    return (row(body.pose, 1), row(body.pose, 2), row(body.pose, 3))


@kernel
def place_feature(body: PlacedBoundary, i: int) -> None:
    """Place a feature, if it is not."""
    if body.is_placed[i]:
        return
    body.is_placed[i] = True
    body.features[i] = body.own.features[i]  # type: ignore[index]
    write_placed(body.own.features[i], position_of(body), rotation_of(body), body.features[i])


@kernel
def place_feature_at(body: PlacedBoundary, i: int, position: Vector, rotation: Matrix) -> None:
    """Place one feature, and the pose of its body, where a pose is tried."""
    for k in range(3):
        body.pose[0, k] = position[k]
        for j in range(3):
            body.pose[1 + j, k] = rotation[j][k]
    body.features[i] = body.own.features[i]  # type: ignore[index]
    write_placed(body.own.features[i], position, rotation, body.features[i])


@kernel
def write_placed(feature: Feature, position: Vector, rotation: Matrix, out: Feature) -> None:
    """Write a feature as it is in the world with its body at a pose; what does not change with the pose is there."""
    point = plus(position, times(rotation, vector_from(feature.point)))
    direction = times(rotation, vector_from(feature.direction))
    for k in range(3):
        out.point[k], out.direction[k] = point[k], direction[k]
    if feature.kind == CIRCLE or feature.radius < 0.0:
        toward = times(rotation, vector_from(feature.toward))
        for k in range(3):
            out.toward[k] = toward[k]


@kernel
def middle_of_part(body: PlacedBoundary, part: int) -> Vector:
    """Return the middle of the ball around a part, in the world."""
    return plus(position_of(body), times(rotation_of(body), vector_from(body.own.parts[part].middle)))


@kernel
def in_body(body: PlacedBoundary, direction: Vector) -> Vector:
    """Return a direction of the world as the body has it."""
    return in_frame(body.pose, direction)


@kernel
def in_frame(pose: FloatArray, direction: Vector) -> Vector:
    """As `in_body`, of a body's pose alone: it is a tenth of what a body is handed over as."""
    return transposed_times((row(pose, 1), row(pose, 2), row(pose, 3)), direction)


@kernel
def seen_from_feature(body: PlacedBoundary, i: int, point: Vector) -> Vector:
    """Return a place of the world as seen from a feature's own point, in the frame of the body."""
    return transposed_times(rotation_of(body), minus(point, vector_from(body.features[i].point)))
