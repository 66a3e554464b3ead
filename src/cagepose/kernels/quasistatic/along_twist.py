"""One step of the quasistatic path: how far along a twist, to which contact, and back on the faces."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.motion import motion_of
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import (
    Vector,
    cross,
    dot,
    matrix_from,
    norm,
    plus,
    times,
    vector_from,
)
from cagepose.kernels.boundary.geometry import Placement, place_object
from cagepose.kernels.contact.contact_set import ContactSet, stays_on_face
from cagepose.kernels.contact.loads import (
    total_load,
    work_done,
)
from cagepose.kernels.contact.metric import moved_along_twist, twist_between, way_between
from cagepose.kernels.contact.on_circle import is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.edge_crossing import first_edge_crossing, still_meet
from cagepose.kernels.quasistatic.first_contact import NO_HIT, Hit, Twist, first_contact
from cagepose.kernels.quasistatic.projection import (
    GAP,
    ON_FACE,
    constrain_features,
    depth_left,
    drop_constraint,
    lack,
)
from cagepose.kernels.quasistatic.pushing_out import (
    StepWorkspace,
    allow_depths,
    constrain_contacts,
    has_fixed,
    pushed_out,
    put_back,
)
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.straying import STRAYED, strayed_at_most

MAY_SLIP = 0.01
"""Share of the way of a step. What sticks in two places may slip by as much, where it cannot turn without, as in a V.
That is of second order in the step, by which its path is wrong anyway."""
TO_FIRST_ORDER = 2.0
"""Times what is worked out to first order."""
HALVINGS = 40
"""How often a step is halved that a contact, or the potential, does not let end."""
LEAST_SPEED = 1e-300
"""Metres for each unit of an amount: a slower motion is a turn."""
SLANTED, NEAR_END = 8.0, 0.01
"""Times what contacts stray, that where one ends may be off along the way; and, in touch tolerances, how near to that
it is looked for.
"""
SECANTS = 6
"""How often what is hit is looked for on the path."""
HALVINGS_TO_FACES = 6
"""How often a step is halved at whose end contacts cannot be put back on their faces."""
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


@kernel
def work_of_depths(contacts: ContactSet) -> float:
    """Return the work of the forces that contacts carry as they come out of what they are deep in, to first order."""
    work = 0.0
    for i in range(contacts.used[0]):
        if is_kept(contacts, i):
            work += contacts.states[i].forces[0] * max(0.0, -contacts.rows[i].gap)
    return work


@kernel
def constrain_step(
    setting: Setting, contacts: ContactSet, twist: Twist, amount: float, work: StepWorkspace
) -> float:
    """Constrain the contacts that stay on their faces in a step; return the way of the step, metres."""
    constrain_contacts(contacts, setting.tolerances.rounding_m, work.constraints)
    way = amount * (norm(twist.velocity) + setting.body.reach_m * norm(twist.spin))
    work.constraints.scratch[0].may_slip_m = max(setting.tolerances.touch_m, MAY_SLIP * way)
    return way


@kernel
def stepped(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    hit: Hit,
    work: StepWorkspace,
) -> tuple[bool, Vector, Quaternion]:
    """Move by ``amount``, keep the contacts that carry on their faces, and put the one that is hit on its own.

    A contact that touches across a gap, within the touch tolerance, keeps the gap, as its gap rate of zero says.
    False: a point would be inside, a contact would not stay on its face, to put all back would be a longer way than the
    step, or the loads would do negative work, more than it takes to bring contacts out that were a little deep. The
    placement is that of the new pose, or of the old one.
    """
    geometry = setting.geometry
    way = constrain_step(setting, contacts, twist, amount, work)
    moved = moved_along_twist(position, quaternion, twist.velocity, twist.spin, amount)
    new_position, new_quaternion = moved
    if hit.feature >= 0:
        if work.constraints.scratch[0].used > 0:
            _, new_position, new_quaternion = put_back(setting, placement, moved[0], moved[1], work.constraints)
        constrain_features(work.constraints, hit.feature, hit.cage_feature, hit.angle, GAP, 0.0)
    done, new_position, new_quaternion = pushed_out(setting, placement, new_position, new_quaternion, work)
    strayed = way_between(moved[0], moved[1], new_position, new_quaternion, setting.body.reach_m)
    if done and strayed <= way + setting.tolerances.touch_m:
        total = total_load(setting.load, position, quaternion, setting.size_m)
        least = -setting.tolerances.resolution_m * total - TO_FIRST_ORDER * work_of_depths(contacts)
        if work_done(setting.load, position, quaternion, new_position, new_quaternion) >= least:
            return True, new_position, new_quaternion
    place_object(geometry, position, quaternion, placement)
    return False, position, quaternion


@kernel
def ends_on_faces(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    work: StepWorkspace,
) -> tuple[bool, Vector, Quaternion]:
    """Whether contacts that stay on their faces can be put back after an amount of a twist, by a way that is shorter; and
    the pose then.
    """
    way = constrain_step(setting, contacts, twist, amount, work)
    moved = moved_along_twist(position, quaternion, twist.velocity, twist.spin, amount)
    done, end, turned = put_back(setting, placement, moved[0], moved[1], work.constraints)
    done = done and way_between(moved[0], moved[1], end, turned, setting.body.reach_m) <= way
    if done:
        done = depth_left(setting.geometry, work.constraints, end, turned, placement) <= work.allowed_m[0]
    return done, end, turned


@kernel
def gap_at(
    setting: Setting, placement: Placement, hit: Hit, position: Vector, quaternion: Quaternion, work: StepWorkspace
) -> float:
    """Return the gap, at a pose, of features that are not constrained, metres; inf: they do not meet, or are."""
    constraints = work.constraints
    if not constrain_features(constraints, hit.feature, hit.cage_feature, hit.angle, GAP, 0.0):
        return math.inf
    last = constraints.scratch[0].used - 1
    gap = lack(setting.geometry, constraints.rows[last], position, quaternion, placement).value
    drop_constraint(constraints, last)
    return gap


@kernel
def hit_on_path(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    hit: Hit,
    work: StepWorkspace,
) -> float:
    """Return after which amount of a twist what is hit is reached where contacts that stay on their faces are on them:
    the root of its gap there, by secants from what a screw says.

    A gap that is closed by the projection afterwards would turn an object aside that reaches two things at once.
    """
    before, gap_before = 0.0, gap_at(setting, placement, hit, position, quaternion, work)
    amount, best, least = hit.amount, hit.amount, math.inf
    for _ in range(SECANTS):
        done, end, turned = ends_on_faces(setting, placement, contacts, position, quaternion, twist, amount, work)
        if not done:
            break
        gap = gap_at(setting, placement, hit, end, turned, work)
        if not abs(gap) < least or amount == before:
            break
        best, least = amount, abs(gap)
        slope = (gap - gap_before) / (amount - before)
        before, gap_before = amount, gap
        if least <= ON_FACE * setting.size_m or not slope < 0.0:
            break
        amount = min(max(amount - gap / slope, 0.5 * amount), twist.end)
    return best


@kernel
def meets_on_path(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    work: StepWorkspace,
) -> bool:
    """Whether a contact still reaches where its features meet, after an amount of a twist and back on the faces."""
    done, end, turned = ends_on_faces(setting, placement, contacts, position, quaternion, twist, amount, work)
    if not done:
        return False
    velocity, spin = twist_between(position, quaternion, end, turned)
    motion, touch_m = motion_of(position, velocity, spin), setting.tolerances.touch_m
    return still_meet(setting.geometry, placement, contacts, i, motion, 1.0, touch_m, 0.0)


@kernel
def crossing_on_path(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    crossing: float,
    reach_m: float,
    work: StepWorkspace,
) -> float:
    """Return after which amount of a twist a contact leaves its face where contacts are on their faces, by halving, from
    what a screw says, which strays by at most ``reach_m``; inf: it does not, up to the end of the twist.
    """
    speed = norm(twist.velocity) + setting.body.reach_m * norm(twist.spin)
    low, high = max(crossing - SLANTED * reach_m / speed, 0.0), min(crossing + SLANTED * reach_m / speed, twist.end)
    if not meets_on_path(setting, placement, contacts, i, position, quaternion, twist, low, work):
        low = 0.0
    if meets_on_path(setting, placement, contacts, i, position, quaternion, twist, high, work):
        low, high = high, twist.end
        if low == high or meets_on_path(setting, placement, contacts, i, position, quaternion, twist, high, work):
            return math.inf
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (high - low) * speed <= NEAR_END * setting.tolerances.touch_m or not low < middle < high:
            break
        if meets_on_path(setting, placement, contacts, i, position, quaternion, twist, middle, work):
            low = middle
        else:
            high = middle
    return high


@kernel
def opens_at(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    position: Vector,
    quaternion: Quaternion,
    work: StepWorkspace,
) -> bool:
    """Whether a contact that is not constrained has opened at a pose."""
    row = contacts.rows[i]
    one = Hit(0.0, row.feature, row.cage_feature, row.angle)
    return setting.tolerances.rounding_m < gap_at(setting, placement, one, position, quaternion, work) < math.inf


@kernel
def ends_with_one_open(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    work: StepWorkspace,
) -> tuple[bool, Vector, Quaternion]:
    """As `ends_on_faces` where one of the contacts opens, by the square of the way: of four feet on a floor that bends
    three carry. It carries nothing any more then.
    """
    for i in range(contacts.used[0]):
        state, carried = contacts.states[i], contacts.states[i].forces[0]
        if carried == 0.0 or state.is_locked or state.is_sticking or state.stays_flat:
            continue
        state.forces[0] = 0.0
        done, end, turned = ends_on_faces(setting, placement, contacts, position, quaternion, twist, amount, work)
        if done and opens_at(setting, placement, contacts, i, end, turned, work):
            return True, end, turned
        state.forces[0] = carried
    return False, position, quaternion


@kernel
def along_faces(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    work: StepWorkspace,
) -> tuple[Twist, bool]:
    """Return the twist that leads, in an amount of one, to where contacts that stay on their faces are on them again at
    the end of a twist, after the way of a size of the scene or a part of it; and whether it is all of it. A travel
    without end is kept, and so is the direction of a motion that nothing guides, and of one of a circle that lies flat
    or fits all around, whose places change as it tilts.
    """
    allow_depths(placement, setting.tolerances, work)
    constrain_contacts(contacts, setting.tolerances.rounding_m, work.constraints)
    if twist.end == math.inf or work.constraints.scratch[0].used == 0:
        return twist, True
    amount = min(twist.end, setting.size_m / max(norm(twist.velocity), LEAST_SPEED))
    if has_fixed(contacts):
        return Twist(twist.velocity, twist.spin, amount), True
    for halving in range(HALVINGS_TO_FACES):
        done, end, turned = ends_on_faces(setting, placement, contacts, position, quaternion, twist, amount, work)
        if not done:
            done, end, turned = ends_with_one_open(
                setting, placement, contacts, position, quaternion, twist, amount, work
            )
        if done:
            velocity, spin = twist_between(position, quaternion, end, turned)
            return Twist(velocity, straightened(velocity, spin, setting.body.reach_m, 0.0), 1.0), halving == 0
        amount *= 0.5
    return Twist(twist.velocity, twist.spin, amount), False


@kernel
def furthest_step(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    work: StepWorkspace,
) -> tuple[float, bool, Vector, Quaternion]:
    """After `along_faces`: go along a twist to its end, the first contact or the edge of a face that carries, or less if need be.

    Return (amount, whether it went as far as it should, position, quaternion); amount 0: it could not move; inf:
    nothing is ahead.
    """
    reach_m, is_guided = 0.0, work.constraints.scratch[0].used > 0
    if is_guided and twist.end < math.inf:
        reach_m = STRAYED * strayed_at_most(
            setting.geometry, placement, contacts, position, quaternion, twist.velocity, twist.spin, twist.end
        )
    hit = first_contact(setting, placement, contacts, position, twist, reach_m)
    if hit.feature >= 0 and is_guided:
        amount = hit_on_path(setting, placement, contacts, position, quaternion, twist, hit, work)
        hit = Hit(amount, hit.feature, hit.cage_feature, hit.angle)
    amount = hit.amount
    edge_crossing, leaving = first_edge_crossing(
        setting.geometry,
        placement,
        contacts,
        position,
        quaternion,
        twist.velocity,
        twist.spin,
        min(twist.end, amount),
        reach_m,
        setting.tolerances.touch_m,
    )
    if edge_crossing < amount and is_guided and twist.end < math.inf:
        edge_crossing = crossing_on_path(
            setting, placement, contacts, leaving, position, quaternion, twist, edge_crossing, reach_m, work
        )
    if edge_crossing < amount:
        amount, hit = edge_crossing, NO_HIT
    if twist.end < amount:
        amount = twist.end
    if amount == math.inf:
        return amount, True, position, quaternion
    for halving in range(HALVINGS):
        done, new_position, new_quaternion = stepped(
            setting, placement, contacts, position, quaternion, twist, amount, hit, work
        )
        if done:
            return amount, halving == 0, new_position, new_quaternion
        amount, hit = 0.5 * amount, NO_HIT
    return 0.0, False, position, quaternion
