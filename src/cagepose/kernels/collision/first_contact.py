"""First contact of all cage points with all boxes: the least entry of equations (2.1) and (2.2).

Only points that can be hit matter, so there is no in-face test to get wrong: a face hidden inside another box cannot be
reached without entering that box first.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.tolerances import KernelTolerances, allowed_depth
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, row
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes, box_point, point_in_box, vector_in_box
from cagepose.kernels.collision.travel import travel_entry
from cagepose.kernels.collision.turn import turn_entry
from cagepose.kernels.native.kernel import kernel

SAFE = 1.0 + 1e-12
"""So that rounding passes over nothing that is just in reach."""


@kernel
def first_contact_travel(
    geometry: BoxesAndPoints, placement: PlacedBoxes, direction: Vector, skip_gap_m: float, tolerances: KernelTolerances
) -> tuple[float, int, int]:
    """Return (distance, point index, box index) of the first contact on a travel along ``direction``; (inf, -1, -1):
    none ahead.

    Points within ``skip_gap_m`` of a box are not asked about that box: -inf skips none.
    """
    least, first_point, first_box = math.inf, -1, -1
    for box in range(len(geometry.half_sizes)):
        half_size = row(geometry.half_sizes, box)
        velocity_box = vector_in_box(placement, box, direction)
        for point in range(len(geometry.points_world)):
            gap = placement.gaps[box, point]
            if gap <= skip_gap_m or gap > SAFE * least:
                continue
            entry = travel_entry(
                box_point(placement, box, point),
                velocity_box,
                half_size,
                allowed_depth(placement.depths[point], tolerances),
                tolerances.resolution_m,
            )
            if entry < least:
                least, first_point, first_box = entry, point, box
    return least, first_point, first_box


@kernel
def is_out_of_reach(gap_m: float, arm_m2: float, key: float) -> bool:
    """Whether a point cannot get as far as a box before the turn comes to ``key``: the chord is shorter than the gap.

    The chord of the angle s is 2 r sin(s/2), with r^2 = ``arm_m2`` and sin^2(s/2) = 1 / (1 + c^2).
    """
    if gap_m <= 0.0 or key >= 0.0:  # beyond half a turn chords shrink again
        return False
    return gap_m * gap_m * (1.0 + key * key) > SAFE * 4.0 * arm_m2


@kernel
def first_contact_turn(
    geometry: BoxesAndPoints, placement: PlacedBoxes, through: Vector, axis: Vector, tolerances: KernelTolerances
) -> tuple[float, int]:
    """Return (key, point index) of the first contact on a right-handed turn; (inf, -1): none in a full turn.

    Keys are c = -cot(s/2), see `cagepose.kernels.collision.turn`; -inf: blocked at once.
    """
    least, first_point = math.inf, -1
    for point in range(len(geometry.points_world)):
        arm = cross(axis, minus(row(geometry.points_world, point), through))
        placement.arms[point] = dot(arm, arm)
    for box in range(len(geometry.half_sizes)):
        half_size = row(geometry.half_sizes, box)
        through_box = point_in_box(placement, box, through)
        axis_box = vector_in_box(placement, box, axis)
        for point in range(len(geometry.points_world)):
            if is_out_of_reach(placement.gaps[box, point], placement.arms[point], least):
                continue
            entry = turn_entry(
                box_point(placement, box, point),
                through_box,
                axis_box,
                half_size,
                allowed_depth(placement.depths[point], tolerances),
                tolerances.resolution_m,
                least,
            )
            if entry < least:
                least, first_point = entry, point
    return least, first_point


@kernel
def turn_is_blocked_at_once(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    points: NDArray[np.int64],
    n_points: int,
    through: Vector,
    axis: Vector,
    tolerances: KernelTolerances,
) -> bool:
    """Whether one of the first ``n_points`` of ``points`` blocks a turn at its start.

    Asked of the touching points before a sweep over all: it answers most stability tests at a tenth of the cost.
    """
    for i in range(n_points):
        point = points[i]
        for box in range(len(geometry.half_sizes)):
            if placement.gaps[box, point] > tolerances.resolution_m:
                continue
            entry = turn_entry(
                box_point(placement, box, point),
                point_in_box(placement, box, through),
                vector_in_box(placement, box, axis),
                row(geometry.half_sizes, box),
                allowed_depth(placement.depths[point], tolerances),
                tolerances.resolution_m,
                -math.inf,
            )
            if entry == -math.inf:
                return True
    return False
