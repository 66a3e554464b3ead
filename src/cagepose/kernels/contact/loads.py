"""What acts on the object: forces, moments and springs, their wrench and their work, (5.2), (5.26) and (5.27). How they
change with the pose is in `load_curvature`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.pose import Quaternion, quaternion_product, rotated
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.contact.cardan import cardan_at, cardan_moment, cardan_turns
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.contact.tolerances import LEAST_OF_WHOLE, LENGTH_OF_NO_SPRING, ROUNDING_OF_ENDS, SHORTEST_SPRING
from cagepose.kernels.native.kernel import kernel

DEAD_FORCE, FOLLOWING_FORCE, DEAD_MOMENT, FOLLOWING_MOMENT, SPRING, CARDAN_MOMENT, FIXED_FORCE = 0, 1, 2, 3, 4, 5, 6
"""Kinds of actions. What is dead keeps its direction in the world, what follows keeps it in the object. A dead force
rides on the object at its point; a fixed one acts at a point of the world, whatever of the object is there."""
STRAIGHT, WINDING, BENT, BOUND = 0, 1, 2, 3
"""How an object flies that touches nothing: its centre of gravity along a straight line; on a helix that is carried
along one; along another way; or so that a spring pulls it back."""
ARCS_PER_TURN = 5.0
"""Along a step the direction of a spring may change by so many times what the object may turn."""


class Action:
    """One force, moment or spring; a record. All zero, it is a force that does nothing.

    Attributes
    ----------
    kind
        See above.
    vector
        Force or moment: in the world, or in the object's frame where it follows. Of a Cardan moment: what drives yaw,
        pitch and roll.
    arm_object
        Where a force or a spring acts, from the centre of gravity, in the object's frame, metres; zero for a fixed
        force. Of a Cardan moment: the axis of roll in the object's frame, a unit vector.
    anchor
        Where a spring is held, or a fixed force acts, as seen from the middle of the cage points, as positions are;
        metres. Of a Cardan moment: the axis of yaw in the world, a unit vector.
    stiffness
        Of a spring, force for each metre.
    tension_at_zero
        What its tension would be if its ends met: at the length l it is ``tension_at_zero + stiffness * l``.
    body
        The body of the cage that the anchor of a spring rides on; 0: it is held in the world.
    """

    kind: int
    vector: Annotated[FloatArray, 3]
    arm_object: Annotated[FloatArray, 3]
    anchor: Annotated[FloatArray, 3]
    stiffness: float
    tension_at_zero: float
    body: int


PhaseLoad = Rows[Action]
"""All that acts in a phase, the weight first."""


class Acting(NamedTuple):
    """An action at a pose: a force, and its moment about the centre of gravity, in the world, as long as the terms that
    it is the sum of, and the part of them that is left of the sum (of a spring; else 1).
    """

    force: Vector
    moment: Vector
    share: float


@kernel
def arm_of(action: Action, quaternion: Quaternion) -> Vector:
    """Return where a force or spring acts, from the centre of gravity, in the world."""
    return rotated(quaternion, vector_from(action.arm_object))


@kernel
def is_idle(action: Action) -> bool:
    """Whether an action is a force that does nothing: no weight in a phase, or the place of an action of another."""
    vector = action.vector
    return action.kind == DEAD_FORCE and vector[0] == 0.0 and vector[1] == 0.0 and vector[2] == 0.0


@kernel
def spring_vector(action: Action, position: Vector, arm: Vector) -> Vector:
    """Return the way from where a spring acts to where it is held."""
    return minus(vector_from(action.anchor), plus(position, arm))


@kernel
def acting(action: Action, position: Vector, quaternion: Quaternion) -> Acting:
    """Return what an action does at a pose."""
    vector = vector_from(action.vector)
    if action.kind == DEAD_FORCE:
        return Acting(vector, cross(arm_of(action, quaternion), vector), 1.0)
    if action.kind == FOLLOWING_FORCE:
        force = rotated(quaternion, vector)
        return Acting(force, cross(arm_of(action, quaternion), force), 1.0)
    if action.kind == FIXED_FORCE:
        return Acting(vector, cross(minus(vector_from(action.anchor), position), vector), 1.0)
    if action.kind == DEAD_MOMENT:
        return Acting((0.0, 0.0, 0.0), vector, 1.0)
    if action.kind == FOLLOWING_MOMENT:
        return Acting((0.0, 0.0, 0.0), rotated(quaternion, vector), 1.0)
    if action.kind == CARDAN_MOMENT:
        joint = cardan_at(vector_from(action.anchor), arm_of(action, quaternion))
        return Acting((0.0, 0.0, 0.0), cardan_moment(joint, vector), 1.0)
    arm = arm_of(action, quaternion)
    way = spring_vector(action, position, arm)
    length = norm(way)
    if length == 0.0:  # it has no direction
        return Acting((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    terms = action.stiffness * length + abs(action.tension_at_zero)
    force = scaled(way, terms / length)
    return Acting(force, cross(arm, force), (action.stiffness * length + action.tension_at_zero) / terms)


@kernel
def write_load(load: PhaseLoad, position: Vector, quaternion: Quaternion, frame: Frame, out: FloatArray) -> float:
    """Write the scaled wrench of a phase's load, D^-1/2 w; return the length of its terms, which may cancel. Those of a
    spring are no shorter than what the rounding of its ends makes of its force, and no action's terms vanish beside
    what of it is held.
    """
    terms = rounding = 0.0
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for which in range(len(load)):
        if is_idle(load[which]):
            continue
        one = acting(load[which], position, quaternion)
        write_scaled_wrench(one.force, one.moment, frame, out)
        whole = norm(one.force) + norm(one.moment) / frame.extent_m
        terms += max(
            math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2 + out[3] ** 2 + out[4] ** 2 + out[5] ** 2),
            LEAST_OF_WHOLE * whole,
        )
        force, moment = plus(force, scaled(one.force, one.share)), plus(moment, scaled(one.moment, one.share))
        if load[which].kind == SPRING:
            ends = norm(vector_from(load[which].anchor)) + norm(position)
            rounding += ROUNDING_OF_ENDS * load[which].stiffness * ends
    write_scaled_wrench(force, moment, frame, out)
    return max(terms, rounding)


@kernel
def pulls_nowhere(load: PhaseLoad, position: Vector, quaternion: Quaternion, size_m: float) -> bool:
    """Whether the ends of a spring have met, which pulls there all the same: in no direction, so that nothing can be
    said of the load.
    """
    for which in range(len(load)):
        action = load[which]
        if action.kind == SPRING and action.tension_at_zero != 0.0:
            way = spring_vector(action, position, arm_of(action, quaternion))
            if norm(way) <= LENGTH_OF_NO_SPRING * size_m:
                return True
    return False


@kernel
def total_load(load: PhaseLoad, position: Vector, quaternion: Quaternion, size_m: float) -> float:
    """Return the sum of what a phase's forces and springs are made of, and of its moments over a length."""
    total = 0.0
    for which in range(len(load)):
        action = load[which]
        if action.kind == SPRING:
            total += norm(acting(action, position, quaternion).force)
        elif action.kind == DEAD_FORCE or action.kind == FOLLOWING_FORCE or action.kind == FIXED_FORCE:
            total += norm(vector_from(action.vector))
        else:
            total += norm(vector_from(action.vector)) / size_m
    return total


