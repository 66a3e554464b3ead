"""A short proof that rest is the only onset: friction asked only of contacts that surely carry, (5.18) to (5.20).

Friction changes how much the contacts carry, but only so much: the part of the load that they take along their normals
is a projection, and moves by no more than the friction that pushes along the normals. Where a contact carries enough in
spite of that, whatever motion begins, and the friction of such contacts is enough for a balance, no other motion can
begin. Nothing is said where this does not succeed: then `cagepose.kernels.stability.uniqueness` searches.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import (
    PassiveSet,
    System,
    aim,
    append_column,
    clear,
    inner,
    length,
    nonnegative_least_squares,
    rounding_scale,
)
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.span import extend, write_complement, write_outside
from cagepose.kernels.contact.cone import HELD
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet
from cagepose.kernels.contact.metric import WRENCH, ScaledVector
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.second_order import IN_SPAN, StabilityWorkspace

SURELY = 1e-6
"""What a proof must have to spare, in lengths of the terms and in parts of the friction: a thousand times what rounding
can make of it."""


class BoundWorkspace:
    """Room for one proof; a record.

    Attributes
    ----------
    pressed
        z0, what the contacts take along their normals without friction: a scaled wrench.
    lever
        u of equation (5.19).
    carrying
        Contacts that carry without friction.
    contacts, limits
        Contacts that surely carry, and the friction mu f_n that each surely has.
    passive
        The solution of one system.
    """

    pressed: ScaledVector
    lever: ScaledVector
    carrying: Annotated[IntArray, WRENCH]
    contacts: Annotated[IntArray, WRENCH]
    limits: Annotated[FloatArray, WRENCH]
    passive: PassiveSet


@kernel
def pushing_part(contact: ContactRow, basis: PassiveSet) -> float:
    """Return the greatest part that a unit force along the tangents can have in the span of a basis."""
    one, two, both = 0.0, 0.0, 0.0
    for k in range(basis.used):
        first, second = inner(basis.basis[k], contact.columns[1], 6), inner(basis.basis[k], contact.columns[2], 6)
        one += first * first
        two += second * second
        both += first * second
    half = 0.5 * (one - two)
    return math.sqrt(0.5 * (one + two) + math.sqrt(half * half + both * both))


@kernel
def write_normals(contacts: ContactSet, friction: float, basis: PassiveSet, system: System) -> None:
    """Write for each contact its normal's wrench and, below it, tau of (5.19); zero for a face that is not chosen."""
    for i in range(contacts.used[0]):
        contact, column = contacts.rows[i], system.columns[i]
        for k in range(7):
            column[k] = 0.0
        if contacts.states[i].chosen:
            for k in range(6):
                column[k] = contact.columns[0, k]
            column[6] = friction * (pushing_part(contact, basis) + SURELY * length(column, 6))


@kernel
def greatest_shift(n_contacts: int, room: BoundWorkspace, system: System) -> float:
    """Return rho, by how much friction can move what the contacts take along their normals (5.19); inf: no bound.

    The shortest u with a_i . u >= tau_i comes from non-negative least squares (Lawson and Hanson's "least distance").
    """
    passive, u = room.passive, room.lever
    for k in range(6):
        system.right_side[k] = 0.0
    system.right_side[6] = 1.0
    clear(passive, WRENCH + 1, 1.0)
    nonnegative_least_squares(system, n_contacts, passive)
    if passive.residual[6] <= 0.0:
        return math.inf
    for k in range(6):
        u[k] = -passive.residual[k] / passive.residual[6]
    stretch = 1.0
    for i in range(n_contacts):
        if system.columns[i, 6] > 0.0:
            along = inner(system.columns[i], u, 6)
            if along <= 0.0:
                return math.inf
            stretch = max(stretch, system.columns[i, 6] / along)
    size = stretch * length(u, 6)
    return stretch * inner(u, room.pressed, 6) / (1.0 - size) if size < 1.0 else math.inf


@kernel
def least_force(
    contacts: ContactSet, place: int, n_carrying: int, shift: float, spare: float, room: BoundWorkspace, system: System
) -> float:
    """Return what one of the carrying contacts carries at least, whatever motion begins, equation (5.20); 0: perhaps
    nothing.
    """
    i, passive = room.carrying[place], room.passive
    column = system.columns[i]
    for k in range(6):
        column[k] = 0.0
        system.right_side[k] = room.pressed[k]
    clear(passive, WRENCH, length(room.pressed, 6))
    for other in range(n_carrying):  # most of them carry without it, too
        if other != place:
            append_column(passive, system.columns[room.carrying[other]], room.carrying[other], 0.0)
    apart = nonnegative_least_squares(system, contacts.used[0], passive)
    work = apart * (apart - shift)
    for j in range(contacts.used[0]):  # what rounding has left of the others' prices
        if system.columns[j, 6] > 0.0:
            work -= max(0.0, inner(system.columns[j], passive.residual, 6)) * shift / system.columns[j, 6]
    for k in range(6):
        column[k] = contacts.rows[i].columns[0, k]
    along = inner(column, passive.residual, 6)
    return work / along if apart > shift + spare and along > 0.0 else 0.0


