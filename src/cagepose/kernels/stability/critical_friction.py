"""The least friction with which contacts can balance a load at a pose, equation (5.17)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.contact.cone import steepest_tangent, write_forces
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.edges import CHOICES_LIMIT, ONLY_CARRYING, first_choice, next_choice
from cagepose.kernels.contact.equilibrium import least_residual
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.on_circle import MOST_ADDED_POINTS, add_on_circles
from cagepose.kernels.contact.tolerances import RESIDUAL_AT_LIMIT, RESIDUAL_OF_LOAD
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.proof import ProofWorkspace
from cagepose.kernels.stability.tolerances import RESIDUAL_WITH_DIGITS

FRICTION_GREATEST = 1e4
"""A coefficient above which a balance counts as none."""
MOST_BISECTIONS = 100


@kernel
def step_to_balance(contacts: ContactSet, work: ContactWorkspace) -> float:
    """Return by how much more friction the residual r would vanish, to first order: |r|^2 / sum f_n |r_t|.

    The contacts' forces are those that leave it.
    """
    residual = work.cone.passive.residual
    gain = 0.0
    for i in range(contacts.used[0]):
        gain += contacts.states[i].forces[0] * steepest_tangent(contacts, i, residual)[0]
    left = length(residual, contacts.n_freedoms)
    return left * left / gain if gain > 0.0 else math.inf


@kernel
def left_of_load(contacts: ContactSet, n_listed: int, frame: Frame, friction: float, work: ContactWorkspace) -> float:
    """Return what the listed contacts, and those points of flat rims that count at this friction, leave of the load."""
    contacts.used[0] = n_listed
    left = least_residual(contacts, friction, work.load, work.load_terms, work)
    for _ in range(MOST_ADDED_POINTS):
        if left <= RESIDUAL_AT_LIMIT or not add_on_circles(
            contacts, frame, friction, work.cone.passive.residual, work.load_terms
        ):
            break
        left = least_residual(contacts, friction, work.load, work.load_terms, work)
    return left


@kernel
def least_friction(contacts: ContactSet, n_listed: int, frame: Frame, work: ContactWorkspace) -> float:
    """Return the least coefficient at which one choice of faces balances the load (5.17); inf: none.

    Bisection, and Newton's method where the residual falls straight to zero: there the last step is taken from a
    residual that is still large enough to be sure of its digits.
    """
    low, high = 0.0, 1.0
    if left_of_load(contacts, n_listed, frame, low, work) <= RESIDUAL_OF_LOAD:
        return 0.0
    while left_of_load(contacts, n_listed, frame, high, work) > RESIDUAL_AT_LIMIT:
        low, high = high, 4.0 * high
        if high > FRICTION_GREATEST:
            return math.inf
    for _ in range(MOST_BISECTIONS):
        left = left_of_load(contacts, n_listed, frame, low, work)
        write_forces(work.cone, low, contacts)
        following = low + step_to_balance(contacts, work)
        if left <= RESIDUAL_WITH_DIGITS:
            return min(following, high)
        if not low < following < high:
            following = 0.5 * (low + high)
        if following in (low, high):
            break
        if left_of_load(contacts, n_listed, frame, following, work) <= RESIDUAL_AT_LIMIT:
            high = following
            following = 0.5 * (low + high)
            if left_of_load(contacts, n_listed, frame, following, work) <= RESIDUAL_AT_LIMIT:
                high = following
                continue
        low = following
    return high


@kernel
def least_friction_of_faces(frame: Frame, at: ProofWorkspace) -> float:
    """Return the least coefficient with which the contacts at a pose balance the load, whichever faces count on edges;
    inf: none; NaN: there are too many choices of faces to ask them all.
    """
    least = 0.0
    contacts, work, n_listed = at.contacts, at.scratch[0].solver, at.contacts.used[0]
    first_choice(contacts)
    for _ in range(CHOICES_LIMIT):
        least = max(least, least_friction(contacts, n_listed, frame, work))
        contacts.used[0] = n_listed
        write_forces(work.cone, least, contacts)
        if least == math.inf or not next_choice(contacts, ONLY_CARRYING):
            return least
    return math.nan
