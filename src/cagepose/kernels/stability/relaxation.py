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
    MOST_FREEDOMS,
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
from cagepose.kernels.contact.cone import write_generator
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.tolerances import (
    DEPENDENT_FORCE,
    POWER_OF_PROOF,
    POWER_OF_TWIST,
    POWER_WITHOUT_HELP,
    RESIDUAL_WITHOUT_CUT,
    ROUNDING_OF_RESIDUAL,
    SINE_AT_REST,
    WIDER_CONES,
)

CONTACT_LIMIT = 24
"""More contacts than this: not asked."""
MOST_WAYS = 6
"""A contact has at most so many velocities that are not allowed in one set of modes."""
UNDECIDED, CLOSED = -1, 4
"""Codes beside those of what a contact does. Whether it opens (OPENS, CLOSED) and whether it slips (STICKS, SLIPS) are
decided each by itself: feet on a floor slip one way, however many of them carry."""
CUT_LIMIT = 96
"""A node and those above it have at most so many twists that no force drives."""
VELOCITY_LIMIT = MOST_WAYS * CONTACT_LIMIT
N_COLUMNS = VELOCITY_LIMIT + CUT_LIMIT
N_VELOCITIES = 8
"""A contact has so many velocities that may not be allowed, each with a number of its own."""
INTO, AWAY, ANY_WAY, BEFORE, BEHIND = 0, 1, 2, 6, 7
"""Their numbers: into the other one, away from it, each of four ways along it, and before and behind a sector."""
QUARTER_TURNS = (1.0, 0.0, -1.0, 0.0, 1.0)
"""Entry k and the next one: the tangents of each of four ways along a contact."""
TWISTS_OF_NODE = 12
"""So many twists are looked for at one node; then it is divided, which tells more."""
MOST_GENERATORS = 80
BESIDE = -3
"""The place of the other load among those of forces; that of the load is -1."""


class Relaxation:
    """Workspace for one node, and its answer; a record.

    Attributes
    ----------
    n_freedoms
        As in `ContactSet`.
    n_places, contacts
        The contacts in question: a "place" is an index of this.
    wrenches
        Of each: scaled wrenches of its normal and its two tangents, the normal of length one.
    load, beside, has_beside
        Of length one; and another one that may act to any extent, if there is one.
    is_smooth
        Whether each has no friction.
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
    n_velocities, ways, n_cuts, cuts
        How many columns are velocities, which they are (N_VELOCITIES times the place, and a number), and the columns
        behind them.
    twist
        z of the proof.
    normal_forces, tangential_forces
        What makes the motion, as far as forces can.
    scale
        Of the load among them.
    """

    n_freedoms: int
    n_places: int
    contacts: Annotated[IntArray, CONTACT_LIMIT]
    is_smooth: Annotated[IntArray, CONTACT_LIMIT]
    wrenches: Annotated[FloatArray, CONTACT_LIMIT, 3, MOST_FREEDOMS]
    load: ScaledVector
    beside: ScaledVector
    has_beside: bool
    openings: Annotated[IntArray, CONTACT_LIMIT]
    slips: Annotated[IntArray, CONTACT_LIMIT]
    starts: Annotated[FloatArray, CONTACT_LIMIT]
    widths: Annotated[FloatArray, CONTACT_LIMIT]
    edges: Annotated[FloatArray, CONTACT_LIMIT, 2, 2]
    motion: PassiveSet
    forces: PassiveSet
    places: Annotated[IntArray, MOST_GENERATORS]
    directions: Annotated[FloatArray, MOST_GENERATORS, 2]
    generator: ScaledVector
    aimed: ScaledVector
    n_velocities: int
    ways: Annotated[IntArray, VELOCITY_LIMIT]
    n_cuts: int
    cuts: Annotated[FloatArray, CUT_LIMIT, MOST_FREEDOMS]
    twist: ScaledVector
    normal_forces: Annotated[FloatArray, CONTACT_LIMIT]
    tangential_forces: Annotated[FloatArray, CONTACT_LIMIT, 2]
    scale: float


