"""How the balance changes with the pose: the Hessian of the potential on the curved constraints, equation (5.9).

    S = D^-1/2 (Hess V - sum lambda_i Hess g_i + sum phi_i . Hess u_i) D^-1/2

V is the potential of the load, g_i the gap of a sliding contact, u_i the way of the object's material at a sticking
one: along the normal with what rolling adds, which moves the place of contact on both bodies.
"""

from __future__ import annotations

from cagepose.kernels.algebra.dense import frobenius_norm
from cagepose.kernels.algebra.least_squares import WRENCH, inner
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.second_order import add_coupling, add_turned_arm
from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, matrix_from, plus, scaled, times, vector_from
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.load_curvature import add_circulation, add_load_curvature
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Frame, is_held
from cagepose.kernels.contact.pressing import add_pressed_curvature, add_pressing_stiffness
from cagepose.kernels.native.kernel import kernel


@kernel
def clear_matrix(out: FloatArray, n: int) -> None:
    for j in range(n):
        for k in range(n):
            out[j, k] = 0.0


@kernel
def add_face_curvature(
    contacts: ContactSet, i: int, carried: float, frame: Frame, curved: bool, out: FloatArray
) -> None:
    """Add what a contact that slides, and carries so much, adds to S: -carried Hess g."""
    contact = contacts.rows[i]
    normal, arm = vector_from(contact.directions[0]), vector_from(contact.arm)
    add_turned_arm(normal, arm, -carried, frame.axes, frame.radii, out)
    add_coupling(normal, -carried, frame.axes, frame.radii, out)
    bend = contacts.bends[i]
    sliding = bend.twin_sliding if curved and bend.has_twin else bend.sliding
    add_matrix(sliding, -carried, out)
    if contacts.n_freedoms > WRENCH:
        add_pressed_curvature(contacts.pressing, contact.cage_body, sliding, -carried, out)


@kernel
def add_rolling(force: Vector, normal: Vector, parallel: Matrix, frame: Frame, out: FloatArray) -> None:
    """Add what rolling adds to a contact that sticks, the symmetric part of force . (w x P m), equation (5.35): the
    place where it touches moves by P m, m = n x w.
    """
    for j in range(3):
        one = scaled(frame.axes[j], 1.0 / frame.radii[j])
        for k in range(3):
            other = scaled(frame.axes[k], 1.0 / frame.radii[k])
            value = dot(force, cross(one, times(parallel, cross(normal, other))))
            out[3 + j, 3 + k] += 0.5 * value
            out[3 + k, 3 + j] += 0.5 * value


@kernel
def add_sticking_curvature(
    contacts: ContactSet, i: int, force: Vector, frame: Frame, curved: bool, out: FloatArray
) -> None:
    """Add what a contact that sticks adds to S with a force: force . Hess u."""
    contact = contacts.rows[i]
    add_turned_arm(force, vector_from(contact.arm), 1.0, frame.axes, frame.radii, out)
    bend = contacts.bends[i]
    parallel = matrix_from(bend.twin_parallel if curved and bend.has_twin else bend.parallel)
    add_rolling(force, vector_from(contact.directions[0]), parallel, frame, out)


@kernel
def curvature_along(curvature: FloatArray, y: FloatArray, n: int) -> float:
    """Return y' S y / y' y, of the first n numbers."""
    total = 0.0
    for j in range(n):
        total += y[j] * inner(curvature[j], y, n)
    return total / inner(y, y, n)


@kernel
def add_matrix(matrix: FloatArray, factor: float, out: FloatArray) -> None:
    for j in range(WRENCH):
        for k in range(WRENCH):
            out[j, k] += factor * matrix[j, k]


@kernel
def clear_held(frame: Frame, out: FloatArray) -> None:
    """Take what is held out of a matrix, as no motion has a part there."""
    for j in range(WRENCH):
        for k in range(WRENCH):
            if is_held(frame, j) or is_held(frame, k):
                out[j, k] = 0.0


@kernel
def stiffen_held(frame: Frame, n: int, out: FloatArray) -> None:
    """Give what is held the greatest curvature of S, as `clear_held`, but that S stays positive where it is one."""
    clear_held(frame, out)
    greatest = frobenius_norm(out, n)
    for k in range(WRENCH):
        if is_held(frame, k):
            out[k, k] = greatest


@kernel
def write_curvature(
    contacts: ContactSet,
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    curved: bool,
    out: FloatArray,
) -> None:
    """Write S, (n, n), for the forces of the contacts, and which of them stick; where features meet that bend by
    different amounts, with those that bend least, or, ``curved``, most.
    """
    clear_matrix(out, contacts.n_freedoms)
    add_load_curvature(load, position, quaternion, frame, out)
    if contacts.n_freedoms > WRENCH:
        add_pressing_stiffness(contacts.pressing, out)
    for i in range(contacts.used[0]):
        contact, state = contacts.rows[i], contacts.states[i]
        if state.forces[0] > 0.0 and not state.is_sticking:
            add_face_curvature(contacts, i, state.forces[0], frame, curved, out)
        elif state.forces[0] > 0.0:
            force = (0.0, 0.0, 0.0)
            for j in range(3):
                force = plus(force, scaled(vector_from(contact.directions[j]), state.forces[j]))
            add_sticking_curvature(contacts, i, force, frame, curved, out)
    stiffen_held(frame, contacts.n_freedoms, out)


@kernel
def write_circulation(
    contacts: ContactSet, load: PhaseLoad, position: Vector, quaternion: Quaternion, frame: Frame, out: FloatArray
) -> None:
    """Write the antisymmetric part of the load's stiffness, (n, n): what no potential has."""
    clear_matrix(out, contacts.n_freedoms)
    add_circulation(load, position, quaternion, frame, out)
    clear_held(frame, out)
