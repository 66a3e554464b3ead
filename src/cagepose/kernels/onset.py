"""What happens from rest at one pose: the contacts hold the object, or it starts to move, equations (5.1) to (5.8).

On an edge one face that holds or leaves is enough, so every combination of faces is asked. The object moves if it
moves with any of them; then the freest counts, the one with the greatest |y| (the least constraint in Gauss's sense).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.cone import (
    BALANCED,
    HELD,
    WRENCH,
    ConeRoom,
    clear_cone,
    cone_residual,
    empty_cone_room,
    write_forces,
)
from cagepose.kernels.contact_set import ContactSet, choose_next_faces
from cagepose.kernels.coulomb import CoulombRoom, allowed_error, coulomb_onset, empty_coulomb_room
from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.least_squares import (
    PassiveSet,
    append_column,
    empty_passive_set,
    inner,
    length,
    rounding_scale,
)

HELD_WITHOUT_FRICTION, HELD_BY_FRICTION, UNSOLVED, MOVES = 0, 1, 2, 3
"""Codes of an onset, from the least to the most that moves."""
COMBINATIONS_LIMIT = 64
"""Of faces on edges: three points on corners of the object have 27."""

STRICTER = 0.1


class OnsetRoom(NamedTuple):
    """Room for one onset, and its answer.

    Attributes
    ----------
    cone, coulomb
        See there.
    y, trial
        Scaled twist of the motion, and that of one combination of faces, (6,).
    span
        Basis of all that the carrying contacts can push along, if none of them slips.
    best_chosen, best_forces
        Faces and forces of the answer so far, (n_contacts,) and (n_contacts, 3).
    residual
        What is left of the load, in lengths of its terms: zero, to rounding, if the object is held, (1,).
    """

    cone: ConeRoom
    coulomb: CoulombRoom
    y: FloatArray
    trial: FloatArray
    span: PassiveSet
    best_chosen: NDArray[np.bool_]
    best_forces: FloatArray
    residual: FloatArray


def empty_onset_room(n_contacts: int) -> OnsetRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return OnsetRoom(
        empty_cone_room(n_contacts),
        empty_coulomb_room(n_contacts),
        np.zeros(6),
        np.zeros(6),
        empty_passive_set(WRENCH),
        np.zeros(n_contacts, np.bool_),
        np.zeros((n_contacts, 3)),
        np.zeros(1),
    )


@kernel
def is_balance(
    columns: FloatArray, left: float, friction: float, strictness: float, scale: float, room: OnsetRoom
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
    span.used[0] = 0
    for k in range(cone.passive.used[0]):
        for j in range(3):
            append_column(span, columns[cone.contacts[cone.passive.labels[k]], j], j, 0.0, WRENCH)
    for k in range(6):
        span.target[k] = cone.passive.residual[k]
    for k in range(span.used[0]):
        part = inner(span.basis[k], span.target, 6)
        for row in range(6):
            span.target[row] -= part * span.basis[k, row]
    return length(span.target, 6) <= strictness * BALANCED * scale


@kernel
def onset_with_faces(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
    room: OnsetRoom,
) -> int:
    """Solve the onset for one choice of faces; return its code. Forces and motion are filled."""
    cone = room.cone
    charged = bool(np.bool_(False))
    clear_cone(cone, b, WRENCH)
    left = cone_residual(columns, chosen, n_contacts, 0.0, b, WRENCH, charged, cone)
    code = HELD_WITHOUT_FRICTION
    used = 0.0
    if friction > 0.0 and left > BALANCED * rounding_scale(cone.passive, b, 6):
        used = friction
        clear_cone(cone, b, WRENCH)
        left = cone_residual(columns, chosen, n_contacts, friction, b, WRENCH, charged, cone)
        code = HELD_BY_FRICTION
    write_forces(cone, n_contacts, used, forces)
    scale = rounding_scale(cone.passive, b, 6)
    for k in range(6):
        y[k] = cone.passive.residual[k]
    if is_balance(columns, left, used, 1.0, scale, room):
        room.residual[0] = left / scale if scale > 0.0 else 0.0
        return code
    if friction > 0.0 and not coulomb_onset(columns, chosen, n_contacts, friction, b, cone, forces, y, room.coulomb):
        return UNSOLVED
    return MOVES


@kernel
def onset(contacts: ContactSet, friction: float, b: FloatArray, room: OnsetRoom) -> int:
    """Solve the onset of motion at a pose; return its code.

    Filled: ``contacts.chosen`` and ``contacts.forces``, and in ``room`` the motion y (zero if held) and the residual.
    """
    n_contacts = contacts.used[0]
    best_code, best_speed = -1, -1.0
    for _ in range(COMBINATIONS_LIMIT):
        code = onset_with_faces(
            contacts.columns, contacts.chosen, n_contacts, friction, b, contacts.forces, room.trial, room
        )
        speed = length(room.trial, 6) if code == MOVES else 0.0
        if code > best_code or (code == best_code and speed > best_speed * (1.0 + 1e-9)):
            best_code, best_speed = code, speed
            for k in range(6):
                room.y[k] = room.trial[k] if code == MOVES else 0.0
            for i in range(n_contacts):
                room.best_chosen[i] = contacts.chosen[i]
                for j in range(3):
                    room.best_forces[i, j] = contacts.forces[i, j]
        if not choose_next_faces(contacts):
            break
    for i in range(n_contacts):
        contacts.chosen[i] = room.best_chosen[i]
        for j in range(3):
            contacts.forces[i, j] = room.best_forces[i, j]
    if best_code == MOVES:
        room.residual[0] = best_speed / length(b, 6)
    return best_code


@kernel
def is_held(contacts: ContactSet, friction: float, b: FloatArray, room: OnsetRoom) -> bool:
    """Whether the contacts hold the object, whichever faces count on edges.

    Asked more strictly than by `onset`, so that a pose found by halving a step is held when it is looked at again.
    """
    n_contacts = contacts.used[0]
    charged = bool(np.bool_(False))
    holds = True
    for _ in range(COMBINATIONS_LIMIT):
        clear_cone(room.cone, b, WRENCH)
        left = cone_residual(contacts.columns, contacts.chosen, n_contacts, friction, b, WRENCH, charged, room.cone)
        scale = rounding_scale(room.cone.passive, b, 6)
        holds = holds and is_balance(contacts.columns, left, friction, STRICTER, scale, room)
        if not choose_next_faces(contacts):
            break
    return holds


@kernel
def sticks(contacts: ContactSet, i: int, friction: float, b: FloatArray, y: FloatArray) -> bool:
    """Whether a contact carries and does not slip, to the digits that `coulomb_onset` asks of y."""
    if contacts.forces[i, 0] <= 0.0 or friction == 0.0:
        return False
    for j in range(1, 3):
        rate = 0.0
        for k in range(6):
            rate += contacts.columns[i, j, k] * y[k]
        if abs(rate) > allowed_error(b, y) * length(contacts.columns[i, j], 6):
            return False
    return True
