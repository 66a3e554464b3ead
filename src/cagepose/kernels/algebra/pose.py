"""Pose algebra: unit quaternions (w, x, y, z), intrinsic ZYX angles, rotation matrices, rigid motions.

Source: docs/conventions.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, cross, minus, norm, plus, scaled
from cagepose.kernels.native.kernel import entry, kernel

Quaternion = tuple[float, float, float, float]


@kernel
def quaternion_product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Return p q, scaled back to length one: first turn by q, then by p."""
    w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]
    inverse_length = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    return (w * inverse_length, x * inverse_length, y * inverse_length, z * inverse_length)


@kernel
def quaternion_about(axis: Vector, angle_rad: float) -> Quaternion:
    """Return the right-handed turn by ``angle_rad`` about the unit vector ``axis``."""
    sine = math.sin(0.5 * angle_rad)
    return (math.cos(0.5 * angle_rad), axis[0] * sine, axis[1] * sine, axis[2] * sine)


@kernel
def turned_by(p: Quaternion, q: Quaternion) -> float:
    """Return twice the sine of half the angle between two orientations: the angle, where it is small."""
    turn = quaternion_product(q, (p[0], -p[1], -p[2], -p[3]))
    return 2.0 * math.sqrt(turn[1] ** 2 + turn[2] ** 2 + turn[3] ** 2)


@kernel
def rotation_vector(start: Quaternion, end: Quaternion) -> Vector:
    """Return axis times angle, radians, of one step's turn; quaternions keep their sign from step to step."""
    back = (start[0], -start[1], -start[2], -start[3])
    turn = quaternion_product(end, back)
    vector = (turn[1], turn[2], turn[3])
    sine = norm(vector)
    return scaled(vector, 2.0 * math.atan2(sine, turn[0]) / sine) if sine > 0.0 else (0.0, 0.0, 0.0)


@kernel
def rotated(q: Quaternion, a: Vector) -> Vector:
    """Return the vector ``a`` turned by q: a + 2 w (r x a) + 2 r x (r x a), with r the vector part."""
    r = (q[1], q[2], q[3])
    t = scaled(cross(r, a), 2.0)
    return plus(plus(a, scaled(t, q[0])), cross(r, t))


@kernel
def matrix_from_quaternion(q: Quaternion) -> Matrix:
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


@kernel
def quaternion_from_euler_zyx(yaw_rad: float, pitch_rad: float, roll_rad: float) -> Quaternion:
    """Return the quaternion of Rz(yaw) Ry(pitch) Rx(roll)."""
    about_z = quaternion_about((0.0, 0.0, 1.0), yaw_rad)
    about_y = quaternion_about((0.0, 1.0, 0.0), pitch_rad)
    about_x = quaternion_about((1.0, 0.0, 0.0), roll_rad)
    return quaternion_product(about_z, quaternion_product(about_y, about_x))


@kernel
def write_upright(q: Quaternion, out: FloatArray) -> None:
    """Write the one of the two quaternions of an orientation, q and -q, whose w is not below zero."""
    sense = math.copysign(1.0, q[0])
    for k in range(4):
        out[k] = sense * q[k]


@entry
def write_quaternions(angles: FloatArray, quaternions: FloatArray) -> None:
    """Write the quaternion (n, 4), w >= 0, of each row of yaw, pitch, roll (n, 3)."""
    for index in range(len(angles)):
        found = quaternion_from_euler_zyx(angles[index, 0], angles[index, 1], angles[index, 2])
        write_upright(found, quaternions[index])


@kernel
def euler_zyx_from_quaternion(q: Quaternion) -> Vector:
    """Return (yaw, pitch, roll) in radians; pitch within +-pi/2. At the pole, where yaw and roll merge, roll is 0.

    The pitch comes from atan2 of both its sine and cosine: asin alone loses half of the digits near the pole.
    """
    m = matrix_from_quaternion(q)
    cos_pitch = math.sqrt(m[0][0] * m[0][0] + m[1][0] * m[1][0])
    pitch = math.atan2(-m[2][0], cos_pitch)
    if cos_pitch < 1e-12:
        return (math.atan2(-m[0][1], m[1][1]), pitch, 0.0)
    return (math.atan2(m[1][0], m[0][0]), pitch, math.atan2(m[2][1], m[2][2]))


@entry
def write_euler_zyx(quaternions: FloatArray, angles: FloatArray) -> None:
    """Write yaw, pitch, roll (n, 3) of each row of quaternions (n, 4)."""
    for index in range(len(quaternions)):
        q = quaternions[index]
        found = euler_zyx_from_quaternion((q[0], q[1], q[2], q[3]))
        for k in range(3):
            angles[index, k] = found[k]


@kernel
def moved_pose(
    position: Vector, quaternion: Quaternion, along: Vector, through: Vector, distance_m: float, angle_rad: float
) -> tuple[Vector, Quaternion]:
    """Move a pose by ``distance_m`` along and ``angle_rad`` about the line through ``through`` with unit vector
    ``along``.

    Equation (1.2) of docs/theory.
    """
    if angle_rad == 0.0:
        return plus(position, scaled(along, distance_m)), quaternion
    turn = quaternion_about(along, angle_rad)
    turned = plus(through, rotated(turn, minus(position, through)))
    return plus(turned, scaled(along, distance_m)), quaternion_product(turn, quaternion)
