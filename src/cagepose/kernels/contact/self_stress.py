"""Contacts without play: motions that they allow to first order and stop to second, equations (5.21) and (5.22).

A plate between two opposite points that are as far apart as it is thick can tip, as far as velocities go: but it would
have to be thinner. Contacts that can press against each other without a load (a self-stress sigma, sum sigma_i a_i = 0)
keep their gaps at zero, and of the motions that do so those with sum sigma_i (second derivative of gap i) < 0 go in.
They are taken out of the contact problem: the object does not begin to move that way, and what the load does there is
carried by forces without bound.
"""

from __future__ import annotations

from cagepose.kernels.algebra.dense import frobenius_norm, remove_span
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import PassiveSet, clear, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.span import extend, write_complement, write_outside, write_reduced
from cagepose.kernels.algebra.vector import cross, vector_from
from cagepose.kernels.contact.cone import N_ROWS, clear_cone, cone_residual
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.curvature import add_face_curvature, clear_matrix
from cagepose.kernels.contact.edges import first_choice, last_of_group
from cagepose.kernels.contact.metric import WRENCH, Frame, write_scaled_wrench
from cagepose.kernels.contact.workspace import ContactWorkspace, SelfStressWorkspace
from cagepose.kernels.native.kernel import kernel

OPPOSED = 1e-5
"""In lengths of the wrenches: what may be left of forces that cancel. A plate that touches on both sides, within the
touch tolerance, can be tilted by up to the root of that tolerance; and its forces would be 1e5 loads and more."""
STOPS = 1e-6
"""In the greatest second derivative: a smaller one is rounding."""


@kernel
def self_stress(contacts: ContactSet, friction: float, stress: SelfStressWorkspace) -> float:
    """Return what is left of the least imbalance of forces at the chosen contacts whose normal parts add up to 1; they
    are in ``stress.cone``.
    """
    for k in range(WRENCH):
        stress.twist[k] = 0.0
    stress.twist[N_ROWS - 1] = 1.0
    clear_cone(stress.cone, stress.twist, N_ROWS, 1.0)
    return cone_residual(contacts, friction, stress.twist, stress.cone)


@kernel
def choose_opposed(contacts: ContactSet, twist: FloatArray, load_terms: float) -> bool:
    """Choose the contacts on faces, not on edges, that a scaled twist does not open and that another one has a part
    against; False: there are none.

    The twist separates, so that it closes no contact; and no self-stress works along it, so that it opens none of those
    that are in one.
    """
    rows, states = contacts.rows, contacts.states
    first_choice(contacts)
    found = False
    for i in range(contacts.used[0]):
        least = -OPPOSED * load_terms * length(rows[i].columns[0], WRENCH)
        is_still = inner(rows[i].columns[0], twist, WRENCH) >= least
        states[i].chosen = states[i].chosen and is_still and last_of_group(contacts, i) == i
    for i in range(contacts.used[0]):
        states[i].is_rejected = True
        for j in range(contacts.used[0]):
            if states[i].chosen and states[j].chosen and inner(rows[i].directions[0], rows[j].directions[0], 3) < 0.0:
                states[i].is_rejected = False
                break
    for i in range(contacts.used[0]):
        states[i].chosen = states[i].chosen and not states[i].is_rejected
        found = found or states[i].chosen
    return found


@kernel
def hold_stressed(contacts: ContactSet, stress: SelfStressWorkspace) -> None:
    """Add the normals of the self-stress in ``stress.cone`` to the span that is held; they are not chosen any more."""
    passive = stress.cone.passive
    for k in range(passive.used):
        i = stress.cone.contacts[passive.labels[k]]
        extend(stress.held, contacts.rows[i].columns[0], OPPOSED)
        contacts.states[i].chosen = False


@kernel
def add_second_order(contacts: ContactSet, frame: Frame, stress: SelfStressWorkspace) -> None:
    """Add the second derivatives of the self-stress in ``stress.cone`` to those of the others."""
    passive = stress.cone.passive
    for k in range(passive.used):
        contact = contacts.rows[stress.cone.contacts[passive.labels[k]]]
        add_face_curvature(contact, passive.x[k], frame, stress.curvature)


