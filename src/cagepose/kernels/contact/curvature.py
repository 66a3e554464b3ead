"""How the balance changes with the pose: the Hessian of the potential on the curved constraints, equation (5.9).

    S = D^-1/2 (Hess V - sum lambda_i Hess g_i + sum phi_i . Hess u_i) D^-1/2

V is the potential of the dead loads, g_i the gap of a sliding contact (a plane of the object over a point of the
world), u_i the way of the object's material at a sticking one.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, plus, row, scaled, vector_from
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import Frame, PhaseLoad, load_arm
from cagepose.kernels.native.kernel import kernel


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
    contacts: ContactSet, load: PhaseLoad, quaternion: Quaternion, frame: Frame, out: FloatArray
) -> None:
    """Write S, (6, 6), for the forces of the contacts, and which of them stick."""
    for j in range(6):
        for k in range(6):
            out[j, k] = 0.0
    for which in range(2):
        arm = load_arm(load, which, quaternion)
        add_arm_curvature(row(load.forces_world, which), arm, -1.0, frame, out)
    for i in range(contacts.used[0]):
        contact, forces = contacts.rows[i], contacts.states[i].forces
        if forces[0] <= 0.0:
            continue
        normal, arm = vector_from(contact.normal), vector_from(contact.arm)
        if contacts.states[i].is_sticking:
            force = (0.0, 0.0, 0.0)
            for j in range(3):
                force = plus(force, scaled(vector_from(contact.columns[j]), forces[j]))
            add_arm_curvature(force, arm, 1.0, frame, out)
            continue
        carried = forces[0]
        add_arm_curvature(scaled(normal, carried), arm, -1.0, frame, out)
        for j in range(3):
            across = cross(normal, frame.axes[j])
            for k in range(3):
                value = -carried * across[k] / frame.radii[j]
                out[k, 3 + j] += value
                out[3 + j, k] += value


@kernel
def greatest_curvature(curvature: FloatArray) -> float:
    """Return the Frobenius norm of S, a bound on all its curvatures."""
    total = 0.0
    for j in range(6):
        total += inner(curvature[j], curvature[j], 6)
    return math.sqrt(total)
