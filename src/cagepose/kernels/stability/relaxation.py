"""Can a motion begin in one set of contact modes? Coulomb's law made convex, and a proof if not: (5.18) to (5.20).

With the modes of some contacts given and others left open, the motions y that the contacts allow make a convex cone,
and so do those that the load, at any scale, and the contact forces can make. A motion takes power from the load: none
can begin if no y in both cones has b . y > 0. The y in both that lies most along b is the residual of non-negative
least squares on b; its columns are velocities that are not allowed, and twists z that no force drives, which are found
when they are wanted.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import (
    PassiveSet,
    System,
    append_column,
    clear,
    inner,
    keep_above,
    label_is_passive,
    length,
    nonnegative_least_squares,
    rounding_scale,
    settle,
)
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS
from cagepose.kernels.contact.metric import WRENCH, ScaledVector
from cagepose.kernels.native.kernel import kernel

CONTACT_LIMIT = 24
"""More contacts than this: not asked."""
UNDECIDED, CLOSED = -1, 3
"""Codes beside those of what a contact does. Whether it opens (OPENS, CLOSED) and whether it slips (STICKS, SLIPS) are
decided each by itself: feet on a floor slip one way, however many of them carry."""
CUT_LIMIT = 96
"""Twists that no force drives, of one node and of those above it."""
N_COLUMNS = 6 * CONTACT_LIMIT + CUT_LIMIT
ROUNDS = 12
"""Twists that are looked for at one node; then it is divided, which tells more."""
GENERATOR_LIMIT = 80

AT_REST = 5e-7
"""Sine of the angle that no motion has above those across the load: rest. One of v loads has at least v."""
ROUNDING = 1e-15
"""In lengths of the terms of the residual."""
WIDER = 1e-6
"""A twist is looked for that no force inside cones wider by this part drives, so that few generators are enough."""
DEPENDENT = 1e-13
"""Forces that depend on each other by less make no twist."""
DRIVEN = 1e-14
"""Of a twist and a wrench of unit length: less power is rounding."""
HARDLY_DRIVEN = 1e-10
"""The same where no generator helps any more, since they nearly depend on each other: what the proof makes of such a
twist may still be small enough."""
PROVEN = 5e-13
"""The same of z of the proof: with AT_REST, it leaves no motion above 1e-6 loads while forces add up to one load."""
NO_CUT = 1e-6
"""In lengths of the motion: what forces miss of it by less, they make."""


class Relaxation:
    """Room for one node, and its answer; a record.

    Attributes
    ----------
    n_places, contacts
        The contacts in question: a "place" is an index of this.
    wrenches
        Of each: scaled wrenches of its normal and its two tangents, the normal of length one.
    load
        Of length one.
    openings, slips, starts, widths, edges
        Whether each opens, whether it slips and, if so, from which angle on and over which, and the two tangents there.
    motion
        Least squares on the load: its residual is the motion. Label: a row of the system.
    forces
        Least squares on the motion, by a load (place -1) and forces.
    places, directions
        Place and tangential part of each generator of a force.
    generator, aimed
        One generator, and the motion turned round.
    n_velocities, n_cuts, cuts
        How many columns are velocities, and the columns behind them.
    twist
        z of the proof.
    normal_forces, tangential_forces
        What makes the motion, as far as forces can.
    scale
        Of the load among them.
    """

    n_places: int
    contacts: Annotated[IntArray, CONTACT_LIMIT]
    wrenches: Annotated[FloatArray, CONTACT_LIMIT, 3, 6]
    load: ScaledVector
    openings: Annotated[IntArray, CONTACT_LIMIT]
    slips: Annotated[IntArray, CONTACT_LIMIT]
    starts: Annotated[FloatArray, CONTACT_LIMIT]
    widths: Annotated[FloatArray, CONTACT_LIMIT]
    edges: Annotated[FloatArray, CONTACT_LIMIT, 2, 2]
    motion: PassiveSet
    forces: PassiveSet
    places: Annotated[IntArray, GENERATOR_LIMIT]
    directions: Annotated[FloatArray, GENERATOR_LIMIT, 2]
    generator: ScaledVector
    aimed: ScaledVector
    n_velocities: int
    n_cuts: int
    cuts: Annotated[FloatArray, CUT_LIMIT, 6]
    twist: ScaledVector
    normal_forces: Annotated[FloatArray, CONTACT_LIMIT]
    tangential_forces: Annotated[FloatArray, CONTACT_LIMIT, 2]
    scale: float


@kernel
def take_contacts(contacts: ContactSet, b: FloatArray, room: Relaxation) -> bool:
    """Take the contacts that are chosen, and the load; False: too many."""
    room.n_places = 0
    for i in range(contacts.used[0]):
        if not contacts.states[i].chosen:
            continue
        place = room.n_places
        if place == CONTACT_LIMIT:
            return False
        columns = contacts.rows[i].columns
        size = length(columns[0], WRENCH)
        for j in range(3):
            for k in range(6):
                room.wrenches[place, j, k] = columns[j, k] / size
        room.contacts[place] = i
        room.n_places += 1
    size = length(b, WRENCH)
    for k in range(6):
        room.load[k] = b[k] / size
    return True


@kernel
def write_edges(place: int, room: Relaxation) -> None:
    for side in range(2):
        angle = room.starts[place] + side * room.widths[place]
        room.edges[place, side, 0], room.edges[place, side, 1] = math.cos(angle), math.sin(angle)


@kernel
def slip_along(place: int, vector: FloatArray, room: Relaxation) -> tuple[float, float]:
    """Return the tangential part of a scaled twist at a contact."""
    return inner(room.wrenches[place, 1], vector, WRENCH), inner(room.wrenches[place, 2], vector, WRENCH)


@kernel
def steepest_friction(place: int, vector: FloatArray, room: Relaxation) -> tuple[float, float, float]:
    """Return (how far the friction lies along a vector that lies most along it, its direction)."""
    one, two = slip_along(place, vector, room)
    size = math.sqrt(one * one + two * two)
    if room.slips[place] == SLIPS:
        first, last = room.edges[place, 0], room.edges[place, 1]
        if size == 0.0 or first[0] * two - first[1] * one < 0.0 or one * last[1] - two * last[0] < 0.0:
            at_first, at_last = one * first[0] + two * first[1], one * last[0] + two * last[1]
            if at_first >= at_last:
                return at_first, first[0], first[1]
            return at_last, last[0], last[1]
    if size == 0.0:
        return 0.0, 1.0, 0.0
    return size, one / size, two / size


@kernel
def most_driven(friction: float, vector: FloatArray, room: Relaxation) -> float:
    """Return the most that a unit normal force, with its friction, or the load turned round lies along a vector."""
    most = -inner(room.load, vector, WRENCH)
    for place in range(room.n_places):
        if room.openings[place] != OPENS:
            along = steepest_friction(place, vector, room)[0]
            most = max(most, inner(room.wrenches[place, 0], vector, WRENCH) + friction * along)
    return most


@kernel
def add_velocity(place: int, normal: float, one: float, two: float, n: int, room: Relaxation, system: System) -> int:
    """Add a velocity at a contact that is not allowed; return the number of columns."""
    wrenches, column = room.wrenches[place], system.columns[n]
    for k in range(6):
        column[k] = normal * wrenches[0, k] + one * wrenches[1, k] + two * wrenches[2, k]
    return n + 1


@kernel
def write_velocities(room: Relaxation, system: System) -> None:
    """Write the velocities that the modes do not allow."""
    n = 0
    for place in range(room.n_places):
        n = add_velocity(place, 1.0, 0.0, 0.0, n, room, system)
        if room.openings[place] == CLOSED:
            n = add_velocity(place, -1.0, 0.0, 0.0, n, room, system)
        if room.slips[place] == STICKS:
            for sign in range(-1, 2, 2):
                n = add_velocity(place, 0.0, sign, 0.0, n, room, system)
                n = add_velocity(place, 0.0, 0.0, sign, n, room, system)
        elif room.slips[place] == SLIPS:
            first, last = room.edges[place, 0], room.edges[place, 1]
            n = add_velocity(place, 0.0, first[1], -first[0], n, room, system)
            n = add_velocity(place, 0.0, -last[1], last[0], n, room, system)
    room.n_velocities = n


@kernel
def write_cuts(room: Relaxation, system: System) -> None:
    """Write the twists known from above behind the velocities."""
    for cut in range(room.n_cuts):
        for k in range(6):
            system.columns[room.n_velocities + cut, k] = room.cuts[cut, k]


@kernel
def add_generator(friction: float, number: int, room: Relaxation) -> int:
    """Let the generator of cones a little wider in that lies most along the residual; return the next number.

    -1: there is none.
    """
    passive = room.forces
    best, most = -2, 0.0
    along = -inner(room.load, passive.residual, WRENCH)
    if along > most:
        best, most = -1, along
    for place in range(room.n_places):
        if room.openings[place] == OPENS:
            continue
        along = steepest_friction(place, passive.residual, room)[0]
        used = (1.0 + WIDER) * friction if along > 0.0 else friction
        along = inner(room.wrenches[place, 0], passive.residual, WRENCH) + used * along
        if along > most:
            best, most = place, along
    if best == -2 or number == GENERATOR_LIMIT:
        return -1
    room.places[number] = best
    for k in range(6):
        room.generator[k] = -room.load[k]
    if best >= 0:
        along, one, two = steepest_friction(best, passive.residual, room)
        used = (1.0 + WIDER) * friction if along > 0.0 else friction
        room.directions[number, 0], room.directions[number, 1] = used * one, used * two
        wrenches = room.wrenches[best]
        for k in range(6):
            room.generator[k] = wrenches[0, k] + used * (one * wrenches[1, k] + two * wrenches[2, k])
    if append_column(passive, room.generator, number, 0.0):
        settle(passive, room.aimed)
    return number + 1 if label_is_passive(passive, number) else -1


@kernel
def find_cut(friction: float, room: Relaxation) -> bool:
    """Look for a twist that no force drives, and against which the motion goes; False: forces make the motion.

    Forces go on from those of the last motion.
    """
    passive, motion = room.forces, room.motion.residual
    size = length(motion, WRENCH)
    for k in range(6):
        room.aimed[k] = -motion[k] / size
    for k in range(passive.used):
        label = passive.labels[k]
        room.places[k] = room.places[label]
        room.directions[k, 0], room.directions[k, 1] = room.directions[label, 0], room.directions[label, 1]
        passive.labels[k] = k
    keep_above(passive, room.aimed, 0.0)
    number = WRENCH
    while number >= 0:
        left = length(passive.residual, WRENCH)
        if left <= NO_CUT:
            return False
        if most_driven(friction, passive.residual, room) <= DRIVEN * left:
            return True
        number = add_generator(friction, number, room)
    return most_driven(friction, passive.residual, room) <= HARDLY_DRIVEN * length(passive.residual, WRENCH)


@kernel
def keep_cut(room: Relaxation, system: System) -> bool:
    """Note the twist found; False: there is no room."""
    if room.n_cuts == CUT_LIMIT:
        return False
    passive, cut = room.forces, room.cuts[room.n_cuts]
    for k in range(passive.used):  # once more: across the forces in use to rounding of its own length
        part = inner(passive.basis[k], passive.residual, WRENCH)
        for j in range(6):
            passive.residual[j] -= part * passive.basis[k, j]
    size = length(passive.residual, WRENCH)
    for k in range(6):
        cut[k] = -passive.residual[k] / size
        system.columns[room.n_velocities + room.n_cuts, k] = cut[k]
    room.n_cuts += 1
    return True


@kernel
def is_proven(friction: float, room: Relaxation) -> bool:
    """Write z of the proof; return whether no force drives it, rounding included."""
    passive = room.motion
    for k in range(6):
        room.twist[k] = room.aimed[k] = 0.0
    for j in range(passive.used):
        cut = passive.labels[j] - room.n_velocities
        if cut >= 0:
            for k in range(6):
                room.twist[k] += passive.x[j] * room.cuts[cut, k]
                room.aimed[k] -= passive.x[j] * room.cuts[cut, k]
    return most_driven(friction, room.aimed, room) <= PROVEN


@kernel
def drop_cuts(n_before: int, room: Relaxation) -> None:
    """Of the twists found at this node, keep those in use."""
    n_kept = n_before
    for cut in range(n_before, room.n_cuts):
        if label_is_passive(room.motion, room.n_velocities + cut):
            for k in range(6):
                room.cuts[n_kept, k] = room.cuts[cut, k]
            n_kept += 1
    room.n_cuts = n_kept


@kernel
def read_forces(room: Relaxation) -> None:
    passive = room.forces
    room.scale = 0.0
    for place in range(room.n_places):
        room.normal_forces[place] = room.tangential_forces[place, 0] = room.tangential_forces[place, 1] = 0.0
    for k in range(passive.used):
        label = passive.labels[k]
        place, x = room.places[label], passive.x[k]
        if place < 0:
            room.scale = x
        else:
            room.normal_forces[place] += x
            room.tangential_forces[place, 0] += x * room.directions[label, 0]
            room.tangential_forces[place, 1] += x * room.directions[label, 1]


@kernel
def is_impossible(friction: float, room: Relaxation, system: System) -> bool:
    """Whether it is proven that no motion can begin with the present modes; ``twist`` is the proof then.

    Else ``motion.residual`` and the forces are a motion of the convex problem, as far as it was solved.
    """
    n_before = room.n_cuts
    write_velocities(room, system)
    write_cuts(room, system)
    clear(room.motion, WRENCH, 1.0)
    clear(room.forces, WRENCH, 1.0)
    room.forces.dependent = DEPENDENT
    for k in range(6):
        system.right_side[k] = room.load[k]
    for _ in range(ROUNDS):
        left = nonnegative_least_squares(system, room.n_velocities + room.n_cuts, room.motion)
        if left + ROUNDING * rounding_scale(room.motion) <= AT_REST:
            if is_proven(friction, room):
                return True
            break
        if not find_cut(friction, room) or not keep_cut(room, system):
            break
    read_forces(room)
    drop_cuts(n_before, room)
    return False
