"""One step of the quasistatic path: how far along a twist, to which contact, and back on the faces."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import (
    Vector,
    cross,
    dot,
    matrix_from,
    minus,
    norm,
    plus,
    row,
    scaled,
    times,
    vector_from,
)
from cagepose.kernels.collision.first_contact import allowed_depth, first_contact_screw, first_contact_travel
from cagepose.kernels.collision.first_meeting import NO_HIT, Hit, first_meeting
from cagepose.kernels.collision.geometry import Geometry, Placement, place_object
from cagepose.kernels.contact.contact_set import ContactSet, stays_on_face
from cagepose.kernels.contact.friction import Friction
from cagepose.kernels.contact.loads import (
    BENT,
    BOUND,
    STRAIGHT,
    PhaseLoad,
    drift_and_sway,
    flight,
    total_load,
    work_done,
)
from cagepose.kernels.contact.metric import Body, moved_along_twist
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.edge_crossing import first_edge_crossing
from cagepose.kernels.quasistatic.projection import (
    GAP,
    Constraints,
    add_constraint,
    constrain_features,
    empty_constraints,
    projected,
)
from cagepose.kernels.quasistatic.straying import STRAYED, strayed
from cagepose.kernels.shapes.meetings import most_meetings
from cagepose.kernels.shapes.motion import motion_of

HALVINGS = 40
"""How often a step is halved that a contact, or the potential, does not let end."""
POINTS_PUSHED = 8
"""Points and shapes that may be pushed out of the object after a step."""
NONE_DEEP, UNKNOWN_DEEP = -1, -2
"""Instead of a meeting that is too deep."""
ROUNDING = 1e-15
"""In lengths of the terms of a load: a slower motion may be no motion."""
STRAIGHT_TRAVEL = 1e-14
"""Radians for each length of the object: a motion that turns by less is a travel."""
OUT_OF_REACH = 10.0
"""In sizes of the scene from all cage points: an object that flies on there has escaped, wherever its load turns to."""


class Setting(NamedTuple):
    """What does not change during a phase.

    Attributes
    ----------
    geometry, body, load
        The scene, with its cage points and boxes as seen from the centre of gravity, and the load of the phase.
    size_m
        The scene's size, metres.
    friction
        Coefficients of friction.
    turn_step_rad
        Longest turn in one step.
    tolerances
        See there.
    """

    geometry: Geometry
    body: Body
    load: PhaseLoad
    size_m: float
    friction: Friction
    turn_step_rad: float
    tolerances: KernelTolerances


class StepWorkspace(NamedTuple):
    """Workspace for one step: contacts to keep, and the depth allowed to each point, (n_points,), and to each pair of
    shapes, (n_parts, n_cage_parts), metres.
    """

    constraints: Constraints
    allowed: FloatArray
    allowed_shapes: FloatArray


def empty_step_workspace(geometry: Geometry) -> StepWorkspace:
    """Return a workspace for one step (plain Python)."""
    n_points, pairs = len(geometry.points_world), (len(geometry.held.parts), len(geometry.cage.parts))
    n_constraints = 3 * (n_points + most_meetings(*pairs)) + POINTS_PUSHED
    return StepWorkspace(empty_constraints(n_constraints), np.zeros(n_points), np.zeros(pairs))


class Twist(NamedTuple):
    """A motion at constant twist.

    Attributes
    ----------
    velocity, spin
        Of the centre of gravity, and angular, for each unit of the amount.
    end
        The greatest amount; inf: a travel with no end of its own.
    """

    velocity: Vector
    spin: Vector
    end: float


@kernel
def straightened(velocity: Vector, spin: Vector, reach_m: float, terms: float) -> Vector:
    """Return the spin, or zero where it is rounding, of the motion or of the terms of the load that it is left of."""
    if norm(spin) * reach_m <= max(STRAIGHT_TRAVEL * norm(velocity), ROUNDING * terms):
        return (0.0, 0.0, 0.0)
    return spin


@kernel
def longest_step(
    contacts: ContactSet, velocity: Vector, spin: Vector, slides: bool, turn_step_rad: float, size_m: float
) -> float:
    """Return how much of a twist keeps its direction: its turn, that of the normals of round shapes that slide, and how
    far sliding contacts leave their faces, stay small (5.11).
    """
    amount = math.inf
    for i in range(contacts.used[0] if len(contacts.bends) > 0 else 0):
        contact = contacts.rows[i]
        if contact.feature >= 0 and stays_on_face(contacts, i):
            way = plus(velocity, cross(spin, vector_from(contact.arm)))
            turns = norm(times(matrix_from(contacts.bends[i].relative), way))
            if turns > 0.0 and turns * amount > turn_step_rad:
                amount = turn_step_rad / turns
    rate = norm(spin)
    if rate == 0.0:
        return amount
    amount = min(amount, turn_step_rad / rate)
    speed = norm(velocity)
    if slides and speed > 0.0:
        amount = min(amount, turn_step_rad * math.sqrt(0.5 * size_m / (rate * speed)))
    return amount


@kernel
def first_contact(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
) -> Hit:
    """Return the first contact along a twist, but for what touches already: of points and boxes, or of shapes."""
    hit = first_point(setting, placement, contacts, position, quaternion, twist)
    if len(setting.geometry.held.parts) == 0:
        return hit
    motion = motion_of(position, twist.velocity, twist.spin)
    end = min(hit.amount, twist.end)
    if motion.rate == 0.0:
        other = first_meeting(setting.geometry, placement, motion, end, 0.0, 0.0)
        return other if other.amount < hit.amount else hit
    astray = strayed(setting.geometry, contacts, position, quaternion, twist.velocity, twist.spin, end, placement.moved)
    near, other = 0.0, NO_HIT
    for _ in range(most_pairs(placement)):
        other = first_meeting(setting.geometry, placement, motion, end, near, STRAYED * astray)
        if other.point < 0 or other.gap <= near:
            break
        reach = STRAYED * strayed(
            setting.geometry, contacts, position, quaternion, twist.velocity, twist.spin, other.amount, placement.moved
        )
        if other.gap > reach:
            break
        near = reach
    return other if other.amount < hit.amount else hit


@kernel
def most_pairs(placement: Placement) -> int:
    return placement.meetings.gaps.size


@kernel
def first_point(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
) -> Hit:
    """Return the first contact of a point and a box along a twist, but for what touches already.

    Contacts that stay on their faces stray on a screw, by the square of its length, and are put back afterwards. Where
    a point is met because of that, not because it came nearer, it is passed over: whether it is reached shows at the
    end.
    """
    end = twist.end
    touch_m = setting.tolerances.touch_m
    rate = norm(twist.spin)
    if rate == 0.0:
        speed = norm(twist.velocity)
        distance, point, box = first_contact_travel(
            setting.geometry, placement, scaled(twist.velocity, 1.0 / speed), touch_m, setting.tolerances
        )
        amount = distance / speed
    else:
        astray = strayed(
            setting.geometry, contacts, position, quaternion, twist.velocity, twist.spin, end, placement.moved
        )
        near, near_depth = 0.0, STRAYED * astray
        angle, point, box = math.inf, -1, -1
        for _ in range(len(setting.geometry.points_world)):
            angle, point, box = first_contact_screw(
                setting.geometry,
                placement,
                position,
                scaled(twist.velocity, 1.0 / rate),
                scaled(twist.spin, 1.0 / rate),
                end * rate,
                touch_m,
                near,
                near_depth,
                setting.tolerances,
            )
            if point < 0 or placement.gaps[box, point] <= near:
                break
            met = angle / rate
            reach = STRAYED * strayed(
                setting.geometry, contacts, position, quaternion, twist.velocity, twist.spin, met, placement.moved
            )
            if placement.gaps[box, point] > reach:
                break
            near = reach
        amount = angle / rate
    if amount > end or point < 0:
        return NO_HIT
    return Hit(amount, point, box, -1, -1, placement.gaps[box, point])


@kernel
def shallowest_face(geometry: Geometry, placement: Placement, point: int, box: int) -> tuple[int, float]:
    """Return (axis, side) of the face of ``box`` that the point is nearest to from inside, or farthest beyond."""
    best_axis, best_gap = 0, -math.inf
    for axis in range(3):
        gap = abs(placement.points_box[box, axis, point]) - geometry.half_sizes[box, axis]
        if gap > best_gap:
            best_axis, best_gap = axis, gap
    return best_axis, math.copysign(1.0, placement.points_box[box, best_axis, point])


@kernel
def constrain_to_face(geometry: Geometry, placement: Placement, point: int, box: int, constraints: Constraints) -> bool:
    """Constrain a point to the face of a box that it has reached."""
    axis, side = shallowest_face(geometry, placement, point, box)
    return add_constraint(constraints, point, box, axis, side, geometry.half_sizes[box, axis])


@kernel
def constrain_contacts(
    geometry: Geometry, placement: Placement, contacts: ContactSet, closed_m: float, constraints: Constraints
) -> None:
    """Constrain the contacts that stay on their faces, and where they stick also in the face.

    Gaps above ``closed_m`` are kept: to close them could take work, or bring another point in.
    """
    constraints.scratch[0].used = 0
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if stays_on_face(contacts, i) and contact.feature >= 0:
            kept = contact.gap if contact.gap > closed_m else 0.0
            constrain_features(constraints, contact.feature, contact.cage_feature, GAP, kept)
        elif stays_on_face(contacts, i):
            at = geometry.half_sizes[contact.box, contact.axis]
            if contact.gap > closed_m:
                at += contact.gap
            add_constraint(constraints, contact.point, contact.box, contact.axis, contact.side, at)
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if contacts.states[i].forces[0] > 0.0 and contacts.states[i].is_sticking:
            for turn in range(1, 3):
                if contact.feature >= 0:
                    constrain_features(constraints, contact.feature, contact.cage_feature, turn, 0.0)
                    continue
                axis = (contact.axis + turn) % 3
                at = placement.points_box[contact.box, axis, contact.point]
                add_constraint(constraints, contact.point, contact.box, axis, 1.0, at)


@kernel
def deepest_offender(placement: Placement, allowed: FloatArray) -> int:
    """Return the point that is farthest deeper than it may; -1: none."""
    worst_point, worst = -1, 0.0
    for point in range(len(allowed)):
        excess = placement.depths[point] - allowed[point]
        if excess > worst:
            worst_point, worst = point, excess
    return worst_point


@kernel
def box_around(geometry: Geometry, placement: Placement, point: int) -> int:
    """Return the box that the point lies deepest in."""
    best_box, best_gap = 0, math.inf
    for box in range(len(geometry.half_sizes)):
        gap = placement.gaps[box, point]
        if gap < best_gap:
            best_box, best_gap = box, gap
    return best_box


@kernel
def pushed_out(
    setting: Setting, placement: Placement, position: Vector, quaternion: Quaternion, work: StepWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Make all constraints hold, and push points out of the object that this has brought in; placement is filled."""
    geometry = setting.geometry
    holds = True
    for _ in range(POINTS_PUSHED):
        if work.constraints.scratch[0].used > 0:
            holds, position, quaternion = projected(
                geometry, setting.body, position, quaternion, work.constraints, setting.size_m, placement.moved
            )
        place_object(geometry, position, quaternion, placement)
        point, meeting = deepest_offender(placement, work.allowed), deepest_meeting(placement, work)
        if not holds or (point < 0 and meeting == NONE_DEEP):
            break
        if point >= 0:
            box = box_around(geometry, placement, point)
            if not constrain_to_face(geometry, placement, point, box, work.constraints):
                return False, position, quaternion
        elif meeting == UNKNOWN_DEEP or not constrain_meeting(placement, meeting, work.constraints):
            return False, position, quaternion
    is_out = deepest_offender(placement, work.allowed) < 0 and deepest_meeting(placement, work) == NONE_DEEP
    return holds and is_out, position, quaternion


