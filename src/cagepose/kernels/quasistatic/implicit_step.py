"""Steps near a balance: the linearly implicit form of the path, equation (5.10).

    (rho 1 + S) delta = b - forces,    rho = 1 / (longest explicit step)

Far from a balance rho is large and delta follows the motion from rest; near a stable one rho falls with the speed and
delta becomes Newton's step, so that the path ends in the balance to rounding instead of zigzagging towards it. Where
S is not convex, what it has below zero is left out: the step leads down along it as an explicit one does. It may be
large across the motion, as of a rim that hardly tips and could roll aside.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.dense import (
    add_across,
    cholesky,
    confine,
    frobenius_norm,
    remove_span,
    solve_lower,
    solve_upper,
)
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, PassiveSet, append_column, clear, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb import coulomb_motion_along
from cagepose.kernels.contact.equilibrium import AT_REST, MOVES, equilibrium_with_faces
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.contact.onset import motion_with_faces
from cagepose.kernels.contact.sharing import SharingWorkspace
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel

LEVEL = 1e-9
"""Fraction of the step. A circle stays flat if no point of it goes farther out or in by more: what its points go by
less is rounding."""
LEAST_RHO = 1e-9
"""In curvatures: freedoms without curvature (a block that slides on a plane) keep the matrix regular by this."""


class ImplicitStepWorkspace:
    """Workspace for one step; a record.

    Attributes
    ----------
    sharing
        See there.
    curvature
        S, and then what `keep_along_faces` makes of it.
    circulation
        The part of the load's stiffness that has no potential.
    held
        Basis of what the contacts that carry hold.
    factor, vectors
        Cholesky factor, lower, or eigenvalues and eigenvectors.
    b, delta
        Load and step in its coordinates, then the step.
    """

    sharing: SharingWorkspace
    curvature: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    circulation: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    held: PassiveSet
    factor: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    vectors: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    b: ScaledVector
    delta: ScaledVector


@kernel
def hold_carrying(contacts: ContactSet, locked: PassiveSet, dependent: float, work: ImplicitStepWorkspace) -> None:
    """Write the basis of what the contacts that carry hold (and, where they stick, along their faces), and of what
    those without play lock. What one holds but for a ``dependent`` part of its wrench, others hold.
    """
    clear(work.held, contacts.n_freedoms, 1.0)
    work.held.dependent = dependent
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        if state.forces[0] > 0.0:
            for which in range(3 if state.is_sticking else 1):
                append_column(work.held, contacts.rows[i].columns[which], which, 0.0)
    for place in range(locked.used):
        append_column(work.held, locked.basis[place], place, 0.0)


@kernel
def keep_along_faces(contacts: ContactSet, locked: PassiveSet, dependent: float, work: ImplicitStepWorkspace) -> float:
    """Replace what S has across the faces, see `hold_carrying`, by the greatest curvature along them.

    Nothing moves there, but it could make the matrix look as if it were not positive, or rounding of the forces as if
    it moved the object. Return the least rho that stands out from the rounding.
    """
    hold_carrying(contacts, locked, dependent, work)
    return keep_along_held(work)


@kernel
def keep_along_held(work: ImplicitStepWorkspace) -> float:
    """As `keep_along_faces`, for the basis that is there."""
    least_rho = LEAST_RHO * frobenius_norm(work.curvature, work.held.n_rows)
    add_across(work.curvature, work.held, confine(work.curvature, work.held))
    return least_rho


@kernel
def rho_against_circulation(work: ImplicitStepWorkspace) -> float:
    """Return the rho with which steps shrink fastest where the stiffness is S + A and S alone is in the matrix: |A|^2
    over the least curvature, as |rho y - A y| is to be far below |(rho + S) y| (5.30).
    """
    size, n = confine(work.circulation, work.held), work.held.n_rows
    write_matrix(work, 0.0)
    symmetric_eigen(work.factor, work.vectors, n)
    least = work.factor[0, 0]
    for k in range(1, n):
        least = min(least, work.factor[k, k])
    return size * max(1.0, size / least) if least > 0.0 else size


@kernel
def write_matrix(work: ImplicitStepWorkspace, rho: float) -> None:
    """Write rho 1 + S."""
    n = work.held.n_rows
    for j in range(n):
        for k in range(n):
            work.factor[j, k] = work.curvature[j, k]
        work.factor[j, j] += rho


@kernel
def write_convex_matrix(work: ImplicitStepWorkspace, rho: float) -> None:
    """Write rho 1 + S, but for what S has below zero: a step down from where it is unstable is an explicit one."""
    write_matrix(work, 0.0)
    n = work.held.n_rows
    symmetric_eigen(work.factor, work.vectors, n)
    curvatures = work.b
    for e in range(n):
        curvatures[e] = rho + max(work.factor[e, e], 0.0)
    for j in range(n):
        for k in range(n):
            work.factor[j, k] = 0.0
            for e in range(n):
                work.factor[j, k] += curvatures[e] * work.vectors[j, e] * work.vectors[k, e]


@kernel
def is_convex(rho: float, work: ImplicitStepWorkspace) -> bool:
    """Whether rho 1 + S is positive; it is factored then."""
    write_matrix(work, rho)
    return cholesky(work.factor, 1e-3 * rho, work.held.n_rows)


@kernel
def shared_step(contacts: ContactSet, rho: float, work: ImplicitStepWorkspace, solver: ContactWorkspace) -> bool:
    """Write the step into ``work.delta`` that keeps all contacts closed that carry, for shared forces: Newton's,
    where S is in ``work.curvature``. False: S is not convex. What is held is what those hold that carried before they
    shared: others hold nothing else, in whichever order they are asked.

    Where contacts share forces in many ways and their normals all but depend on each other, as of a cone that touches
    the edges of a square hole, the one that the onset takes may be unstable, and a balance between two is stable.
    """
    if not is_convex(rho, work):
        return False
    n = contacts.n_freedoms
    for k in range(n):
        work.delta[k] = solver.load[k]
        for i in range(contacts.used[0]):
            work.delta[k] += contacts.states[i].forces[0] * contacts.rows[i].columns[0, k]
    remove_span(work.delta, work.held)
    solve_lower(work.factor, work.delta, work.delta, n)
    solve_upper(work.factor, work.delta, n)
    return True


@kernel
def write_in_coordinates(work: ImplicitStepWorkspace, y: FloatArray, amount: float, out: FloatArray) -> None:
    """Write an amount of a motion in the step's coordinates, L^T y."""
    n = work.held.n_rows
    for j in range(n):
        out[j] = 0.0
        for k in range(j, n):
            out[j] += amount * work.factor[k, j] * y[k]


