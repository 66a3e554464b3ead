"""Onset of motion with Coulomb friction: the forces and the motion that they leave, equations (5.7) and (5.8).

With the slip speeds s_i charged to the generators of the cones (De Saxce),

    min 1/2 |b - A f|^2 + sum mu s_i f_n,i    over |f_t,i| <= mu f_n,i,

is convex: its motion y is unique, even where contacts share forces in many ways. Where its slip speeds are the s_i that
went in, it is Coulomb's law: without the charge a sliding contact would open at the rate mu s_i. The speeds are found
by iteration, and Newton's method on the modes that show takes it to rounding.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.cone import WRENCH, ConeRoom, clear_cone, cone_residual, steepest_tangent, write_forces
from cagepose.kernels.coulomb_newton import (
    OPENS,
    SLIPS,
    STICKS,
    NewtonRoom,
    empty_newton_room,
    newton_on_modes,
)
from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.least_squares import inner, length

ROUNDS = 240
ROUNDS_UNDAMPED = 60
DAMPED = 0.4
"""Contacts that take turns in slipping meet half way if each goes only this part of its way."""
ROUNDS_BETWEEN = 6
"""Rounds before Newton's method is tried (again)."""
OBEYS, LAST_RESORT = 1e-9, 1e-6
"""In lengths of the motion: the greatest violation of Coulomb's law. Where that is not reached, in lengths of the load:
it bends the path by far less than a step does."""
ROUNDING = 1e-5
"""In lengths of the load: the violation of the law by a motion slower than this is measured as if it were as fast."""
SLOW, SLOWEST = 1e-6, 1e-10
"""In lengths of the motion: a slower contact is tried as one that sticks, first with the one limit, then the other."""
ENUMERATED = 5
"""Contacts up to which all combinations of modes are tried if the iteration goes round in circles: 243."""


class CoulombRoom(NamedTuple):
    """Room for one problem: the forces before Newton's method, (n_contacts, 3), and what that needs."""

    kept: FloatArray
    newton: NewtonRoom


def empty_coulomb_room(n_contacts: int) -> CoulombRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return CoulombRoom(np.zeros((n_contacts, 3)), empty_newton_room(n_contacts))


@kernel
def motion_left(
    columns: FloatArray, chosen: NDArray[np.bool_], n_contacts: int, b: FloatArray, forces: FloatArray, y: FloatArray
) -> None:
    """Write y = b - A f: the scaled twist that the contact forces leave of the load."""
    for k in range(6):
        y[k] = b[k]
    for i in range(n_contacts):
        if chosen[i]:
            for j in range(3):
                for k in range(6):
                    y[k] -= columns[i, j, k] * forces[i, j]


@entry_kernel
def coulomb_error(
    columns: FloatArray, chosen: NDArray[np.bool_], n_contacts: int, friction: float, forces: FloatArray, y: FloatArray
) -> float:
    """Return the greatest violation of Coulomb's law, as a velocity: going in, forces at an open contact, a cone left,
    or friction not along the slip, equation (5.7).
    """
    worst = 0.0
    for i in range(n_contacts):
        if not chosen[i]:
            continue
        size = length(columns[i, 0], 6)
        normal = inner(columns[i, 0], y, 6)
        slip, one, two = steepest_tangent(columns[i], y)
        worst = max(worst, normal / size, min(-normal / size, forces[i, 0] * size), -forces[i, 0] * size)
        tangential = math.hypot(forces[i, 1], forces[i, 2])
        worst = max(worst, (tangential - friction * forces[i, 0]) * size)
        missing = friction * forces[i, 0] - (forces[i, 1] * one + forces[i, 2] * two)
        worst = max(worst, min(slip / size, missing * size))
    return worst


@kernel
def allowed_error(b: FloatArray, y: FloatArray) -> float:
    """Return which violation of the law, as a velocity, is rounding."""
    return OBEYS * max(length(y, 6), ROUNDING * length(b, 6))


