"""Where the bodies of the cage are along a drive, how fast they go there, and what their drivers do.

A share from 0 to 1 says how much of a phase's drive is done. All is seen from the middle of the cage, as positions are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, quaternion_product, rotated
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, dtype_of, empty_rows
from cagepose.kernels.algebra.vector import (
    Vector,
    cross,
    dot,
    minus,
    norm,
    plus,
    row,
    scaled,
    times,
    transposed_times,
    vector_from,
)
from cagepose.kernels.boundary.features import number_of_bodies, place_turned
from cagepose.kernels.boundary.geometry import Geometry, cage_at
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.loads import Action, PhaseLoad, acting, arm_of, spring_vector
from cagepose.kernels.contact.metric import moved_along_twist
from cagepose.kernels.contact.pressing import Pressing, press_farther
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.cases import Cases, Start, displacement_of, place_displaced

BEFORE_LEG_ENDS = 1e-12
"""In shares. A leg that has so little left is done."""


class DriveMemory(NamedTuple):
    """Where the bodies of the cage have got to, and how they go on.

    Attributes
    ----------
    begun, reached
        How each body is displaced from its place in the scene: a position and a quaternion, (n_bodies, 7), at the
        beginning of the phase, and now.
    twists
        Velocity, spin and length of each leg, (n_bodies, n_legs, 7).
    n_legs
        How many legs each body follows in the phase, (n_bodies,).
    pressing, tried
        How each body presses, and how far it has gone so, in the rest that was found last, and in one that is tried.
    limits
        The driver's force along its way at which each body stops, at the beginning, and how it changes for a unit
        share, (n_bodies, 2); inf: at none.
    actions, anchors
        What acts in each phase, (n_phases, n_actions), with springs on bodies held where these are now; and where
        springs are held in the scene, (n_phases, n_actions, 3).
    """

    begun: FloatArray
    reached: FloatArray
    twists: FloatArray
    n_legs: IntArray
    pressing: Rows[Pressing]
    tried: Rows[Pressing]
    limits: FloatArray
    actions: Rows[PhaseLoad]
    anchors: FloatArray


def empty_drive_memory(n_phases: int, n_bodies: int, n_legs: int, n_actions: int) -> DriveMemory:
    """Return memory for the drives of a scene, with at most so many legs of a body in a phase, and so many actions
    (plain Python).
    """
    return DriveMemory(
        np.zeros((n_bodies, 7)),
        np.zeros((n_bodies, 7)),
        np.zeros((n_bodies, n_legs, 7)),
        np.zeros(n_bodies, np.int64),
        empty_rows(Pressing, n_bodies),
        empty_rows(Pressing, n_bodies),
        np.full((n_bodies, 2), np.inf),
        np.zeros((n_phases, n_actions), dtype_of(Action)),
        np.zeros((n_phases, n_actions, 3)),
    )


@kernel
def write_pose(out: FloatArray, position: Vector, quaternion: Quaternion) -> None:
    for k in range(3):
        out[k] = position[k]
    for k in range(4):
        out[3 + k] = quaternion[k]


@kernel
def pose_from(numbers: FloatArray) -> tuple[Vector, Quaternion]:
    return vector_from(numbers), (numbers[3], numbers[4], numbers[5], numbers[6])


@kernel
def begin_drives(start: Start, cases: Cases, memory: DriveMemory) -> Start:
    """Return a case whose loads are those of memory, which springs on bodies may be moved in; no phase has begun."""
    n_bodies = number_of_bodies(start.geometry.cage)
    for body in range(n_bodies):
        position, quaternion = displacement_of(cases, start.geometry, body)
        write_pose(memory.reached[body], position, quaternion)
    if n_bodies == 1:
        return start
    for phase in range(len(start.actions)):
        for which in range(len(start.actions[phase])):
            memory.actions[phase][which] = start.actions[phase][which]  # type: ignore[index]
            for k in range(3):
                memory.anchors[phase, which, k] = start.actions[phase][which].anchor[k]
    return Start(
        start.geometry,
        start.position,
        start.quaternion,
        start.origin_world,
        start.size_m,
        start.friction,
        start.tolerances,
        memory.actions,
    )


@kernel
def begin_phase(phase: int, start: Start, cases: Cases, memory: DriveMemory) -> bool:
    """Begin with a phase's drive, where the bodies are; return whether there is one."""
    drives, geometry, is_driven = cases.drives, start.geometry, False
    still = geometry.placed.poses[0]
    turned = (row(still, 1), row(still, 2), row(still, 3))
    middle = scaled(transposed_times(turned, row(still, 0)), -1.0)
    for body in range(number_of_bodies(geometry.cage)):
        memory.n_legs[body] = n_legs = drives.n_legs[phase, body]
        memory.limits[body, 0] = math.inf
        is_driven = is_driven or n_legs > 0
        for k in range(7):
            memory.begun[body, k] = memory.reached[body, k]
        for which in range(n_legs):
            leg, twist = drives.legs[phase][body][which], memory.twists[body, which]
            spin = vector_from(leg.spin)
            velocity = times(turned, plus(vector_from(leg.velocity), cross(spin, middle)))
            spin = times(turned, spin)
            for k in range(3):
                twist[k], twist[3 + k] = velocity[k], spin[k]
            twist[6] = leg.length
    return is_driven


