"""How equally stiff contacts share a load: the least squares of forces in round cones that balance it (5.25)."""

from __future__ import annotations

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.studies.contact_cones import ContactCones
from cagepose.studies.tolerances import LEAST_DAMPING, RESIDUAL_SOLVED, SHORTEST_PART

MOST_STEPS = 200
"""Newton's method takes so many steps at most. It needs more the nearer the load lies to what the contacts cannot
balance."""
FIRST_DAMPING = 0.1
"""Stiffness in all directions, in parts of the residual of the load. It keeps a step short in which a contact comes to
carry or stops to, and fades away as fast as the residual does."""
DAMPING_FACTOR = 0.25
"""Factor of the damping after a step that is taken whole. After another step it is one over this."""
SHARE_OF_SLOPE = 0.1
"""A step may pass the best place along it by so much of the slope at its start: slopes keep digits that values lose."""


def equally_stiff_forces(cones: ContactCones, load: FloatArray) -> FloatArray:
    """Return the forces, normal and two tangents, (n, 3), whose wrench is ``load``, (6,), with the least squares.

    They are unique. By duality they are the projections onto the cones of A_i^T y, with the motion y at which
    load . y - 1/2 sum |f_i|^2 is greatest: contacts that push back in proportion to it. This is found by Newton's
    method. Where no forces balance the load, those returned do not: ask `ContactCones.wrench`.
    """
    motion, columns = np.zeros(6), cones.columns
    size, damping = float(np.linalg.norm(load)), FIRST_DAMPING
    for _ in range(MOST_STEPS):
        forces, stiffness = _projected(columns @ motion, cones.friction)
        left = load - cones.wrench(forces)
        missing = float(np.linalg.norm(left)) / size
        if missing <= RESIDUAL_SOLVED:
            break
        hessian = np.einsum("iak,iab,ibl->kl", columns, stiffness, columns)
        hessian[np.diag_indices(6)] += max(damping * missing, LEAST_DAMPING)
        step = np.linalg.solve(hessian, left)
        slope, length = float(left @ step), 1.0
        while length > SHORTEST_PART:
            ahead = _projected(columns @ (motion + length * step), cones.friction)[0]
            if (load - cones.wrench(ahead)) @ step >= -SHARE_OF_SLOPE * slope:
                break
            length *= 0.5
        motion = motion + length * step
        damping *= DAMPING_FACTOR if length == 1.0 else 1.0 / DAMPING_FACTOR
    return forces


def _projected(forces: FloatArray, friction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the projection of forces (n, 3) onto their cones, and its derivative (n, 3, 3)."""
    normal, tangential = forces[:, 0], forces[:, 1:]
    size = np.linalg.norm(tangential, axis=1)
    is_inside = size <= friction * normal
    is_off = ~is_inside & (friction * size <= -normal)
    directions = np.divide(tangential, size[:, None], out=np.zeros_like(tangential), where=size[:, None] > 0.0)
    rays = np.concatenate([np.ones((len(forces), 1)), friction[:, None] * directions], axis=1)
    along = (normal + friction * size) / (1.0 + friction**2)
    derivative = rays[:, :, None] * rays[:, None, :] / (1.0 + friction**2)[:, None, None]
    turning = np.divide(friction * along, size, out=np.zeros_like(size), where=size > 0.0)
    derivative[:, 1:, 1:] += turning[:, None, None] * (np.eye(2) - directions[:, :, None] * directions[:, None, :])
    derivative[is_inside] = np.eye(3)
    derivative[is_off] = 0.0
    projected = along[:, None] * rays
    projected[is_inside] = forces[is_inside]
    projected[is_off] = 0.0
    return projected, derivative
