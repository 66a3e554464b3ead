"""How contacts without friction share what they carry if they are equally stiff: the least squares of forces (5.25).

By duality f_i = max(0, a_i . m), with the motion m at which w . m - 1/2 sum f_i^2 is greatest: contacts that push back
in proportion to it. This is found by Newton's method.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.dense import cholesky, remove_span, solve_lower, solve_upper
from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, PassiveSet, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.native.kernel import kernel

MOST_STEPS = 40
LEAST_STIFFNESS = 1e-12
"""In lengths of the columns squared: in directions that no contact resists."""
NOT_SHARED = 1e-8
"""In lengths of the wrench: so much of it may be left; a stiffness needs no more digits."""
SHORTEST_PART, SHARE_OF_SLOPE = 1e-3, 0.1
"""Of a step, and of the slope at its start: a step is halved that passes the best place by more."""
OPENING = 1e-6
"""In lengths of the load's terms. A contact that opens faster carries nothing."""


class SharingWorkspace:
    """Memory for one distribution of forces; a record.

    Attributes
    ----------
    stiffness
        Of all contacts that carry, and then its Cholesky factor, lower.
    wrench, left
        What is shared, and what is left of it.
    motion, step, ahead
        The motion m, what Newton's method adds to it, and where a part of that leads.
    """

    stiffness: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    wrench: ScaledVector
    left: ScaledVector
    motion: ScaledVector
    step: ScaledVector
    ahead: ScaledVector


@kernel
def write_left(contacts: ContactSet, motion: FloatArray, work: SharingWorkspace) -> None:
    """Write the forces of a motion, of the contacts that count, and what they leave of the wrench."""
    n = contacts.n_freedoms
    for k in range(n):
        work.left[k] = work.wrench[k]
    for i in range(contacts.used[0]):
        state, normal = contacts.states[i], contacts.rows[i].columns[0]
        state.forces[0] = max(inner(normal, motion, n), 0.0) if state.may_share else 0.0
        for k in range(n):
            work.left[k] -= state.forces[0] * normal[k]


@kernel
def write_stiffness(contacts: ContactSet, work: SharingWorkspace) -> None:
    """Write the stiffness of the contacts that carry, with a little in all directions."""
    total, n = 0.0, contacts.n_freedoms
    for j in range(n):
        for k in range(n):
            work.stiffness[j, k] = 0.0
    for i in range(contacts.used[0]):
        if contacts.states[i].forces[0] > 0.0:
            normal = contacts.rows[i].columns[0]
            total += inner(normal, normal, n)
            for j in range(n):
                for k in range(n):
                    work.stiffness[j, k] += normal[j] * normal[k]
    for k in range(n):
        work.stiffness[k, k] += LEAST_STIFFNESS * max(total, 1.0)


@kernel
def share_evenly(
    contacts: ContactSet, carrying: PassiveSet, y: FloatArray, terms: float, work: SharingWorkspace
) -> bool:
    """Share what the contacts carry of a load, of terms so long, that begins the motion ``y``, among all that do not
    open with it and hold nothing that those which carry, with that basis, do not hold; False: it was not found, and
    the forces are as they were.
    """
    n = contacts.n_freedoms
    for k in range(n):
        work.wrench[k] = 0.0
    for i in range(contacts.used[0]):
        state, normal = contacts.states[i], contacts.rows[i].columns[0]
        state.kept_forces[0] = state.forces[0]
        opens = -inner(normal, y, n) > OPENING * length(normal, n) * terms
        for k in range(n):
            work.step[k] = normal[k]
        remove_span(work.step, carrying)
        is_other = length(work.step, n) > carrying.dependent * length(normal, n)
        state.may_share = state.chosen and (state.forces[0] > 0.0 or not (opens or is_other))
        for k in range(n):
            work.wrench[k] += state.forces[0] * normal[k]
    for i in range(contacts.used[0]):  # with all of them: one linear system, where all come to carry
        contacts.states[i].forces[0] = 1.0 if contacts.states[i].may_share else 0.0
    for k in range(n):
        work.motion[k], work.left[k] = 0.0, work.wrench[k]
    for _ in range(MOST_STEPS):
        write_stiffness(contacts, work)
        if not cholesky(work.stiffness, 0.0, n):
            break
        solve_lower(work.stiffness, work.left, work.step, n)
        solve_upper(work.stiffness, work.step, n)
        slope, part = inner(work.left, work.step, n), 1.0
        while True:
            for k in range(n):
                work.ahead[k] = work.motion[k] + part * work.step[k]
            write_left(contacts, work.ahead, work)
            if part < SHORTEST_PART or inner(work.left, work.step, n) >= -SHARE_OF_SLOPE * slope:
                break
            part *= 0.5
        for k in range(n):
            work.motion[k] = work.ahead[k]
        if length(work.left, n) <= NOT_SHARED * length(work.wrench, n):
            return True
    for i in range(contacts.used[0]):
        contacts.states[i].forces[0] = contacts.states[i].kept_forces[0]
    return False
