"""Onset of motion with Coulomb friction: the forces and the motion that they leave, equations (5.7) and (5.8).

With the slip speeds s_i charged to the generators of the cones (De Saxce),

    min 1/2 |b - A f|^2 + sum mu s_i f_n,i    over |f_t,i| <= mu f_n,i,

is convex: its motion y is unique, even where contacts share forces in many ways. Where its slip speeds are the s_i that
went in, it is Coulomb's law: without the charge a sliding contact would open at the rate mu s_i. The speeds are found
by iteration, and Newton's method on the modes that show takes it to rounding.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.contact.cone import ConeWorkspace, clear_cone, cone_residual, steepest_tangent, write_forces
from cagepose.kernels.contact.contact_set import ContactRow
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS, NewtonRoom, newton_on_modes
from cagepose.kernels.contact.metric import WRENCH
from cagepose.kernels.native.kernel import kernel

ROUNDS = 240
ROUNDS_UNDAMPED = 60
DAMPED = 0.4
"""Contacts that take turns in slipping meet half way if each goes only this part of its way."""
FIRST_ROUNDS, ROUNDS_BETWEEN = 3, 6
"""Newton's method is tried after each of the first rounds, which mostly show the modes, and then after so many."""
OBEYS, LAST_RESORT = 1e-9, 1e-6
"""In lengths of the motion: the greatest violation of Coulomb's law. Where that is not reached, in lengths of the load:
it bends the path by far less than a step does."""
ROUNDING = 1e-5
"""In lengths of the load: the violation of the law by a motion slower than this is measured as if it were as fast."""
SLOW, SLOWEST = 1e-6, 1e-10
"""In lengths of the motion: a slower contact is tried as one that sticks, first with the one limit, then the other."""
ENUMERATED = 5
"""Contacts up to which all combinations of modes are tried if the iteration goes round in circles: 243."""


@kernel
def motion_left(rows: Rows[ContactRow], n_contacts: int, b: FloatArray, y: FloatArray) -> None:
    """Write y = b - A f: the scaled twist that the contact forces leave of the load."""
    for k in range(6):
        y[k] = b[k]
    for i in range(n_contacts):
        if rows[i].chosen:
            for j in range(3):
                for k in range(6):
                    y[k] -= rows[i].columns[j, k] * rows[i].forces[j]


@kernel
def keep_forces(rows: Rows[ContactRow], n_contacts: int) -> None:
    for i in range(n_contacts):
        for j in range(3):
            rows[i].kept_forces[j] = rows[i].forces[j]


@kernel
def put_forces_back(rows: Rows[ContactRow], n_contacts: int) -> None:
    for i in range(n_contacts):
        for j in range(3):
            rows[i].forces[j] = rows[i].kept_forces[j]


@kernel
def coulomb_error(rows: Rows[ContactRow], n_contacts: int, friction: float, y: FloatArray) -> float:
    """Return the greatest violation of Coulomb's law, as a velocity: going in, forces at an open contact, a cone left,
    or friction not along the slip, equation (5.7).
    """
    worst = 0.0
    for i in range(n_contacts):
        if not rows[i].chosen:
            continue
        forces = rows[i].forces
        size = length(rows[i].columns[0], 6)
        normal = inner(rows[i].columns[0], y, 6)
        slip, one, two = steepest_tangent(rows[i], y)
        worst = max(worst, normal / size, min(-normal / size, forces[0] * size), -forces[0] * size)
        tangential = math.sqrt(forces[1] * forces[1] + forces[2] * forces[2])
        worst = max(worst, (tangential - friction * forces[0]) * size)
        missing = friction * forces[0] - (forces[1] * one + forces[2] * two)
        worst = max(worst, min(slip / size, missing * size))
    return worst


@kernel
def allowed_error(terms: float, y: FloatArray) -> float:
    """Return which violation of the law, as a velocity, is rounding."""
    return OBEYS * max(length(y, 6), ROUNDING * terms)