@kernel
def hold_the_rest(contacts: ContactSet, stress: SelfStressWorkspace) -> None:
    """Add to the span that is held what stress can reach beside it: self-stresses of the other contacts, seen outside
    the span, to which those found can add what is missing. The normals' wrenches are lost.
    """
    while True:
        for i in range(contacts.used[0]):
            state, column = contacts.states[i], contacts.rows[i].columns[0]
            if state.chosen:
                state.chosen = write_outside(stress.held, column, OPPOSED, stress.twist)
                for k in range(WRENCH):
                    column[k] = stress.twist[k]
        if self_stress(contacts, 0.0, stress) > OPPOSED:
            return
        hold_stressed(contacts, stress)


@kernel
def find_stopped(stress: SelfStressWorkspace, stopped: PassiveSet) -> None:
    """Write a basis of the motions that keep all the gaps held and that the second derivatives stop.

    Where those open a gap for other such motions, nothing is said: a little of one pays for some of the other.
    """
    n_free = write_complement(stress.held, stress.free)
    write_reduced(stress.curvature, stress.free, n_free, stress.reduced)
    symmetric_eigen(stress.reduced, stress.vectors, n_free)
    least = STOPS * frobenius_norm(stress.curvature)
    for e in range(n_free):
        if stress.reduced[e, e] < -least:
            return
    for e in range(n_free):
        if stress.reduced[e, e] > least:
            for k in range(WRENCH):
                stress.twist[k] = 0.0
                for i in range(n_free):
                    stress.twist[k] += stress.vectors[i, e] * stress.free[i, k]
            extend(stopped, stress.twist, OPPOSED)


@kernel
def take_out(contacts: ContactSet, frame: Frame, stopped: PassiveSet, stress: SelfStressWorkspace) -> None:
    """Write the wrenches anew, without what they do along the motions that are stopped.

    Normals that then nearly lie in the span that is held are put into it, so that opposite ones are exactly opposite.
    """
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        columns, arm = contact.columns, vector_from(contact.arm)
        for j in range(3):
            direction = vector_from(contact.directions[j])
            write_scaled_wrench(direction, cross(arm, direction), frame, columns[j])
            left = write_outside(stopped, columns[j], OPPOSED, stress.twist)
            for k in range(WRENCH):
                columns[j, k] = stress.twist[k]
            if j == 0 and not left:  # it stops nothing that is not stopped already
                contact.group = -1
        write_outside(stress.held, columns[0], 0.0, stress.twist)
        if length(stress.twist, WRENCH) <= OPPOSED * length(columns[0], WRENCH):
            for k in range(WRENCH):
                columns[0, k] -= stress.twist[k]


@kernel
def take_out_stopped(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> bool:
    """Find the motions that contacts without play stop to second order, and take them out of wrenches and load; False:
    there are none.

    Parameters
    ----------
    contacts
        At a pose, from `find_contacts`. Which are chosen is lost.
    frame
        The scaled coordinates there.
    work
        Given: the load, and what is left of it. Filled: ``stopped``, a basis of these motions.
    """
    stress, stopped = work.stress, work.stopped
    clear(stopped, WRENCH, 1.0)
    if not choose_opposed(contacts, work.cone.passive.residual, work.load_terms):
        return False
    clear(stress.held, WRENCH, 1.0)
    clear_matrix(stress.curvature)
    while self_stress(contacts, 0.0, stress) <= OPPOSED:
        add_second_order(contacts, frame, stress)
        hold_stressed(contacts, stress)
    if stress.held.used == 0:
        return False
    hold_the_rest(contacts, stress)
    find_stopped(stress, stopped)
    take_out(contacts, frame, stopped, stress)
    for k in range(WRENCH):
        work.whole_load[k] = work.load[k]
    remove_span(work.load, stopped)
    return bool(stopped.used > 0)


@kernel
def carried_without_bound(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> float:
    """Return what the forces leave of the whole load, in its lengths: what contacts without play carry beside them."""
    left, column = work.stress.twist, work.trial
    for k in range(WRENCH):
        left[k] = work.whole_load[k]
    for i in range(contacts.used[0]):
        arm, forces = vector_from(contacts.rows[i].arm), contacts.states[i].forces
        for j in range(3):
            direction = vector_from(contacts.rows[i].directions[j])
            write_scaled_wrench(direction, cross(arm, direction), frame, column)
            for k in range(WRENCH):
                left[k] -= forces[j] * column[k]
    return length(left, WRENCH) / work.load_terms
