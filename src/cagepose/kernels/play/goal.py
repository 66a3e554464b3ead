"""What play asks for, its slope and its curvature: an angle, or the displacement of points (7.4), (7.6)."""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.pose import Quaternion, euler_zyx_from_quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, row, scaled
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.play.newton import add_gap, add_product, add_turning
from cagepose.kernels.play.rows import PlayRoom

YAW, PITCH, ROLL, SHIFT = range(4)
"""What is asked for: an angle (in the order of `euler_zyx_from_quaternion`), or how far points go."""


class Goal:
    """What is to be as great as can be; a record.

    Attributes
    ----------
    kind, sign
        YAW, PITCH, ROLL or SHIFT; +1 or -1: its least value is asked for.
    starts, directions
        For SHIFT: two points of the object at the start, in the frame of the motion, and vectors; the value is the sum
        of both displacements times their vectors. One point's displacement has a unit vector and a zero; the work of a
        load has the weight and the force.
    """

    kind: int
    sign: float
    starts: Annotated[FloatArray, 2, 3]
    directions: Annotated[FloatArray, 2, 3]


@kernel
def value_at(goal: Goal, position: Vector, quaternion: Quaternion) -> float:
    """Return the goal's value, its sign applied; radians or metres."""
    if goal.kind == SHIFT:
        shift = 0.0
        for i in range(2):
            turned = rotated(quaternion, row(goal.starts, i))
            for k in range(3):
                shift += goal.directions[i, k] * (turned[k] - goal.starts[i, k] + position[k])
        return goal.sign * shift
    angle: float = goal.sign * euler_zyx_from_quaternion(quaternion)[goal.kind]
    return angle


@kernel
def write_slope(goal: Goal, quaternion: Quaternion, length_m: float, room: PlayRoom) -> float:
    """Write the objective: the rate of the value (in radians or lengths of the scene) with the twist (7.4), its largest
    coefficient 1; return the factor taken out.
    """
    objective = room.program.objective
    for k in range(6):
        objective[k] = 0.0
    if goal.kind == SHIFT:
        for i in range(2):
            moment = cross(rotated(quaternion, row(goal.starts, i)), row(goal.directions, i))
            for k in range(3):
                objective[k] += goal.sign * goal.directions[i, k]
                objective[3 + k] += goal.sign * moment[k] / length_m
    else:
        yaw, pitch, _ = euler_zyx_from_quaternion(quaternion)
        cos_yaw, sin_yaw = math.cos(yaw), math.sin(yaw)
        slope = (cos_yaw * math.tan(pitch), sin_yaw * math.tan(pitch), 1.0)
        if goal.kind == PITCH:
            slope = (-sin_yaw, cos_yaw, 0.0)
        elif goal.kind == ROLL:
            slope = (cos_yaw / math.cos(pitch), sin_yaw / math.cos(pitch), 0.0)
        for k in range(3):
            objective[3 + k] = goal.sign * slope[k]
    largest = 0.0
    for k in range(6):
        largest = max(largest, abs(objective[k]))
    for k in range(6):
        objective[k] /= largest
    return largest


@kernel
def write_curvature(goal: Goal, quaternion: Quaternion, length_m: float, factor: float, room: PlayRoom) -> None:
    """Write the second derivatives of the value, with the limiting gaps at their prices (7.6)."""
    newton = room.newton
    for i in range(6):
        for k in range(6):
            newton.curvature[i, k] = 0.0
    for i in range(newton.n_rows):
        pair = newton.pairs[i]
        add_gap(newton.curvature, row(room.rows, pair), row(room.arms, pair), newton.prices[i])
    scale = goal.sign / factor
    if goal.kind == SHIFT:
        for i in range(2):
            arm = scaled(rotated(quaternion, row(goal.starts, i)), 1.0 / length_m)
            add_turning(newton.curvature, row(goal.directions, i), arm, scale)
        return
    yaw, pitch, _ = euler_zyx_from_quaternion(quaternion)
    tangent, cosine = math.tan(pitch), math.cos(pitch)
    across, along = (-math.sin(yaw), math.cos(yaw), 0.0), (math.cos(yaw), math.sin(yaw), 0.0)
    yaw_rate = (along[0] * tangent, along[1] * tangent, 1.0)
    if goal.kind == YAW:
        add_product(newton.curvature, across, along, scale / cosine**2)
        add_product(newton.curvature, across, yaw_rate, scale * tangent)
    elif goal.kind == PITCH:
        add_product(newton.curvature, along, yaw_rate, -scale)
    else:
        add_product(newton.curvature, across, yaw_rate, scale / cosine)
        add_product(newton.curvature, along, across, scale * tangent / cosine)
