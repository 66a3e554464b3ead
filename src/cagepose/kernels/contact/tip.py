"""A part that tips on a flat rim turns about one point of it, whose place is sought: in the motion with this point
alone no other one of the rim goes in.

The exchange of `on_circle` closes in on that place from both sides. Two points so near each other share their force in
many ways, and each slips a little as the other one sticks, where Newton's method ends no more.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import cross, dot, minus, vector_from
from cagepose.kernels.contact.cone import clear_cone, cone_residual
from cagepose.kernels.contact.contact_set import ContactSet, count_chosen
from cagepose.kernels.contact.coulomb import coulomb_onset, obeys
from cagepose.kernels.contact.metric import Frame, ScaledVector, twist_of
from cagepose.kernels.contact.on_circle import add_on_circles, add_point, angle_of_deepest
from cagepose.kernels.contact.pressing import velocity_of_body
from cagepose.kernels.contact.tolerances import PARALLEL_COSINE, SAME_PLACE_RAD
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel

MOST_TRIALS = 40
"""So many places are tried."""
WIDEST_TRIAL_RAD = 0.5
"""Radians. The places that are tried are no farther apart until the deepest place is between two of them."""


@kernel
def tips_on_circle(contacts: ContactSet, frame: Frame, friction: float, work: ContactWorkspace) -> bool:
    """Find the motion about one point of a flat rim, where that of all listed points was not found.

    Filled, if there is one: the point is appended, and the forces, ``work.y`` and the residual are those of the motion.

    Parameters
    ----------
    contacts, frame, friction
        The problem. With a choice of faces that differ, or contacts that are locked, none is looked for.
    work
        Given: the load.
    """
    if work.locked.used > 0 or not has_one_normal_each(contacts):
        return False
    n_before = contacts.used[0]
    left = solve_cones(contacts, friction, work)
    for i in range(n_before):
        rim = contacts.bends[i].on_circle
        if rim.length == 0.0 or rim.is_on_ball or is_of_circle_before(contacts, i):
            continue
        solve_cones(contacts, friction, work)
        start = angle_to_deepest(contacts, i, 0.0, work.cone.passive.residual, frame)
        leave_out_circle(contacts, i)
        angle = angle_of_tip(contacts, n_before, i, start, frame, friction, work)
        if angle != math.inf and turns_about(contacts, n_before, i, angle, frame, friction, work):
            work.residual = left
            return True
        contacts.used[0] = n_before
        count_chosen(contacts)
    return False


@kernel
def has_one_normal_each(contacts: ContactSet) -> bool:
    """Whether all faces of each group have one normal, as where two rims cross at one height: any choice will do."""
    one = True
    for i in range(contacts.used[0]):
        first = contacts.rows[contacts.rows[i].group]
        turned = dot(vector_from(first.directions[0]), vector_from(contacts.rows[i].directions[0]))
        one = one and turned > PARALLEL_COSINE
    return one


@kernel
def solve_cones(contacts: ContactSet, friction: float, work: ContactWorkspace) -> float:
    """Return what forces in the cones of the contacts that count leave of the load: where `coulomb_onset` starts."""
    clear_cone(work.cone, work.load, contacts.n_freedoms, work.load_terms)
    return cone_residual(contacts, friction, work.cone)


@kernel
def is_of_same_circle(contacts: ContactSet, i: int, j: int) -> bool:
    """Whether two contacts are of the same parts, with the same normal."""
    one, other = contacts.rows[i], contacts.rows[j]
    if one.part != other.part or one.cage_part != other.cage_part:
        return False
    return dot(vector_from(one.directions[0]), vector_from(other.directions[0])) > PARALLEL_COSINE


@kernel
def is_of_circle_before(contacts: ContactSet, i: int) -> bool:
    """Whether a contact before this one is of the same rim."""
    found = False
    for j in range(i):
        found = found or (contacts.bends[j].on_circle.length != 0.0 and is_of_same_circle(contacts, i, j))
    return found


@kernel
def leave_out_circle(contacts: ContactSet, i: int) -> None:
    """Leave the contacts of a rim out of the problem."""
    for j in range(contacts.used[0]):
        if is_of_same_circle(contacts, i, j):
            contacts.states[j].counts = False
            for k in range(3):
                contacts.states[j].forces[k] = 0.0


@kernel
def angle_to_deepest(contacts: ContactSet, i: int, angle: float, y: ScaledVector, frame: Frame) -> float:
    """Return how far along a rim, radians, the point is from one at an angle that goes in fastest, or opens slowest."""
    velocity, spin = twist_of(y, frame)
    velocity = minus(velocity, velocity_of_body(contacts.pressing, contacts.rows[i].cage_body, y))
    away = angle_of_deepest(contacts, i, 0.0, velocity, spin, 0.0) - angle
    return math.atan2(math.sin(away), math.cos(away))


@kernel
def way_from_tip(
    contacts: ContactSet, n_before: int, i: int, angle: float, frame: Frame, friction: float, work: ContactWorkspace
) -> float:
    """Return how far the deepest point of a rim is from that at an angle, in the motion with this point alone; inf:
    none was found.
    """
    contacts.used[0] = n_before
    add_point(contacts, i, angle, frame)
    solve_cones(contacts, friction, work)
    if not coulomb_onset(contacts, friction, work.load, work.cone, work.y, work.newton, work.pivots):
        return math.inf
    return angle_to_deepest(contacts, i, angle, work.y, frame)


@kernel
def angle_of_tip(
    contacts: ContactSet, n_before: int, i: int, start: float, frame: Frame, friction: float, work: ContactWorkspace
) -> float:
    """Return the angle along a rim of the point that is the deepest one in the motion about it; inf: none was found.

    Each trial says on which side of it that is. It leads past, by more the farther the load is ahead of the rim, so
    that two trials soon have it between them; then false position.
    """
    low, at_low, angle, last_side = start, 0.0, start, 0.0
    high, at_high = math.inf, 0.0
    for trial in range(MOST_TRIALS):
        away = way_from_tip(contacts, n_before, i, angle, frame, friction, work)
        if abs(away) <= SAME_PLACE_RAD or away == math.inf:
            return angle if away != math.inf else math.inf
        if trial == 0 or (high == math.inf and (away > 0.0) == (at_low > 0.0)):
            low, at_low = angle, away
            angle += min(max(away, -WIDEST_TRIAL_RAD), WIDEST_TRIAL_RAD)
            continue
        if high == math.inf:
            high, at_high = angle, away
        elif (away > 0.0) == (at_low > 0.0):
            low, at_low = angle, away
            at_high *= 0.5 if last_side < 0.0 else 1.0
            last_side = -1.0
        else:
            high, at_high = angle, away
            at_low *= 0.5 if last_side > 0.0 else 1.0
            last_side = 1.0
        angle = low - at_low * (high - low) / (at_high - at_low)
    return math.inf


@kernel
def turns_about(
    contacts: ContactSet, n_before: int, i: int, angle: float, frame: Frame, friction: float, work: ContactWorkspace
) -> bool:
    """Whether the motion about a point of a rim, which is appended, is one with all contacts: none goes in."""
    row, beyond = row_on_circle_at(contacts, n_before, i, angle)
    if row < 0 or way_from_tip(contacts, n_before, row, beyond, frame, friction, work) == math.inf:
        return False
    count_chosen(contacts)
    n_all = contacts.used[0]
    if add_on_circles(contacts, frame, 0.0, work.y, work.load_terms):
        contacts.used[0] = n_all
        return False
    return obeys(contacts, friction, work.load_terms, work.y)


@kernel
def row_on_circle_at(contacts: ContactSet, n_before: int, i: int, angle: float) -> tuple[int, float]:
    """Return the listed contact whose part of a rim holds the point at an angle, and the angle from there; -1: none
    does, as the face has ended.
    """
    rim = contacts.bends[i].on_circle
    axis, outward = vector_from(rim.axis), vector_from(rim.outward)
    aside = cross(axis, outward)
    for j in range(n_before):
        other = contacts.bends[j].on_circle
        if other.length == 0.0 or not is_of_same_circle(contacts, i, j):
            continue
        there = vector_from(other.outward)
        away = angle - math.atan2(dot(aside, there), dot(outward, there))
        away = math.atan2(math.sin(away), math.cos(away))
        if -other.before - SAME_PLACE_RAD <= away <= other.after + SAME_PLACE_RAD:
            return j, away
    return -1, 0.0
