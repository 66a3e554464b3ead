"""Points and directions of a body that moves at a constant twist: an exact screw, equation (2.3)."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled
from cagepose.kernels.native.kernel import kernel


class Motion(NamedTuple):
    """A constant twist, for each unit of the amount.

    Attributes
    ----------
    center, velocity
        A place in the world, and how fast the body's material moves there, metres.
    rate, axis
        Radians about a unit vector; zero: a travel.
    """

    center: Vector
    velocity: Vector
    rate: float
    axis: Vector


@kernel
def motion_of(center: Vector, velocity: Vector, spin: Vector) -> Motion:
    rate = norm(spin)
    return Motion(center, velocity, rate, scaled(spin, 1.0 / rate) if rate > 0.0 else spin)


@kernel
def velocity_at(motion: Motion, point: Vector) -> Vector:
    """Return the velocity of the body's material at a place in the world; it stays the same, as the twist does."""
    return plus(motion.velocity, scaled(cross(motion.axis, minus(point, motion.center)), motion.rate))


@kernel
def moved_point(motion: Motion, point: Vector, amount: float) -> Vector:
    """Return where a point of the body is after an amount, equation (2.3).

    With V its velocity for each radian and V_perp its part across the axis a, the point moves by V_perp sin s + (V_perp
    x a)(cos s - 1) + a (a.V) s: nothing here grows with the distance of the axis.
    """
    velocity, angle = velocity_at(motion, point), motion.rate * amount
    if angle == 0.0:
        return plus(point, scaled(velocity, amount))
    per_radian = scaled(velocity, 1.0 / motion.rate)
    rise = dot(per_radian, motion.axis)
    side = minus(per_radian, scaled(motion.axis, rise))
    half_sine = math.sin(0.5 * angle)
    moved = plus(scaled(side, math.sin(angle)), scaled(cross(side, motion.axis), -2.0 * half_sine * half_sine))
    return plus(point, plus(moved, scaled(motion.axis, rise * angle)))


@kernel
def turned(motion: Motion, direction: Vector, amount: float) -> Vector:
    """Return a direction of the body after an amount."""
    angle = motion.rate * amount
    if angle == 0.0:
        return direction
    along = cross(motion.axis, direction)
    half_sine = math.sin(0.5 * angle)
    moved = plus(scaled(along, math.sin(angle)), scaled(cross(motion.axis, along), 2.0 * half_sine * half_sine))
    return plus(direction, moved)