@kernel
def obeys(rows: Rows[ContactRow], n_contacts: int, friction: float, terms: float, y: FloatArray) -> bool:
    """Whether forces and motion obey Coulomb's law, but for a small part of the motion (or rounding of the load)."""
    return coulomb_error(rows, n_contacts, friction, y) <= allowed_error(terms, y)


@kernel
def solves_with_modes(
    rows: Rows[ContactRow],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    terms: float,
    y: FloatArray,
    room: NewtonRoom,
) -> bool:
    """Try Newton's method from the kept forces; without success they are put back."""
    newton_on_modes(rows, n_contacts, friction, b, y, room)
    motion_left(rows, n_contacts, b, y)
    if obeys(rows, n_contacts, friction, terms, y):
        return True
    put_forces_back(rows, n_contacts)
    motion_left(rows, n_contacts, b, y)
    return False


@kernel
def solves_with_any_modes(
    rows: Rows[ContactRow],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    terms: float,
    y: FloatArray,
    room: NewtonRoom,
) -> bool:
    """Try all combinations of modes, for few contacts."""
    n_chosen = 0
    for i in range(n_contacts):
        if rows[i].chosen:
            n_chosen += 1
    if n_chosen > ENUMERATED:
        return False
    for combination in range(3**n_chosen):
        left = combination
        for i in range(n_contacts):
            rows[i].mode = OPENS
            if rows[i].chosen:
                rows[i].mode = left % 3
                left //= 3
        if solves_with_modes(rows, n_contacts, friction, b, terms, y, room):
            return True
    return False


@kernel
def read_modes(rows: Rows[ContactRow], n_contacts: int, slow_speed: float, y: FloatArray) -> None:
    """Read off which contacts open, stick and slip, and keep the forces."""
    keep_forces(rows, n_contacts)
    for i in range(n_contacts):
        contact = rows[i]
        contact.mode = OPENS
        if contact.forces[0] > 0.0:
            slip = steepest_tangent(contact, y)[0]
            contact.mode = SLIPS if slip > slow_speed * length(contact.columns[0], 6) else STICKS


@kernel
def coulomb_onset(
    rows: Rows[ContactRow],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    cone: ConeWorkspace,
    y: FloatArray,
    newton: NewtonRoom,
) -> bool:
    """Find forces and motion that obey Coulomb's law at every contact; False: none was found.

    Parameters
    ----------
    rows, n_contacts, friction, b
        As in `cagepose.kernels.contact.cone.cone_residual`. The forces are part of the solution.
    cone
        Its solution without charge: where the iteration starts.
    y
        Filled: the scaled twist of the motion, (at least 6,).
    newton
        Room.
    """
    charged = True
    terms = cone.passive.terms
    for i in range(n_contacts):
        rows[i].slip = 0.0
    for turn in range(1, ROUNDS + 1):
        write_forces(cone, friction, rows, n_contacts)
        motion_left(rows, n_contacts, b, y)
        if obeys(rows, n_contacts, friction, terms, y):
            return True
        if turn <= FIRST_ROUNDS or turn % ROUNDS_BETWEEN == 0:
            slow = SLOW if turn % (2 * ROUNDS_BETWEEN) != 0 else SLOWEST
            read_modes(rows, n_contacts, slow * length(y, 6), y)
            if solves_with_modes(rows, n_contacts, friction, b, terms, y, newton):
                return True
        share = 1.0 if turn <= ROUNDS_UNDAMPED else DAMPED
        for i in range(n_contacts):
            slip = steepest_tangent(rows[i], y)[0] if rows[i].chosen else 0.0
            rows[i].slip += share * (slip - rows[i].slip)
        clear_cone(cone, b, WRENCH, terms)
        cone_residual(rows, n_contacts, friction, b, charged, cone)
    read_modes(rows, n_contacts, SLOW * length(y, 6), y)
    if solves_with_any_modes(rows, n_contacts, friction, b, terms, y, newton):
        return True
    return coulomb_error(rows, n_contacts, friction, y) <= LAST_RESORT * terms
