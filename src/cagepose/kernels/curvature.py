"""How the balance changes with the pose: the Hessian of the potential on the curved constraints, equation (5.9).

    S = D^-1/2 (Hess V - sum lambda_i Hess g_i + sum phi_i . Hess u_i) D^-1/2

V is the potential of the dead loads, g_i the gap of a sliding contact (a plane of the object over a point of the
world), u_i the way of the object's material at a sticking one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact_set import ContactSet
from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.metric import DeadLoads, Frame, load_arm
from cagepose.kernels.pose import Quaternion
from cagepose.kernels.vector import Vector, cross, dot, plus, row, scaled


@kernel
def add_arm_curvature(force: Vector, arm: Vector, sign: float, frame: Frame, out: FloatArray) -> None:
    """Add sign (sym(force arm') - (force . arm) 1) to the turning block: the second order of a turned arm."""
    together = dot(force, arm)
    for j in range(3):
        for k in range(3):
            value = 0.5 * (
                dot(force, frame.axes[j]) * dot(arm, frame.axes[k])
                + dot(force, frame.axes[k]) * dot(arm, frame.axes[j])
            )
            if j == k:
                value -= together
            out[3 + j, 3 + k] += sign * value / (frame.radii[j] * frame.radii[k])


@kernel
def write_curvature(
    contacts: ContactSet,
    is_sticking: NDArray[np.bool_],
    loads: DeadLoads,
    phase: int,
    quaternion: Quaternion,
    frame: Frame,
    out: FloatArray,
) -> None:
    """Write S, (6, 6), for the forces in ``contacts``; ``is_sticking`` (n_contacts,) says where one sticks."""
    for j in range(6):
        for k in range(6):
            out[j, k] = 0.0
    for which in range(2):
        arm = load_arm(loads, phase, which, quaternion)
        add_arm_curvature(row(loads.forces_world[phase], which), arm, -1.0, frame, out)
    for i in range(contacts.used[0]):
        if contacts.forces[i, 0] <= 0.0:
            continue
        normal, arm = row(contacts.normals, i), row(contacts.arms, i)
        if is_sticking[i]:
            force = (0.0, 0.0, 0.0)
            for j in range(3):
                direction = (contacts.columns[i, j, 0], contacts.columns[i, j, 1], contacts.columns[i, j, 2])
                force = plus(force, scaled(direction, contacts.forces[i, j]))
            add_arm_curvature(force, arm, 1.0, frame, out)
            continue
        carried = contacts.forces[i, 0]
        add_arm_curvature(scaled(normal, carried), arm, -1.0, frame, out)
        for j in range(3):
            across = cross(normal, frame.axes[j])
            for k in range(3):
                value = -carried * across[k] / frame.radii[j]
                out[k, 3 + j] += value
                out[3 + j, k] += value