@kernel
def deepest_meeting(placement: Placement, work: StepWorkspace) -> int:
    """Return the meeting of shapes that is farthest deeper than it may; UNKNOWN_DEEP: parts are, but at no known place;
    NONE_DEEP: none is.
    """
    meetings, found, worst = placement.meetings, NONE_DEEP, 0.0
    if meetings.used[0] < 0:
        return UNKNOWN_DEEP
    for one in range(meetings.gaps.shape[0]):
        for other in range(meetings.gaps.shape[1]):
            if -meetings.gaps[one, other] - work.allowed_shapes[one, other] > worst:
                found, worst = UNKNOWN_DEEP, -meetings.gaps[one, other] - work.allowed_shapes[one, other]
    worst = 0.0
    for at in range(meetings.used[0]):
        row = meetings.rows[at]
        excess = -row.gap - work.allowed_shapes[row.part, row.cage_part]
        if excess > worst and not row.is_hidden:
            found, worst = at, excess
    return found


@kernel
def constrain_meeting(placement: Placement, at: int, constraints: Constraints) -> bool:
    """Constrain the gap of a meeting that is too deep to zero."""
    row = placement.meetings.rows[at]
    return constrain_features(constraints, row.feature, row.cage_feature, GAP, 0.0)


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
    False: a point would be inside, a contact would not stay on its face, or the loads would do negative work. The
    placement is that of the new pose, or of the old one.
    """
    geometry = setting.geometry
    constrain_contacts(geometry, placement, contacts, setting.tolerances.rounding_m, work.constraints)
    moved = moved_along_twist(position, quaternion, twist.velocity, twist.spin, amount)
    if hit.feature >= 0:
        constrain_features(work.constraints, hit.feature, hit.cage_feature, GAP, 0.0)
    elif hit.point >= 0:
        place_object(geometry, moved[0], moved[1], placement)
        constrain_to_face(geometry, placement, hit.point, hit.box, work.constraints)
    done, new_position, new_quaternion = pushed_out(setting, placement, moved[0], moved[1], work)
    if done:
        total = total_load(setting.load, position, quaternion, setting.size_m)
        rounding = setting.tolerances.resolution_m * total
        done = work_done(setting.load, position, quaternion, new_position, new_quaternion) >= -rounding
    if done:
        return True, new_position, new_quaternion
    place_object(geometry, position, quaternion, placement)
    return False, position, quaternion


@kernel
def nothing_ahead(setting: Setting, position: Vector, quaternion: Quaternion, velocity: Vector, spin: Vector) -> bool:
    """Whether an object that touches nothing, and begins to move with a velocity and a spin, has got away (5.32).

    Where the way of its centre of gravity is known for ever, straight or winding, no cage point may be met on it. A way
    that is not straight also leads away where it is out of reach and goes on. A spring with stiffness brings it back.
    """
    kind = flight(setting.load)
    if kind == BOUND:
        return False
    if kind != STRAIGHT and is_out_of_reach(setting, position, velocity):
        return True
    if kind == BENT:
        return False
    drift, sway = drift_and_sway(setting.load, position, quaternion, spin)
    size = norm(drift)
    if size == 0.0:
        return False
    along = scaled(drift, 1.0 / size)
    for point in range(len(setting.geometry.points_world)):
        ahead = 0.0
        distance = 0.0
        for k in range(3):
            ahead += (setting.geometry.points_world[point, k] - position[k]) * along[k]
        for k in range(3):
            away = setting.geometry.points_world[point, k] - position[k] - max(ahead, 0.0) * along[k]
            distance += away * away
        if math.sqrt(distance) <= setting.body.reach_m + sway:
            return False
    cage = setting.geometry.cage.parts
    for which in range(len(setting.geometry.points_world), len(cage)):
        arm = minus(vector_from(cage[which].middle), position)
        away = norm(minus(arm, scaled(along, max(dot(arm, along), 0.0))))
        if away <= setting.body.reach_m + sway + cage[which].reach:
            return False
    return True


@kernel
def is_out_of_reach(setting: Setting, position: Vector, velocity: Vector) -> bool:
    """Whether the object is sizes of the scene away from all cage points, and goes away from their middle."""
    if dot(position, velocity) <= 0.0:
        return False
    for point in range(len(setting.geometry.points_world)):
        away = norm(minus(row(setting.geometry.points_world, point), position))
        if away <= OUT_OF_REACH * setting.size_m + setting.body.reach_m:
            return False
    cage = setting.geometry.cage.parts
    for which in range(len(setting.geometry.points_world), len(cage)):
        away = norm(minus(vector_from(cage[which].middle), position)) - cage[which].reach
        if away <= OUT_OF_REACH * setting.size_m + setting.body.reach_m:
            return False
    return True


@kernel
def allow_depths(placement: Placement, tolerances: KernelTolerances, work: StepWorkspace) -> None:
    """Write how deep each point and each pair of shapes may be after the step: no deeper than it is."""
    for point in range(len(work.allowed)):
        work.allowed[point] = allowed_depth(placement.depths[point], tolerances)
    gaps = placement.meetings.gaps
    for one in range(gaps.shape[0]):
        for other in range(gaps.shape[1]):
            work.allowed_shapes[one, other] = allowed_depth(-gaps[one, other], tolerances)


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
    """Go along a twist to its end, the first contact or the edge of a face that carries, or less if need be.

    Return (amount, whether it went as far as it should, position, quaternion); amount 0: it could not move; inf:
    nothing is ahead.
    """
    allow_depths(placement, setting.tolerances, work)
    hit = first_contact(setting, placement, contacts, position, quaternion, twist)
    amount = hit.amount
    edge_crossing = first_edge_crossing(
        setting.geometry,
        placement,
        contacts,
        position,
        quaternion,
        twist.velocity,
        twist.spin,
        twist.end,
        setting.tolerances.touch_m,
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
