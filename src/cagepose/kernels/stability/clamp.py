"""Does a rest hang on contacts that no load keeps closed? What opens one of them for a moment ends it.

A board that is jammed between two points rests by friction that only the points keep up, each against the other. Where
contacts can press against each other without a load, the load must do with fewer of them: with so few that they no
longer can. And where rest is not the only onset, the motion that begins without one of the contacts must not lead away
from it.
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.equilibrium import least_residual
from cagepose.kernels.contact.onset import motion_with_faces
from cagepose.kernels.contact.self_stress import self_stress
from cagepose.kernels.contact.tolerances import RESIDUAL_AT_LIMIT
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.tolerances import SPEED_OF_OPENING

MOST_ASKED = 24
"""This is asked of at most so many contacts, as many as those of which another impending motion is ruled out."""


@kernel
def is_balanced_without(contacts: ContactSet, i: int, friction: float, work: ContactWorkspace) -> bool:
    """Leave a contact out; return whether the load is balanced then."""
    contacts.states[i].counts = False
    return least_residual(contacts, friction, work.load, work.load_terms, work) <= RESIDUAL_AT_LIMIT


@kernel
def leave_one_out(contacts: ContactSet, friction: float, work: ContactWorkspace) -> int:
    """Leave out one of the contacts that press against each other, and return it; -1: the load needs all of them."""
    cone = work.stress.cone
    for k in range(cone.passive.used):
        i = int(cone.contacts[cone.passive.labels[k]])
        if is_balanced_without(contacts, i, friction, work):
            return i
        contacts.states[i].counts = True
    return -1


@kernel
def hangs_on_a_clamp(contacts: ContactSet, friction: float, work: ContactWorkspace) -> bool:
    """Whether no contacts were found that balance the load and cannot press against each other.

    Parameters
    ----------
    contacts, friction
        Of a rest; the coefficient.
    work
        Given: the load. The forces in its cones are lost.
    """
    left_out, hangs = 0, False
    if contacts.used[0] > MOST_ASKED:
        return hangs
    while not hangs and self_stress(contacts, friction, work.stress) <= RESIDUAL_AT_LIMIT:
        i = leave_one_out(contacts, friction, work)
        hangs = i < 0
        if not hangs:
            left_out |= 1 << i
    for i in range(contacts.used[0]):
        if (left_out >> i) & 1:
            contacts.states[i].counts = True
    return hangs


@kernel
def parts_for_good(contacts: ContactSet, friction: float, work: ContactWorkspace) -> bool:
    """Whether there is a contact without which the object begins to move away from it. Parameters as above; the forces
    of the contacts are lost, too.
    """
    parts = False
    if contacts.used[0] > MOST_ASKED:
        return parts
    for i in range(contacts.used[0]):
        state, column, y, n = contacts.states[i], contacts.rows[i].columns[0], work.trial, contacts.n_freedoms
        if not state.counts or parts:
            continue
        if not is_balanced_without(contacts, i, friction, work):
            parts = True
            if motion_with_faces(contacts, friction, work.load, y, work):
                parts = inner(column, y, n) < -SPEED_OF_OPENING * length(column, n) * length(y, n)
        state.counts = True
    return parts
