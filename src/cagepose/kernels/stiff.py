"""Steps near a balance: the linearly implicit form of the path, equation (5.10).

    (rho 1 + S) delta = b - forces,    rho = 1 / (longest explicit step)

Far from a balance rho is large and delta follows the motion from rest; near a stable one rho falls with the speed and
delta becomes Newton's step, so that the path ends in the balance to rounding instead of zigzagging towards it. Where
the balance is unstable, rho is raised until the matrix is positive, and delta leads away from it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact_set import ContactSet
from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.least_squares import inner
from cagepose.kernels.onset import MOVES, OnsetRoom, onset_with_faces

RAISES = 12
"""How often rho is raised, four times each, before the explicit step is taken after all."""
LEAST_RHO = 1e-9
"""In curvatures: freedoms without curvature (a block that slides on a plane) keep the matrix regular by this."""
HOLD = 10.0
"""In curvatures: stiffness given to the contacts that carry. They do not move along their normals, so it changes
nothing but that the matrix need be positive only along the faces."""


class StiffRoom(NamedTuple):
    """Room for one step.

    Attributes
    ----------
    curvature
        S, (6, 6).
    factor
        Cholesky factor, lower, (6, 6).
    columns
        Wrenches of the contacts in its coordinates, (n_contacts, 3, 6).
    b, delta
        Load and step in its coordinates, then the step, (6,).
    forces
        What the contacts carry during the step, (n_contacts, 3).
    is_sticking
        Which contacts stick, (n_contacts,).
    """

    curvature: FloatArray
    factor: FloatArray
    columns: FloatArray
    b: FloatArray
    delta: FloatArray
    forces: FloatArray
    is_sticking: NDArray[np.bool_]


def empty_stiff_room(n_contacts: int) -> StiffRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return StiffRoom(
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        np.zeros((n_contacts, 3, 6)),
        np.zeros(6),
        np.zeros(6),
        np.zeros((n_contacts, 3)),
        np.zeros(n_contacts, np.bool_),
    )


@kernel
def curvature_along(curvature: FloatArray, y: FloatArray) -> float:
    """Return y' S y / y' y."""
    total = 0.0
    for j in range(6):
        total += y[j] * inner(curvature[j], y, 6)
    return total / inner(y, y, 6)


@kernel
def greatest_curvature(curvature: FloatArray) -> float:
    """Return the Frobenius norm of S, a bound on all its curvatures."""
    total = 0.0
    for j in range(6):
        total += inner(curvature[j], curvature[j], 6)
    return math.sqrt(total)


@kernel
def cholesky(matrix: FloatArray, least_pivot: float) -> bool:
    """Factor a symmetric (6, 6) matrix in place (lower half); False: a pivot is not above ``least_pivot``."""
    for j in range(6):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > least_pivot:
            return False
        matrix[j, j] = math.sqrt(pivot)
        for i in range(j + 1, 6):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    return True


@kernel
def solve_lower(factor: FloatArray, vector: FloatArray, out: FloatArray) -> None:
    """Write L^-1 vector."""
    for j in range(6):
        out[j] = vector[j]
        for k in range(j):
            out[j] -= factor[j, k] * out[k]
        out[j] /= factor[j, j]


@kernel
def solve_upper(factor: FloatArray, vector: FloatArray) -> None:
    """Replace a vector by L^-T vector."""
    for j in range(5, -1, -1):
        for k in range(j + 1, 6):
            vector[j] -= factor[k, j] * vector[k]
        vector[j] /= factor[j, j]


@kernel
def write_matrix(contacts: ContactSet, room: StiffRoom, rho: float, hold: float) -> None:
    """Write rho 1 + S + hold sum a a' over the contacts that carry (normals, and tangents where they stick)."""
    for j in range(6):
        for k in range(6):
            room.factor[j, k] = room.curvature[j, k]
        room.factor[j, j] += rho
    for i in range(contacts.used[0]):
        if contacts.forces[i, 0] <= 0.0:
            continue
        for which in range(3 if room.is_sticking[i] else 1):
            a = contacts.columns[i, which]
            weight = hold / inner(a, a, 6)
            for j in range(6):
                for k in range(6):
                    room.factor[j, k] += weight * a[j] * a[k]


@kernel
def stiff_step(
    contacts: ContactSet, friction: float, b: FloatArray, y: FloatArray, rho: float, room: StiffRoom, solver: OnsetRoom
) -> bool:
    """Write the step into ``room.delta`` and its forces into ``room.forces``; False: take the explicit step.

    ``room.curvature`` and ``room.is_sticking`` are given; y is the explicit motion.
    """
    n_contacts = contacts.used[0]
    size = greatest_curvature(room.curvature)
    rho = max(rho, LEAST_RHO * size)
    for _ in range(RAISES):
        write_matrix(contacts, room, rho, HOLD * (size + rho))
        if cholesky(room.factor, 1e-3 * rho):
            break
        rho = max(4.0 * rho, 1e-3 * size)
    else:
        return False
    for i in range(n_contacts):
        for j in range(3):
            solve_lower(room.factor, contacts.columns[i, j], room.columns[i, j])
            room.forces[i, j] = 0.0
    solve_lower(room.factor, b, room.b)
    code = onset_with_faces(
        room.columns, contacts.chosen, n_contacts, friction, room.b, room.forces, room.delta, solver
    )
    solve_upper(room.factor, room.delta)
    return code == MOVES and inner(room.delta, y, 6) > 0.0
