"""Contact forces inside exact friction cones: min |b - A f| with |f_t| <= mu f_n, equations (5.4) to (5.6).

A cone has infinitely many generators n + mu d, d any unit tangent. The active-set method of `least_squares` needs only
the one that points most along the residual r, and that one is known in closed form: d = r_t / |r_t|. So cones stay
round, where a pyramid would be off by 1 - cos(pi / k), and at the end either the residual is zero, and the forces are
the proof of balance, or no generator points along it, and the residual is the proof that there is none.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.least_squares import (
    WRENCH,
    PassiveSet,
    aim,
    aim_at,
    append_column,
    clear,
    exchange_column,
    inner,
    label_is_passive,
    length,
    rounding_scale,
    settle,
)
from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.tolerances import LEAST_PRICE
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.contact.tolerances import (
    LEAST_FORCE,
    MOST_FORCES_COUNTED,
    RESIDUAL_OF_LOAD,
    SHARE_OF_FORCES,
    STEEPER_BY_ROUNDING,
)
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import kernel

GENERATOR_LIMIT = 400


class ConeWorkspace:
    """Memory for one problem, and its solution; a record.

    Attributes
    ----------
    passive
        The generators in use; their labels index the next two.
    contacts, directions
        Contact and tangent d of each generator.
    is_corrected
        Whether the slip speeds of the contacts count, as a cost of mu s_i for each newton of their normal force (5.7).
    column
        One generator; in a system with one more row than there are freedoms that adds up the normal forces.
    """

    passive: PassiveSet
    contacts: Annotated[IntArray, GENERATOR_LIMIT]
    directions: Annotated[FloatArray, GENERATOR_LIMIT, 2]
    is_corrected: bool
    column: ScaledVector


@kernel
def steepest_tangent(contacts: ContactSet, i: int, vector: FloatArray) -> tuple[float, float, float]:
    """Return (length of the slip at a contact in a scaled motion, its direction)."""
    columns, drift, n = contacts.rows[i].columns, contacts.rows[i].drift, contacts.n_freedoms
    one, two = inner(columns[1], vector, n) + drift[1], inner(columns[2], vector, n) + drift[2]
    size = math.sqrt(one * one + two * two)
    if size == 0.0:
        return 0.0, 1.0, 0.0
    inverse = 1.0 / size
    return size, inverse * one, inverse * two


@kernel
def write_generator(columns: FloatArray, friction: float, one: float, two: float, n: int, out: FloatArray) -> None:
    """Write n + mu d, of n numbers, with the tangent d given by its parts along two of them."""
    if n == WRENCH:  # nearly always: a loop of a length that is known is several times as fast
        for k in range(WRENCH):
            out[k] = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])
        return
    for k in range(n):
        out[k] = columns[0, k] + friction * (one * columns[1, k] + two * columns[2, k])


@kernel
def clear_cone(cone: ConeWorkspace, b: FloatArray, n_rows: int, terms: float) -> None:
    """Start from no force: b is (n,), or (n + 1,) where a sum of the normal forces is asked for too, of terms so
    long.
    """
    cone.is_corrected = False
    clear(cone.passive, n_rows, terms)
    aim_at(cone.passive, b)
    aim(cone.passive)


@kernel
def generator_price(contacts: ContactSet, i: int, friction: float, cone: ConeWorkspace) -> tuple[float, bool]:
    """Return how far the steepest generator of a contact lies along the residual r, and whether the contact has one.

    A generator in use lies across r (but for its cost), so for another of the same contact only the angle between
    their tangents counts: mu |r_t| (1 - cos), which has its digits however small it is.
    """
    passive = cone.passive
    slip, one, two = steepest_tangent(contacts, i, passive.residual) if friction > 0.0 else (0.0, 1.0, 0.0)
    nearest = math.inf
    for k in range(passive.used):
        label = passive.labels[k]
        if cone.contacts[label] == i:
            across = one * cone.directions[label, 1] - two * cone.directions[label, 0]
            along = one * cone.directions[label, 0] + two * cone.directions[label, 1]
            apart = across * across / (1.0 + along) if along > 0.0 else 1.0 - along
            nearest = min(nearest, apart)
    if nearest < math.inf:
        return friction * slip * nearest, True
    row = contacts.rows[i]
    price = inner(row.columns[0], passive.residual, contacts.n_freedoms) + row.drift[0] + friction * slip
    if passive.n_rows > contacts.n_freedoms:
        price += passive.residual[contacts.n_freedoms]
    return price - slip_cost(contacts, i, friction, cone), False


@kernel
def slip_cost(contacts: ContactSet, i: int, friction: float, cone: ConeWorkspace) -> float:
    """Return what a unit of a contact's normal force costs with De Saxce's correction."""
    return friction * contacts.states[i].slip_speed if cone.is_corrected else 0.0


@kernel
def residual_in_loads(passive: PassiveSet) -> float:
    """Return what is left of the load, in its lengths: zero, to rounding, if forces balance it."""
    forces = min(rounding_scale(passive) - passive.terms, MOST_FORCES_COUNTED * passive.terms)
    scale = passive.terms + SHARE_OF_FORCES * forces
    return length(passive.residual, passive.n_rows) / scale if scale > 0.0 else 0.0


@kernel
def renumber_generators(contacts: ContactSet, cone: ConeWorkspace) -> int:
    """Number the generators in use from zero on, so that there is always memory; return how many there are.

    No contact is rejected any more.
    """
    passive = cone.passive
    for i in range(contacts.used[0]):
        contacts.states[i].is_rejected = False
    for k in range(passive.used):
        label = passive.labels[k]
        cone.contacts[k] = cone.contacts[label]
        cone.directions[k, 0], cone.directions[k, 1] = cone.directions[label, 0], cone.directions[label, 1]
        passive.labels[k] = k
    return int(passive.used)


@kernel
def add_generator(contacts: ContactSet, friction: float, number: int, cone: ConeWorkspace) -> int:
    """Let the generator in that lies most along the residual, as the one with this number; return the next number.

    -1: none lies along it. Parameters as for `cone_residual`.
    """
    passive, states, n = cone.passive, contacts.states, contacts.n_freedoms
    scale = rounding_scale(passive)
    left = length(passive.residual, passive.n_rows)
    # the contact whose generator lies most along the residual
    best, best_price = -1, 0.0
    for i in range(contacts.used[0]):
        if not states[i].counts or states[i].is_rejected:
            continue
        price, is_steeper = generator_price(contacts, i, friction, cone)
        if price <= 0.0:
            continue
        size = length(contacts.rows[i].columns[0], n) + (1.0 if passive.n_rows > n else 0.0)
        if (
            price > best_price * size
            and price > (STEEPER_BY_ROUNDING * left if is_steeper else LEAST_PRICE * scale) * size
        ):
            best, best_price = i, price / size
    if best < 0:
        return -1
    # its steepest generator comes in, or takes the place of one that it depends on
    _, one, two = steepest_tangent(contacts, best, passive.residual)
    if friction == 0.0:  # so that what follows with friction may go on from here
        one = two = 0.0
    write_generator(contacts.rows[best].columns, friction, one, two, n, cone.column)
    cone.column[n] = 1.0
    cone.contacts[number] = best
    cone.directions[number, 0], cone.directions[number, 1] = one, two
    drift = contacts.rows[best].drift
    cost = slip_cost(contacts, best, friction, cone) - drift[0] - friction * (one * drift[1] + two * drift[2])
    if append_column(passive, cone.column, number, cost) or (
        cone.is_corrected and exchange_column(passive, cone.column, number, cost)
    ):
        settle(passive)
    if label_is_passive(passive, number):
        for i in range(contacts.used[0]):
            states[i].is_rejected = False
    else:
        states[best].is_rejected = True
    return number + 1


@kernel
def cone_residual(contacts: ContactSet, friction: float, cone: ConeWorkspace) -> float:
    """Return the least |b - sum of contact forces| in lengths of b, going on from the forces in ``cone``.

    Parameters
    ----------
    contacts
        At a pose.
    friction
        Coefficient of friction.
    cone
        The solution. Start with `clear_cone`, which takes the load b, or with the solution for no friction: rays are
        those of one coefficient.

    Returns
    -------
    float
        Zero, to rounding: the forces balance the load. Else the residual in ``cone.passive`` separates the load from
        all that the contacts can carry.
    """
    heed_interrupt()
    passive = cone.passive
    n_generators = renumber_generators(contacts, cone)
    while 0 <= n_generators < GENERATOR_LIMIT:
        if friction > 0.0 and not cone.is_corrected and residual_in_loads(passive) <= RESIDUAL_OF_LOAD:
            break
        n_generators = add_generator(contacts, friction, n_generators, cone)
    return residual_in_loads(passive)


@kernel
def write_forces(cone: ConeWorkspace, friction: float, contacts: ContactSet) -> None:
    """Write normal and tangential forces of all contacts."""
    for i in range(contacts.used[0]):
        for k in range(3):
            contacts.states[i].forces[k] = 0.0
    for k in range(cone.passive.used):
        label = cone.passive.labels[k]
        forces, x = contacts.states[cone.contacts[label]].forces, cone.passive.x[k]
        if x * cone.passive.sizes[k] <= LEAST_FORCE * cone.passive.terms:
            continue
        forces[0] += x
        forces[1] += x * friction * cone.directions[label, 0]
        forces[2] += x * friction * cone.directions[label, 1]
