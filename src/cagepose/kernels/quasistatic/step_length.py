"""How far a motion keeps its direction, and whether it turns at all."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, matrix_from, norm, plus, times, vector_from
from cagepose.kernels.contact.contact_set import ContactSet, stays_on_face
from cagepose.kernels.native.kernel import kernel

ROUNDING = 1e-15
"""In lengths of the terms of a load: a slower motion may be no motion."""
STRAIGHT_TRAVEL = 1e-14
"""Radians for each length of the object: a motion that turns by less is a travel."""
ON_SMALL_WAYS, WIDEST = 0.04, 10.0
"""In sizes of the scene: where normals of round shapes turn by a radian on a shorter way, as in a narrow clearance,
they may turn more in a step, as it strays less; and how many times more."""


@kernel
def straightened(velocity: Vector, spin: Vector, reach_m: float, terms: float) -> Vector:
    """Return the spin, or zero where it is rounding, of the motion or of the terms of the load that it is left of."""
    if norm(spin) * reach_m <= max(STRAIGHT_TRAVEL * norm(velocity), ROUNDING * terms):
        return (0.0, 0.0, 0.0)
    return spin


@kernel
def turn_of_normals(contacts: ContactSet, velocity: Vector, spin: Vector) -> float:
    """Return how fast the normals of round shapes that slide or roll turn: the greatest |K v + L m|.

    A contact that carries nothing counts where a straight way would lead into it, as along the wall of a hole.
    """
    fastest = 0.0
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        way = plus(velocity, cross(spin, vector_from(contact.arm)))
        bend, rolls = contacts.bends[i], cross(vector_from(contact.directions[0]), spin)
        bent = times(matrix_from(bend.relative), way)
        if not stays_on_face(contacts, i) and not dot(way, bent) < 0.0:
            continue
        turn = plus(bent, times(matrix_from(bend.share), rolls))
        fastest = max(fastest, norm(turn))
    return fastest


@kernel
def longest_step(
    contacts: ContactSet, velocity: Vector, spin: Vector, slides: bool, turn_step_rad: float, size_m: float
) -> float:
    """Return how much of a twist keeps its direction: its turn, that of the normals of round shapes that slide, and how
    far sliding contacts leave their faces, stay small (5.11, 5.36).
    """
    turns, rate, speed = turn_of_normals(contacts, velocity, spin), norm(spin), norm(velocity)
    amount = math.inf
    if turns > 0.0:
        way = (speed + rate * size_m) / turns
        amount = turn_step_rad / turns * min(max(math.sqrt(ON_SMALL_WAYS * size_m / way), 1.0), WIDEST)
    if rate == 0.0:
        return amount
    amount = min(amount, turn_step_rad / rate)
    if slides and speed > 0.0:
        amount = min(amount, turn_step_rad * math.sqrt(0.5 * size_m / (rate * speed)))
    return amount