@kernel
def joining_twist(
    start: Vector, start_turned: Quaternion, end: Vector, end_turned: Quaternion
) -> tuple[Vector, Vector]:
    """Return (velocity of the centre of gravity at the start, spin) of the screw that leads from one pose to another in
    a unit of time, by the smaller angle (5.27).
    """
    back = (start_turned[0], -start_turned[1], -start_turned[2], -start_turned[3])
    turn = quaternion_product(end_turned, back)
    sense = math.copysign(1.0, turn[0])
    vector = (sense * turn[1], sense * turn[2], sense * turn[3])
    sine = norm(vector)
    way = minus(end, start)
    if sine == 0.0:
        return way, (0.0, 0.0, 0.0)
    half = math.atan2(sine, abs(turn[0]))
    axis = scaled(vector, 1.0 / sine)
    bent = cross(axis, way)
    # 1 - x / tan x loses digits where x is small
    bulge = half * half / 3.0 if half < 1e-4 else 1.0 - half / math.tan(half)
    velocity = plus(plus(way, scaled(bent, -half)), scaled(cross(axis, bent), bulge))
    return velocity, scaled(axis, 2.0 * half)


@kernel
def work_done(load: PhaseLoad, start: Vector, start_turned: Quaternion, end: Vector, end_turned: Quaternion) -> float:
    """Return the work of a phase's load between two poses of the centre of gravity.

    That of dead forces, springs and Cardan moments is what their potential falls, (5.2), (5.26) and (5.37). That of
    other moments, of what follows and of fixed forces is taken along the screw that joins the poses: their power along
    it is constant (5.27).
    """
    work = 0.0
    for which in range(len(load)):
        action = load[which]
        if is_idle(action):
            continue
        arm, turned_arm = arm_of(action, start_turned), arm_of(action, end_turned)
        moved = plus(minus(end, start), minus(turned_arm, arm))
        if action.kind == DEAD_FORCE:
            work += dot(vector_from(action.vector), moved)
        elif action.kind == SPRING:
            before = spring_vector(action, start, arm)
            after = spring_vector(action, end, turned_arm)
            lengths = norm(before) + norm(after)
            mean = 0.5 * action.stiffness
            if lengths > 0.0:
                mean += action.tension_at_zero / lengths
            work += mean * dot(moved, plus(before, after))
        elif action.kind == CARDAN_MOMENT:
            axes = vector_from(action.anchor), vector_from(action.arm_object)
            work += dot(vector_from(action.vector), cardan_turns(axes[0], axes[1], start_turned, end_turned))
        else:
            velocity, spin = joining_twist(start, start_turned, end, end_turned)
            one = acting(action, start, start_turned)
            work += dot(one.force, velocity) + dot(one.moment, spin)
    return work


