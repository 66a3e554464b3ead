"""Contacts that slide are put back on their faces: Newton's method on their gaps, the shortest way in the metric.

A screw leaves a curved constraint by the square of its length. Without this, gaps would open or close with the number
of steps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.geometry import FloatArray, Geometry
from cagepose.kernels.jit import kernel
from cagepose.kernels.least_squares import PassiveSet, append_column, empty_passive_set
from cagepose.kernels.metric import Body, frame_at, moved_along_twist, twist_of, write_scaled_wrench
from cagepose.kernels.pose import Quaternion, rotated
from cagepose.kernels.vector import Vector, cross, dot, minus, row, scaled

ROUNDS = 12
ON_FACE = 4e-16
"""In sizes of the scene: a gap that is rounding."""


class Pins(NamedTuple):
    """Coordinates of cage points, in frames of boxes, that shall have given values.

    Attributes
    ----------
    used
        How many there are, (1,).
    points, boxes, axes, sides
        As in `ContactSet`: side * (coordinate of the point along the box's axis) ..., (n,).
    targets
        ... is to be this, (n,), metres: half the size of the box for a point on its face.
    column, y, values
        Room: one wrench and a scaled twist (6,), and what is missing at each, (n,).
    basis
        Room.
    """

    used: NDArray[np.int64]
    points: NDArray[np.int64]
    boxes: NDArray[np.int64]
    axes: NDArray[np.int64]
    sides: FloatArray
    targets: FloatArray
    column: FloatArray
    y: FloatArray
    values: FloatArray
    basis: PassiveSet


def empty_pins(n_pins: int) -> Pins:
    """Return room for ``n_pins`` (plain Python)."""
    return Pins(
        np.zeros(1, np.int64),
        np.zeros(n_pins, np.int64),
        np.zeros(n_pins, np.int64),
        np.zeros(n_pins, np.int64),
        np.zeros(n_pins),
        np.zeros(n_pins),
        np.zeros(6),
        np.zeros(6),
        np.zeros(n_pins),
        empty_passive_set(6),
    )


@kernel
def add_pin(pins: Pins, point: int, box: int, axis: int, side: float, target: float) -> bool:
    """Add a pin; False: there is no room, or it is there already."""
    n = pins.used[0]
    if n == len(pins.points):
        return False
    for i in range(n):
        if pins.points[i] == point and pins.boxes[i] == box and pins.axes[i] == axis:
            return False
    pins.points[n], pins.boxes[n], pins.axes[n] = point, box, axis
    pins.sides[n], pins.targets[n] = side, target
    pins.used[0] = n + 1
    return True


@kernel
def box_axis(geometry: Geometry, box: int, axis: int) -> Vector:
    """Return an axis of a box in the object's frame."""
    r = geometry.box_rotations
    return (r[box, 0, axis], r[box, 1, axis], r[box, 2, axis])


@kernel
def pull_back(
    geometry: Geometry, body: Body, position: Vector, quaternion: Quaternion, pins: Pins, size_m: float
) -> tuple[bool, Vector, Quaternion]:
    """Move the object so that all pins hold; return (whether they do, position, quaternion).

    Pins that depend on others follow from them: where they do not, that shows as a point inside the object later.
    """
    worst_before = math.inf
    for _ in range(ROUNDS):
        frame = frame_at(body, quaternion)
        back = (quaternion[0], -quaternion[1], -quaternion[2], -quaternion[3])
        pins.basis.used[0] = 0
        worst = 0.0
        for i in range(pins.used[0]):
            axis_object = scaled(box_axis(geometry, pins.boxes[i], pins.axes[i]), pins.sides[i])
            arm = minus(row(geometry.points_world, pins.points[i]), position)
            from_box = minus(rotated(back, arm), row(geometry.box_positions, pins.boxes[i]))
            direction = rotated(quaternion, axis_object)
            write_scaled_wrench(direction, cross(arm, direction), frame, pins.column)
            place = pins.basis.used[0]
            if append_column(pins.basis, pins.column, i, 0.0, 6):
                pins.values[place] = dot(axis_object, from_box) - pins.targets[i]
                worst = max(worst, abs(pins.values[place]))
        if worst <= ON_FACE * size_m or worst >= worst_before:
            return worst <= 1e3 * ON_FACE * size_m, position, quaternion
        worst_before = worst
        for k in range(6):
            pins.y[k] = 0.0
        for i in range(pins.basis.used[0]):
            for j in range(i):
                pins.values[i] -= pins.basis.triangle[i, j] * pins.values[j]
            pins.values[i] /= pins.basis.triangle[i, i]
            for k in range(6):
                pins.y[k] += pins.values[i] * pins.basis.basis[i, k]
        velocity, spin = twist_of(pins.y, frame)
        position, quaternion = moved_along_twist(position, quaternion, velocity, spin, 1.0)
    return False, position, quaternion
