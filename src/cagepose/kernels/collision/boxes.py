"""Boxes held by points alone, as the paper's method and the search for a way out take them, and the boxes at a pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, matrix, minus, plus, row, times, transposed_times
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

FEATURES_OF_PART = 64
"""What has so many times more features may touch in as many times more places."""


class BoxesAndPoints(NamedTuple):
    """Boxes in the object's frame and cage points in the world.

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
    """

    half_sizes: FloatArray
    box_positions: FloatArray
    box_rotations: FloatArray
    n_own_boxes: int
    points_world: FloatArray


class PlacedBoxes(NamedTuple):
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
    """

    box_positions: FloatArray
    box_rotations: FloatArray
    points_object: FloatArray
    points_box: FloatArray
    gaps: FloatArray
    depths: FloatArray
    arms: FloatArray


def empty_placed_boxes(geometry: BoxesAndPoints) -> PlacedBoxes:
    """Return a workspace for boxes at one pose (plain Python: making arrays in compiled code is slow to compile)."""
    n_boxes, n_points = len(geometry.half_sizes), len(geometry.points_world)
    return PlacedBoxes(
        np.empty((n_boxes, 3)),
        np.empty((n_boxes, 3, 3)),
        np.empty((3, n_points)),
        np.empty((n_boxes, 3, n_points)),
        np.empty((n_boxes, n_points)),
        np.empty(n_points),
        np.empty(n_points),
    )


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
    """Place boxes at a pose of the object: the first four arguments are those of `BoxesAndPoints`, the last six
    of `PlacedBoxes`. Passing either as a whole takes as long as placing a few points.
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


@entry
def place_boxes_at(geometry: BoxesAndPoints, position: Vector, quaternion: Quaternion, placement: PlacedBoxes) -> None:
    """Fill ``placement`` for the object at the given pose."""
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


@kernel
def is_clear_of(geometry: BoxesAndPoints, position: Vector, rotation: Matrix, point: int, touch_m: float) -> bool:
    """Whether one point touches no box, as `PlacedBoxes.gaps` has it, when the object is at the given pose."""
    point_object = transposed_times(rotation, minus(row(geometry.points_world, point), position))
    for box in range(len(geometry.half_sizes)):
        from_box = minus(point_object, row(geometry.box_positions, box))
        point_box = transposed_times(matrix(geometry.box_rotations, box), from_box)
        if box_gap(point_box, row(geometry.half_sizes, box)) <= touch_m:
            return False
    return True


@kernel
def box_point(placement: PlacedBoxes, box: int, point: int) -> Vector:
    """Return a cage point in the frame of one box."""
    return (
        placement.points_box[box, 0, point],
        placement.points_box[box, 1, point],
        placement.points_box[box, 2, point],
    )


@kernel
def vector_in_box(placement: PlacedBoxes, box: int, vector_world: Vector) -> Vector:
    """Turn a world vector into the frame of one box."""
    return transposed_times(matrix(placement.box_rotations, box), vector_world)


@kernel
def point_in_box(placement: PlacedBoxes, box: int, point_world: Vector) -> Vector:
    """Turn a world point into the frame of one box."""
    return vector_in_box(placement, box, minus(point_world, row(placement.box_positions, box)))