@kernel
def displaced_at(memory: DriveMemory, pressing: Rows[Pressing], body: int, share: float) -> tuple[Vector, Quaternion]:
    """Return how a body is displaced from its place in the scene after a share of the drive, and as far as it has gone
    as it presses.
    """
    position, quaternion = pose_from(memory.begun[body])
    n_legs = memory.n_legs[body]
    for which in range(n_legs):
        amount, twist = min(share * n_legs - which, 1.0), memory.twists[body, which]
        if amount > 0.0:
            spin = (twist[3], twist[4], twist[5])
            velocity = plus(vector_from(twist), cross(spin, position))
            position, quaternion = moved_along_twist(position, quaternion, velocity, spin, amount)
    gone = scaled(vector_from(pressing[body].direction), pressing[body].gone)
    return plus(position, gone), quaternion


@kernel
def move_bodies(geometry: Geometry, phase: int, share: float, memory: DriveMemory) -> None:
    """Place the bodies that are driven where they are after a share of a phase, and the springs that ride on bodies."""
    place_bodies(geometry, phase, share, memory, memory.pressing)


@kernel
def place_bodies(geometry: Geometry, phase: int, share: float, memory: DriveMemory, pressing: Rows[Pressing]) -> None:
    """As `move_bodies`, with what presses where it is at a rest, or in a trial."""
    n_bodies = number_of_bodies(geometry.cage)
    if n_bodies == 1:
        return
    for body in range(1, n_bodies):
        if memory.n_legs[body] > 0 or pressing[body].freedom > 0:
            position, quaternion = displaced_at(memory, pressing, body, share)
            write_pose(memory.reached[body], position, quaternion)
            place_displaced(geometry, body, position, quaternion)
    moved = memory.actions[phase]
    for which in range(len(moved)):
        body = moved[which].body
        if body > 0:
            position, quaternion = pose_from(memory.reached[body])
            anchor = plus(position, rotated(quaternion, vector_from(memory.anchors[phase, which])))
            for k in range(3):
                moved[which].anchor[k] = anchor[k]


@kernel
def press_on_by(geometry: Geometry, pressing: Rows[Pressing], motion: FloatArray, amount: float) -> None:
    """Let bodies that press go on by a part of a scaled motion of all that can move."""
    for body in range(1, len(pressing)):
        own = pressing[body].freedom
        if own > 0:
            press_farther(pressing[body], amount * motion[own])
            pose, way = geometry.placed.poses[body], scaled(vector_from(pressing[body].direction), amount * motion[own])
            rotation = (row(pose, 1), row(pose, 2), row(pose, 3))
            place_turned(cage_at(geometry, body), plus(row(pose, 0), way), rotation)


@kernel
def next_leg(memory: DriveMemory, share: float) -> float:
    """Return the share after which a body goes on along another leg, or the drive ends."""
    nearest = 1.0
    for body in range(len(memory.n_legs)):
        for which in range(1, memory.n_legs[body]):
            ends = which / memory.n_legs[body]
            if ends > share + BEFORE_LEG_ENDS:
                nearest = min(nearest, ends)
    return nearest


@kernel
def leg_at(memory: DriveMemory, body: int, share: float) -> int:
    """Return the leg along which a body goes on after a share; -1: it stands still."""
    n_legs: int = memory.n_legs[body]
    return min(int((share + BEFORE_LEG_ENDS) * n_legs), n_legs - 1)


@kernel
def twist_of_body(memory: DriveMemory, body: int, share: float) -> tuple[Vector, Vector]:
    """Return (velocity of its material at the origin, spin) of a body for a unit share, as it goes on after one."""
    which = leg_at(memory, body, share)
    if which < 0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    twist, n_legs = memory.twists[body, which], memory.n_legs[body]
    return scaled(vector_from(twist), n_legs), scaled((twist[3], twist[4], twist[5]), n_legs)


@kernel
def write_drift(contacts: ContactSet, i: int, position: Vector, share: float, memory: DriveMemory) -> None:
    """Write how fast a contact closes and slips because its body is driven, for a unit share."""
    contact = contacts.rows[i]
    velocity, spin = twist_of_body(memory, contact.cage_body, share)
    there = plus(velocity, cross(spin, plus(position, vector_from(contact.arm))))
    for j in range(3):
        contact.drift[j] = -dot(vector_from(contact.directions[j]), there)


