"""Where a sliding contact runs over the end of one of its features."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import Motion, motion_of
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import CIRCLE, FACE, PlacedBoundary
from cagepose.kernels.boundary.first_touch import place_after
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_at, cage_of, held_at, held_moved
from cagepose.kernels.boundary.kept import meeting_kept
from cagepose.kernels.boundary.meeting import both_reach
from cagepose.kernels.boundary.meetings import slack_of
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.reach import beyond_face
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.tolerances import SAME_NORMAL_RAD, SAME_WAY
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.pushing_out import is_fixed
from cagepose.kernels.quasistatic.straying import STRAYED, strayed

CLEAR = 1.1
"""In touch tolerances: how far beyond the edge a contact is let go, so that it does not touch the next face too."""
NEAR_GUESS, FALSE_POSITIONS = 1e-13, 12
"""In amounts of the whole motion: an end that is guessed, in so many trials, is looked for so near to it first."""
HALVINGS = 50
"""A motion is halved so many times to find where a contact of two shapes ends."""


@kernel
def still_meet(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    motion: Motion,
    amount: float,
    touch_m: float,
    within_m: float,
) -> bool:
    """Whether the features of a contact still reach where they meet, after an amount of a motion, by so much within
    their ends.

    Those that do with quite another normal have come apart: an edge and the circle that lay across it. A circle that
    lies flat may go from one face to another one that is flush with it.
    """
    contact, moved = contacts.rows[i], held_moved(geometry, placement)
    cage, one, other = cage_at(geometry, contact.cage_body), contact.feature, contact.cage_feature
    place_after(held_at(geometry, placement), one, motion, amount, moved)
    has_circle = moved.features[one].kind == CIRCLE or cage.features[other].kind == CIRCLE
    fixed = is_fixed(contacts, i) or (has_circle and amount == 0.0)  # where it was found
    met = meeting_kept(moved, one, cage, other, contact.angle, fixed, touch_m, placement.memory.places)
    if not met.is_one or dot(met.normal, vector_from(contact.directions[0])) < SAME_WAY:
        return False
    if reach_within(geometry, moved, one, other, met, touch_m, within_m):
        return True
    is_met = False
    for k in range(contacts.used[0] if contacts.states[i].stays_flat else 0):
        beside = contacts.rows[k]
        turned = minus(vector_from(beside.directions[0]), vector_from(contact.directions[0]))
        if not contacts.states[k].stays_flat or norm(turned) > SAME_NORMAL_RAD or is_met:
            continue
        if (beside.feature == one) != (beside.cage_feature == other):
            place_after(held_at(geometry, placement), beside.feature, motion, amount, moved)
            is_met = reach_within(geometry, moved, beside.feature, beside.cage_feature, met, touch_m, within_m)
    return is_met


@kernel
def reach_within(
    geometry: Geometry, moved: PlacedBoundary, i: int, j: int, met: Meeting, touch_m: float, within_m: float
) -> bool:
    """Whether two features reach where they meet, by so much within their ends."""
    one, other = geometry.held.features[i], geometry.cage.own.features[j]
    slack = CLEAR * slack_of(one, other, touch_m) - within_m / min(one.least, other.least)
    return both_reach(moved, i, cage_of(geometry, j), j, met, slack, 2.0 * CLEAR * touch_m - within_m)


@kernel
def beyond_border(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    motion: Motion,
    amount: float,
    touch_m: float,
) -> float:
    """Return how far a vertex is beyond where its contact with a face ends, after an amount of a motion, metres; inf:
    the features are others.
    """
    contact, moved = contacts.rows[i], held_moved(geometry, placement)
    cage, one, other = cage_at(geometry, contact.cage_body), contact.feature, contact.cage_feature
    place_after(held_at(geometry, placement), one, motion, amount, moved)
    return beyond_end(moved, one, cage, other, touch_m)


@kernel
def beyond_end(moved: PlacedBoundary, one: int, cage: PlacedBoundary, other: int, touch_m: float) -> float:
    """As `beyond_border`, of two features that are placed."""
    kind, cage_kind = moved.features[one].kind, cage.features[other].kind
    if not (kind == FACE or cage_kind == FACE) or kind == CIRCLE or cage_kind == CIRCLE:
        return math.inf
    if kind == FACE:
        beyond = beyond_face(moved, one, vector_from(cage.features[other].point))
    else:
        beyond = beyond_face(cage, other, vector_from(moved.features[one].point))
    return beyond - 2.0 * CLEAR * touch_m


@kernel
def end_of_face(
    geometry: Geometry, placement: Placement, contacts: ContactSet, i: int, motion: Motion, end: float, touch_m: float
) -> float:
    """Return the amount of a motion, up to ``end``, after which a vertex runs over the border of a face, by false
    position (Illinois); inf: it does not, or the features are others.
    """
    low, high = 0.0, end
    at_low = beyond_border(geometry, placement, contacts, i, motion, low, touch_m)
    at_high = beyond_border(geometry, placement, contacts, i, motion, high, touch_m)
    if at_low >= 0.0 or at_high <= 0.0:
        return math.inf
    amount = end
    for _ in range(FALSE_POSITIONS):
        amount = low - at_low * (high - low) / (at_high - at_low)
        if high - low <= NEAR_GUESS * end:
            break
        beyond = beyond_border(geometry, placement, contacts, i, motion, amount, touch_m)
        if beyond < 0.0:
            low, at_low, at_high = amount, beyond, 0.5 * at_high
        else:
            high, at_high, at_low = amount, beyond, 0.5 * at_low
    return amount


@kernel
def end_of_meeting(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    motion: Motion,
    end: float,
    touch_m: float,
) -> tuple[float, float]:
    """Return two amounts of a motion, up to ``end``, between which a contact runs over the end of one of its features,
    a rounding apart; inf: it does not.
    """
    if end == math.inf:
        row = contacts.rows[i]
        apart_m = geometry.held.parts[row.part].reach + geometry.cage.own.parts[row.cage_part].reach + touch_m
        end = 2.0 * apart_m / norm(motion.velocity)
    if still_meet(geometry, placement, contacts, i, motion, end, touch_m, 0.0):
        return math.inf, math.inf
    low, high = 0.0, end
    guess = end_of_face(geometry, placement, contacts, i, motion, end, touch_m)
    for side in (-NEAR_GUESS, NEAR_GUESS):
        near = guess + side * end
        if not low < near < high:
            continue
        if still_meet(geometry, placement, contacts, i, motion, near, touch_m, 0.0):
            low = near
        else:
            high = near
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if still_meet(geometry, placement, contacts, i, motion, middle, touch_m, 0.0):
            low = middle
        else:
            high = middle
    return low, high


@kernel
def speed_of_place(geometry: Geometry, contacts: ContactSet, i: int, velocity: Vector, spin: Vector) -> float:
    """Return about how fast the place of a contact goes along its features at a twist: as fast as the object's material
    does there, or at the core of one that is round: where a ball rolls, its material stands still.
    """
    contact = contacts.rows[i]
    arm, normal = vector_from(contact.arm), vector_from(contact.directions[0])
    core = minus(arm, scaled(normal, geometry.held.features[contact.feature].radius))
    cage_core = plus(arm, scaled(normal, geometry.cage.own.features[contact.cage_feature].radius))
    fastest = norm(plus(velocity, cross(spin, arm)))
    for at in (core, cage_core):
        fastest = max(fastest, norm(plus(velocity, cross(spin, at))))
    return fastest


@kernel
def edge_crossing(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    center: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    end: float,
    reach_m: float,
    touch_m: float,
) -> float:
    """Return the amount of a twist, up to ``end``, after which a contact leaves the face that it stays on; inf: it does
    not.

    Where it would only because contacts stray, by the square of the way, within ``reach_m``, it is passed over: they
    are put back. So it is where one of them has no place there any more: it may have one when it is put back. One that
    begins so near to a border is passed over, too, as it may run along it; but not where it ends farther away than
    that, as at another border, and is farther beyond than that where the motion ends.
    """
    motion = motion_of(center, velocity, spin)
    before, crossing = end_of_meeting(geometry, placement, contacts, i, motion, end, touch_m)
    if crossing < math.inf:
        astray = strayed(geometry, placement, contacts, center, quaternion, velocity, spin, before, math.inf)
        reach = max(reach_m, STRAYED * astray)
        if still_meet(geometry, placement, contacts, i, motion, 0.0, touch_m, reach):
            return crossing
        if crossing * speed_of_place(geometry, contacts, i, velocity, spin) <= reach:
            return math.inf
        if end == math.inf or not still_meet(geometry, placement, contacts, i, motion, end, touch_m, -reach):
            return crossing
    return math.inf
