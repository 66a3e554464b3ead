"""Is rest the only onset of motion that Coulomb's law allows? Strong stability, by branch and bound: equation (5.13).

Friction can hold an object that could as well begin to move. Modes of contact are left undecided at first. A set of
modes in which the convex problem of `relaxation` has no motion is closed, and with it all that are more definite; else
the contact whose motion and force violate Coulomb's law most is decided: it opens or stays closed; it sticks or slips
in a quarter; a quarter is halved. All sets closed: rest is the only onset, and the tree with a twist for each of its
leaves is the proof. A motion that nearly obeys the law is taken to rounding by Newton's method: another onset.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, System, inner, length
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb import coulomb_error, motion_left
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS, NewtonWorkspace, add_carrying, newton_on_modes
from cagepose.kernels.contact.metric import Frame, ScaledVector
from cagepose.kernels.contact.on_circle import MOST_ADDED_POINTS, add_on_circles
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.relaxation import (
    CLOSED,
    UNDECIDED,
    Relaxation,
    begin,
    is_impossible,
    slip_along,
    start_from,
    take_contacts,
    write_edges,
    write_shares,
)
from cagepose.kernels.stability.tolerances import LEAST_MOTION, NARROWEST_SECTOR_RAD, SLIP_AT_REST, VIOLATION_TRIED

UNIQUE, OTHER_FOUND, NOT_SHOWN = 0, 1, 2
"""Codes of the answer."""
NODE_LIMIT = 20000
"""Sets of modes after which the search is given up."""
FIRST_SECTORS = 4
SHARE_OF_SECTOR = 0.4
"""Share of a sector. The slip that is seen first lies so far from its edge, so that halving does not put an edge there.
"""


class ModeTree:
    """The search, which is the proof if it ends without a motion; a record. Node 0 decides nothing.

    Attributes
    ----------
    n_nodes
        In use.
    parents, places, modes, starts, widths
        Of each node: the one that it divides, and what it decides of which contact.
    n_cuts
        Twists known from above.
    is_closed, twists
        Whether no motion can begin there, and z, which proves it.
    ways, shares
        Of what velocities that are not allowed b - z is made, as in `Relaxation.ways`, -1: no more, and how much of
        each. Where no proof was found: the same of what is left of the load.
    waiting
        Nodes still to be looked at.
    relaxation
        Of the present node.
    y
        Scaled twist of another onset, if one is found.
    """

    n_nodes: int
    parents: Annotated[IntArray, NODE_LIMIT]
    places: Annotated[IntArray, NODE_LIMIT]
    modes: Annotated[IntArray, NODE_LIMIT]
    starts: Annotated[FloatArray, NODE_LIMIT]
    widths: Annotated[FloatArray, NODE_LIMIT]
    n_cuts: Annotated[IntArray, NODE_LIMIT]
    is_closed: Annotated[IntArray, NODE_LIMIT]
    twists: Annotated[FloatArray, NODE_LIMIT, MOST_FREEDOMS]
    ways: Annotated[IntArray, NODE_LIMIT, MOST_FREEDOMS]
    shares: Annotated[FloatArray, NODE_LIMIT, MOST_FREEDOMS]
    waiting: Annotated[IntArray, NODE_LIMIT]
    relaxation: Relaxation
    y: ScaledVector


@kernel
def stand_at_node(node: int, tree: ModeTree) -> None:
    """Write the modes of a node: what it decides, and those above it of other contacts."""
    work = tree.relaxation
    for place in range(work.n_places):
        work.openings[place] = UNDECIDED
        work.slips[place] = STICKS if work.is_smooth[place] else UNDECIDED  # nothing is to be decided of no friction
    work.n_cuts = tree.n_cuts[node]
    while node > 0:
        place, mode = tree.places[node], tree.modes[node]
        if mode in (OPENS, CLOSED):
            work.openings[place] = mode
        elif work.slips[place] == UNDECIDED:
            work.slips[place] = mode
            if mode == SLIPS:
                write_edges(place, tree.starts[node], tree.widths[node], work)
        node = tree.parents[node]


@kernel
def opening_power(place: int, work: Relaxation) -> float:
    """Return the power by which a contact violates Coulomb's law: it carries and opens."""
    closing = inner(work.wrenches[place, 0], work.motion.residual, work.n_freedoms)
    power: float = max(0.0, -work.normal_forces[place] * closing)
    return power


