"""Which points touch, on which faces, with which normals and gaps: equation (2.4) and the visibility of faces (2.7).

A point within the touch tolerance of a face may lie on an edge, so it can touch several faces of a box, and several
boxes. Where boxes of the union touch, a face hidden inside another box gives no contact. That can only happen on an
edge of the face: elsewhere the point itself, which lies in no box, sees it. There a probe asks: from the point, a
little into the face and a little outward, is there another box?
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import PROBE, PROBE_MARGIN, KernelTolerances
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, row, scaled
from cagepose.kernels.collision.boxes import (
    BoxesAndPoints,
    PlacedBoxes,
    box_gap,
    box_point,
    empty_placed_boxes,
    place_boxes_at,
    point_in_box,
)
from cagepose.kernels.native.kernel import kernel


@kernel
def face_normal(placement: PlacedBoxes, box: int, axis: int, side: float) -> Vector:
    """Return the outward normal, in the world, of the face of ``box`` at ``side`` (+1 or -1) of its axis 0, 1 or 2."""
    r = placement.box_rotations
    return (side * r[box, 0, axis], side * r[box, 1, axis], side * r[box, 2, axis])


@kernel
def touches_face(point_box: Vector, half_size: Vector, axis: int, touch_m: float) -> bool:
    """Whether a point no farther than ``touch_m`` from the box touches the face (or its opposite) along ``axis``."""
    return abs(abs(point_box[axis]) - half_size[axis]) <= touch_m


@kernel
def inside_another_box(
    geometry: BoxesAndPoints, placement: PlacedBoxes, box: int, probe_box: Vector, touch_m: float
) -> bool:
    """Whether a probe point, given in the frame of ``box``, lies well inside any other box."""
    r = placement.box_rotations[box]
    probe_world = row(placement.box_positions, box)
    for k in range(3):
        probe_world = plus(probe_world, scaled((r[0, k], r[1, k], r[2, k]), probe_box[k]))
    for other in range(len(geometry.half_sizes)):
        if other != box:
            gap = box_gap(point_in_box(placement, other, probe_world), row(geometry.half_sizes, other))
            if gap < -PROBE_MARGIN * touch_m:
                return True
    return False


@kernel
def moved_coordinate(point: Vector, axis: int, value: float) -> Vector:
    """Return the point with one coordinate replaced."""
    return (
        value if axis == 0 else point[0],
        value if axis == 1 else point[1],
        value if axis == 2 else point[2],
    )


@kernel
def is_hidden(
    geometry: BoxesAndPoints, placement: PlacedBoxes, box: int, point: int, axis: int, touch_m: float
) -> bool:
    """Whether the face that the point touches along ``axis`` is covered by another box at this place (2.7)."""
    half_size = row(geometry.half_sizes, box)
    probe = box_point(placement, box, point)
    on_edge = False
    for k in range(3):
        if k == axis:
            probe = moved_coordinate(probe, k, math.copysign(half_size[k] + PROBE * touch_m, probe[k]))
        elif abs(probe[k]) > half_size[k] - touch_m:
            on_edge = True
            probe = moved_coordinate(probe, k, math.copysign(half_size[k] - PROBE * touch_m, probe[k]))
    return on_edge and inside_another_box(geometry, placement, box, probe, touch_m)


@kernel
def steepest_contact(
    geometry: BoxesAndPoints, placement: PlacedBoxes, point: int, load_direction: Vector, tolerances: KernelTolerances
) -> tuple[bool, Vector, bool]:
    """Return (touches, normal, tie): of the faces that the point touches, the one that faces the load most.

    The smaller angle to the load counts (rule R4), that is the greater cosine n.f. Cosines within the tie tolerance are
    equal: then the first face counts (by box, then axis), and it is told. A point that touches only hidden faces does
    not touch.
    """
    best_cosine = -math.inf
    best_normal = (0.0, 0.0, 0.0)
    is_tie = False
    for box in range(geometry.n_own_boxes):
        half_size = row(geometry.half_sizes, box)
        point_box = box_point(placement, box, point)
        if placement.gaps[box, point] > tolerances.touch_m:
            continue
        for axis in range(3):
            if not touches_face(point_box, half_size, axis, tolerances.touch_m):
                continue
            normal = face_normal(placement, box, axis, math.copysign(1.0, point_box[axis]))
            cosine = dot(normal, load_direction)
            is_equal = abs(cosine - best_cosine) <= tolerances.tie
            if cosine < best_cosine and not is_equal:
                continue
            if is_hidden(geometry, placement, box, point, axis, tolerances.touch_m):
                continue
            if is_equal:
                is_tie = is_tie or norm(minus(normal, best_normal)) > tolerances.tie
            else:
                best_cosine, best_normal, is_tie = cosine, normal, False
    return best_cosine > -math.inf, best_normal, is_tie


def deepest_boxes(
    geometry: BoxesAndPoints, position: Vector, quaternion: Quaternion
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return, for each cage point, the greatest depth inside a box (below zero: outside) in metres, and that box.

    A box index of ``n_own_boxes`` or more is a bridge: the point lies in the seam between two boxes. Plain Python.
    """
    placement = empty_placed_boxes(geometry)
    place_boxes_at(geometry, position, quaternion, placement)
    depths = (geometry.half_sizes[:, :, None] - np.abs(placement.points_box)).min(axis=1)
    return placement.depths, depths.argmax(axis=0)
