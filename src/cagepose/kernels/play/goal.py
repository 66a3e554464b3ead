"""What play asks for, its slope and its curvature: an angle, or the displacement of points (7.4), (7.6)."""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.pose import euler_zyx_from_quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.second_order import add_coupling, add_turned_arm
from cagepose.kernels.algebra.vector import Vector, cross, row
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.play.polytope import Motion, PlayWorkspace

YAW, PITCH, ROLL, SHIFT = range(4)
"""What is asked for: an angle (in the order of `euler_zyx_from_quaternion`), or how far points go."""
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
RADII = (1.0, 1.0, 1.0)


class Goal:
    """What is to be as great as can be; a record.

    Attributes
    ----------
    kind, sign
        YAW, PITCH, ROLL or SHIFT; +1 or -1: its least value is asked for.
    starts, directions
        For SHIFT: two points of the object at the start, lengths of the scene, and vectors; the value is the sum of
        both displacements times their vectors. One point's displacement has a unit vector and a zero; the work of a
        load has the weight and the force.
    """

    kind: int
    sign: float
    starts: Annotated[FloatArray, 2, 3]
    directions: Annotated[FloatArray, 2, 3]


@kernel
def value_at(goal: Goal, motion: Motion) -> float:
    """Return the goal's value, its sign applied; radians or lengths of the scene."""
    position, quaternion = motion
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
def write_slope(goal: Goal, motion: Motion, objective: FloatArray) -> float:
    """Write the rate of the value with the twist (7.4), its largest coefficient 1; return the factor taken out."""
    for k in range(6):
        objective[k] = 0.0
    if goal.kind == SHIFT:
        for i in range(2):
            moment = cross(rotated(motion[1], row(goal.starts, i)), row(goal.directions, i))
            for k in range(3):
                objective[k] += goal.sign * goal.directions[i, k]
                objective[3 + k] += goal.sign * moment[k]
    else:
        yaw, pitch, _ = euler_zyx_from_quaternion(motion[1])
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
def write_curvature(goal: Goal, motion: Motion, factor: float, work: PlayWorkspace) -> None:
    """Write the second derivatives of the value, with the limiting gaps at their prices (7.6).

    ``factor`` was taken out of the value's slope, and is taken out of its curvature.
    """
    held, curvature = work.newton.held, work.newton.curvature
    for i in range(6):
        for k in range(6):
            curvature[i, k] = 0.0
    for i in range(held.used):
        pair, price = held.labels[i], held.target[i]
        normal, arm = row(work.rows, pair), row(work.arms, pair)
        add_turned_arm(normal, arm, price, AXES, RADII, curvature)
        add_coupling(normal, price, AXES, RADII, curvature)
    scale = goal.sign / factor
    if goal.kind == SHIFT:
        for i in range(2):
            arm = rotated(motion[1], row(goal.starts, i))
            add_turned_arm(row(goal.directions, i), arm, scale, AXES, RADII, curvature)
        return
    yaw, pitch, _ = euler_zyx_from_quaternion(motion[1])
    tangent, cosine = math.tan(pitch), math.cos(pitch)
    across, along = (-math.sin(yaw), math.cos(yaw), 0.0), (math.cos(yaw), math.sin(yaw), 0.0)
    yaw_rate = (along[0] * tangent, along[1] * tangent, 1.0)
    if goal.kind == YAW:
        add_product(across, along, scale / cosine**2, curvature)
        add_product(across, yaw_rate, scale * tangent, curvature)
    elif goal.kind == PITCH:
        add_product(along, yaw_rate, -scale, curvature)
    else:
        add_product(across, yaw_rate, scale / cosine, curvature)
        add_product(along, across, scale * tangent / cosine, curvature)


@kernel
def add_product(a: Vector, b: Vector, factor: float, curvature: FloatArray) -> None:
    """Add the second derivatives of factor * (w . a)(w . b) / 2."""
    for i in range(3):
        for k in range(3):
            curvature[3 + i, 3 + k] += 0.5 * factor * (a[i] * b[k] + b[i] * a[k])