@kernel
def find_carrying(contacts: ContactSet, friction: float, b: FloatArray, room: BoundWorkspace, system: System) -> int:
    """Find the contacts that carry whatever motion begins; return how many. The system holds all normals."""
    passive, n = room.passive, contacts.used[0]
    for k in range(6):
        system.right_side[k] = b[k]
    clear(passive, WRENCH, length(b, 6))
    nonnegative_least_squares(system, n, passive)
    spare = SURELY * rounding_scale(passive)
    n_carrying = passive.used
    for k in range(6):
        room.pressed[k] = b[k] - passive.residual[k]
    for k in range(n_carrying):
        room.carrying[k] = passive.labels[k]
    shift = greatest_shift(n, room, system)
    n_sure = 0
    for k in range(n_carrying):
        force = least_force(contacts, k, n_carrying, shift, spare, room, system) if shift < math.inf else 0.0
        if force > 0.0:
            room.contacts[n_sure], room.limits[n_sure] = room.carrying[k], friction * force
            n_sure += 1
    return n_sure


@kernel
def write_shared_friction(
    contacts: ContactSet,
    n_sure: int,
    b: FloatArray,
    n_free: int,
    free: FloatArray,
    room: BoundWorkspace,
    row: FloatArray,
) -> float:
    """Share what is left of the load off the span of the normals out among the sure contacts, in parts of their limits
    and with the least sum of squares; return the greatest part. ``passive.residual`` holds two for each contact.
    """
    passive, rows = room.passive, contacts.rows
    clear(passive, 2 * n_sure, 1.0)
    strength = 0.0
    for place in range(n_sure):
        strength += room.limits[place]
    for k in range(n_free):
        for place in range(n_sure):
            for j in range(2):
                tangent = rows[room.contacts[place]].columns[1 + j]
                row[2 * place + j] = room.limits[place] * inner(free[k], tangent, 6)
        if length(row, 2 * n_sure) > IN_SPAN * strength:
            append_column(passive, row, k, inner(free[k], b, 6))
    for k in range(2 * n_sure):
        row[k] = 0.0
    aim(passive, row)  # from zero, costs alone: the shortest vector g with row_k . g = cost_k
    greatest = 0.0
    for place in range(n_sure):
        one, two = passive.residual[2 * place], passive.residual[2 * place + 1]
        greatest = max(greatest, math.sqrt(one * one + two * two))
    return greatest


@kernel
def rest_is_unique(
    contacts: ContactSet,
    friction: float,
    b: FloatArray,
    terms: float,
    room: BoundWorkspace,
    rest: StabilityWorkspace,
    system: System,
) -> bool:
    """Whether rest is proven to be the only onset that Coulomb's law allows; False says nothing.

    Parameters
    ----------
    contacts, friction, b, terms
        The contacts (those that are chosen count), the coefficient, the scaled wrench of the load, (at least 6,), and
        the length of its terms.
    room, rest, system
        Room; what is held and free in ``rest`` is lost.
    """
    rows, n = contacts.rows, contacts.used[0]
    clear(rest.held, WRENCH, 1.0)
    for i in range(n):
        if contacts.states[i].chosen:
            extend(rest.held, rows[i].columns[0], IN_SPAN)
    write_normals(contacts, friction, rest.held, system)
    n_sure = find_carrying(contacts, friction, b, room, system)
    if n_sure == 0:
        return False
    n_free = write_complement(rest.held, rest.free)
    if write_shared_friction(contacts, n_sure, b, n_free, rest.free, room, system.right_side) > 1.0 - SURELY:
        return False
    left = room.pressed
    for k in range(6):
        left[k] = b[k]
        for place in range(n_sure):
            for j in range(2):
                part = room.limits[place] * room.passive.residual[2 * place + j]
                left[k] -= part * rows[room.contacts[place]].columns[1 + j, k]
    # Contacts that surely carry do not open, so their normals may take any part of the rest here, even a pull.
    clear(rest.held, WRENCH, 1.0)
    for place in range(n_sure):
        extend(rest.held, rows[room.contacts[place]].columns[0], IN_SPAN)
    for i in range(n):
        if contacts.states[i].chosen:
            write_outside(rest.held, rows[i].columns[0], IN_SPAN, system.columns[i])
    write_outside(rest.held, left, IN_SPAN, system.right_side)
    clear(room.passive, WRENCH, terms)
    return nonnegative_least_squares(system, n, room.passive) <= HELD * rounding_scale(room.passive)
