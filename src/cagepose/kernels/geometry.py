"""What does not change during a run (`Geometry`), and what follows from one pose (`Placement`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.record import FloatArray
from cagepose.kernels.vector import Vector, matrix, minus, plus, row, times, transposed_times


class Geometry(NamedTuple):
    """Boxes in the object's frame, cage points in the world.

    Where two boxes meet flush, the plane between them belongs to the inside of the object, but to the inside of
    neither box. A further box bridges each such seam (see `cagepose.nouns.seams`): it lies within the two, so it
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


class Placement(NamedTuple):
    """The boxes at one pose of the object, and the cage points seen from each of them.

    Attributes
    ----------
    box_positions, box_rotations
        Pose of each box in the world, (n_boxes, 3) metres and (n_boxes, 3, 3).
    points_box
        Cage points in the frame of each box, (n_boxes, n_points, 3), metres.
    gaps
        `box_gap` of each of them, (n_boxes, n_points), metres.
    depths
        How deep each point lies in the object: the greatest depth over the boxes, below zero outside, (n_points,),
        metres.
    """

    box_positions: FloatArray
    box_rotations: FloatArray
    points_box: FloatArray
    gaps: FloatArray
    depths: FloatArray


def empty_placement(geometry: Geometry) -> Placement:
    """Return room for one placement (plain Python: making arrays in compiled code is slow to compile)."""
    n_boxes = len(geometry.half_sizes)
    n_points = len(geometry.points_world)
    return Placement(
        np.empty((n_boxes, 3)),
        np.empty((n_boxes, 3, 3)),
        np.empty((n_boxes, n_points, 3)),
        np.empty((n_boxes, n_points)),
        np.empty(n_points),
    )


@kernel
def box_gap(point_box: Vector, half_size: Vector) -> float:
    """Return max_k(|q_k| - h_k), equation (2.4): below zero inside; at an edge every touching slab must go in."""
    return max(abs(point_box[0]) - half_size[0], abs(point_box[1]) - half_size[1], abs(point_box[2]) - half_size[2])


@entry_kernel
def place_object(geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement) -> None:
    """Fill ``placement`` for the object at the given pose."""
    rotation = matrix_from_quaternion(quaternion)
    n_points = len(geometry.points_world)
    for point in range(n_points):  # assigning to a slice would compile numba's whole shape-error machinery: 2 s
        placement.depths[point] = -np.inf
    for box in range(len(geometry.half_sizes)):
        half_size = row(geometry.half_sizes, box)
        box_position = plus(position, times(rotation, row(geometry.box_positions, box)))
        local = geometry.box_rotations[box]
        columns = (
            times(rotation, (local[0, 0], local[1, 0], local[2, 0])),
            times(rotation, (local[0, 1], local[1, 1], local[2, 1])),
            times(rotation, (local[0, 2], local[1, 2], local[2, 2])),
        )
        for i in range(3):
            placement.box_positions[box, i] = box_position[i]
            for k in range(3):
                placement.box_rotations[box, i, k] = columns[k][i]
        for point in range(n_points):
            # Rows of `columns` are the box's axes, so this product is the way back into the box's frame.
            point_box = times(columns, minus(row(geometry.points_world, point), box_position))
            for k in range(3):
                placement.points_box[box, point, k] = point_box[k]
            gap = box_gap(point_box, half_size)
            placement.gaps[box, point] = gap
            placement.depths[point] = max(placement.depths[point], -gap)


@kernel
def depth_of_point(geometry: Geometry, position: Vector, quaternion: Quaternion, point: int) -> float:
    """Return how deep one point lies in the object at the given pose, as `Placement.depths` has it."""
    rotation = matrix_from_quaternion(quaternion)
    point_object = transposed_times(rotation, minus(row(geometry.points_world, point), position))
    depth = -np.inf
    for box in range(len(geometry.half_sizes)):
        from_box = minus(point_object, row(geometry.box_positions, box))
        point_box = transposed_times(matrix(geometry.box_rotations, box), from_box)
        depth = max(depth, -box_gap(point_box, row(geometry.half_sizes, box)))
    return depth


@kernel
def vector_in_box(placement: Placement, box: int, vector_world: Vector) -> Vector:
    """Turn a world vector into the frame of one box."""
    return transposed_times(matrix(placement.box_rotations, box), vector_world)


@kernel
def point_in_box(placement: Placement, box: int, point_world: Vector) -> Vector:
    """Turn a world point into the frame of one box."""
    return vector_in_box(placement, box, minus(point_world, row(placement.box_positions, box)))