@kernel
def take_contacts(contacts: ContactSet, b: FloatArray, work: Relaxation) -> bool:
    """Take the contacts that are chosen, and the load; False: too many."""
    work.n_freedoms, work.n_places, n = contacts.n_freedoms, 0, contacts.n_freedoms
    for i in range(contacts.used[0]):
        if not contacts.states[i].counts:
            continue
        place = work.n_places
        if place == CONTACT_LIMIT:
            return False
        columns = contacts.rows[i].columns
        size = length(columns[0], n)
        for j in range(3):
            for k in range(n):
                work.wrenches[place, j, k] = columns[j, k] / size
        work.contacts[place], work.is_smooth[place] = i, is_smooth(contacts, i)
        work.n_places += 1
    size = length(b, n)
    for k in range(n):
        work.load[k] = b[k] / size
    work.has_beside = False
    return True


@kernel
def write_edges(place: int, start: float, width: float, work: Relaxation) -> None:
    """Write from which angle on and over which a contact slips; most have their cosines from the node before."""
    if work.starts[place] == start and work.widths[place] == width:
        return
    work.starts[place], work.widths[place] = start, width
    for side in range(2):
        angle = start + side * width
        work.edges[place, side, 0], work.edges[place, side, 1] = math.cos(angle), math.sin(angle)


@kernel
def slip_along(place: int, vector: FloatArray, work: Relaxation) -> tuple[float, float]:
    """Return the tangential part of a scaled twist at a contact."""
    wrenches, n = work.wrenches[place], work.n_freedoms
    return inner(wrenches[1], vector, n), inner(wrenches[2], vector, n)


@kernel
def steepest_friction(place: int, vector: FloatArray, work: Relaxation) -> tuple[float, float, float]:
    """Return (how far the friction lies along a vector that lies most along it, its direction)."""
    one, two = slip_along(place, vector, work)
    size = math.sqrt(one * one + two * two)
    if work.slips[place] == SLIPS:
        first, last = work.edges[place, 0], work.edges[place, 1]
        if size == 0.0 or first[0] * two - first[1] * one < 0.0 or one * last[1] - two * last[0] < 0.0:
            at_first, at_last = one * first[0] + two * first[1], one * last[0] + two * last[1]
            if at_first >= at_last:
                return at_first, first[0], first[1]
            return at_last, last[0], last[1]
    if size == 0.0:
        return 0.0, 1.0, 0.0
    return size, one / size, two / size


@kernel
def most_driven(friction: float, vector: FloatArray, work: Relaxation) -> float:
    """Return the most that a unit normal force, with its friction, or a load turned round lies along a vector."""
    most = -inner(work.load, vector, work.n_freedoms)
    if work.has_beside:
        most = max(most, -inner(work.beside, vector, work.n_freedoms))
    for place in range(work.n_places):
        if work.openings[place] != OPENS:
            along = steepest_friction(place, vector, work)[0]
            most = max(most, inner(work.wrenches[place, 0], vector, work.n_freedoms) + friction * along)
    return most


@kernel
def add_velocity(
    place: int, which: int, normal: float, one: float, two: float, n: int, work: Relaxation, system: System
) -> int:
    """Add a velocity at a contact that is not allowed; return the number of columns."""
    wrenches, column = work.wrenches[place], system.columns[n]
    work.ways[n] = N_VELOCITIES * place + which
    for k in range(work.n_freedoms):
        column[k] = normal * wrenches[0, k] + one * wrenches[1, k] + two * wrenches[2, k]
    return n + 1


@kernel
def write_velocities(work: Relaxation, system: System) -> None:
    """Write the velocities that the modes do not allow."""
    n = 0
    for place in range(work.n_places):
        n = add_velocity(place, INTO, 1.0, 0.0, 0.0, n, work, system)
        if work.openings[place] == CLOSED:
            n = add_velocity(place, AWAY, -1.0, 0.0, 0.0, n, work, system)
        if work.slips[place] == STICKS:
            for turn in range(4):
                n = add_velocity(
                    place, ANY_WAY + turn, 0.0, QUARTER_TURNS[turn], QUARTER_TURNS[turn + 1], n, work, system
                )
        elif work.slips[place] == SLIPS:
            first, last = work.edges[place, 0], work.edges[place, 1]
            n = add_velocity(place, BEFORE, 0.0, first[1], -first[0], n, work, system)
            n = add_velocity(place, BEHIND, 0.0, -last[1], last[0], n, work, system)
    work.n_velocities = n