@kernel
def longest_pull(
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    turn_step_rad: float,
    size_m: float,
    reach_m: float,
) -> float:
    """Return how much of a twist springs keep their direction for, and fixed forces their moment (5.31); inf: there are
    none, or none of them changes. ``reach_m``: how far the object reaches from its centre of gravity.

    A spring whose tension is in proportion to its length has no part in that: its force is linear in the pose.
    """
    amount = math.inf
    for which in range(len(load)):
        action = load[which]
        if action.kind == FIXED_FORCE:
            across, force = norm(cross(vector_from(action.vector), velocity)), norm(vector_from(action.vector))
            if across > 0.0:
                amount = min(amount, ARCS_PER_TURN * turn_step_rad * reach_m * force / across)
        if action.kind != SPRING:
            continue
        arm = arm_of(action, quaternion)
        speed = norm(plus(velocity, cross(spin, arm)))
        length = norm(spring_vector(action, position, arm))
        longest = max(length, size_m)
        if action.tension_at_zero != 0.0:
            longest = ARCS_PER_TURN * turn_step_rad * max(length, SHORTEST_SPRING * size_m)
        if speed > 0.0:
            amount = min(amount, longest / speed)
    return amount


@kernel
def flight(load: PhaseLoad) -> int:
    """Return how an object flies that touches nothing: STRAIGHT, WINDING, BENT or BOUND (5.32)."""
    follows, turns_away, found = False, False, STRAIGHT
    for which in range(len(load)):
        action = load[which]
        if is_idle(action):
            continue
        if action.kind == SPRING:
            found = max(found, BOUND if action.stiffness > 0.0 else BENT)
        elif action.kind == FOLLOWING_FORCE:
            follows = True
        elif (
            action.kind == DEAD_MOMENT
            or action.kind == CARDAN_MOMENT
            or action.kind == FIXED_FORCE
            or norm(vector_from(action.arm_object)) > 0.0
        ):
            turns_away = True  # its moment is not the same in the object's frame
    if follows:
        found = max(found, BENT if turns_away else WINDING)
    return found


@kernel
def drift_and_sway(load: PhaseLoad, position: Vector, quaternion: Quaternion, spin: Vector) -> tuple[Vector, float]:
    """Return the mean velocity of the centre of gravity of an object that flies, STRAIGHT or WINDING, with a spin, and
    how far it strays from a straight line along it (5.32).
    """
    dead, following = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for which in range(len(load)):
        action = load[which]
        if action.kind == DEAD_FORCE or action.kind == FIXED_FORCE:
            dead = plus(dead, vector_from(action.vector))
        elif action.kind == FOLLOWING_FORCE:
            following = plus(following, acting(action, position, quaternion).force)
    rate = norm(spin)
    if rate == 0.0:
        return plus(dead, following), 0.0
    axis = scaled(spin, 1.0 / rate)
    rise = scaled(axis, dot(axis, following))
    return plus(dead, rise), 2.0 * norm(minus(following, rise)) / rate
