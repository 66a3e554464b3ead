"""Contacts without play: motions that they allow to first order and stop to second, equations (5.21) and (5.22).

A plate between two opposite points that are as far apart as it is thick can tip, as far as velocities go: but it would
have to be thinner. Contacts that can press against each other without a load (a self-stress sigma, sum sigma_i a_i = 0)
keep their gaps at zero: they are locked. Of the motions that do so, those with sum sigma_i (second derivative of gap i)
< 0 go in. What is locked can push and pull alike, as more of the self-stress adds to all of its forces, so the object
does not begin to move along its normals, and the others only have to do with what is free beside that. They may be
opposite there, too, and so on.
"""

from __future__ import annotations

from cagepose.kernels.algebra.dense import frobenius_norm, remove_span
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import clear, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.span import extend, write_complement, write_outside, write_reduced
from cagepose.kernels.contact.cone import ConeWorkspace, clear_cone, cone_residual
from cagepose.kernels.contact.contact_set import ContactSet, count_chosen
from cagepose.kernels.contact.curvature import add_face_curvature, clear_held, clear_matrix
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.tolerances import (
    CARRIED_ALONG_LOCKED,
    LEAST_CURVATURE,
    LEAST_PLAY,
    RESIDUAL_OF_SELF_STRESS,
    SHARE_IN_SELF_STRESS,
)
from cagepose.kernels.contact.workspace import STRESS_LIMIT, ContactWorkspace, SelfStressWorkspace
from cagepose.kernels.native.kernel import kernel

WEIGHT_OF_MOMENTS = 1e-3
"""A moment counts for so much beside a force where locked contacts cannot balance both. Forces without bound, on levers
of no length, carry the moment that is left."""


@kernel
def self_stress(contacts: ContactSet, friction: float, stress: SelfStressWorkspace) -> float:
    """Return what is left of the least imbalance of forces whose normal parts add up to 1, at the contacts that count;
    they are in ``stress.cone``.
    """
    n = contacts.n_freedoms
    for k in range(n):
        stress.twist[k] = 0.0
    stress.twist[n] = 1.0
    clear_cone(stress.cone, stress.twist, n + 1, 1.0)
    return cone_residual(contacts, friction, stress.cone)


@kernel
def clear_self_stress(contacts: ContactSet, stress: SelfStressWorkspace) -> bool:
    """Find a self-stress of contacts that count to which all of them belong; False: there is none.

    A contact may carry so little that it only makes up for the residual of the others, within RESIDUAL_OF_SELF_STRESS.
    It does not belong to the self-stress, since its second derivative would count for what no force of it means.
    """
    left = self_stress(contacts, 0.0, stress)
    for _ in range(contacts.n_freedoms + 1):
        if left > RESIDUAL_OF_SELF_STRESS:
            return False
        passive, belongs_all = stress.cone.passive, True
        for i in range(contacts.used[0]):
            contacts.states[i].counts = False
        for k in range(passive.used):
            i = stress.cone.contacts[passive.labels[k]]
            size = length(contacts.rows[i].columns[0], contacts.n_freedoms)
            contacts.states[i].counts = size == 0.0 or passive.x[k] * size > SHARE_IN_SELF_STRESS
            belongs_all = belongs_all and contacts.states[i].counts
        if belongs_all:
            return True
        left = self_stress(contacts, 0.0, stress)
    return False


@kernel
def weight_of_freedom(k: int) -> float:
    """Return how much one of the numbers of a wrench counts where locked contacts cannot balance all of them."""
    return WEIGHT_OF_MOMENTS if k >= 3 else 1.0