@kernel
def write_cuts(work: Relaxation, system: System) -> None:
    """Write the twists known from above behind the velocities."""
    for cut in range(work.n_cuts):
        for k in range(work.n_freedoms):
            system.columns[work.n_velocities + cut, k] = work.cuts[cut, k]


@kernel
def add_generator(friction: float, number: int, work: Relaxation) -> int:
    """Let the generator of cones a little wider in that lies most along the residual; return the next number.

    -1: there is none.
    """
    passive = work.forces
    best, most = -2, 0.0
    along = -inner(work.load, passive.residual, work.n_freedoms)
    if along > most:
        best, most = -1, along
    along = -inner(work.beside, passive.residual, work.n_freedoms) if work.has_beside else 0.0
    if along > most:
        best, most = BESIDE, along
    for place in range(work.n_places):
        if work.openings[place] == OPENS:
            continue
        along = steepest_friction(place, passive.residual, work)[0]
        used = (1.0 + WIDER_CONES) * friction if along > 0.0 else friction
        along = inner(work.wrenches[place, 0], passive.residual, work.n_freedoms) + used * along
        if along > most:
            best, most = place, along
    if best == -2 or number == MOST_GENERATORS:
        return -1
    work.places[number] = best
    for k in range(work.n_freedoms):
        work.generator[k] = -work.beside[k] if best == BESIDE else -work.load[k]
    if best >= 0:
        along, one, two = steepest_friction(best, passive.residual, work)
        used = (1.0 + WIDER_CONES) * friction if along > 0.0 else friction
        work.directions[number, 0], work.directions[number, 1] = used * one, used * two
        wrenches = work.wrenches[best]
        write_generator(wrenches, used, one, two, work.n_freedoms, work.generator)
    if append_column(passive, work.generator, number, 0.0):
        settle(passive)
    return number + 1 if label_is_passive(passive, number) else -1


@kernel
def find_cut(friction: float, work: Relaxation) -> bool:
    """Look for a twist that no force drives, and against which the motion goes; False: forces make the motion.

    Forces go on from those of the last motion.
    """
    passive, motion = work.forces, work.motion.residual
    size = length(motion, work.n_freedoms)
    for k in range(work.n_freedoms):
        work.aimed[k] = -motion[k] / size
    for k in range(passive.used):
        label = passive.labels[k]
        work.places[k] = work.places[label]
        work.directions[k, 0], work.directions[k, 1] = work.directions[label, 0], work.directions[label, 1]
        passive.labels[k] = k
    keep_above(passive, work.aimed, 0.0)
    number = work.n_freedoms
    while number >= 0:
        left = length(passive.residual, work.n_freedoms)
        if left <= RESIDUAL_WITHOUT_CUT:
            return False
        if most_driven(friction, passive.residual, work) <= POWER_OF_TWIST * left:
            return True
        number = add_generator(friction, number, work)
    return most_driven(friction, passive.residual, work) <= POWER_WITHOUT_HELP * length(
        passive.residual, work.n_freedoms
    )


@kernel
def keep_cut(work: Relaxation, system: System) -> bool:
    """Note the twist found; False: there are too many."""
    if work.n_cuts == CUT_LIMIT:
        return False
    passive, cut = work.forces, work.cuts[work.n_cuts]
    for k in range(passive.used):  # once more: across the forces in use to rounding of its own length
        part = inner(passive.basis[k], passive.residual, work.n_freedoms)
        for j in range(work.n_freedoms):
            passive.residual[j] -= part * passive.basis[k, j]
    size = length(passive.residual, work.n_freedoms)
    for k in range(work.n_freedoms):
        cut[k] = -passive.residual[k] / size
        system.columns[work.n_velocities + work.n_cuts, k] = cut[k]
    work.n_cuts += 1
    return True