@kernel
def obeys(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
) -> bool:
    """Whether forces and motion obey Coulomb's law, but for a small part of the motion (or rounding of the load)."""
    return coulomb_error(columns, chosen, n_contacts, friction, forces, y) <= allowed_error(b, y)


@kernel
def solves_with_modes(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
    room: CoulombRoom,
) -> bool:
    """Try Newton's method from the forces in ``room.kept``; without success they are put back."""
    newton_on_modes(columns, n_contacts, friction, b, forces, y, room.newton)
    motion_left(columns, chosen, n_contacts, b, forces, y)
    if obeys(columns, chosen, n_contacts, friction, b, forces, y):
        return True
    for i in range(n_contacts):
        for j in range(3):
            forces[i, j] = room.kept[i, j]
    motion_left(columns, chosen, n_contacts, b, forces, y)
    return False


@kernel
def solves_with_any_modes(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    forces: FloatArray,
    y: FloatArray,
    room: CoulombRoom,
) -> bool:
    """Try all combinations of modes, for few contacts."""
    n_chosen = 0
    for i in range(n_contacts):
        if chosen[i]:
            n_chosen += 1
    if n_chosen > ENUMERATED:
        return False
    for combination in range(3**n_chosen):
        left = combination
        for i in range(n_contacts):
            room.newton.modes[i] = OPENS
            if chosen[i]:
                room.newton.modes[i] = left % 3
                left //= 3
        if solves_with_modes(columns, chosen, n_contacts, friction, b, forces, y, room):
            return True
    return False


@kernel
def read_modes(
    columns: FloatArray, n_contacts: int, slow_speed: float, forces: FloatArray, y: FloatArray, room: CoulombRoom
) -> None:
    """Read off which contacts open, stick and slip, and keep the forces."""
    for i in range(n_contacts):
        for j in range(3):
            room.kept[i, j] = forces[i, j]
        room.newton.modes[i] = OPENS
        if forces[i, 0] > 0.0:
            slip = steepest_tangent(columns[i], y)[0]
            room.newton.modes[i] = SLIPS if slip > slow_speed * length(columns[i, 0], 6) else STICKS


@entry_kernel
def coulomb_onset(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    cone: ConeRoom,
    forces: FloatArray,
    y: FloatArray,
    room: CoulombRoom,
) -> bool:
    """Find forces and motion that obey Coulomb's law at every contact; False: none was found.

    Parameters
    ----------
    columns, chosen, n_contacts, friction, b
        As in `cagepose.kernels.cone.cone_residual`.
    cone
        Its solution without charge: where the iteration starts.
    forces, y
        The solution: (n_contacts, 3), and the scaled twist of the motion, (6,).
    room
        Room for ``n_contacts`` contacts.
    """
    charged = bool(np.bool_(True))
    for i in range(n_contacts):
        cone.slips[i] = 0.0
    for turn in range(1, ROUNDS + 1):
        write_forces(cone, n_contacts, friction, forces)
        motion_left(columns, chosen, n_contacts, b, forces, y)
        if obeys(columns, chosen, n_contacts, friction, b, forces, y):
            return True
        if turn % ROUNDS_BETWEEN == 0:
            slow = SLOW if turn % (2 * ROUNDS_BETWEEN) != 0 else SLOWEST
            read_modes(columns, n_contacts, slow * length(y, 6), forces, y, room)
            if solves_with_modes(columns, chosen, n_contacts, friction, b, forces, y, room):
                return True
        share = 1.0 if turn <= ROUNDS_UNDAMPED else DAMPED
        for i in range(n_contacts):
            slip = steepest_tangent(columns[i], y)[0] if chosen[i] else 0.0
            cone.slips[i] += share * (slip - cone.slips[i])
        clear_cone(cone, b, WRENCH)
        cone_residual(columns, chosen, n_contacts, friction, b, WRENCH, charged, cone)
    read_modes(columns, n_contacts, SLOW * length(y, 6), forces, y, room)
    if solves_with_any_modes(columns, chosen, n_contacts, friction, b, forces, y, room):
        return True
    return coulomb_error(columns, chosen, n_contacts, friction, forces, y) <= LAST_RESORT * length(b, 6)
