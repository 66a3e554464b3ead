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
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet
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
def is_parallel(one: ContactRow, other: ContactRow) -> bool:
    """Whether two contacts have the same normal, to the last digit."""
    return bool(
        one.directions[0, 0] == other.directions[0, 0]
        and one.directions[0, 1] == other.directions[0, 1]
        and one.directions[0, 2] == other.directions[0, 2]
    )


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
        if i > 0 and states[i].chosen and states[i - 1].chosen and is_parallel(rows[i], rows[i - 1]):
            states[i].is_rejected = states[i - 1].is_rejected  # of thousands on one face, one is asked
            continue
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
def drop_stressed(contacts: ContactSet, stress: SelfStressWorkspace) -> None:
    """Choose the contacts of the self-stress in ``stress.cone`` no longer."""
    for k in range(stress.cone.passive.used):
        contacts.states[stress.cone.contacts[stress.cone.passive.labels[k]]].chosen = False


@kernel
def hold_stressed(contacts: ContactSet, stress: SelfStressWorkspace) -> None:
    """Add the normals of the self-stresses of the chosen contacts to the span that is held.

    Of the other contacts the part outside the span is asked again: what is missing inside, self-stresses that have been
    found can add. The normals' wrenches are lost.
    """
    clear(stress.held, WRENCH, 1.0)
    while self_stress(contacts, 0.0, stress) <= OPPOSED:
        for k in range(stress.cone.passive.used):
            i = stress.cone.contacts[stress.cone.passive.labels[k]]
            extend(stress.held, contacts.rows[i].columns[0], OPPOSED)
        drop_stressed(contacts, stress)
        for i in range(contacts.used[0]):
            state, column = contacts.states[i], contacts.rows[i].columns[0]
            if state.chosen:
                state.chosen = write_outside(stress.held, column, OPPOSED, stress.twist)
                for k in range(WRENCH):
                    column[k] = stress.twist[k]


@kernel
def write_wrench(contacts: ContactSet, i: int, j: int, frame: Frame, out: FloatArray) -> None:
    """Write the scaled wrench of a unit force of contact i in its direction j, as `find_contacts` does."""
    direction = vector_from(contacts.rows[i].directions[j])
    write_scaled_wrench(direction, cross(vector_from(contacts.rows[i].arm), direction), frame, out)


@kernel
def add_stopped(contacts: ContactSet, frame: Frame, stopped: PassiveSet, stress: SelfStressWorkspace) -> None:
    """Add what the self-stress in ``stress.cone`` stops of the motions that are neither held nor stopped; that is then
    held, too. Where it opens a gap for others of them, it stops none: a little of one pays for some of another.
    """
    passive = stress.cone.passive
    clear_matrix(stress.curvature)
    for k in range(passive.used):
        contact = contacts.rows[stress.cone.contacts[passive.labels[k]]]
        add_face_curvature(contact, passive.x[k], frame, stress.curvature)
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
    for place in range(stopped.used):
        extend(stress.held, stopped.basis[place], OPPOSED)


@kernel
def find_stopped(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> bool:
    """Write a basis of the motions that contacts without play stop to second order into ``work.stopped``; False: there
    are none. Which contacts are chosen is lost.
    """
    stress, stopped = work.stress, work.stopped
    clear(stopped, WRENCH, 1.0)
    if not choose_opposed(contacts, work.cone.passive.residual, work.load_terms):
        return False
    if self_stress(contacts, 0.0, stress) > OPPOSED:
        return False
    hold_stressed(contacts, stress)
    for i in range(contacts.used[0]):
        write_wrench(contacts, i, 0, frame, contacts.rows[i].columns[0])
    before = -1
    while stopped.used > before:  # what one self-stress stops may leave another with nothing that it opens
        before = int(stopped.used)
        choose_opposed(contacts, work.cone.passive.residual, work.load_terms)
        while self_stress(contacts, 0.0, stress) <= OPPOSED:
            add_stopped(contacts, frame, stopped, stress)
            drop_stressed(contacts, stress)
    return bool(stopped.used > 0)


@kernel
def take_out(contacts: ContactSet, i: int, j: int, work: ContactWorkspace) -> None:
    """Take out of a wrench what it does along the motions that are stopped.

    A normal that then nearly lies in the span that is held is put into it, so that opposite ones are exactly opposite.
    """
    column, stress = contacts.rows[i].columns[j], work.stress
    is_group = contacts.rows[i].group == i and last_of_group(contacts, i) == i
    if j == 0 and is_group and not write_outside(work.stopped, column, OPPOSED, stress.twist):
        contacts.rows[i].group = -1  # it stops nothing that is not stopped already
        return
    remove_span(column, work.stopped)
    if j == 0:
        write_outside(stress.held, column, 0.0, stress.twist)
        if length(stress.twist, WRENCH) <= OPPOSED * length(column, WRENCH):
            for k in range(WRENCH):
                column[k] -= stress.twist[k]


@kernel
def take_out_stopped(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> bool:
    """Take the motions that contacts without play stop to second order out of wrenches and load; False: there are none.

    Parameters
    ----------
    contacts
        At a pose, from `find_contacts`. Which are chosen is lost.
    frame
        The scaled coordinates there.
    work
        Given: the load, and what is left of it. Filled: ``stopped``, a basis of these motions.
    """
    if not find_stopped(contacts, frame, work):
        return False
    for k in range(WRENCH):
        work.whole_load[k] = work.load[k]
    remove_span(work.load, work.stopped)
    for i in range(contacts.used[0]):
        for j in range(3):
            take_out(contacts, i, j, work)
    return True


@kernel
def carried_without_bound(contacts: ContactSet, frame: Frame, work: ContactWorkspace) -> float:
    """Return what the forces leave of the whole load, in its lengths: what contacts without play carry beside them."""
    left, column = work.stress.twist, work.trial
    for k in range(WRENCH):
        left[k] = work.whole_load[k]
    for i in range(contacts.used[0]):
        for j in range(3):
            write_wrench(contacts, i, j, frame, column)
            for k in range(WRENCH):
                left[k] -= contacts.states[i].forces[j] * column[k]
    return length(left, WRENCH) / work.load_terms
