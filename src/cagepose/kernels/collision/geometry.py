"""What does not change during a run (`Geometry`), and what follows from one pose (`Placement`).

Cage points against boxes are told by the boxes' faces, here; where there are other shapes, all parts by their features,
in `cagepose.kernels.boundary`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Matrix, Vector, matrix, minus, plus, row, times, transposed_times
from cagepose.kernels.boundary.features import (
    BodyPart,
    Boundary,
    Feature,
    PlacedBoundary,
    Placing,
    empty_placing,
    place_boundary,
    placed_in,
)
from cagepose.kernels.boundary.groups import number_groups
from cagepose.kernels.boundary.meetings import find_meetings
from cagepose.kernels.boundary.overlap import OverlapWork, empty_overlap_work
from cagepose.kernels.boundary.queue import MOST_WAITING, Queue, empty_queue
from cagepose.kernels.boundary.touching import Meetings, empty_meetings, most_meetings
from cagepose.kernels.boundary.tree import Node
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

FEATURES_OF_PART = 64
"""What has so many times more features may touch in as many times more places."""


class Geometry(NamedTuple):
    """Boxes in the object's frame and cage points in the world; or, where there are other shapes, two boundaries.

    Where two boxes meet flush, the plane between them belongs to the inside of the object, but to the inside of
    neither box. A further box bridges each such seam (see `cagepose.model.seams`): it lies within the two, so it
    gives no contacts of its own.

    Attributes
    ----------
    half_sizes
        (n_boxes, 3), metres: the object's own boxes first, then the bridges.
    box_positions, box_rotations
        Pose of each box in the object's frame, (n_boxes, 3) metres and (n_boxes, 3, 3).
    n_own_boxes
        How many of the boxes are no bridges.
    points_world
        (n_points, 3), metres.
    held, cage
        All parts of the object, its own boxes first, in its frame, and of the cage, its points first, in the world.
        Boxes and points are not listed then; where there are only these, both are empty.
    touch_m
        Parts within this distance touch.
    """

    half_sizes: FloatArray
    box_positions: FloatArray
    box_rotations: FloatArray
    n_own_boxes: int
    points_world: FloatArray
    held: Boundary
    cage: PlacedBoundary
    touch_m: float


class Placement(NamedTuple):
    """The boxes at one pose of the object, and the cage points seen from each of them.

    Attributes
    ----------
    box_positions, box_rotations
        Pose of each box in the world, (n_boxes, 3) metres and (n_boxes, 3, 3).
    points_object, points_box
        Cage points in the frame of the object, (3, n_points), and of each box, (n_boxes, 3, n_points), metres: in this
        order a processor works out several points at once.
    gaps
        `box_gap` of each of them, (n_boxes, n_points), metres.
    depths
        How deep each point lies in the object: the greatest depth over the boxes, below zero outside, (n_points,),
        metres.
    arms
        Memory for the squared distance of each point from the axis of a turn, (n_points,), square metres.
    body
        Memory for the object's boundary, see `held_at`.
    moved
        Memory for it at a pose that is tried, see `held_moved`.
    meetings
        Where it touches the cage's.
    queue
        Memory for pairs of nodes that may touch on the way.
    """

    box_positions: FloatArray
    box_rotations: FloatArray
    points_object: FloatArray
    points_box: FloatArray
    gaps: FloatArray
    depths: FloatArray
    arms: FloatArray
    body: Placing
    moved: Placing
    meetings: Meetings
    queue: Queue


def empty_placement(geometry: Geometry) -> Placement:
    """Return a workspace for one placement (plain Python: making arrays in compiled code is slow to compile)."""
    n_boxes = len(geometry.half_sizes)
    n_points = len(geometry.points_world)
    return Placement(
        np.empty((n_boxes, 3)),
        np.empty((n_boxes, 3, 3)),
        np.empty((3, n_points)),
        np.empty((n_boxes, 3, n_points)),
        np.empty((n_boxes, n_points)),
        np.empty(n_points),
        np.empty(n_points),
        empty_placing(geometry.held),
        empty_placing(geometry.held),
        empty_meetings(max(len(geometry.held.features), len(geometry.cage.features)), most_rows(geometry)),
        empty_queue(most_waiting(geometry)),
    )


def most_waiting(geometry: Geometry) -> int:
    """Return how many pairs of nodes may wait (plain Python): none without boundaries."""
    n_features = len(geometry.held.features) + len(geometry.cage.own.features)
    return max(MOST_WAITING, n_features) if len(geometry.held.features) > 0 else 0


def most_rows(geometry: Geometry) -> int:
    """Return how many meetings of the two boundaries there is memory for (plain Python)."""
    n_parts, n_cage_parts = (
        max(len(body.parts), len(body.features) // FEATURES_OF_PART) for body in (geometry.held, geometry.cage.own)
    )
    return most_meetings(n_parts, n_cage_parts)


def most_elements(geometry: Geometry) -> int:
    """Return how many points and shapes the cage has (plain Python)."""
    return max(len(geometry.points_world), len(geometry.cage.own.parts))


class PlacedCage(NamedTuple):
    """Memory for the cage of a case, in the world: its points, (n_points, 3), metres; its boundary at a pose; as single
    points may be elsewhere from case to case, features, parts and trees of its own; and for the start check.
    """

    points_world: FloatArray
    placing: Placing
    features: Rows[Feature]
    parts: Rows[BodyPart]
    nodes: Rows[Node]
    overlap: OverlapWork


def empty_cage(geometry: Geometry) -> PlacedCage:
    """Return memory for the cage of a case (plain Python)."""
    own = geometry.cage.own
    return PlacedCage(
        np.empty_like(geometry.points_world),
        empty_placing(own),
        empty_rows(Feature, len(own.features)),
        empty_rows(BodyPart, len(own.parts)),
        empty_rows(Node, len(own.nodes)),
        empty_overlap_work(geometry.held, own),
    )


@kernel
def is_shaped(geometry: Geometry) -> bool:
    """Whether the object and the cage are two boundaries."""
    return len(geometry.held.features) > 0


@kernel
def held_at(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return the object's boundary at its pose."""
    return placed_in(geometry.held, placement.body)


