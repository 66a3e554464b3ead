"""Does a rest hang on contacts that no load keeps closed? What opens one of them for a moment ends it.

A board that is jammed between two points rests by friction that only the points keep up, each against the other. Where
contacts can press against each other without a load, the load must do with fewer of them: with so few that they no
longer can. And the motion that begins without one of those that are left must not lead away from it.
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.contact.cone import HELD
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.equilibrium import AT_REST, equilibrium_of_choice, least_residual
from cagepose.kernels.contact.metric import WRENCH, Frame
from cagepose.kernels.contact.onset import motion_with_faces
from cagepose.kernels.contact.self_stress import count_chosen, forget_locked, self_stress
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel

ASKED = 24
"""Contacts up to which this is asked, as many as those of which another onset is ruled out."""
OPENS = 1e-9
"""In lengths of the motion: a contact that it leaves more slowly stays where it is."""


@kernel
def does_without(contacts: ContactSet, i: int, friction: float, work: ContactWorkspace) -> bool:
    """Leave a contact out if the load is balanced without it."""
    contacts.states[i].counts = False
    if least_residual(contacts, friction, work.load, work.load_terms, work) <= HELD:
        return True
    contacts.states[i].counts = True
    return False


@kernel
def leave_one_out(contacts: ContactSet, friction: float, work: ContactWorkspace) -> bool:
    """Leave out one of the contacts that press against each other; False: the load needs all of them."""
    cone = work.stress.cone
    for k in range(cone.passive.used):
        if does_without(contacts, cone.contacts[cone.passive.labels[k]], friction, work):
            return True
    return False


@kernel
def parts_for_good(contacts: ContactSet, i: int, friction: float, work: ContactWorkspace) -> bool:
    """Whether the object begins to move away from a contact without it."""
    state, column, y = contacts.states[i], contacts.rows[i].columns[0], work.trial
    state.counts = False
    parts = least_residual(contacts, friction, work.load, work.load_terms, work) > HELD
    if parts and motion_with_faces(contacts, friction, work.load, y, work):
        parts = inner(column, y, WRENCH) < -OPENS * length(column, WRENCH) * length(y, WRENCH)
    state.counts = True
    return parts


@kernel
def hangs_on_a_clamp(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> bool:
    """Whether no contacts were found that balance the load, cannot press against each other, and do not part for good.

    Parameters
    ----------
    contacts, frame, friction
        Of a rest with one choice of faces; the coefficient.
    work
        Given: the load.
    """
    hangs = False
    if contacts.used[0] > ASKED:
        return hangs
    while not hangs and self_stress(contacts, friction, work.stress) <= HELD:
        hangs = not leave_one_out(contacts, friction, work)
    for i in range(contacts.used[0]):
        if contacts.states[i].counts and not hangs:
            hangs = parts_for_good(contacts, i, friction, work)
    count_chosen(contacts)
    forget_locked(contacts, frame, work)
    equilibrium_of_choice(contacts, frame, friction, AT_REST, work)  # for its forces
    return hangs