@kernel
def write_drivers(
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    share: float,
    memory: DriveMemory,
    out: FloatArray,
) -> float:
    """Write the force and the moment about the origin that each body needs in balance with contacts and springs, and
    how much of them is along its way, (n_bodies, 7); return the sum along the ways.
    """
    for body in range(len(out)):
        for k in range(7):
            out[body, k] = 0.0
    for i in range(contacts.used[0]):
        contact, state = contacts.rows[i], contacts.states[i]
        force = (0.0, 0.0, 0.0)
        for j in range(3):
            force = plus(force, scaled(vector_from(contact.directions[j]), -state.forces[j]))
        add_force(out[contact.cage_body], force, plus(position, vector_from(contact.arm)))
    for which in range(len(load)):
        if load[which].body > 0:
            one = acting(load[which], position, quaternion)
            add_force(out[load[which].body], scaled(one.force, one.share), vector_from(load[which].anchor))
    total = 0.0
    for body in range(len(out)):
        which = leg_at(memory, body, share)
        if which >= 0:
            driver, velocity = out[body], vector_from(memory.twists[body, which])
            twist = memory.twists[body, which]
            power = dot(vector_from(driver), velocity)
            for k in range(3):
                power += driver[3 + k] * twist[3 + k]
            driver[6] = power / twist[6]
            total += driver[6]
    return total


@kernel
def has_limit(stop_at: float, memory: DriveMemory) -> bool:
    """Whether the drive stops at a force."""
    found = stop_at < math.inf
    for body in range(len(memory.limits)):
        found = found or memory.limits[body, 0] < math.inf
    return found


@kernel
def left_to_limit(stop_at: float, total: float, share: float, drivers: FloatArray, memory: DriveMemory) -> float:
    """Return how much the drivers' forces may still rise, the sum of them up to ``stop_at`` and that of each body up to
    its own limit, as a part of these; below zero: one is past it; inf: there are none.
    """
    left = (stop_at - total) / stop_at if stop_at < math.inf else math.inf
    for body in range(len(drivers)):
        limit, rate = memory.limits[body, 0], memory.limits[body, 1]
        if limit < math.inf:
            left = min(left, (limit + rate * share - drivers[body, 6]) / max(abs(limit), abs(rate)))
    return left


@kernel
def slack_at(share: float, memory: DriveMemory) -> float:
    """Return the share from which on a body that nothing resists is held by its limit, which is zero; inf: none is."""
    nearest = math.inf
    for body in range(len(memory.limits)):
        limit, rate = memory.limits[body, 0], memory.limits[body, 1]
        if limit < math.inf and rate < 0.0 and limit > 0.0:
            nearest = min(nearest, max(-limit / rate, share))
    return nearest


@kernel
def add_force(out: FloatArray, force: Vector, place: Vector) -> None:
    """Add a force and its moment about the origin."""
    moment = cross(place, force)
    for k in range(3):
        out[k] += force[k]
        out[3 + k] += moment[k]


@kernel
def seen_from_body(
    memory: DriveMemory,
    begun: Rows[Pressing],
    body: int,
    shares: tuple[float, float],
    end: Vector,
    turned: Quaternion,
) -> tuple[Vector, Quaternion]:
    """Return a pose after the second share as a body sees it that has stayed where it was after the first one, which is
    where what presses had ``begun``; it is now as in a trial.
    """
    position, quaternion = displaced_at(memory, begun, body, shares[0])
    later, later_turned = displaced_at(memory, memory.tried, body, shares[1])
    back = (later_turned[0], -later_turned[1], -later_turned[2], -later_turned[3])
    by = quaternion_product(quaternion, back)
    return plus(position, rotated(by, minus(end, later))), quaternion_product(by, turned)


@kernel
def is_driven_by(memory: DriveMemory, load: PhaseLoad) -> bool:
    """Whether a spring rides on a body that is driven."""
    found = False
    for which in range(len(load)):
        found = found or (load[which].body > 0 and memory.n_legs[load[which].body] > 0)
    return found


@kernel
def write_displacement(geometry: Geometry, memory: DriveMemory, body: int, out: FloatArray) -> None:
    """Write how a body is displaced from its place in the scene, in the cage's frame: the way back of
    `displacement_of`.
    """
    still = geometry.placed.poses[0]
    turned, origin = (row(still, 1), row(still, 2), row(still, 3)), row(still, 0)
    position, quaternion = pose_from(memory.reached[body])
    moved = transposed_times(turned, plus(position, minus(rotated(quaternion, origin), origin)))
    axis = transposed_times(turned, (quaternion[1], quaternion[2], quaternion[3]))
    write_pose(out, moved, (quaternion[0], axis[0], axis[1], axis[2]))


@kernel
def energy_of_riding(load: PhaseLoad, position: Vector, quaternion: Quaternion) -> float:
    """Return the energy of the springs that ride on bodies."""
    energy = 0.0
    for which in range(len(load)):
        action = load[which]
        if action.body > 0:
            stretched = norm(spring_vector(action, position, arm_of(action, quaternion)))
            energy += (0.5 * action.stiffness * stretched + action.tension_at_zero) * stretched
    return energy
