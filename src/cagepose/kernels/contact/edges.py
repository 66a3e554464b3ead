"""Choices of faces at edges: of each group of faces that one point touches, one counts at a time (2.4).

The one way through them: ``first_choice``, then ``next_choice`` until it says that there is none.
"""

from __future__ import annotations

from cagepose.kernels.contact.contact_set import ContactSet, choose
from cagepose.kernels.native.kernel import kernel

CHOICES_LIMIT = 729
"""Choices that are asked: six points on corners of the object, all of which carry."""
ONLY_CARRYING, EVERY = False, True
"""Which choices are asked: those whose answer is not known from another, or all of them."""


@kernel
def last_of_group(contacts: ContactSet, first: int) -> int:
    last = first
    while last + 1 < contacts.used[0] and contacts.rows[last + 1].group == first:
        last += 1
    return last


@kernel
def first_choice(contacts: ContactSet) -> None:
    """Choose the first face of each group."""
    for i in range(contacts.used[0]):
        choose(contacts, i, contacts.rows[i].group == i)
        contacts.states[i].has_carried = False


@kernel
def next_choice(contacts: ContactSet, every: bool) -> bool:
    """Choose the next combination of faces; False: there is none, and the first is chosen again.

    Where no face of a group carried, another face of it would not either, and the same forces balance the load (or
    leave the same motion): such combinations are left out with ONLY_CARRYING.
    """
    rows, states = contacts.rows, contacts.states
    for first in range(contacts.used[0]):
        if rows[first].group == first:
            for i in range(first, last_of_group(contacts, first) + 1):
                if states[i].chosen and states[i].forces[0] > 0.0:
                    states[first].has_carried = True
    for first in range(contacts.used[0]):
        if rows[first].group != first:
            continue
        last = last_of_group(contacts, first)
        if every or states[first].has_carried:
            for i in range(first, last):
                if states[i].chosen:
                    choose(contacts, i, False)
                    choose(contacts, i + 1, True)
                    return True
        for i in range(first, last + 1):
            choose(contacts, i, i == first)
        states[first].has_carried = False
    return False


@kernel
def has_one_choice(contacts: ContactSet) -> bool:
    """Whether there is no edge, so that all faces count."""
    one = True
    for i in range(contacts.used[0]):
        one = one and contacts.rows[i].group == i
    return one


@kernel
def keep_choice(contacts: ContactSet) -> None:
    """Keep the faces that are chosen, and what they carry."""
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.kept_chosen = state.chosen
        for j in range(3):
            state.kept_forces[j] = state.forces[j]


@kernel
def return_to_kept(contacts: ContactSet) -> None:
    """Choose the faces that were kept, with their forces."""
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        choose(contacts, i, state.kept_chosen)
        for j in range(3):
            state.forces[j] = state.kept_forces[j]