@kernel
def is_proven(friction: float, work: Relaxation) -> bool:
    """Write z of the proof; return whether no force drives it, rounding included."""
    passive = work.motion
    for k in range(work.n_freedoms):
        work.twist[k] = work.aimed[k] = 0.0
    for j in range(passive.used):
        cut = passive.labels[j] - work.n_velocities
        if cut >= 0:
            for k in range(work.n_freedoms):
                work.twist[k] += passive.x[j] * work.cuts[cut, k]
                work.aimed[k] -= passive.x[j] * work.cuts[cut, k]
    return most_driven(friction, work.aimed, work) <= POWER_OF_PROOF


@kernel
def write_shares(work: Relaxation, ways: IntArray, shares: FloatArray) -> None:
    """Write of what velocities b - z of the proof, or of what is left of the load, is made: their places, as in
    `Relaxation.ways`, and shares, (n_freedoms,) each; -1: no more.
    """
    n = 0
    for j in range(work.motion.used):
        if work.motion.labels[j] < work.n_velocities:
            ways[n], shares[n] = work.ways[work.motion.labels[j]], work.motion.x[j]
            n += 1
    for k in range(n, work.n_freedoms):
        ways[k] = -1


@kernel
def drop_cuts(n_before: int, work: Relaxation) -> None:
    """Keep those of this node's twists that are in use."""
    n_kept = n_before
    for cut in range(n_before, work.n_cuts):
        if label_is_passive(work.motion, work.n_velocities + cut):
            for k in range(work.n_freedoms):
                work.cuts[n_kept, k] = work.cuts[cut, k]
            n_kept += 1
    work.n_cuts = n_kept


@kernel
def read_forces(work: Relaxation) -> None:
    passive = work.forces
    work.scale = 0.0
    for place in range(work.n_places):
        work.normal_forces[place] = work.tangential_forces[place, 0] = work.tangential_forces[place, 1] = 0.0
    for k in range(passive.used):
        label = passive.labels[k]
        place, x = work.places[label], passive.x[k]
        if place == -1:
            work.scale = x
        elif place >= 0:
            work.normal_forces[place] += x
            work.tangential_forces[place, 0] += x * work.directions[label, 0]
            work.tangential_forces[place, 1] += x * work.directions[label, 1]


@kernel
def begin(work: Relaxation, system: System) -> None:
    """Write what the present modes do not allow."""
    write_velocities(work, system)
    write_cuts(work, system)
    clear(work.motion, work.n_freedoms, 1.0)


@kernel
def start_from(ways: IntArray, work: Relaxation, system: System) -> None:
    """Let the solution begin with velocities that bounded the motion where less was decided."""
    for k in range(work.n_freedoms):
        for j in range(work.n_velocities if ways[k] >= 0 else 0):
            if work.ways[j] == ways[k]:
                append_column(work.motion, system.columns[j], j, 0.0)


@kernel
def is_impossible(friction: float, work: Relaxation, system: System) -> bool:
    """Whether it is proven that no motion can begin with the modes that were begun with; ``twist`` is the proof then.

    Else ``motion.residual`` and the forces are a motion of the convex problem, as far as it was solved.
    """
    n_before = work.n_cuts
    clear(work.forces, work.n_freedoms, 1.0)
    work.forces.dependent = DEPENDENT_FORCE
    for k in range(work.n_freedoms):
        system.right_side[k] = work.load[k]
    for _ in range(TWISTS_OF_NODE):
        left = nonnegative_least_squares(system, work.n_velocities + work.n_cuts, work.motion)
        if left + ROUNDING_OF_RESIDUAL * rounding_scale(work.motion) <= SINE_AT_REST:
            if is_proven(friction, work):
                return True
            break
        if not find_cut(friction, work) or not keep_cut(work, system):
            break
    read_forces(work)
    drop_cuts(n_before, work)
    return False
