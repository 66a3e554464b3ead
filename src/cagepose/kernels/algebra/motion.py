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


class Turned(NamedTuple):
    """How far a motion has come: its amount, and of its angle s the sine and 1 - cos s."""

    amount: float
    sine: float
    versine: float


@kernel
def turned_by_amount(motion: Motion, amount: float) -> Turned:
    """Return how far a motion is after an amount."""
    angle = motion.rate * amount
    if angle == 0.0:
        return Turned(amount, 0.0, 0.0)
    half_sine = math.sin(0.5 * angle)
    return Turned(amount, math.sin(angle), 2.0 * half_sine * half_sine)


@kernel
def moved_point(motion: Motion, point: Vector, so_far: Turned) -> Vector:
    """Return where a point of the body is then, equation (2.3).

    With V its velocity for each radian and V_perp its part across the axis a, the point moves by V_perp sin s + (V_perp
    x a)(cos s - 1) + a (a.V) s: nothing here grows with the distance of the axis.
    """
    velocity, angle = velocity_at(motion, point), motion.rate * so_far.amount
    if angle == 0.0:
        return plus(point, scaled(velocity, so_far.amount))
    per_radian = scaled(velocity, 1.0 / motion.rate)
    rise = dot(per_radian, motion.axis)
    side = minus(per_radian, scaled(motion.axis, rise))
    moved = plus(scaled(side, so_far.sine), scaled(cross(side, motion.axis), -so_far.versine))
    return plus(point, plus(moved, scaled(motion.axis, rise * angle)))


@kernel
def turned(motion: Motion, direction: Vector, so_far: Turned) -> Vector:
    """Return what a direction of the body is then."""
    if so_far.sine == 0.0 and so_far.versine == 0.0:
        return direction
    along = cross(motion.axis, direction)
    return plus(direction, plus(scaled(along, so_far.sine), scaled(cross(motion.axis, along), so_far.versine)))
