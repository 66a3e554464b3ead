"""Do the contacts balance a load? Forces inside their friction cones that do, or a twist that separates them.

The one place where this is decided, for a run, for the first rest on the way, for a proof and for the least friction.
On an edge one face that holds or leaves is enough (2.4): a load is balanced if it is with every choice of faces.
"""

from __future__ import annotations

from cagepose.kernels.algebra.dense import remove_span
from cagepose.kernels.algebra.least_squares import WRENCH, append_column, clear, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import norm, vector_from
from cagepose.kernels.contact.cone import clear_cone, cone_residual, write_forces
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.edges import (
    CHOICES_LIMIT,
    ONLY_CARRYING,
    first_choice,
    has_one_choice,
    keep_choice,
    next_choice,
    return_to_kept,
)
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.on_circle import MOST_ADDED_POINTS, add_on_circles
from cagepose.kernels.contact.self_stress import (
    begin_unlocked,
    carry_by_locked,
    forget_locked,
    take_out_stopped,
    write_residual,
)
from cagepose.kernels.contact.tolerances import (
    RESIDUAL_AT_LIMIT,
    RESIDUAL_BY_ROUNDING,
    RESIDUAL_OF_LOAD,
    RESIDUAL_OF_SELF_STRESS,
    ROUNDING_OF_PLACE,
)
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel

HELD_WITHOUT_FRICTION, HELD_BY_FRICTION, UNSOLVED, MOVES, MOVES_SOMEHOW = 0, 1, 2, 3, 4
"""What the contacts do, from the least to the most that moves. Of a balance, MOVES says that there is none, and
UNSOLVED that there are too many choices of faces to ask them all, and that those which were asked hold. Of an onset
MOVES_SOMEHOW says that there is no balance, and that how the object begins to move was not found."""
SPARED = (0.1, 0.01, 0.001, 1e-6)
"""Parts of the friction that a balance may leave: the first with which there is one gives its forces."""
AT_REST, ON_THE_WAY = 1.0, 0.1
"""Strictness. A pose on the way is looked at again when the run has got there: it must hold then, too."""


@kernel
def least_residual(contacts: ContactSet, friction: float, b: FloatArray, terms: float, work: ContactWorkspace) -> float:
    """Return what contact forces with this friction leave of a load, in lengths of its terms; they are in the cone."""
    clear_cone(work.cone, b, contacts.n_freedoms, terms)
    return cone_residual(contacts, friction, work.cone)


@kernel
def rounding_of_normals(contacts: ContactSet, work: ContactWorkspace) -> float:
    """Return what the rounding of places may leave of a load, in lengths of its terms: a pin in a bore that is a
    thousandth wider turns its normal by the way over that thousandth.
    """
    turned = 0.0
    for i in range(contacts.used[0]):
        relative, most = contacts.bends[i].relative, 0.0
        for j in range(3):
            for k in range(3):
                most = max(most, abs(relative[j, k]))
        place = vector_from(contacts.rows[i].arm)
        turned += contacts.states[i].forces[0] * most * ROUNDING_OF_PLACE * norm(place)
    return turned / work.cone.passive.terms


@kernel
def is_balance(contacts: ContactSet, left: float, friction: float, strictness: float, work: ContactWorkspace) -> bool:
    """Whether a residual counts as zero: up to RESIDUAL_OF_LOAD, or what the rounding of normals leaves, and up to
    RESIDUAL_AT_LIMIT where contacts slip.

    The part of it that slips at no contact (a swing about one that sticks) has nothing to do with the limit of
    friction, and has all its digits.
    """
    if left <= strictness * RESIDUAL_OF_LOAD:
        return True
    if left <= strictness * RESIDUAL_BY_ROUNDING and left <= strictness * rounding_of_normals(contacts, work):
        return True
    if friction == 0.0 or left > strictness * RESIDUAL_AT_LIMIT:
        return False
    span, cone, n = work.span, work.cone, contacts.n_freedoms
    clear(span, n, cone.passive.terms)
    for k in range(cone.passive.used):
        for j in range(3):
            append_column(span, contacts.rows[cone.contacts[cone.passive.labels[k]]].columns[j], k, 0.0)
    whole = length(cone.passive.residual, n)
    for k in range(n):
        span.target[k] = cone.passive.residual[k]
    remove_span(span.target, span)
    return left * length(span.target, n) <= strictness * RESIDUAL_OF_LOAD * whole


@kernel
def spare_friction(contacts: ContactSet, friction: float, b: FloatArray, terms: float, work: ContactWorkspace) -> int:
    """Choose the forces of a balance: without friction where those do, else as far inside their cones as they can, so
    that no contact looks as if it were about to slip. Return which.
    """
    left = least_residual(contacts, 0.0, b, terms, work)
    write_forces(work.cone, 0.0, contacts)
    if is_balance(contacts, left, 0.0, AT_REST, work):
        work.residual = left
        return HELD_WITHOUT_FRICTION
    for share in SPARED:
        used = (1.0 - share) * friction
        left = least_residual(contacts, used, b, terms, work)
        if left <= RESIDUAL_AT_LIMIT:
            write_forces(work.cone, used, contacts)
            work.residual = left
            return HELD_BY_FRICTION
    work.residual = least_residual(contacts, friction, b, terms, work)
    write_forces(work.cone, friction, contacts)
    return HELD_BY_FRICTION