@kernel
def slipping_power(friction: float, place: int, work: Relaxation) -> float:
    """Return the power by which a contact violates Coulomb's law: friction is not full, or not along the slip."""
    one, two = slip_along(place, work.motion.residual, work)
    full = friction * work.normal_forces[place] * math.sqrt(one * one + two * two)
    power: float = max(0.0, full - work.tangential_forces[place, 0] * one - work.tangential_forces[place, 1] * two)
    return power


@kernel
def worst_contact(friction: float, work: Relaxation) -> tuple[int, bool]:
    """Return (the contact to decide, whether it is to be decided if it opens): where Coulomb's law is violated most.

    Contact -1: all is decided, to the narrowest sector.
    """
    worst, is_opening, most = -1, False, -1.0
    for place in range(work.n_places):
        if work.openings[place] == OPENS:
            continue
        power = opening_power(place, work)
        if work.openings[place] == UNDECIDED and power > most:
            worst, is_opening, most = place, True, power
        power = slipping_power(friction, place, work)
        slips = work.slips[place]
        if power > most and (slips == UNDECIDED or (slips == SLIPS and work.widths[place] > NARROWEST_SECTOR_RAD)):
            worst, is_opening, most = place, False, power
    return worst, is_opening


@kernel
def add_node(parent: int, place: int, mode: int, start: float, width: float, n_waiting: int, tree: ModeTree) -> int:
    """Let a set of modes wait; return how many wait."""
    node = tree.n_nodes
    tree.parents[node], tree.places[node], tree.modes[node] = parent, place, mode
    tree.starts[node], tree.widths[node] = start, width
    tree.n_cuts[node], tree.is_closed[node] = tree.relaxation.n_cuts, 0
    tree.waiting[n_waiting] = node
    tree.n_nodes += 1
    return n_waiting + 1


@kernel
def divide(node: int, place: int, is_opening: bool, n_waiting: int, tree: ModeTree) -> int:
    """Decide more of one contact; return how many nodes wait. What the motion shows comes last: it is next."""
    work = tree.relaxation
    if is_opening:
        n_waiting = add_node(node, place, CLOSED, 0.0, 0.0, n_waiting, tree)
        return add_node(node, place, OPENS, 0.0, 0.0, n_waiting, tree)
    if work.slips[place] == SLIPS:
        start, half = work.starts[place], 0.5 * work.widths[place]
        n_waiting = add_node(node, place, SLIPS, start, half, n_waiting, tree)
        return add_node(node, place, SLIPS, start + half, half, n_waiting, tree)
    one, two = slip_along(place, work.motion.residual, work)
    sector = 2.0 * math.pi / FIRST_SECTORS
    start = math.atan2(two, one) - SHARE_OF_SECTOR * sector
    n_waiting = add_node(node, place, STICKS, 0.0, 0.0, n_waiting, tree)
    for m in range(FIRST_SECTORS, 0, -1):
        n_waiting = add_node(node, place, SLIPS, start + m * sector, sector, n_waiting, tree)
    return n_waiting


@kernel
def is_near(friction: float, work: Relaxation) -> bool:
    """Whether the motion of the convex problem nearly obeys Coulomb's law, and forces nearly make it."""
    if work.scale <= 0.0 or length(work.forces.residual, work.n_freedoms) > VIOLATION_TRIED:
        return False
    total = 0.0
    for place in range(work.n_places):
        total += opening_power(place, work) + slipping_power(friction, place, work)
    return total <= VIOLATION_TRIED * work.scale * inner(work.load, work.motion.residual, work.n_freedoms)