@kernel
def balance_by_locked(contacts: ContactSet, load: FloatArray, work: ContactWorkspace) -> None:
    """Balance, with the locked contacts, what a load does along what is locked, forces before moments: their forces
    are in ``work.stress.reaction``. The locked contacts count afterwards.

    Only the parts of their wrenches count that made them locked: a tilt of 1e-6 between opposite faces carries nothing.
    """
    stress, n = work.stress, contacts.n_freedoms
    for k in range(n):
        stress.twist[k] = 0.0
        for place in range(work.locked.used):
            stress.twist[k] += inner(work.locked.basis[place], load, n) * work.locked.basis[place, k]
        stress.twist[k] *= weight_of_freedom(k)
    for i in range(contacts.used[0]):
        state, column = contacts.states[i], contacts.rows[i].columns[0]
        state.counts = state.is_locked
        if state.is_locked:
            wrench = contacts.rows[i].wrenches[0]
            write_outside(stress.pressed, wrench, 0.0, column)
            for k in range(n):
                column[k] = weight_of_freedom(k) * (wrench[k] - column[k])
    clear_cone(stress.reaction, stress.twist, n, length(stress.twist, n))
    cone_residual(contacts, 0.0, stress.reaction)
    for i in range(contacts.used[0]):
        if contacts.states[i].is_locked:
            for k in range(contacts.n_freedoms):
                contacts.rows[i].columns[0, k] = 0.0


@kernel
def add_second_order(contacts: ContactSet, cone: ConeWorkspace, frame: Frame, out: FloatArray) -> None:
    """Add -sum sigma_i Hess g_i of the forces in ``cone``."""
    for k in range(cone.passive.used):
        add_face_curvature(contacts, cone.contacts[cone.passive.labels[k]], cone.passive.x[k], frame, False, out)


@kernel
def stop(curvature: FloatArray, work: ContactWorkspace) -> None:
    """Add what a self-stress with this second order stops, of the motions that are still free. Where it opens a gap for
    others of them, it stops none: a little of one pays for some of another.
    """
    stress = work.stress
    n_free = write_complement(work.locked, stress.free)
    write_reduced(curvature, stress.free, n_free, work.locked.n_rows, stress.reduced)
    symmetric_eigen(stress.reduced, stress.vectors, n_free)
    least = LEAST_CURVATURE * frobenius_norm(curvature, work.locked.n_rows)
    for e in range(n_free):
        if stress.reduced[e, e] < -least:
            return
    for e in range(n_free):
        if stress.reduced[e, e] > least:
            for k in range(work.locked.n_rows):
                stress.twist[k] = 0.0
                for i in range(n_free):
                    stress.twist[k] += stress.vectors[i, e] * stress.free[i, k]
            extend(work.stopped, stress.twist, RESIDUAL_OF_SELF_STRESS)
            extend(work.locked, stress.twist, RESIDUAL_OF_SELF_STRESS)


@kernel
def lock(contacts: ContactSet, frame: Frame, n_stresses: int, work: ContactWorkspace) -> None:
    """Lock the contacts of the self-stress in ``stress.cone``, number ``n_stresses``, and write its second order.

    It balances outside of what is locked already: there, locked contacts make up for the rest.
    """
    stress = work.stress
    passive, curvature = stress.cone.passive, stress.curvatures[n_stresses]
    clear_matrix(curvature, contacts.n_freedoms)
    add_second_order(contacts, stress.cone, frame, curvature)
    for k in range(contacts.n_freedoms):
        stress.imbalance[k] = 0.0
    for j in range(passive.used):
        wrench = contacts.rows[stress.cone.contacts[passive.labels[j]]].wrenches[0]
        for k in range(contacts.n_freedoms):
            stress.imbalance[k] -= passive.x[j] * wrench[k]
    balance_by_locked(contacts, stress.imbalance, work)
    add_second_order(contacts, stress.reaction, frame, curvature)
    clear_held(frame, curvature)
    for k in range(passive.used):
        i = stress.cone.contacts[passive.labels[k]]
        contacts.states[i].is_locked = True
        extend(stress.pressed, contacts.rows[i].columns[0], RESIDUAL_OF_SELF_STRESS)
        extend(work.locked, contacts.rows[i].columns[0], RESIDUAL_OF_SELF_STRESS)