@kernel
def equilibrium_with_faces(
    contacts: ContactSet, friction: float, strictness: float, b: FloatArray, terms: float, work: ContactWorkspace
) -> int:
    """Return the code of a load for one choice of faces; forces and residual are filled.

    Parameters
    ----------
    contacts, friction
        Those that count; the coefficient of friction.
    strictness
        Of the tolerance: AT_REST or ON_THE_WAY.
    b, terms
        The load's scaled wrench, (at least n_freedoms,), and the length of its terms.
    work
        Filled.
    """
    left = least_residual(contacts, friction, b, terms, work)
    write_forces(work.cone, friction, contacts)
    work.residual = left
    if not is_balance(contacts, left, friction, strictness, work):
        return MOVES
    if friction == 0.0:
        return HELD_WITHOUT_FRICTION
    return spare_friction(contacts, friction, b, terms, work)


@kernel
def needs_second_order(contacts: ContactSet, code: int, friction: float, work: ContactWorkspace) -> bool:
    """Whether contacts without play may stop what forces do not: where these do not balance the load, or are without
    bound. Without friction contacts that carry do not press against each other, so another one must be closed as well.

    Curvatures are of one free body, so that with more freedoms nothing is asked to second order.
    """
    if contacts.n_freedoms != WRENCH:
        return False
    pushed, n_idle = 0.0, 0
    for i in range(contacts.used[0]):
        pushed += contacts.states[i].forces[0]
        opens = (
            inner(contacts.rows[i].columns[0], work.cone.passive.residual, contacts.n_freedoms)
            < -RESIDUAL_OF_SELF_STRESS * work.load_terms
        )
        if contacts.states[i].forces[0] == 0.0 and not opens:
            n_idle += 1
    return pushed * RESIDUAL_OF_SELF_STRESS > work.load_terms or (code == MOVES and (n_idle > 0 or friction > 0.0))


@kernel
def equilibrium_of_choice(
    contacts: ContactSet, frame: Frame, friction: float, strictness: float, work: ContactWorkspace
) -> int:
    """As `equilibrium_with_faces` of the load in ``work``; where it takes forces without bound, contacts without play
    are asked to second order, see `self_stress`. What they lock stays out of the wrenches until `forget_locked`.
    """
    code = equilibrium_with_faces(contacts, friction, strictness, work.load, work.load_terms, work)
    if needs_second_order(contacts, code, friction, work) and take_out_stopped(contacts, frame, friction, work):
        work.has_locked = True
        code = equilibrium_with_faces(contacts, friction, strictness, work.load, work.load_terms, work)
        if code != MOVES:
            carry_by_locked(contacts, friction, work)
            write_residual(work)
    return code


@kernel
def next_choice_unlocked(contacts: ContactSet, every: bool, work: ContactWorkspace) -> bool:
    """As `next_choice`, with nothing locked."""
    forget_locked(contacts, work)
    return next_choice(contacts, every)


@kernel
def return_to_choice(
    contacts: ContactSet, frame: Frame, friction: float, strictness: float, work: ContactWorkspace
) -> None:
    """Choose the faces that were kept, with their forces, and with what is locked there."""
    forget_locked(contacts, work)
    return_to_kept(contacts)
    if work.has_locked:
        equilibrium_of_choice(contacts, frame, friction, strictness, work)


@kernel
def equilibrium(contacts: ContactSet, frame: Frame, friction: float, strictness: float, work: ContactWorkspace) -> int:
    """As `equilibrium_of_listed`; where rims lie flat, with all their points that a motion would go in at."""
    code = equilibrium_of_listed(contacts, frame, friction, strictness, work)
    for _ in range(MOST_ADDED_POINTS):
        if code != MOVES or not add_on_circles(contacts, frame, friction, work.cone.passive.residual, work.load_terms):
            break
        forget_locked(contacts, work)
        code = equilibrium_of_listed(contacts, frame, friction, strictness, work)
    return code


@kernel
def equilibrium_of_listed(
    contacts: ContactSet, frame: Frame, friction: float, strictness: float, work: ContactWorkspace
) -> int:
    """Return the code of the load in ``work``: held, MOVES as soon as one choice of faces does not balance it, or
    UNSOLVED.

    Filled: which faces are chosen, their forces, and the residual. For MOVES the faces are those that do not balance
    it, and the next choices have not been asked.

    Parameters
    ----------
    contacts
        At a pose, from `find_contacts`.
    frame
        The scaled coordinates there.
    friction, strictness
        Coefficient of friction; of the tolerance, AT_REST or ON_THE_WAY.
    work
        Given: the load. Filled: the answer.
    """
    begin_unlocked(contacts, work)
    best_code, best_left = -1, 0.0
    first_choice(contacts)
    one_choice = has_one_choice(contacts)
    for _ in range(CHOICES_LIMIT):
        code = equilibrium_of_choice(contacts, frame, friction, strictness, work)
        if code == MOVES:
            return MOVES
        if code > best_code or (code == best_code and work.residual > max(best_left, RESIDUAL_AT_LIMIT)):
            best_code, best_left = code, work.residual
            keep_choice(contacts)
        if one_choice or not next_choice_unlocked(contacts, ONLY_CARRYING, work):
            break
    else:
        best_code = UNSOLVED
    if not one_choice:
        return_to_choice(contacts, frame, friction, strictness, work)
        work.residual = best_left
    return best_code
