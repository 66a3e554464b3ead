"""What happens from rest at one pose: the contacts hold the object, or it starts to move, equations (5.1) to (5.8).

It moves if it does with any choice of faces at edges; then the freest counts, the one with the greatest |y| (the least
constraint in Gauss's sense).
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet, choose, is_smooth
from cagepose.kernels.contact.coulomb import allowed_error, coulomb_motion_along, coulomb_onset
from cagepose.kernels.contact.edges import (
    CHOICES_LIMIT,
    EVERY,
    ONLY_CARRYING,
    first_choice,
    has_one_choice,
    keep_choice,
)
from cagepose.kernels.contact.equilibrium import (
    AT_REST,
    MOVES,
    MOVES_SOMEHOW,
    equilibrium,
    equilibrium_of_choice,
    is_balance,
    least_residual,
    next_choice_unlocked,
    return_to_choice,
)
from cagepose.kernels.contact.metric import Frame, twist_of
from cagepose.kernels.contact.on_circle import MOST_ADDED_POINTS, add_on_circles, drop_idle, keeps_on_circle
from cagepose.kernels.contact.self_stress import begin_unlocked, carry_by_locked, forget_locked
from cagepose.kernels.contact.tip import tips_on_circle
from cagepose.kernels.contact.tolerances import FASTER_MOTION, LEAST_ALONG
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel


@kernel
def motion_with_faces(
    contacts: ContactSet, friction: float, b: FloatArray, y: FloatArray, work: ContactWorkspace
) -> bool:
    """Write the motion that a load begins which these faces do not balance, and the forces; False: none was found."""
    for k in range(contacts.n_freedoms):
        y[k] = work.cone.passive.residual[k]
    return friction == 0.0 or coulomb_onset(contacts, friction, b, work.cone, y, work.newton, work.pivots)


@kernel
def freest_motion(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> int:
    """Go on from `equilibrium` where it says MOVES: find the motion that begins; MOVES_SOMEHOW: none was found.

    Filled: which faces are chosen, their forces, and in ``work`` the motion y and the residual.
    """
    code, fastest, left, one_choice = MOVES, -1.0, 0.0, has_one_choice(contacts)
    for _ in range(CHOICES_LIMIT):
        if code == MOVES:
            solved = motion_with_faces(contacts, friction, work.load, work.trial, work)
            speed = length(work.trial, contacts.n_freedoms) if solved else 0.0
            if speed > fastest * FASTER_MOTION:
                fastest, left = speed, work.residual
                for k in range(contacts.n_freedoms):
                    work.y[k] = work.trial[k] if solved else 0.0
                keep_choice(contacts)
        if one_choice or not next_choice_unlocked(contacts, ONLY_CARRYING, work):
            break
        code = equilibrium_of_choice(contacts, frame, friction, AT_REST, work)
    else:
        return MOVES_SOMEHOW
    if not one_choice:
        return_to_choice(contacts, frame, friction, AT_REST, work)
        if work.has_locked:
            motion_with_faces(contacts, friction, work.load, work.trial, work)
    work.residual = left
    return MOVES if fastest > 0.0 else MOVES_SOMEHOW


@kernel
def onset(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> int:
    """Solve the onset of motion at a pose; return its code.

    Filled: which faces are chosen, their forces, and in ``work`` the motion y (zero if held) and the residual.
    """
    for k in range(contacts.n_freedoms):
        work.y[k] = 0.0
    code = equilibrium(contacts, frame, friction, AT_REST, work)
    if code == MOVES:
        code = freest_motion(contacts, frame, friction, work)
        for _ in range(MOST_ADDED_POINTS):
            if code != MOVES or friction == 0.0 or not add_on_circles(contacts, frame, 0.0, work.y, work.load_terms):
                break
            forget_locked(contacts, work)
            code = equilibrium(contacts, frame, friction, AT_REST, work)
            if code == MOVES:
                code = freest_motion(contacts, frame, friction, work)
        if code == MOVES_SOMEHOW and friction > 0.0 and tips_on_circle(contacts, frame, friction, work):
            code = MOVES
        if work.locked.used > 0:
            carry_by_locked(contacts, friction, work)
    drop_idle(contacts, work.cone)
    return code


@kernel
def cosine(y: FloatArray, other: FloatArray, n: int) -> float:
    """Return that of the angle between two scaled motions, both of which are some."""
    return inner(y, other, n) / (length(y, n) * length(other, n))


@kernel
def motion_along(
    contacts: ContactSet, frame: Frame, friction: float, before: FloatArray, y: FloatArray, work: ContactWorkspace
) -> bool:
    """Find the motion of the listed contacts that goes on as the one before; see `goes_on`."""
    n, found, most, one_choice = contacts.n_freedoms, False, LEAST_ALONG, has_one_choice(contacts)
    terms, trial = work.load_terms, work.trial
    if not one_choice:
        begin_unlocked(contacts, work)
        first_choice(contacts)
        equilibrium_of_choice(contacts, frame, friction, AT_REST, work)
    for _ in range(CHOICES_LIMIT):
        if coulomb_motion_along(contacts, friction, work.load, terms, before, work.cone, trial, work.newton):
            along = cosine(trial, before, n)
            if along > most:
                found, most = True, along
                for k in range(n):
                    y[k] = trial[k]
                keep_choice(contacts)
        if one_choice or not next_choice_unlocked(contacts, ONLY_CARRYING, work):
            break
        equilibrium_of_choice(contacts, frame, friction, AT_REST, work)
    if found and not one_choice:
        return_to_choice(contacts, frame, friction, AT_REST, work)
        if work.has_locked:
            coulomb_motion_along(contacts, friction, work.load, terms, y, work.cone, trial, work.newton)
    return found


@kernel
def goes_on(
    contacts: ContactSet, frame: Frame, friction: float, before: FloatArray, y: FloatArray, work: ContactWorkspace
) -> bool:
    """Whether an object that friction could hold, as `equilibrium` says of it, and that moves, goes on: the motion y
    that obeys Coulomb's law as well, nearest to the one before (5.62). With edges it goes on if it does with any choice
    of faces; then the one counts with which it turns least.

    Filled: as by `onset`, but for y. If it does not go on, only the contacts are as they were: neither their forces nor
    which faces are chosen.
    """
    n_before, found = contacts.used[0], length(before, contacts.n_freedoms) > 0.0
    for _ in range(MOST_ADDED_POINTS):
        found = found and motion_along(contacts, frame, friction, before, y, work)
        if not found or not add_on_circles(contacts, frame, 0.0, y, work.load_terms):
            break
        forget_locked(contacts, work)
        equilibrium(contacts, frame, friction, AT_REST, work)
    if not found:
        contacts.used[0] = n_before
        return False
    if work.locked.used > 0:
        carry_by_locked(contacts, friction, work)
    drop_idle(contacts, work.cone)
    return True


@kernel
def holds_with_some_faces(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> bool:
    """Whether contacts, of which some are on edges, would hold the load in ``work`` with one of the choices of faces:
    an object that moves all the same does so only because of the edges. Asked before `onset`; the forces are lost.
    """
    if has_one_choice(contacts):
        return False
    for i in range(contacts.used[0]):  # what all faces at once do not hold, no choice does
        choose(contacts, i, True)
    left = least_residual(contacts, friction, work.load, work.load_terms, work)
    if not is_balance(contacts, left, friction, AT_REST, work):
        return False
    begin_unlocked(contacts, work)
    first_choice(contacts)
    holds = False
    for _ in range(CHOICES_LIMIT):
        holds = equilibrium_of_choice(contacts, frame, friction, AT_REST, work) != MOVES
        if holds or not next_choice_unlocked(contacts, EVERY, work):
            break
    forget_locked(contacts, work)
    return holds


@kernel
def find_sticking(
    contacts: ContactSet, frame: Frame, friction: float, touch_m: float, terms: float, y: FloatArray
) -> None:
    """Find which contacts carry and do not slip, and which rims stay flat, to the digits that `coulomb_onset` asks."""
    velocity, spin = twist_of(y, frame)
    n, allowed = contacts.n_freedoms, allowed_error(contacts, terms, y)
    for i in range(contacts.used[0]):
        columns, state = contacts.rows[i].columns, contacts.states[i]
        error = allowed * length(columns[0], n)
        state.stays_flat = keeps_on_circle(contacts, i, velocity, spin, touch_m, error)
        state.is_sticking = state.forces[0] > 0.0 and friction > 0.0 and not is_smooth(contacts, i)
        for j in range(1, 3):
            if abs(inner(columns[j], y, n) + contacts.rows[i].drift[j]) > allowed * length(columns[j], n):
                state.is_sticking = False
