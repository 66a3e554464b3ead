"""Do contact forces balance a load? As a proof asks it: forces with some to spare, or a twist that none resists."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import length, rounding_scale
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.contact.cone import BALANCED, HELD, clear_cone, cone_residual, write_forces
from cagepose.kernels.contact.contact_set import (
    ContactRow,
    ContactSet,
    choose_first_faces,
    choose_next_faces,
    keep_faces,
    put_best_faces_back,
)
from cagepose.kernels.contact.metric import WRENCH
from cagepose.kernels.contact.onset import (
    COMBINATIONS_LIMIT,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    UNSOLVED,
    ContactWorkspace,
    is_balance,
)
from cagepose.kernels.contact.separation import separating_twist, step_to_balance
from cagepose.kernels.native.kernel import kernel

RESERVE = 1e-6
"""A balance that needs all but this part of the friction is at its limit."""


@kernel
def left_by_friction(rows: Rows[ContactRow], n_contacts: int, friction: float, room: ContactWorkspace) -> float:
    """Return what contact forces with this friction leave of the load, in lengths of the terms."""
    clear_cone(room.cone, room.load, WRENCH, room.load_terms)
    return left_from_less_friction(rows, n_contacts, friction, room)


@kernel
def left_from_less_friction(rows: Rows[ContactRow], n_contacts: int, friction: float, room: ContactWorkspace) -> float:
    """Return the same, going on from the solution in ``room``, which is that for less friction."""
    cone = room.cone
    charged = False
    left = cone_residual(rows, n_contacts, friction, room.load, charged, cone)
    scale = rounding_scale(cone.passive)
    return left / scale if scale > 0.0 else 0.0


@kernel
def take_forces(rows: Rows[ContactRow], n_contacts: int, friction: float, left: float, room: ContactWorkspace) -> None:
    write_forces(room.cone, friction, rows, n_contacts)
    room.residual = left


@kernel
def balance_with_faces(rows: Rows[ContactRow], n_contacts: int, friction: float, room: ContactWorkspace) -> int:
    """Return the code of the load in ``room`` for one choice of faces: MOVES where no forces balance it.

    Filled: forces, and the residual. Forces of a balance with friction lie inside the cones, not on them, where they
    can, so that no contact looks as if it were about to slip.
    """
    cone, spared = room.cone, (1.0 - RESERVE) * friction
    left = left_by_friction(rows, n_contacts, 0.0, room)
    take_forces(rows, n_contacts, 0.0, left, room)
    if left <= BALANCED:
        return HELD_WITHOUT_FRICTION
    if friction == 0.0:
        return MOVES
    if step_to_balance(rows, n_contacts, cone) > friction:
        if separating_twist(rows, n_contacts, friction, room.load, cone):
            room.residual = length(cone.passive.residual, 6) / rounding_scale(cone.passive)
            return MOVES
        clear_cone(cone, room.load, WRENCH, room.load_terms)  # its cones were wider
    left = left_from_less_friction(rows, n_contacts, spared, room)
    if left > BALANCED:
        left = left_by_friction(rows, n_contacts, friction, room)
        take_forces(rows, n_contacts, friction, left, room)
        scale = rounding_scale(cone.passive)
        if not is_balance(rows, left * scale, friction, 1.0, scale, room):
            return MOVES
        left = left_by_friction(rows, n_contacts, spared, room)
    if left <= HELD:
        take_forces(rows, n_contacts, spared, left, room)
    return HELD_BY_FRICTION


@kernel
def balance(contacts: ContactSet, friction: float, room: ContactWorkspace) -> int:
    """Return the code of the load in ``room``, whichever faces count on edges: MOVES as soon as it is not balanced.

    Filled: which faces are chosen, their forces, and the residual; for MOVES ``cone.passive.residual`` is a twist along
    which the load works and that no contact force resists (5.6). UNSOLVED: there are too many choices to ask them all;
    those that were asked hold.
    """
    rows, n_contacts = contacts.rows, contacts.used[0]
    best_code, best_left = -1, 0.0
    every = False
    for _ in range(COMBINATIONS_LIMIT):
        code = balance_with_faces(rows, n_contacts, friction, room)
        if code == MOVES:
            choose_first_faces(contacts)
            return MOVES
        if code > best_code:
            best_code, best_left = code, room.residual
            keep_faces(contacts)
        if not choose_next_faces(contacts, every):
            break
    else:
        best_code = UNSOLVED
    put_best_faces_back(contacts)
    room.residual = best_left
    return best_code
