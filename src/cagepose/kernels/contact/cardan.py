"""A moment that drives the angles of a Cardan joint (5.37): yaw about an axis of the world, roll about one of the
object, pitch about the line across both. What pushes these angles to their ends has a potential, as no dead moment has.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm, plus, scaled
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.tolerances import LEAST_COSINE_OF_PITCH
from cagepose.kernels.native.kernel import kernel


class Cardan(NamedTuple):
    """A joint at one pose: its yaw axis, the line about which pitch turns, that across both, and sine and cosine of the
    pitch.
    """

    yaw_axis: Vector
    pitch_axis: Vector
    ahead: Vector
    sine: float
    cosine: float


@kernel
def cardan_at(yaw_axis: Vector, roll_axis: Vector) -> Cardan:
    """Return the joint between two unit vectors of the world."""
    across = cross(yaw_axis, roll_axis)
    cosine = norm(across)
    if cosine < LEAST_COSINE_OF_PITCH:
        across = cross(yaw_axis, (1.0, 0.0, 0.0) if abs(yaw_axis[0]) < 0.5 else (0.0, 1.0, 0.0))
    pitch_axis = scaled(across, 1.0 / norm(across))
    return Cardan(
        yaw_axis,
        pitch_axis,
        cross(pitch_axis, yaw_axis),
        -dot(yaw_axis, roll_axis),
        max(cosine, LEAST_COSINE_OF_PITCH),
    )


@kernel
def cardan_moment(joint: Cardan, drives: Vector) -> Vector:
    """Return the moment whose power is that of drives of yaw, pitch and roll."""
    ahead = (drives[0] * joint.sine + drives[2]) / joint.cosine
    moment = plus(scaled(joint.yaw_axis, drives[0]), scaled(joint.pitch_axis, drives[1]))
    return plus(moment, scaled(joint.ahead, ahead))


@kernel
def cardan_turns(yaw_axis: Vector, roll_axis_object: Vector, before: Quaternion, after: Quaternion) -> Vector:
    """Return by how much yaw, pitch and roll have turned between two orientations, each by less than half a turn."""
    one = cardan_at(yaw_axis, rotated(before, roll_axis_object))
    other = cardan_at(yaw_axis, rotated(after, roll_axis_object))
    yaw = math.atan2(dot(yaw_axis, cross(one.pitch_axis, other.pitch_axis)), dot(one.pitch_axis, other.pitch_axis))
    line = rotated((before[0], -before[1], -before[2], -before[3]), one.pitch_axis)
    later = rotated((after[0], -after[1], -after[2], -after[3]), other.pitch_axis)
    roll = -math.atan2(dot(roll_axis_object, cross(line, later)), dot(line, later))
    pitch = math.atan2(
        other.sine * one.cosine - one.sine * other.cosine, one.cosine * other.cosine + one.sine * other.sine
    )
    return yaw, pitch, roll


@kernel
def add_cardan_curvature(joint: Cardan, drives: Vector, frame: Frame, out: FloatArray) -> None:
    """Add the Hessian of the potential, minus drives times angles: of each slope its derivative, symmetric.

    Under a turn the pitch axis turns back by the yaw's slope times ``ahead``, and that forward by the pitch axis.
    """
    tangent, square = joint.sine / joint.cosine, joint.cosine * joint.cosine
    yaw = cardan_moment(joint, (1.0, 0.0, 0.0))
    with_pitch = (drives[0] + drives[2] * joint.sine) / square
    with_yaw = drives[0] * tangent + drives[2] / joint.cosine
    for j in range(3):
        for k in range(3):
            value = 0.0
            for one, other in ((j, k), (k, j)):
                ahead = dot(joint.ahead, frame.axes[one])
                pitch, pitch_other = dot(joint.pitch_axis, frame.axes[one]), dot(joint.pitch_axis, frame.axes[other])
                turn = dot(yaw, frame.axes[other])
                value += with_pitch * ahead * pitch_other + with_yaw * pitch * turn - drives[1] * ahead * turn
            out[3 + j, 3 + k] -= 0.5 * value / (frame.radii[j] * frame.radii[k])
