"""A short proof that contacts do not balance a load: a twist along which the load works and that no force resists.

The residual of the problem with round cones is such a twist, but it takes many generators to its last digit. In cones
a little wider than they are, few generators are enough: the twist that leaves those by some degrees too little still
leaves the true ones.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import PRICE, inner, length, rounding_scale
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.contact.cone import (
    GENERATOR_LIMIT,
    ConeWorkspace,
    add_generator,
    renumber_generators,
    steepest_tangent,
)
from cagepose.kernels.contact.contact_set import ContactRow
from cagepose.kernels.native.kernel import kernel

WIDER = 1.05
"""Times the friction."""
SURELY = 1e-6
"""In lengths of the terms: what is left of the load at least."""


@kernel
def step_to_balance(rows: Rows[ContactRow], n_contacts: int, room: ConeWorkspace) -> float:
    """Return by how much more friction the residual r would vanish, to first order: |r|^2 / sum f_n |r_t|.

    The contacts' forces are those of ``room``.
    """
    residual = room.passive.residual
    gain = 0.0
    for i in range(n_contacts):
        gain += rows[i].forces[0] * steepest_tangent(rows[i], residual)[0]
    left = length(residual, 6)
    return left * left / gain if gain > 0.0 else math.inf


@kernel
def leaves_cones(rows: Rows[ContactRow], n_contacts: int, friction: float, slack: float, twist: FloatArray) -> bool:
    """Whether no force inside a cone works against a scaled twist: n . r + mu |r_t| <= 0 at all contacts (5.6)."""
    for i in range(n_contacts):
        if rows[i].chosen:
            normal = rows[i].columns[0]
            allowed = slack * length(normal, 6) - inner(normal, twist, 6)
            if allowed < 0.0 or friction * steepest_tangent(rows[i], twist)[0] > allowed:
                return False
    return True


@kernel
def separating_twist(
    rows: Rows[ContactRow], n_contacts: int, friction: float, b: FloatArray, room: ConeWorkspace
) -> bool:
    """Whether a twist is found that proves that there is no balance; False says nothing.

    Parameters
    ----------
    rows, n_contacts, friction, b
        As in `cagepose.kernels.contact.cone.cone_residual`.
    room
        Its solution without friction; afterwards ``room.passive.residual`` is the twist.
    """
    passive = room.passive
    charged = False
    number = renumber_generators(rows, n_contacts, room)
    while 0 <= number < GENERATOR_LIMIT and length(passive.residual, 6) > SURELY * rounding_scale(passive):
        if leaves_cones(rows, n_contacts, friction, PRICE * passive.terms, passive.residual):
            return inner(b, passive.residual, 6) > 0.0
        number = add_generator(rows, n_contacts, WIDER * friction, b, charged, number, room)
    return False
