"""What happens from rest at one pose: the contacts hold the object, or it starts to move, equations (5.1) to (5.8).

On an edge one face that holds or leaves is enough, so every combination of faces is asked. The object moves if it
moves with any of them; then the freest counts, the one with the greatest |y| (the least constraint in Gauss's sense).
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import PassiveSet, append_column, clear, inner, length, rounding_scale
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.contact.cone import BALANCED, HELD, ConeWorkspace, clear_cone, cone_residual, write_forces
from cagepose.kernels.contact.contact_set import (
    ContactRow,
    ContactSet,
    choose_next_faces,
    keep_faces,
    put_best_faces_back,
)
from cagepose.kernels.contact.coulomb import allowed_error, coulomb_onset
from cagepose.kernels.contact.coulomb_newton import NewtonRoom
from cagepose.kernels.contact.metric import WRENCH, ScaledVector
from cagepose.kernels.native.kernel import kernel

HELD_WITHOUT_FRICTION, HELD_BY_FRICTION, UNSOLVED, MOVES = 0, 1, 2, 3
"""Codes of an onset, from the least to the most that moves."""
COMBINATIONS_LIMIT = 729
"""Of faces on edges that carry: six points on corners of the object."""

STRICTER = 0.1


class ContactWorkspace:
    """Room for one onset, and its answer; a record.

    Attributes
    ----------
    load, load_terms
        Given: the scaled wrench of the load, and the length of its terms (which may cancel).
    cone, newton
        See there.
    y, trial
        Scaled twist of the motion, and that of one combination of faces.
    span
        Basis of all that the carrying contacts can push along, if none of them slips.
    residual
        What the contacts leave of the load, in lengths of the terms: zero, to rounding, if the object is held.
    """

    load: ScaledVector
    load_terms: float
    cone: ConeWorkspace
    newton: NewtonRoom
    y: ScaledVector
    trial: ScaledVector
    span: PassiveSet
    residual: float


@kernel
def is_balance(
    rows: Rows[ContactRow], left: float, friction: float, strictness: float, scale: float, room: ContactWorkspace
) -> bool:
    """Whether a residual counts as zero: up to BALANCED, and where contacts slip up to HELD, in lengths of the terms.

    The part of it that slips at no contact (a swing about one that sticks) has nothing to do with the limit of
    friction, and has all its digits.
    """
    if left <= strictness * BALANCED * scale:
        return True
    if friction == 0.0 or left > strictness * HELD * scale:
        return False
    span, cone = room.span, room.cone
    clear(span, WRENCH, scale)
    for k in range(cone.passive.used):
        for j in range(3):
            append_column(span, rows[cone.contacts[cone.passive.labels[k]]].columns[j], k, 0.0)
    for k in range(6):
        span.target[k] = cone.passive.residual[k]
    for k in range(span.used):
        part = inner(span.basis[k], span.target, 6)
        for row in range(6):
            span.target[row] -= part * span.basis[k, row]
    return length(span.target, 6) <= strictness * BALANCED * scale


@kernel
def onset_with_faces(
    rows: Rows[ContactRow],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    terms: float,
    y: FloatArray,
    room: ContactWorkspace,
) -> int:
    """Solve the onset for one choice of faces; return its code. Forces and motion are filled."""
    cone = room.cone
    charged = False
    clear_cone(cone, b, WRENCH, terms)
    left = cone_residual(rows, n_contacts, 0.0, b, charged, cone)
    code = HELD_WITHOUT_FRICTION
    used = 0.0
    if friction > 0.0 and left > BALANCED * rounding_scale(cone.passive):
        used = friction
        clear_cone(cone, b, WRENCH, terms)
        left = cone_residual(rows, n_contacts, friction, b, charged, cone)
        code = HELD_BY_FRICTION
    write_forces(cone, used, rows, n_contacts)
    scale = rounding_scale(cone.passive)
    room.residual = left / scale if scale > 0.0 else 0.0
    for k in range(6):
        y[k] = cone.passive.residual[k]
    if is_balance(rows, left, used, 1.0, scale, room):
        return code
    if friction > 0.0 and not coulomb_onset(rows, n_contacts, friction, b, cone, y, room.newton):
        return UNSOLVED
    return MOVES


@kernel
def onset(contacts: ContactSet, friction: float, room: ContactWorkspace) -> int:
    """Solve the onset of motion at a pose; return its code.

    Filled: which faces are chosen, their forces, and in ``room`` the motion y (zero if held) and the residual.
    """
    rows, n_contacts = contacts.rows, contacts.used[0]
    best_code, best_speed, best_left = -1, -1.0, 0.0
    every = False
    for _ in range(COMBINATIONS_LIMIT):
        code = onset_with_faces(rows, n_contacts, friction, room.load, room.load_terms, room.trial, room)
        speed = length(room.trial, 6) if code == MOVES else 0.0
        if code > best_code or (code == best_code and speed > best_speed * (1.0 + 1e-9)):
            best_code, best_speed, best_left = code, speed, room.residual
            for k in range(6):
                room.y[k] = room.trial[k] if code == MOVES else 0.0
            keep_faces(contacts)
        if not choose_next_faces(contacts, every):
            break
    else:
        return UNSOLVED
    put_best_faces_back(contacts)
    room.residual = best_left
    return best_code


@kernel
def is_held(contacts: ContactSet, friction: float, room: ContactWorkspace) -> bool:
    """Whether the contacts hold the object, whichever faces count on edges.

    Asked more strictly than by `onset`, so that a pose found by halving a step is held when it is looked at again.
    """
    rows, n_contacts = contacts.rows, contacts.used[0]
    no = False
    for _ in range(COMBINATIONS_LIMIT):
        clear_cone(room.cone, room.load, WRENCH, room.load_terms)
        left = cone_residual(rows, n_contacts, friction, room.load, no, room.cone)
        write_forces(room.cone, friction, rows, n_contacts)
        scale = rounding_scale(room.cone.passive)
        if not is_balance(rows, left, friction, STRICTER, scale, room):
            return False
        if not choose_next_faces(contacts, no):
            return True
    return False


@kernel
def sticks(contact: ContactRow, friction: float, terms: float, y: FloatArray) -> bool:
    """Whether a contact carries and does not slip, to the digits that `coulomb_onset` asks of y."""
    if contact.forces[0] <= 0.0 or friction == 0.0:
        return False
    for j in range(1, 3):
        rate = inner(contact.columns[j], y, 6)
        if abs(rate) > allowed_error(terms, y) * length(contact.columns[j], 6):
            return False
    return True
