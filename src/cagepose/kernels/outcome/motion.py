"""The one motion from a pose to another, or that begins with a twist: a travel, a turn or a screw (Chasles)."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion, quaternion_product
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import NONE, SCREW, TRAVEL, TURN

ROUNDING_OF_TURN_RAD = 1e-12
"""Radians. A smaller turn between two poses is rounding."""
ROUNDING_OF_WAY = 1e-9
"""Fraction of the way. A smaller travel along the axis is rounding, and so is what a turn moves over the object's size.
It also holds for the turning of a twist, over the radius of gyration: Newton's method leaves 1e-11 of it."""


class ScrewMotion(NamedTuple):
    """A motion of finite or of vanishing size.

    Attributes
    ----------
    motion
        Code of its kind; NONE: there is none.
    along, through
        Direction of a travel, or axis and a point on it.
    distance, angle
        Metres and radians; for a twist the distance for each radian, and 1.
    """

    motion: int
    along: Vector
    through: Vector
    distance: float
    angle: float


@kernel
def motion_between(
    start: Vector,
    start_quaternion: Quaternion,
    end: Vector,
    end_quaternion: Quaternion,
    size_m: float,
    turned: Vector,
) -> ScrewMotion:
    """Return the motion from one pose to another.

    Two poses leave open how many times the object has turned, and which way round; the steps between them tell.

    Parameters
    ----------
    start, end
        Where the same point of the object is; its way sets what counts as rounding.
    start_quaternion, end_quaternion
        Orientations.
    size_m
        How far the object's points are apart at most, or more.
    turned
        The turns on the way added up, axes times angles, radians; zero: it turned by 180 degrees at most.
    """
    zero = (0.0, 0.0, 0.0)
    way = minus(end, start)
    back = (start_quaternion[0], -start_quaternion[1], -start_quaternion[2], -start_quaternion[3])
    turn = quaternion_product(end_quaternion, back)
    sense = math.copysign(1.0, turn[0])
    vector = (sense * turn[1], sense * turn[2], sense * turn[3])
    sine = norm(vector)
    angle = 2.0 * math.atan2(sine, abs(turn[0]))
    distance = norm(way)
    if angle <= ROUNDING_OF_TURN_RAD or angle * size_m <= ROUNDING_OF_WAY * distance:
        if distance == 0.0:
            return ScrewMotion(NONE, zero, zero, 0.0, 0.0)
        return ScrewMotion(TRAVEL, scaled(way, 1.0 / distance), zero, distance, 0.0)
    axis = scaled(vector, 1.0 / sine)
    angle += 2.0 * math.pi * math.floor((dot(turned, axis) - angle) / (2.0 * math.pi) + 0.5)
    if angle < 0.0:
        axis, angle = scaled(axis, -1.0), -angle
    rise = dot(axis, way)
    across = minus(way, scaled(axis, rise))
    lever = scaled(cross(axis, across), 0.5 / math.tan(0.5 * angle))
    through = plus(plus(start, scaled(across, 0.5)), lever)
    if abs(rise) <= ROUNDING_OF_WAY * distance:
        return ScrewMotion(TURN, axis, through, 0.0, angle)
    return ScrewMotion(SCREW, axis, through, rise, angle)


@kernel
def motion_of_twist(velocity: Vector, spin: Vector, center: Vector, radius_m: float) -> ScrewMotion:
    """Return the motion that begins with a twist of the point ``center``; ``radius_m`` compares turns with travels."""
    rate, speed = norm(spin), norm(velocity)
    if rate * radius_m <= ROUNDING_OF_WAY * speed:
        return ScrewMotion(TRAVEL, scaled(velocity, 1.0 / speed), (0.0, 0.0, 0.0), 0.0, 0.0)
    axis = scaled(spin, 1.0 / rate)
    rise = dot(axis, velocity)
    lever = cross(axis, minus(velocity, scaled(axis, rise)))
    through = plus(center, scaled(lever, 1.0 / rate))
    if abs(rise) <= ROUNDING_OF_WAY * max(speed, rate * radius_m):
        return ScrewMotion(TURN, axis, through, 0.0, 1.0)
    return ScrewMotion(SCREW, axis, through, rise / rate, 1.0)
