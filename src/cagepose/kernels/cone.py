"""Contact forces inside exact friction cones: min |b - A f| with |f_t| <= mu f_n, equations (5.4) to (5.6).

A cone has infinitely many generators n + mu d, d any unit tangent. The active-set method of `least_squares` needs only
the one that points most along the residual r, and that one is known in closed form: d = r_t / |r_t|. So cones stay
round, where a pyramid would be off by 1 - cos(pi / k), and at the end either the residual is zero, and the forces are
the proof of balance, or no generator points along it, and the residual is the proof that there is none.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.least_squares import (
    PRICE,
    PassiveSet,
    aim,
    append_column,
    empty_passive_set,
    exchange_column,
    inner,
    label_is_passive,
    length,
    rounding_scale,
    settle,
)

BALANCED = 1e-11
"""In lengths of the terms of the residual. Ten thousand times their rounding: rounding that a nearly dependent set of
contacts has magnified still counts as balance."""
HELD = 1e-9
"""The same at the limit of friction, where round cones leave more: rounding counts by its square root there."""
STEEPER = 1e-13
"""In lengths of the residual: a generator that points along it by so little more than one in use is no better."""
GENERATOR_LIMIT = 400
WRENCH, N_ROWS = 6, 7
"""A scaled wrench has 6 rows; the 7th, if it is used, adds up the normal forces."""


class ConeRoom(NamedTuple):
    """Room for one problem, and its solution.

    Attributes
    ----------
    passive
        The generators in use; their labels index the next two.
    contacts, directions
        Contact and tangent d of each generator, (n_generators,) and (n_generators, 2).
    slips
        Slip speed of each contact that its generators are charged for, (n_contacts,): zero for balance (5.4), see
        `cagepose.kernels.coulomb` for (5.7).
    column
        One generator, (7,).
    rejected
        Contacts whose generator did not help, (n_contacts,).
    """

    passive: PassiveSet
    contacts: NDArray[np.int64]
    directions: FloatArray
    slips: FloatArray
    column: FloatArray
    rejected: NDArray[np.bool_]


def empty_cone_room(n_contacts: int) -> ConeRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return ConeRoom(
        empty_passive_set(N_ROWS),
        np.zeros(GENERATOR_LIMIT, np.int64),
        np.zeros((GENERATOR_LIMIT, 2)),
        np.zeros(n_contacts),
        np.zeros(N_ROWS),
        np.zeros(n_contacts, np.bool_),
    )


@kernel
def steepest_tangent(columns: FloatArray, vector: FloatArray) -> tuple[float, float, float]:
    """Return (length of the tangential part of a scaled twist at a contact, its direction)."""
    one = inner(columns[1], vector, 6)
    two = inner(columns[2], vector, 6)
    size = math.hypot(one, two)
    if size == 0.0:
        return 0.0, 1.0, 0.0
    return size, one / size, two / size


@kernel
def write_generator(columns: FloatArray, friction: float, one: float, two: float, out: FloatArray) -> None:
    for k in range(6):
        out[k] = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])


@kernel
def clear_cone(room: ConeRoom, b: FloatArray, n_rows: int) -> None:
    """Start from no force."""
    room.passive.used[0] = 0
    aim(room.passive, b, n_rows)


@kernel
def generator_price(
    columns: FloatArray, contact: int, friction: float, n_rows: int, charged: bool, room: ConeRoom
) -> tuple[float, bool]:
    """Return how far the steepest generator of a contact lies along the residual r, and whether the contact has one.

    A generator in use lies across r (but for its charge), so for another of the same contact only the angle between
    their tangents counts: mu |r_t| (1 - cos), which has its digits however small it is.
    """
    passive = room.passive
    slip, one, two = steepest_tangent(columns, passive.residual)
    nearest = math.inf
    for k in range(passive.used[0]):
        label = passive.labels[k]
        if room.contacts[label] == contact:
            across = one * room.directions[label, 1] - two * room.directions[label, 0]
            along = one * room.directions[label, 0] + two * room.directions[label, 1]
            apart = across * across / (1.0 + along) if along > 0.0 else 1.0 - along
            nearest = min(nearest, apart)
    if nearest < math.inf:
        return friction * slip * nearest, True
    price = inner(columns[0], passive.residual, 6) + friction * slip
    if n_rows == N_ROWS:
        price += passive.residual[N_ROWS - 1]
    return (price - friction * room.slips[contact] if charged else price), False


@entry_kernel
def cone_residual(
    columns: FloatArray,
    chosen: NDArray[np.bool_],
    n_contacts: int,
    friction: float,
    b: FloatArray,
    n_rows: int,
    charged: bool,
    room: ConeRoom,
) -> float:
    """Return the least |b - sum of contact forces|, going on from the forces in ``room``.

    Parameters
    ----------
    columns
        Scaled wrenches along normal and tangents, (n_contacts, 3, 6).
    chosen
        Which contacts count, (n_contacts,).
    friction
        Coefficient of friction.
    b, n_rows
        Scaled wrench of the load, (6,). With 7 rows: (7,), and the last one asks for a sum of the normal forces.
    charged
        Whether ``room.slips`` counts; else it is zero.
    room
        The solution. Start with `clear_cone`, or with the solution for a smaller coefficient.

    Returns
    -------
    float
        Zero, to rounding: the forces balance the load. Else the residual in ``room.passive`` separates the load from
        all that the contacts can carry.
    """
    passive = room.passive
    n_generators = 0
    for k in range(passive.used[0]):  # renumber, so that the room is never full
        label = passive.labels[k]
        room.contacts[k] = room.contacts[label]
        room.directions[k, 0], room.directions[k, 1] = room.directions[label, 0], room.directions[label, 1]
        passive.labels[k] = k
        n_generators = k + 1
    for i in range(n_contacts):
        room.rejected[i] = False
    while n_generators < GENERATOR_LIMIT:
        scale = rounding_scale(passive, b, n_rows)
        left = length(passive.residual, n_rows)
        if friction > 0.0 and not charged and left <= BALANCED * scale:
            break
        best, best_price = -1, 0.0
        for i in range(n_contacts):
            if not chosen[i] or room.rejected[i]:
                continue
            price, is_steeper = generator_price(columns[i], i, friction, n_rows, charged, room)
            size = length(columns[i, 0], 6)
            if price > best_price * size and price > (STEEPER * left if is_steeper else PRICE * scale) * size:
                best, best_price = i, price / size
        if best < 0:
            break
        _, one, two = steepest_tangent(columns[best], passive.residual)
        write_generator(columns[best], friction, one, two, room.column)
        room.column[N_ROWS - 1] = 1.0
        room.contacts[n_generators] = best
        room.directions[n_generators, 0], room.directions[n_generators, 1] = one, two
        cost = friction * room.slips[best] if charged else 0.0
        if append_column(passive, room.column, n_generators, cost, n_rows) or (
            charged and exchange_column(passive, room.column, n_generators, cost, n_rows)
        ):
            settle(passive, b, n_rows)
        if label_is_passive(passive, n_generators):
            for i in range(n_contacts):
                room.rejected[i] = False
        else:
            room.rejected[best] = True
        n_generators += 1
    return length(passive.residual, n_rows)


@kernel
def write_forces(room: ConeRoom, n_contacts: int, friction: float, forces: FloatArray) -> None:
    """Write normal and tangential forces of all contacts, (n_contacts, 3)."""
    for i in range(n_contacts):
        for k in range(3):
            forces[i, k] = 0.0
    for k in range(room.passive.used[0]):
        label = room.passive.labels[k]
        i, x = room.contacts[label], room.passive.x[k]
        forces[i, 0] += x
        forces[i, 1] += x * friction * room.directions[label, 0]
        forces[i, 2] += x * friction * room.directions[label, 1]
