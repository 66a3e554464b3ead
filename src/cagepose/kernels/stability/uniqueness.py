"""Is rest the only onset of motion that Coulomb's law allows? All contact modes are tried: equation (5.13).

Friction can hold an object that could as well begin to move. So for every combination of modes the conditions on
(motion, forces) are written as a system with non-negative unknowns, in which the motion is not zero (w . nu = 1) and
the load comes in at any scale tau. A combination without a solution is ruled out, and with it all that share it. Slip
directions are held in sectors, halved where that is too coarse, and cones in pyramids around them: whatever is ruled
out so is ruled out in truth.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import PassiveSet, System, clear, inner, length, nonnegative_least_squares
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb import coulomb_error, motion_left
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS, NewtonWorkspace, add_carrying, newton_on_modes
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.native.kernel import kernel

CONTACT_LIMIT = 4
"""More contacts than this: not tried."""
FIRST_SECTORS = 4
NARROWEST_RAD = 1e-4
"""A sector that is narrower is not halved again."""
GENERATORS = 24
"""Edges of the pyramid around a cone."""
SYSTEM_LIMIT = 4000
"""Systems after which the search is given up."""
WAITING = 1024
"""Combinations that may wait to be looked at."""
IMPOSSIBLE = 1e-7
"""A system that misses its right side (of length 1) by more has no solution."""
MOVES_AT_ALL = 1e-6
"""In lengths of the load: a slower motion is not told from rest."""
N_ROWS = 3 * CONTACT_LIMIT + 1
N_COLUMNS = 1 + CONTACT_LIMIT * (GENERATORS + 3)

UNIQUE, OTHER_FOUND, NOT_SHOWN = 0, 1, 2
"""Codes of the answer."""
UNDECIDED = -1


class ModesWorkspace:
    """Room for one search; a record.

    Attributes
    ----------
    contacts
        Contacts in question.
    modes, starts, widths
        What each does (-1: undecided) and, if it slips, from which angle on and over which.
    waiting_modes, waiting_starts, waiting_widths
        The same for the combinations still to be looked at.
    owners, directions
        Contact and tangent of each column that is a force, -1 where it is none.
    passive
        The system's solution.
    wrench
        One generator.
    y
        Scaled twist of a consistent onset, if one is found.
    """

    contacts: Annotated[IntArray, CONTACT_LIMIT]
    modes: Annotated[IntArray, CONTACT_LIMIT]
    starts: Annotated[FloatArray, CONTACT_LIMIT]
    widths: Annotated[FloatArray, CONTACT_LIMIT]
    waiting_modes: Annotated[IntArray, WAITING, CONTACT_LIMIT]
    waiting_starts: Annotated[FloatArray, WAITING, CONTACT_LIMIT]
    waiting_widths: Annotated[FloatArray, WAITING, CONTACT_LIMIT]
    owners: Annotated[IntArray, N_COLUMNS]
    directions: Annotated[FloatArray, N_COLUMNS, 2]
    passive: PassiveSet
    wrench: ScaledVector
    y: ScaledVector


@kernel
def write_velocity(
    contacts: ContactSet,
    n_rows: int,
    b: FloatArray,
    wrench: FloatArray,
    sign: float,
    out: FloatArray,
    room: ModesWorkspace,
) -> None:
    """Write what one scaled wrench adds to the velocities that the modes speak of, and to w . nu."""
    for place in range(n_rows):
        columns = contacts.rows[room.contacts[place]].columns
        mode = room.modes[place]
        size = length(columns[0], 6)
        for j in range(3):
            speaks = j == 0 or mode > OPENS
            out[3 * place + j] = sign * inner(columns[j], wrench, 6) / size if speaks else 0.0
    out[3 * n_rows] = sign * inner(b, wrench, 6) / length(b, 6)


@kernel
def add_force_column(
    contacts: ContactSet,
    n_rows: int,
    b: FloatArray,
    place: int,
    friction: float,
    angle: float,
    n_columns: int,
    room: ModesWorkspace,
    system: System,
) -> int:
    """Add the force along one generator of a cone; return the number of columns."""
    columns = contacts.rows[room.contacts[place]].columns
    one, two = math.cos(angle), math.sin(angle)
    for k in range(6):
        room.wrench[k] = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])
    write_velocity(contacts, n_rows, b, room.wrench, -1.0, system.columns[n_columns], room)
    room.owners[n_columns] = place
    room.directions[n_columns, 0], room.directions[n_columns, 1] = friction * one, friction * two
    return n_columns + 1


@kernel
def add_slack(
    n_rows: int, row: int, one: float, two: float, n_columns: int, room: ModesWorkspace, system: System
) -> int:
    """Add a column with two entries, at ``row`` and the one below; return the number of columns."""
    for k in range(3 * n_rows + 1):
        system.columns[n_columns, k] = 0.0
    system.columns[n_columns, row] = one
    system.columns[n_columns, row + 1] = two
    room.owners[n_columns] = -1
    return n_columns + 1


@kernel
def write_modes(
    contacts: ContactSet, n_rows: int, friction: float, b: FloatArray, room: ModesWorkspace, system: System
) -> int:
    """Write the system of the present modes; return the number of columns. Column 0 is the scale of the load."""
    write_velocity(contacts, n_rows, b, b, 1.0, system.columns[0], room)
    room.owners[0] = -1
    n_columns = 1
    around = friction / math.cos(math.pi / GENERATORS)
    for place in range(n_rows):
        mode = room.modes[place]
        if mode in (UNDECIDED, OPENS):
            n_columns = add_slack(n_rows, 3 * place, 1.0, 0.0, n_columns, room, system)
        if mode in (UNDECIDED, STICKS):
            for g in range(GENERATORS):
                angle = (g + 0.5) * 2.0 * math.pi / GENERATORS
                n_columns = add_force_column(contacts, n_rows, b, place, around, angle, n_columns, room, system)
        if mode == SLIPS:
            for side in range(2):
                angle = room.starts[place] + side * room.widths[place]
                n_columns = add_force_column(contacts, n_rows, b, place, friction, angle, n_columns, room, system)
                n_columns = add_slack(
                    n_rows, 3 * place + 1, -math.cos(angle), -math.sin(angle), n_columns, room, system
                )
            # The arc lies between its chord and the corner of the tangents at its ends.
            middle = room.starts[place] + 0.5 * room.widths[place]
            corner = friction / math.cos(0.5 * room.widths[place])
            n_columns = add_force_column(contacts, n_rows, b, place, corner, middle, n_columns, room, system)
    for k in range(3 * n_rows):
        system.right_side[k] = 0.0
    system.right_side[3 * n_rows] = 1.0
    return n_columns


@kernel
def is_possible(
    contacts: ContactSet, n_rows: int, friction: float, b: FloatArray, room: ModesWorkspace, system: System
) -> bool:
    """Whether the present modes are not ruled out."""
    n_columns = write_modes(contacts, n_rows, friction, b, room, system)
    clear(room.passive, 3 * n_rows + 1, 1.0)
    return nonnegative_least_squares(system, n_columns, room.passive) <= IMPOSSIBLE


@kernel
def is_witnessed(
    contacts: ContactSet, n_rows: int, friction: float, b: FloatArray, room: ModesWorkspace, newton: NewtonWorkspace
) -> bool:
    """Whether Newton's method from the solution of the system ends in a motion that obeys Coulomb's law.

    The forces of the contacts are those of that motion afterwards.
    """
    scale = 0.0
    for i in range(contacts.used[0]):
        for j in range(3):
            contacts.states[i].forces[j] = 0.0
    for k in range(room.passive.used):
        if room.passive.labels[k] == 0:
            scale = room.passive.x[k]
    if scale <= 0.0:
        return False
    for k in range(room.passive.used):
        label = room.passive.labels[k]
        place = room.owners[label]
        if place >= 0:
            share = room.passive.x[k] / scale
            forces = contacts.states[room.contacts[place]].forces
            forces[0] += share
            forces[1] += share * room.directions[label, 0]
            forces[2] += share * room.directions[label, 1]
    newton.n_carrying = 0
    for place in range(n_rows):
        if room.modes[place] != OPENS:
            add_carrying(newton, room.contacts[place], room.modes[place])
    motion_left(contacts, b, room.y)
    for attempt in range(2):
        if coulomb_error(contacts, friction, room.y) <= MOVES_AT_ALL * MOVES_AT_ALL * length(b, 6):
            return length(room.y, 6) > MOVES_AT_ALL * length(b, 6)
        if attempt == 0:
            newton_on_modes(contacts, friction, b, room.y, newton)
            motion_left(contacts, b, room.y)
    return False


@kernel
def put_aside(n_waiting: int, place: int, mode: int, start: float, width: float, room: ModesWorkspace) -> int:
    """Let the present combination wait, with another mode of one contact; return how many wait."""
    for k in range(CONTACT_LIMIT):
        room.waiting_modes[n_waiting, k] = room.modes[k]
        room.waiting_starts[n_waiting, k] = room.starts[k]
        room.waiting_widths[n_waiting, k] = room.widths[k]
    room.waiting_modes[n_waiting, place] = mode
    room.waiting_starts[n_waiting, place] = start
    room.waiting_widths[n_waiting, place] = width
    return n_waiting + 1


@kernel
def branch(n_rows: int, n_waiting: int, room: ModesWorkspace) -> int:
    """Divide the present combination: decide a contact, else halve the widest sector; return how many wait.

    -1: nothing is left to divide.
    """
    widest, width = -1, NARROWEST_RAD
    for place in range(n_rows):
        if room.modes[place] == UNDECIDED:
            sector = 2.0 * math.pi / FIRST_SECTORS
            for m in range(FIRST_SECTORS):
                n_waiting = put_aside(n_waiting, place, SLIPS, m * sector, sector, room)
            n_waiting = put_aside(n_waiting, place, STICKS, 0.0, 0.0, room)
            return put_aside(n_waiting, place, OPENS, 0.0, 0.0, room)
        if room.modes[place] == SLIPS and room.widths[place] > width:
            widest, width = place, room.widths[place]
    if widest < 0:
        return -1
    start, half = room.starts[widest], 0.5 * room.widths[widest]
    n_waiting = put_aside(n_waiting, widest, SLIPS, start, half, room)
    return put_aside(n_waiting, widest, SLIPS, start + half, half, room)


@kernel
def other_onset(
    contacts: ContactSet, friction: float, b: FloatArray, room: ModesWorkspace, newton: NewtonWorkspace, system: System
) -> int:
    """Return UNIQUE if Coulomb's law allows no onset but rest; OTHER_FOUND: one is in ``room``; or NOT_SHOWN.

    The forces of the contacts are lost.
    """
    n_rows = 0
    for i in range(contacts.used[0]):
        if contacts.states[i].chosen:
            if n_rows == CONTACT_LIMIT:
                return NOT_SHOWN
            room.contacts[n_rows] = i
            n_rows += 1
    for place in range(CONTACT_LIMIT):
        room.modes[place] = UNDECIDED
        room.starts[place] = room.widths[place] = 0.0
    n_waiting = branch(n_rows, 0, room)
    for _ in range(SYSTEM_LIMIT):
        if n_waiting == 0:
            return UNIQUE
        if n_waiting > WAITING - FIRST_SECTORS - 2:
            return NOT_SHOWN
        n_waiting -= 1
        n_undecided = 0
        for place in range(n_rows):
            room.modes[place] = room.waiting_modes[n_waiting, place]
            room.starts[place] = room.waiting_starts[n_waiting, place]
            room.widths[place] = room.waiting_widths[n_waiting, place]
            if room.modes[place] == UNDECIDED:
                n_undecided += 1
        if not is_possible(contacts, n_rows, friction, b, room, system):
            continue
        if n_undecided == 0 and is_witnessed(contacts, n_rows, friction, b, room, newton):
            return OTHER_FOUND
        n_waiting = branch(n_rows, n_waiting, room)
        if n_waiting < 0:
            return NOT_SHOWN
    return NOT_SHOWN