@kernel
def held_moved(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return memory for the object's boundary at a pose that is tried."""
    return placed_in(geometry.held, placement.moved)


@kernel
def box_gap(point_box: Vector, half_size: Vector) -> float:
    """Return max_k(|q_k| - h_k), equation (2.4): below zero inside; at an edge every touching slab must go in."""
    return max(abs(point_box[0]) - half_size[0], abs(point_box[1]) - half_size[1], abs(point_box[2]) - half_size[2])


@kernel
def place_boxes(
    half_sizes: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    points_world: FloatArray,
    position: Vector,
    quaternion: Quaternion,
    box_positions: FloatArray,
    box_rotations: FloatArray,
    points: FloatArray,
    points_boxes: FloatArray,
    gaps_boxes: FloatArray,
    depths: FloatArray,
) -> None:
    """Place boxes at a pose of the object: the first four arguments are those of `Geometry`, the last six of
    `Placement`. Passing either as a whole takes as long as placing a few points.
    """
    heed_interrupt()
    rotation = matrix_from_quaternion(quaternion)
    n_points = len(points_world)
    for point in range(n_points):
        depths[point] = -np.inf
        seen = transposed_times(rotation, minus(row(points_world, point), position))
        points[0, point], points[1, point], points[2, point] = seen
    for box in range(len(half_sizes)):
        half_size, middle = row(half_sizes, box), row(middles, box)
        axes = matrix(turns, box)
        world = plus(position, times(rotation, middle))
        for i in range(3):
            box_positions[box, i] = world[i]
            turned = transposed_times(axes, rotation[i])
            for k in range(3):
                box_rotations[box, i, k] = turned[k]
        points_box, gaps = points_boxes[box], gaps_boxes[box]
        is_aligned = axes[0][0] == 1.0 and axes[1][1] == 1.0 and axes[2][2] == 1.0
        if is_aligned:  # most boxes, at a third of the cost
            for point in range(n_points):
                x, y, z = points[0, point] - middle[0], points[1, point] - middle[1], points[2, point] - middle[2]
                points_box[0, point], points_box[1, point], points_box[2, point] = x, y, z
                gaps[point] = box_gap((x, y, z), half_size)
                depths[point] = max(depths[point], -gaps[point])
        else:
            for point in range(n_points):
                seen = minus((points[0, point], points[1, point], points[2, point]), middle)
                x, y, z = transposed_times(axes, seen)
                points_box[0, point], points_box[1, point], points_box[2, point] = x, y, z
                gaps[point] = box_gap((x, y, z), half_size)
                depths[point] = max(depths[point], -gaps[point])


@kernel
def place_points(geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement) -> None:
    """Fill what ``placement`` has of boxes and points for the object at the given pose; so short that it is inlined."""
    place_boxes(
        geometry.half_sizes,
        geometry.box_positions,
        geometry.box_rotations,
        geometry.points_world,
        position,
        quaternion,
        placement.box_positions,
        placement.box_rotations,
        placement.points_object,
        placement.points_box,
        placement.gaps,
        placement.depths,
    )


@entry
def place_object(geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement) -> None:
    """Fill ``placement`` for the object at the given pose."""
    place_points(geometry, position, quaternion, placement)
    if is_shaped(geometry):
        held = held_at(geometry, placement)
        place_boundary(held, position, quaternion)
        find_meetings(held, geometry.cage, geometry.touch_m, placement.meetings)
        number_groups(held, geometry.cage, geometry.touch_m, placement.meetings)


@kernel
def is_clear_of(geometry: Geometry, position: Vector, rotation: Matrix, point: int, touch_m: float) -> bool:
    """Whether one point touches no box, as `Placement.gaps` has it, when the object is at the given pose."""
    point_object = transposed_times(rotation, minus(row(geometry.points_world, point), position))
    for box in range(len(geometry.half_sizes)):
        from_box = minus(point_object, row(geometry.box_positions, box))
        point_box = transposed_times(matrix(geometry.box_rotations, box), from_box)
        if box_gap(point_box, row(geometry.half_sizes, box)) <= touch_m:
            return False
    return True


@kernel
def box_point(placement: Placement, box: int, point: int) -> Vector:
    """Return a cage point in the frame of one box."""
    return (
        placement.points_box[box, 0, point],
        placement.points_box[box, 1, point],
        placement.points_box[box, 2, point],
    )


@kernel
def vector_in_box(placement: Placement, box: int, vector_world: Vector) -> Vector:
    """Turn a world vector into the frame of one box."""
    return transposed_times(matrix(placement.box_rotations, box), vector_world)


@kernel
def point_in_box(placement: Placement, box: int, point_world: Vector) -> Vector:
    """Turn a world point into the frame of one box."""
    return vector_in_box(placement, box, minus(point_world, row(placement.box_positions, box)))
