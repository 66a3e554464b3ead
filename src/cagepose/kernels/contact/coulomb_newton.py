"""Newton's method on Coulomb's law once it is known which contacts open, stick and slip: equation (5.8).

Sweeps over the contacts find the modes soon and the digits late; with the modes known, the law is a smooth system of
equations in the motion y and the forces, and a few steps solve it to rounding.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.elimination import eliminate
from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, inner, length
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.cone import steepest_tangent
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth
from cagepose.kernels.contact.tolerances import LAST_CHANGE
from cagepose.kernels.native.kernel import kernel

STICKING_LIMIT = 12
"""More contacts than this that stick (or half as many again that slip): left to the sweeps."""
CARRYING_LIMIT = 3 * STICKING_LIMIT
UNKNOWNS = MOST_FREEDOMS + 3 * CARRYING_LIMIT
"""There is room for as many that stick as may carry: the rest of a mode has them all."""
MOST_NEWTON_STEPS = 8

OPENS, STICKS, SLIPS, SLIDES = 0, 1, 2, 3
"""Codes of what a contact does; one without friction slides."""


class NewtonWorkspace:
    """Memory for one system of n equations; a record.

    Attributes
    ----------
    n_carrying
        Contacts that do not open; -1: there are too many.
    contacts, modes, first_unknowns
        Each one's row, what it does, and the place of its normal force in the system.
    matrix
        The system, right side last.
    order, greatest_of
        Which unknown each column holds, and memory, see `eliminate`.
    changes
        What a step adds to each unknown.
    """

    n_carrying: int
    contacts: Annotated[IntArray, CARRYING_LIMIT]
    modes: Annotated[IntArray, CARRYING_LIMIT]
    first_unknowns: Annotated[IntArray, CARRYING_LIMIT]
    matrix: Annotated[FloatArray, UNKNOWNS, UNKNOWNS + 1]
    order: Annotated[IntArray, UNKNOWNS]
    greatest_of: Annotated[FloatArray, UNKNOWNS]
    changes: Annotated[FloatArray, UNKNOWNS]


@kernel
def add_carrying(newton: NewtonWorkspace, contact: int, mode: int) -> None:
    """Let one more contact carry: from ``n_carrying = 0`` on, in the order of their rows."""
    place = newton.n_carrying
    if 0 <= place < CARRYING_LIMIT:
        newton.contacts[place], newton.modes[place] = contact, mode
        newton.n_carrying = place + 1
    else:
        newton.n_carrying = -1


@kernel
def n_forces(mode: int) -> int:
    """Return how many unknown forces a contact has: one that slips has its normal force, and by how much its friction
    turns with the slip.
    """
    return 1 if mode == SLIDES else 2 if mode == SLIPS else 3


@kernel
def number_unknowns(contacts: ContactSet, y: FloatArray, newton: NewtonWorkspace) -> int:
    """Number the unknowns: those of the motion, one to three forces of each contact; return how many, -1: too many."""
    n = contacts.n_freedoms
    for place in range(newton.n_carrying):
        i = newton.contacts[place]
        if is_smooth(contacts, i):
            newton.modes[place] = SLIDES
        elif newton.modes[place] == SLIPS and steepest_tangent(contacts, i, y)[0] == 0.0:
            newton.modes[place] = STICKS  # a slip without direction
        newton.first_unknowns[place] = n
        n += n_forces(newton.modes[place])
        if n > contacts.n_freedoms + CARRYING_LIMIT:
            return -1
    return -1 if newton.n_carrying < 0 else n


@kernel
def write_system(
    contacts: ContactSet, friction: float, b: FloatArray, y: FloatArray, n: int, newton: NewtonWorkspace
) -> None:
    """Write the linear system of one step: balance of y, then one row for each velocity that is zero."""
    m, n_freedoms = newton.matrix, contacts.n_freedoms
    for i in range(n):
        for j in range(n + 1):
            m[i, j] = 0.0
    # balance of y
    for k in range(n_freedoms):
        m[k, k] = 1.0
        m[k, n] = b[k] - y[k]
    # the unknowns of each contact that carries
    for place in range(newton.n_carrying):
        i, first, mode = newton.contacts[place], newton.first_unknowns[place], newton.modes[place]
        columns, drift, forces = contacts.rows[i].columns, contacts.rows[i].drift, contacts.states[i].forces
        if mode != SLIPS:
            for j in range(n_forces(mode)):
                for k in range(n_freedoms):
                    m[k, first + j] = m[first + j, k] = columns[j, k]
                    m[k, n] -= columns[j, k] * forces[j]
                m[first + j, n] = -inner(columns[j], y, n_freedoms) - drift[j]
        else:
            # The friction across is that along, times the change of the slip across, over the slip. That as a factor in
            # the balance would be so great where the slip is slow that other equations seem singular beside it.
            slip, one, two = steepest_tangent(contacts, i, y)
            along = friction * forces[0]
            greater = max(abs(along), slip)
            for k in range(n_freedoms):
                generator = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])
                m[first, k] = columns[0, k]
                m[k, first] = generator
                m[k, n] -= generator * forces[0]
                m[k, first + 1] = two * columns[1, k] - one * columns[2, k]
                m[first + 1, k] = along / greater * m[k, first + 1]
            m[first + 1, first + 1] = -slip / greater
            m[first, n] = -inner(columns[0], y, n_freedoms) - drift[0]


@kernel
def add_changes(contacts: ContactSet, friction: float, y: FloatArray, n: int, newton: NewtonWorkspace) -> float:
    """Add what the last step found to the motion and to the forces; return the greatest change.

    The friction of a contact that slips turns as the step says, from the slip that the step began with: read off the
    new motion, it would have the rounding of that over the slip, and a slow slip under a great force makes much of it.
    """
    greatest, changes = 0.0, newton.changes
    for row in range(n):
        changes[newton.order[row]] = newton.matrix[row, n]
        greatest = max(greatest, abs(newton.matrix[row, n]))
    for place in range(newton.n_carrying):
        i, first, mode = newton.contacts[place], newton.first_unknowns[place], newton.modes[place]
        forces = contacts.states[i].forces
        if mode != SLIPS:
            for j in range(n_forces(mode)):
                forces[j] += changes[first + j]
        else:
            _, one, two = steepest_tangent(contacts, i, y)
            aside = changes[first + 1]
            forces[0] += changes[first]
            forces[1] = friction * forces[0] * one + aside * two
            forces[2] = friction * forces[0] * two - aside * one
    for k in range(contacts.n_freedoms):
        y[k] += changes[k]
    return greatest


@kernel
def newton_on_modes(
    contacts: ContactSet, friction: float, b: FloatArray, y: FloatArray, newton: NewtonWorkspace
) -> None:
    """Move forces and motion to the solution with the modes in ``newton``, if there is one near; the caller checks it.

    Contacts that open carry nothing afterwards.
    """
    n = number_unknowns(contacts, y, newton)
    if n < 0:
        return
    for _ in range(MOST_NEWTON_STEPS):
        write_system(contacts, friction, b, y, n, newton)
        eliminate(newton.matrix, newton.order, newton.greatest_of, n)
        if add_changes(contacts, friction, y, n, newton) <= LAST_CHANGE * length(b, contacts.n_freedoms):
            break
    let_open(contacts, newton)


@kernel
def let_open(contacts: ContactSet, newton: NewtonWorkspace) -> None:
    """Contacts that open carry nothing."""
    place = 0
    for i in range(contacts.used[0]):
        if place < newton.n_carrying and newton.contacts[place] == i:
            place += 1
            continue
        for j in range(3):
            contacts.states[i].forces[j] = 0.0
