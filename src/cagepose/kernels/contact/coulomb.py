"""Onset of motion with Coulomb friction: the forces and the motion that they leave, equations (5.7) and (5.8).

With De Saxce's correction, slip speeds s_i as costs of the normal forces,

    min 1/2 |b - A f|^2 + sum mu s_i f_n,i    over |f_t,i| <= mu f_n,i,

is convex: its motion y is unique, even where contacts share forces in many ways. Where its slip speeds are the s_i that
went in, it is Coulomb's law: without the correction a sliding contact would open at the rate mu s_i. The speeds are
found by iteration, and Newton's method on the modes that show takes it to rounding.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.cone import ConeWorkspace, clear_cone, cone_residual, steepest_tangent, write_forces
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb_newton import (
    SLIPS,
    STICKS,
    NewtonWorkspace,
    add_carrying,
    newton_on_modes,
)
from cagepose.kernels.contact.coulomb_pivots import PivotWorkspace, pivot_to_forces
from cagepose.kernels.contact.tolerances import (
    LEAST_SPEED_OF_LAW,
    LONGEST_MOTION,
    SLIP_TRIED_LAST,
    SLIP_TRIED_STICKING,
    SLOWEST_ALONG,
    VIOLATION_IN_LOADS,
    VIOLATION_OF_COULOMB,
)
from cagepose.kernels.native.kernel import kernel

SWEEPS = 60
FIRST_SWEEPS = 3
"""Newton's method is tried after each of the first sweeps, which mostly show the modes."""
SWEEPS_BETWEEN = 6
"""After them it is tried each time that so many sweeps have passed."""
ROUNDS_ALONG = 3
"""How often the iteration is begun from a motion: from the one before, then from those that Newton's method finds."""
SHARES_TRIED = (1.0, 0.03, 0.001)
"""Of the speed of the motion before. One that comes to its end is much slower, and where it is thought to be fast,
contacts that carry seem to open."""
TIMES_TURNED = 6
"""How often the sides of pyramids are turned to the slip."""


@kernel
def motion_left(contacts: ContactSet, b: FloatArray, y: FloatArray) -> None:
    """Write y = b - A f: the scaled twist that the contact forces leave of the load."""
    for k in range(contacts.n_freedoms):
        y[k] = b[k]
    for i in range(contacts.used[0]):
        if contacts.states[i].counts:
            for j in range(3):
                for k in range(contacts.n_freedoms):
                    y[k] -= contacts.rows[i].columns[j, k] * contacts.states[i].forces[j]


@kernel
def read_cone(contacts: ContactSet, friction: float, b: FloatArray, cone: ConeWorkspace, y: FloatArray) -> None:
    """Read forces and motion from the solution of the problem with round cones."""
    write_forces(cone, friction, contacts)
    motion_left(contacts, b, y)


@kernel
def coulomb_error(contacts: ContactSet, friction: float, y: FloatArray) -> float:
    """Return the greatest violation of Coulomb's law, as a velocity: going in, forces at an open contact, a cone left,
    or friction not along the slip, equation (5.7).
    """
    worst = 0.0
    for i in range(contacts.used[0]):
        if not contacts.states[i].counts:
            continue
        contact, forces = contacts.rows[i], contacts.states[i].forces
        size = length(contact.columns[0], contacts.n_freedoms)
        normal = inner(contact.columns[0], y, contacts.n_freedoms) + contact.drift[0]
        slip, one, two = steepest_tangent(contacts, i, y)
        worst = max(worst, normal / size, min(-normal / size, forces[0] * size), -forces[0] * size)
        tangential = math.sqrt(forces[1] * forces[1] + forces[2] * forces[2])
        worst = max(worst, (tangential - friction * forces[0]) * size)
        missing = friction * forces[0] - (forces[1] * one + forces[2] * two)
        worst = max(worst, min(slip / size, missing * size))
    return worst


@kernel
def allowed_error(contacts: ContactSet, terms: float, y: FloatArray) -> float:
    """Return which violation of the law, as a velocity, is rounding."""
    return VIOLATION_OF_COULOMB * max(length(y, contacts.n_freedoms), LEAST_SPEED_OF_LAW * terms)


@kernel
def obeys(contacts: ContactSet, friction: float, terms: float, y: FloatArray) -> bool:
    """Whether forces and motion obey Coulomb's law, but for a small part of the motion (or rounding of the load).

    The law takes power from the load, so that no motion is longer than that: one that is was made by Newton's method.
    """
    if length(y, contacts.n_freedoms) > LONGEST_MOTION * terms:
        return False
    return coulomb_error(contacts, friction, y) <= allowed_error(contacts, terms, y)


@kernel
def solves_with_modes(
    contacts: ContactSet, friction: float, b: FloatArray, terms: float, y: FloatArray, newton: NewtonWorkspace
) -> bool:
    """Whether Newton's method from the present forces, with the modes in ``newton``, ends in Coulomb's law."""
    newton_on_modes(contacts, friction, b, y, newton)
    motion_left(contacts, b, y)
    return obeys(contacts, friction, terms, y)


