"""The metric D of motion from rest, and twists and wrenches in its units: equations (5.1) to (5.3).

D is that of a rigid body of mass 1: D = diag(1, 1, 1, K), K the inertia about the centre of gravity. In "scaled"
coordinates y = D^1/2 nu, along the principal axes of K, the metric is the identity, every component is a length, and
moments can be compared with forces. A scaled vector is an array of six: three for travel, three for turning.

A freedom that is held has an infinite D: no wrench moves the object along it, and no motion has a part there. Its
numbers in scaled wrenches and twists are zero, so that what holds it need not be known: it carries all that acts there.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.least_squares import MOST_ROWS, WRENCH, PassiveSet
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
    held
        1 for what is held, or 0: travel along x, y and z of the world, and turns about them. Of the turns none is held,
        all are, or all but one.
    """

    axes_object: Annotated[FloatArray, 3, 3]
    radii: Annotated[FloatArray, 3]
    reach_m: float
    held: Annotated[FloatArray, 6]


class Frame(NamedTuple):
    """The scaled coordinates at one pose.

    Attributes
    ----------
    axes
        Rows are the principal axes in the world; where turns are held, the axes of the world.
    radii
        Radii of gyration about them, metres; infinite where the turn is held.
    travels
        1, or 0 along an axis of the world along which travel is held.
    extent_m
        The greatest radius of gyration of the object, whatever is held, metres.
    """

    axes: Matrix
    radii: Vector
    travels: Vector
    extent_m: float


@kernel
def frame_at(body: Body, quaternion: Quaternion) -> Frame:
    axes = (
        rotated(quaternion, row(body.axes_object, 0)),
        rotated(quaternion, row(body.axes_object, 1)),
        rotated(quaternion, row(body.axes_object, 2)),
    )
    radii, held = (body.radii[0], body.radii[1], body.radii[2]), body.held
    travels, extent_m = (1.0 - held[0], 1.0 - held[1], 1.0 - held[2]), max(radii[0], radii[1], radii[2])
    if held[3] + held[4] + held[5] == 0.0:
        return Frame(axes, radii, travels, extent_m)
    about = (radius_about(axes, radii, body, 0), radius_about(axes, radii, body, 1), radius_about(axes, radii, body, 2))
    return Frame(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), about, travels, extent_m)


@kernel
def radius_about(axes: Matrix, radii: Vector, body: Body, axis: int) -> float:
    """Return the radius of gyration about an axis of the world, from the principal ones; inf: the turn is held."""
    if body.held[3 + axis] == 1.0:
        return math.inf
    return norm((radii[0] * axes[0][axis], radii[1] * axes[1][axis], radii[2] * axes[2][axis]))


@kernel
def write_scaled_wrench(force: Vector, moment: Vector, frame: Frame, out: FloatArray) -> None:
    """Write D^-1/2 (force, moment about the centre of gravity) into six numbers."""
    turning = times(frame.axes, moment)
    for k in range(3):
        out[k] = frame.travels[k] * force[k]
    out[3] = turning[0] / frame.radii[0]
    out[4] = turning[1] / frame.radii[1]
    out[5] = turning[2] / frame.radii[2]


@kernel
def wrench_of(scaled_wrench: FloatArray, frame: Frame) -> tuple[Vector, Vector]:
    """Return (force, moment about the centre of gravity) of a scaled wrench, with no part in what is held: D^1/2 y."""
    s, radii = scaled_wrench, frame.radii
    turning = (
        radii[0] * s[3] if s[3] != 0.0 else 0.0,
        radii[1] * s[4] if s[4] != 0.0 else 0.0,
        radii[2] * s[5] if s[5] != 0.0 else 0.0,
    )
    return (s[0], s[1], s[2]), transposed_times(frame.axes, turning)


@kernel
def is_held(frame: Frame, k: int) -> bool:
    """Whether one of the six freedoms is held."""
    return frame.travels[k] == 0.0 if k < 3 else frame.radii[k - 3] == math.inf


@kernel
def hold_freedoms(frame: Frame, span: PassiveSet) -> None:
    """Begin an empty span with the freedoms that are held."""
    for k in range(WRENCH):
        if is_held(frame, k):
            for row in range(span.n_rows):
                span.basis[span.used, row] = 1.0 if row == k else 0.0
            span.used += 1


@kernel
def twist_of(y: FloatArray, frame: Frame) -> tuple[Vector, Vector]:
    """Return (velocity of the centre of gravity, angular velocity) of a scaled twist: nu = D^-1/2 y."""
    turning = (y[3] / frame.radii[0], y[4] / frame.radii[1], y[5] / frame.radii[2])
    return (y[0], y[1], y[2]), transposed_times(frame.axes, turning)


@kernel
def write_scaled_twist(velocity: Vector, spin: Vector, frame: Frame, out: FloatArray) -> None:
    """Write the scaled twist of a motion into six numbers, without what is held: y = D^1/2 nu."""
    turning = times(frame.axes, spin)
    for k in range(3):
        out[k] = frame.travels[k] * velocity[k]
        out[3 + k] = frame.radii[k] * turning[k] if frame.radii[k] < math.inf else 0.0


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
