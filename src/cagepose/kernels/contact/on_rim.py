"""A rim that lies flat touches with all its points, of which some are listed: others are added where they count.

Of a cylinder that stands on a floor, or of a ball in a round hole, eight contacts are listed. If they do not hold the
load, the motion that begins goes in deepest at some point of the rim, in closed form; this is added, and the question
asked again, until no point goes in: the exchange method of semi-infinite programs. The points close in on the two
between which the rim carries, halving the angle each time.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.contact.contact_set import ContactSet, choose, write_directions
from cagepose.kernels.contact.metric import WRENCH, Frame, twist_of
from cagepose.kernels.native.kernel import kernel

MOST_ADDED = 40
"""Points of rims, for one question."""
ENTERS = 1e-10
"""Of the motion: a point of a rim that goes in more slowly does not count."""
ROUNDING = 3e-16
"""Of the terms of the load: so much of a speed is their rounding."""


@kernel
def angle_of_deepest(contacts: ContactSet, i: int, velocity: Vector, spin: Vector) -> float:
    """Return the angle along the rim, from a place of it that touches, to where a motion goes in fastest."""
    row, rim = contacts.rows[i], contacts.bends[i].on_rim
    axis, outward = vector_from(rim.axis), vector_from(rim.outward)
    normal = vector_from(row.directions[0])
    if rim.is_on_ball:  # n . v(p) = (p - c) . v(c) / r, or its opposite
        away = minus(vector_from(row.arm), vector_from(rim.ball))
        side = math.copysign(rim.length, rim.length * dot(away, normal))
        way = scaled(plus(velocity, cross(spin, vector_from(rim.ball))), side)
    else:  # n . (w x p) = p . (n x w)
        way = scaled(cross(normal, spin), rim.length)
    return math.atan2(dot(way, cross(axis, outward)), dot(way, outward))


@kernel
def add_point(contacts: ContactSet, i: int, angle: float, frame: Frame) -> None:
    """Append the contact at an angle along the rim from a place of it that touches."""
    row, rim, place = contacts.rows[i], contacts.bends[i].on_rim, contacts.used[0]
    axis, outward = vector_from(rim.axis), vector_from(rim.outward)
    center = minus(vector_from(row.arm), scaled(outward, rim.length))
    there = plus(scaled(outward, math.cos(angle)), scaled(cross(axis, outward), math.sin(angle)))
    arm, normal = plus(center, scaled(there, rim.length)), vector_from(row.directions[0])
    if rim.is_on_ball:
        away = minus(arm, vector_from(rim.ball))
        side = math.copysign(1.0, dot(minus(vector_from(row.arm), vector_from(rim.ball)), normal))
        normal = scaled(away, side / norm(away))
    new, state = contacts.rows[place], contacts.states[place]
    new.point, new.box, new.axis, new.side, new.gap, new.group = row.point, row.box, 0, 1.0, row.gap, place
    arc = rim.arc_after if angle > 0.0 else rim.arc_before
    if rim.is_of_cage:
        new.feature, new.cage_feature = (row.feature if rim.face < 0 else rim.face), arc
    else:
        new.feature, new.cage_feature = arc, (row.cage_feature if rim.face < 0 else rim.face)
    write_directions(new, normal, arm, norm(vector_from(row.directions[1])), frame)
    choose(contacts, place, True)
    state.is_locked = state.is_sticking = state.has_carried = state.kept_chosen = False
    for k in range(3):
        state.forces[k] = state.kept_forces[k] = 0.0
    contacts.bends[place] = contacts.bends[i]  # type: ignore[index]
    contacts.bends[place].on_rim.length = 0.0
    contacts.used[0] = place + 1


@kernel
def add_on_rims(contacts: ContactSet, frame: Frame, y: FloatArray, terms: float) -> bool:
    """Append the point of a flat rim that a motion y goes in fastest at; False: none counts, or there is no room.

    What y is the rest of has ``terms`` of this length: slower than their rounding, nothing goes in.
    """
    if len(contacts.bends) == 0:
        return False
    velocity, spin = twist_of(y, frame)
    n_listed, fastest, least = contacts.used[0], -1, max(ENTERS * length(y, WRENCH), ROUNDING * terms)
    for i in range(n_listed):
        rim = contacts.bends[i].on_rim
        if contacts.rows[i].feature < 0 or rim.length == 0.0 or contacts.used[0] == len(contacts.rows):
            continue
        angle = angle_of_deepest(contacts, i, velocity, spin)
        if angle == 0.0 or abs(angle) > (1.0 + ENTERS) * (rim.after if angle > 0.0 else rim.before):
            continue
        add_point(contacts, i, angle, frame)
        speed = inner(contacts.rows[n_listed].columns[0], y, WRENCH)
        contacts.used[0] = n_listed
        if speed > least:
            fastest, least = i, speed
    if fastest < 0:
        return False
    add_point(contacts, fastest, angle_of_deepest(contacts, fastest, velocity, spin), frame)
    return True