@kernel
def solves_by_pivoting(
    contacts: ContactSet,
    friction: float,
    b: FloatArray,
    terms: float,
    y: FloatArray,
    newton: NewtonWorkspace,
    pivots: PivotWorkspace,
) -> bool:
    """Whether Newton's method ends in Coulomb's law from what pyramids instead of cones say: first along the tangents,
    then turned to the slip that they said before.
    """
    for k in range(contacts.n_freedoms):
        pivots.turned_to[k] = 0.0
    for _ in range(TIMES_TURNED):
        if not pivot_to_forces(contacts, friction, b, pivots):
            return False
        motion_left(contacts, b, y)
        for k in range(contacts.n_freedoms):
            pivots.turned_to[k] = y[k]
        for slow in (SLIP_TRIED_STICKING, SLIP_TRIED_LAST):
            read_modes(contacts, slow * length(y, contacts.n_freedoms), y, newton)
            if solves_with_modes(contacts, friction, b, terms, y, newton):
                return True
    return False


@kernel
def read_modes(contacts: ContactSet, slow_speed: float, y: FloatArray, newton: NewtonWorkspace) -> None:
    """Read off which contacts stick and slip; the others open."""
    newton.n_carrying = 0
    for i in range(contacts.used[0]):
        if contacts.states[i].forces[0] > 0.0:
            size = length(contacts.rows[i].columns[0], contacts.n_freedoms)
            slips = steepest_tangent(contacts, i, y)[0] > slow_speed * size
            add_carrying(newton, i, SLIPS if slips else STICKS)


@kernel
def correct(
    contacts: ContactSet, friction: float, b: FloatArray, terms: float, y: FloatArray, cone: ConeWorkspace
) -> None:
    """Solve the problem with De Saxce's correction for the slip speeds of a motion, equation (5.8)."""
    for i in range(contacts.used[0]):
        contacts.states[i].slip_speed = steepest_tangent(contacts, i, y)[0] if contacts.states[i].counts else 0.0
    clear_cone(cone, b, contacts.n_freedoms, terms)
    cone.is_corrected = True
    cone_residual(contacts, friction, cone)


@kernel
def coulomb_motion_along(
    contacts: ContactSet,
    friction: float,
    b: FloatArray,
    terms: float,
    before: FloatArray,
    cone: ConeWorkspace,
    y: FloatArray,
    newton: NewtonWorkspace,
) -> bool:
    """Find forces and a motion that obey Coulomb's law near a motion, where rest may obey it as well (5.62); False:
    none was found, or none but rest.

    Parameters
    ----------
    contacts, friction, b, terms
        As in `coulomb_onset`; the length of the terms of the load.
    before
        The scaled motion before, at any speed.
    cone, newton
        Memory.
    y
        Filled: the one that was found, which must not be the memory of the one before.
    """
    n = contacts.n_freedoms
    for share in SHARES_TRIED:
        for k in range(n):
            y[k] = share * before[k]
        for _ in range(ROUNDS_ALONG):
            correct(contacts, friction, b, terms, y, cone)
            read_cone(contacts, friction, b, cone, y)
            if obeys(contacts, friction, terms, y):
                if length(y, n) > SLOWEST_ALONG * terms:
                    return True
                break  # at rest
            read_modes(contacts, SLIP_TRIED_STICKING * length(y, n), y, newton)
            solved = solves_with_modes(contacts, friction, b, terms, y, newton)
            is_motion = SLOWEST_ALONG * terms < length(y, n) <= LONGEST_MOTION * terms
            if solved and is_motion:
                return True
            if not is_motion:
                read_cone(contacts, friction, b, cone, y)
    return False


@kernel
def coulomb_onset(
    contacts: ContactSet,
    friction: float,
    b: FloatArray,
    cone: ConeWorkspace,
    y: FloatArray,
    newton: NewtonWorkspace,
    pivots: PivotWorkspace,
) -> bool:
    """Find forces and motion that obey Coulomb's law at every contact; False: none was found.

    Parameters
    ----------
    contacts, friction, b
        As in `cagepose.kernels.contact.cone.cone_residual`. The forces are part of the solution.
    cone
        Its solution without correction: where the iteration starts.
    y
        Filled: the scaled motion, (at least n_freedoms,).
    newton, pivots
        Memory.
    """
    terms = cone.passive.terms
    for turn in range(1, SWEEPS + 1):
        read_cone(contacts, friction, b, cone, y)
        if obeys(contacts, friction, terms, y):
            return True
        if turn <= FIRST_SWEEPS or turn % SWEEPS_BETWEEN == 0:
            slow = SLIP_TRIED_STICKING if turn % (2 * SWEEPS_BETWEEN) != 0 else SLIP_TRIED_LAST
            read_modes(contacts, slow * length(y, contacts.n_freedoms), y, newton)
            if solves_with_modes(contacts, friction, b, terms, y, newton):
                return True
            read_cone(contacts, friction, b, cone, y)
        correct(contacts, friction, b, terms, y, cone)
    if solves_by_pivoting(contacts, friction, b, terms, y, newton, pivots):
        return True
    read_cone(contacts, friction, b, cone, y)
    return coulomb_error(contacts, friction, y) <= VIOLATION_IN_LOADS * terms