@kernel
def stop_all(n_stresses: int, work: ContactWorkspace) -> bool:
    """Add what the self-stresses stop; return whether that is any more. What one of them stops may leave another with
    nothing that it opens.
    """
    n_before, n_last = work.stopped.used, -1
    while work.stopped.used > n_last:
        n_last = int(work.stopped.used)
        for n in range(n_stresses):
            stop(work.stress.curvatures[n], work)
    return bool(work.stopped.used > n_before)


@kernel
def take_out_locked(contacts: ContactSet, work: ContactWorkspace) -> None:
    """Take what is locked out of the normals' wrenches; what hardly anything is left of has no part outside."""
    for i in range(contacts.used[0]):
        column = contacts.rows[i].columns[0]
        write_outside(work.locked, column, RESIDUAL_OF_SELF_STRESS, work.stress.twist)
        for k in range(contacts.n_freedoms):
            column[k] = work.stress.twist[k]


@kernel
def find_locked(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> None:
    """Find which of the chosen contacts are in self-stresses, and what these stop to second order.

    Parameters
    ----------
    contacts
        At a pose, from `find_contacts`, with a choice of faces, none locked. Filled: which are, and what is left of the
        normals' wrenches.
    frame
        The scaled coordinates there.
    work
        Filled: ``stopped``, ``locked`` and ``is_chained``.
    """
    clear(work.stress.pressed, contacts.n_freedoms, 1.0)
    clear(work.stopped, contacts.n_freedoms, 1.0)
    clear(work.locked, contacts.n_freedoms, 1.0)
    n_stresses, n_locked = 0, 0
    while n_stresses < STRESS_LIMIT:
        for i in range(contacts.used[0]):
            state = contacts.states[i]
            is_closed = contacts.rows[i].gap <= LEAST_PLAY * frame.extent_m
            state.counts = state.chosen and is_closed and not state.is_locked
        if clear_self_stress(contacts, work.stress):
            lock(contacts, frame, n_stresses, work)
            n_stresses += 1
        elif not stop_all(n_stresses, work):
            break
        elif n_locked == 0:
            n_locked = int(work.locked.used)
        take_out_locked(contacts, work)
    work.is_chained = 0 < n_locked < work.locked.used
    count_chosen(contacts)


@kernel
def restore_wrenches(contacts: ContactSet) -> None:
    """Write the wrenches as `find_contacts` does, and lock nothing."""
    for i in range(contacts.used[0]):
        contacts.states[i].is_locked = False
        row = contacts.rows[i]
        for j in range(3):
            for k in range(contacts.n_freedoms):
                row.columns[j, k] = row.wrenches[j, k]


@kernel
def write_locked(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> None:
    """Write a basis of what contacts without play lock into ``work.locked``; the contacts stay as they are."""
    find_locked(contacts, frame, work)
    restore_wrenches(contacts)


@kernel
def begin_unlocked(contacts: ContactSet, work: ContactWorkspace) -> None:
    """Lock nothing yet; the load in ``work`` is the whole one."""
    clear(work.stopped, contacts.n_freedoms, 1.0)
    clear(work.locked, contacts.n_freedoms, 1.0)
    work.has_locked = work.is_second_order = work.is_chained = False
    for i in range(contacts.used[0]):
        contacts.states[i].is_locked = False
    for k in range(contacts.n_freedoms):
        work.whole_load[k] = work.load[k]


@kernel
def forget_locked(contacts: ContactSet, work: ContactWorkspace) -> None:
    """Lock nothing any more: wrenches and load are what they were, and all chosen contacts count."""
    if work.locked.used == 0:
        return
    work.is_chained = False
    count_chosen(contacts)
    restore_wrenches(contacts)
    clear(work.stopped, contacts.n_freedoms, 1.0)
    clear(work.locked, contacts.n_freedoms, 1.0)
    for k in range(contacts.n_freedoms):
        work.load[k] = work.whole_load[k]


@kernel
def take_out_stopped(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> bool:
    """Take what contacts without play lock out of wrenches and load; False: they stop nothing to second order.

    Parameters
    ----------
    contacts
        At a pose, from `find_contacts`, with a choice of faces.
    frame
        The scaled coordinates there.
    friction
        With friction locked contacts count in the contact problem, as friction is less than their normal forces make
        it: only what is stopped is taken out, and of their normals what keeps them from being exactly opposite.
    work
        Given: the load. Filled: ``stopped`` and ``locked``, bases of the motions in question.
    """
    find_locked(contacts, frame, work)
    if work.stopped.used == 0:
        clear(work.locked, contacts.n_freedoms, 1.0)
        restore_wrenches(contacts)
        return False
    for i in range(contacts.used[0]):
        if contacts.states[i].is_locked:
            contacts.states[contacts.rows[i].group].has_carried = True
    if friction > 0.0:
        clear(work.locked, contacts.n_freedoms, 1.0)
        for place in range(work.stopped.used):
            extend(work.locked, work.stopped.basis[place], 0.0)
        restore_wrenches(contacts)
        for i in range(contacts.used[0]):
            take_out(contacts, i, work)
    remove_span(work.load, work.locked)
    return True


@kernel
def take_out(contacts: ContactSet, i: int, work: ContactWorkspace) -> None:
    """Take what is stopped out of the wrenches of a contact with friction; a normal that then nearly lies in the span
    of the locked ones is put into it.
    """
    row, outside = contacts.rows[i], work.stress.twist
    if not write_outside(work.stopped, row.columns[0], RESIDUAL_OF_SELF_STRESS, outside):
        contacts.states[i].counts = False  # it stops nothing that is not stopped already
        return
    for j in range(3):
        remove_span(row.columns[j], work.stopped)
    write_outside(work.stress.pressed, row.columns[0], 0.0, outside)
    if length(outside, contacts.n_freedoms) <= RESIDUAL_OF_SELF_STRESS * length(row.columns[0], contacts.n_freedoms):
        for k in range(contacts.n_freedoms):
            row.columns[0, k] -= outside[k]


@kernel
def carry_by_locked(contacts: ContactSet, friction: float, work: ContactWorkspace) -> None:
    """Write the forces of the locked contacts beside those of the others (with friction they are among them), and what
    all of them leave of the whole load into ``work.stress.imbalance``.
    """
    reaction, left = work.stress.reaction, work.stress.imbalance
    write_left(contacts, left, work)
    if friction > 0.0:
        return
    balance_by_locked(contacts, left, work)
    count_chosen(contacts)
    for k in range(reaction.passive.used):
        contacts.states[reaction.contacts[reaction.passive.labels[k]]].forces[0] = reaction.passive.x[k]
    write_left(contacts, left, work)


@kernel
def write_residual(work: ContactWorkspace) -> None:
    """Write what the forces leave of the load at rest, and whether it is carried by contacts without play, along what
    they stop.
    """
    left = work.stress.imbalance
    work.residual = length(left, work.stopped.n_rows) / work.load_terms
    remove_span(left, work.stopped)
    if work.residual - length(left, work.stopped.n_rows) / work.load_terms > CARRIED_ALONG_LOCKED:
        work.is_second_order = True


@kernel
def write_left(contacts: ContactSet, left: FloatArray, work: ContactWorkspace) -> None:
    """Write what the forces of the contacts leave of the whole load."""
    for k in range(contacts.n_freedoms):
        left[k] = work.whole_load[k]
    for i in range(contacts.used[0]):
        for j in range(3):
            for k in range(contacts.n_freedoms):
                left[k] -= contacts.states[i].forces[j] * contacts.rows[i].wrenches[j, k]
