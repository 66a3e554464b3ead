"""The least friction with which contacts can balance a load at a pose, equation (5.17)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.contact.balance import left_by_friction
from cagepose.kernels.contact.cone import BALANCED, HELD, write_forces
from cagepose.kernels.contact.contact_set import ContactRow, choose_next_faces
from cagepose.kernels.contact.onset import COMBINATIONS_LIMIT, ContactWorkspace
from cagepose.kernels.contact.separation import step_to_balance
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.proof import ProofWorkspace

FRICTION_GREATEST = 1e4
"""A coefficient above which a balance counts as none."""
BISECTIONS = 100
SURE = 1e-6
"""In lengths of the terms: a residual small enough for one last step, and large enough to have its digits."""


@kernel
def least_friction(rows: Rows[ContactRow], n_contacts: int, solver: ContactWorkspace) -> float:
    """Return the least coefficient at which one choice of faces balances the load (5.17); inf: none.

    Bisection, and Newton's method where the residual falls straight to zero: there the last step is taken from a
    residual that is still large enough to be sure of its digits.
    """
    low, high = 0.0, 1.0
    if left_by_friction(rows, n_contacts, low, solver) <= BALANCED:
        return 0.0
    while left_by_friction(rows, n_contacts, high, solver) > HELD:
        low, high = high, 4.0 * high
        if high > FRICTION_GREATEST:
            return math.inf
    for _ in range(BISECTIONS):
        left = left_by_friction(rows, n_contacts, low, solver)
        write_forces(solver.cone, low, rows, n_contacts)
        following = low + step_to_balance(rows, n_contacts, solver.cone)
        if left <= SURE:
            return min(following, high)
        if not low < following < high:
            following = 0.5 * (low + high)
        if following in (low, high):
            break
        if left_by_friction(rows, n_contacts, following, solver) <= HELD:
            high = following
            following = 0.5 * (low + high)
            if left_by_friction(rows, n_contacts, following, solver) <= HELD:
                high = following
                continue
        low = following
    return high


@kernel
def least_friction_of_faces(at: ProofWorkspace) -> float:
    """Return the least coefficient with which the contacts at a pose balance the load, whichever faces count on edges;
    inf: none; NaN: there are too many choices of faces to ask them all.
    """
    least = 0.0
    rows, n_contacts = at.contacts.rows, at.contacts.used[0]
    every = False
    for _ in range(COMBINATIONS_LIMIT):
        least = max(least, least_friction(rows, n_contacts, at.rooms[0].solver))
        write_forces(at.rooms[0].solver.cone, least, rows, n_contacts)
        if least == math.inf or not choose_next_faces(at.contacts, every):
            return least
    return math.nan