@kernel
def is_witnessed(contacts: ContactSet, friction: float, b: FloatArray, tree: ModeTree, newton: NewtonWorkspace) -> bool:
    """Whether Newton's method from the motion of the convex problem ends in one that obeys Coulomb's law.

    The forces of the contacts are those of that motion afterwards.
    """
    work = tree.relaxation
    for i in range(contacts.used[0]):
        for j in range(3):
            contacts.states[i].forces[j] = 0.0
    y, size = work.motion.residual, length(b, contacts.n_freedoms)
    slow = SLIP_AT_REST * length(y, contacts.n_freedoms)
    newton.n_carrying = 0
    for place in range(work.n_places):
        if work.normal_forces[place] <= 0.0:
            continue
        i = work.contacts[place]
        one, two = slip_along(place, y, work)
        add_carrying(newton, i, SLIPS if math.sqrt(one * one + two * two) > slow else STICKS)
        share = size / (work.scale * length(contacts.rows[i].columns[0], contacts.n_freedoms))
        contacts.states[i].forces[0] = share * work.normal_forces[place]
        contacts.states[i].forces[1] = share * work.tangential_forces[place, 0]
        contacts.states[i].forces[2] = share * work.tangential_forces[place, 1]
    motion_left(contacts, b, tree.y)
    newton_on_modes(contacts, friction, b, tree.y, newton)
    motion_left(contacts, b, tree.y)
    if coulomb_error(contacts, friction, tree.y) > LEAST_MOTION * LEAST_MOTION * size:
        return False
    return length(tree.y, contacts.n_freedoms) > LEAST_MOTION * size


@kernel
def other_onset(
    contacts: ContactSet, friction: float, b: FloatArray, tree: ModeTree, newton: NewtonWorkspace, system: System
) -> int:
    """Return UNIQUE if Coulomb's law allows no onset but rest; OTHER_FOUND: one is in ``tree``; or NOT_SHOWN.

    The forces of the contacts are lost.
    """
    if not take_contacts(contacts, b, tree.relaxation):
        return NOT_SHOWN
    return search_modes(contacts, friction, b, True, tree, newton, system)


@kernel
def search_modes(
    contacts: ContactSet,
    friction: float,
    b: FloatArray,
    is_tried: bool,
    tree: ModeTree,
    newton: NewtonWorkspace,
    system: System,
) -> int:
    """Search all sets of modes of contacts that are taken already; see `other_onset`. ``is_tried``: motions that come
    near to the law are tried as another onset.
    """
    work = tree.relaxation
    tree.n_nodes = work.n_cuts = 0
    n_waiting = add_node(-1, -1, UNDECIDED, 0.0, 0.0, 0, tree)
    while n_waiting > 0:
        n_waiting -= 1
        node = tree.waiting[n_waiting]
        stand_at_node(node, tree)
        begin(work, system)
        if node > 0:
            start_from(tree.ways[tree.parents[node]], work, system)
        is_closed = is_impossible(friction, work, system)
        write_shares(work, tree.ways[node], tree.shares[node])
        if is_closed:
            tree.is_closed[node] = 1
            for k in range(contacts.n_freedoms):
                tree.twists[node, k] = work.twist[k]
            continue
        if is_tried and is_near(friction, work) and is_witnessed(contacts, friction, b, tree, newton):
            return OTHER_FOUND
        place, is_opening = worst_contact(friction, work)
        if place < 0 or tree.n_nodes > NODE_LIMIT - FIRST_SECTORS - 1:
            return NOT_SHOWN
        n_waiting = divide(node, place, is_opening, n_waiting, tree)
    return UNIQUE


@kernel
def other_onset_on_circles(
    contacts: ContactSet,
    frame: Frame,
    friction: float,
    b: FloatArray,
    terms: float,
    tree: ModeTree,
    newton: NewtonWorkspace,
    system: System,
) -> int:
    """As `other_onset`, but no motion that goes into a rim that lies flat, between the points of it that are listed:
    the point where it does is appended.
    """
    for _ in range(MOST_ADDED_POINTS):
        answer = other_onset(contacts, friction, b, tree, newton, system)
        if answer != OTHER_FOUND or contacts.used[0] == len(contacts.rows):
            return answer if answer != OTHER_FOUND else NOT_SHOWN
        if not add_on_circles(contacts, frame, 0.0, tree.y, terms):
            return OTHER_FOUND
    return NOT_SHOWN
