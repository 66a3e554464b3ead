"""The metric D of motion from rest, and twists and wrenches in its units: equations (5.1) to (5.3).

D is that of a rigid body of mass 1: D = diag(1, 1, 1, K), K the inertia about the centre of gravity. In "scaled"
coordinates y = D^1/2 nu, along the principal axes of K, the metric is the identity, every component is a length, and
moments can be compared with forces. A scaled vector is an array of six: three for travel, three for turning.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.least_squares import MOST_ROWS
from cagepose.kernels.algebra.motion import motion_of, moved_point, turned_by_amount
from cagepose.kernels.algebra.pose import (
    Quaternion,
    quaternion_about,
    quaternion_product,
    rotated,
    rotation_vector,
    turned_by,
)
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import (
    Matrix,
    Vector,
    cross,
    dot,
    minus,
    norm,
    plus,
    row,
    scaled,
    times,
    transposed_times,
)
from cagepose.kernels.native.kernel import kernel

ScaledVector = Annotated[FloatArray, MOST_ROWS]
"""A scaled motion or wrench in a record: of each free body three numbers for travel and three for turning, and one
more that only the question for self-stress uses (5.16)."""


class Body:
    """The object's inertia for mass 1; a record.

    Attributes
    ----------
    axes_object
        Principal axes of the inertia about the centre of gravity, rows, in the object's frame.
    radii
        Radii of gyration about them, metres.
    reach_m
        Distance of the farthest corner from the centre of gravity, metres.
    """

    axes_object: Annotated[FloatArray, 3, 3]
    radii: Annotated[FloatArray, 3]
    reach_m: float


class Frame(NamedTuple):
    """The scaled coordinates at one pose: rows are the principal axes in the world."""

    axes: Matrix
    radii: Vector


@kernel
def frame_at(body: Body, quaternion: Quaternion) -> Frame:
    axes = (
        rotated(quaternion, row(body.axes_object, 0)),
        rotated(quaternion, row(body.axes_object, 1)),
        rotated(quaternion, row(body.axes_object, 2)),
    )
    return Frame(axes, (body.radii[0], body.radii[1], body.radii[2]))


@kernel
def write_scaled_wrench(force: Vector, moment: Vector, frame: Frame, out: FloatArray) -> None:
    """Write D^-1/2 (force, moment about the centre of gravity) into six numbers."""
    turning = times(frame.axes, moment)
    for k in range(3):
        out[k] = force[k]
    out[3] = turning[0] / frame.radii[0]
    out[4] = turning[1] / frame.radii[1]
    out[5] = turning[2] / frame.radii[2]


@kernel
def twist_of(y: FloatArray, frame: Frame) -> tuple[Vector, Vector]:
    """Return (velocity of the centre of gravity, angular velocity) of a scaled twist: nu = D^-1/2 y."""
    turning = (y[3] / frame.radii[0], y[4] / frame.radii[1], y[5] / frame.radii[2])
    return (y[0], y[1], y[2]), transposed_times(frame.axes, turning)


@kernel
def moved_along_twist(
    position: Vector, quaternion: Quaternion, velocity: Vector, spin: Vector, amount: float
) -> tuple[Vector, Quaternion]:
    """Move a pose by ``amount`` along a constant twist: an exact screw, equation (2.3), wherever its axis lies."""
    motion = motion_of(position, velocity, spin)
    moved = moved_point(motion, position, turned_by_amount(motion, amount))
    if motion.rate * amount == 0.0:
        return moved, quaternion
    return moved, quaternion_product(quaternion_about(motion.axis, motion.rate * amount), quaternion)


@kernel
def twist_between(position: Vector, quaternion: Quaternion, end: Vector, turned: Quaternion) -> tuple[Vector, Vector]:
    """Return (velocity, angular velocity) of the constant twist that leads from one pose to another in an amount of
    one, with a turn below half a turn.
    """
    way, spin = minus(end, position), rotation_vector(quaternion, turned)
    angle = norm(spin)
    if angle == 0.0:
        return way, spin
    axis = scaled(spin, 1.0 / angle)
    across = minus(way, scaled(axis, dot(axis, way)))
    side = minus(scaled(across, 0.5 * angle / math.tan(0.5 * angle)), scaled(cross(spin, across), 0.5))
    return plus(minus(way, across), side), spin


@kernel
def way_between(position: Vector, quaternion: Quaternion, end: Vector, turned: Quaternion, reach_m: float) -> float:
    """Return how far a body that reaches so far from its position moves at most from one pose to another one near it,
    metres.
    """
    return norm(minus(end, position)) + reach_m * turned_by(quaternion, turned)