@kernel
def implicit_step(
    contacts: ContactSet,
    turned: ContactSet,
    friction: float,
    rho: float,
    could_stay: bool,
    rounding_m: float,
    work: ImplicitStepWorkspace,
    solver: ContactWorkspace,
) -> bool:
    """Write the step into ``work.delta``, and what the contacts carry on it; False: take the explicit step. Where the
    object ``could_stay`` it is the step along which the motion goes on.

    Given are the explicit motion ``solver.y``, ``work.curvature`` along the faces, and which contacts stick; ``turned``
    is memory for the contacts in the step's coordinates.
    """
    n = contacts.n_freedoms
    if not is_convex(rho, work):
        write_convex_matrix(work, rho)
        if not cholesky(work.factor, 1e-3 * rho, n):
            return False
    turned.used[0] = contacts.used[0]
    for i in range(contacts.used[0]):
        turned.states[i].counts = contacts.states[i].counts
        for j in range(3):
            solve_lower(work.factor, contacts.rows[i].columns[j], turned.rows[i].columns[j], n)
            turned.rows[i].drift[j] = 0.0
    solve_lower(work.factor, solver.load, work.b, n)
    terms = solver.load_terms * length(work.b, n) / length(solver.load, n)
    if could_stay:
        write_in_coordinates(work, solver.y, 1.0 / rho, solver.trial)
        if not coulomb_motion_along(
            turned, friction, work.b, terms, solver.trial, solver.cone, work.delta, solver.newton
        ):
            return False
    else:
        if equilibrium_with_faces(turned, friction, AT_REST, work.b, terms, solver) != MOVES:
            return False
        if not motion_with_faces(turned, friction, work.b, work.delta, solver):
            return False
    solve_upper(work.factor, work.delta, n)
    if inner(work.delta, solver.y, n) <= 0.0:
        return False
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        if state.is_locked:
            continue
        for j in range(3):
            state.forces[j] = turned.states[i].forces[j]
        state.is_sticking = state.is_sticking and state.forces[0] > 0.0
    for i in range(contacts.used[0]):
        state, normal = contacts.states[i], contacts.rows[i].columns[0]
        least = max(LEVEL * length(normal, n) * length(work.delta, n), rounding_m)
        is_level = abs(inner(normal, work.delta, n)) <= least
        state.stays_flat = state.stays_flat and is_level
    return True
