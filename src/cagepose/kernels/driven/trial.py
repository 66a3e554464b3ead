"""Where a drive may get to in one step: the rest of the mode there, and the guards that say whether the mode lasts."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.elimination import eliminate
from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.geometry import cage_at, held_moved
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.contact.coulomb_newton import CARRYING_LIMIT, SLIPS, STICKS, NewtonWorkspace, n_forces
from cagepose.kernels.contact.metric import frame_at, moved_along_twist, twist_of, way_between
from cagepose.kernels.contact.pressing import copy_pressing
from cagepose.kernels.driven.bodies import (
    has_limit,
    left_to_limit,
    move_bodies,
    press_on_by,
    twist_of_body,
    write_drift,
    write_drivers,
)
from cagepose.kernels.driven.rate import APART, NO_SLIP, copy_contact, slip_of, speed_of, write_change
from cagepose.kernels.driven.rest_of_mode import (
    NEARLY_ON_FACE,
    along_slip,
    follow_contact,
    list_carrying,
    rest_of_mode,
    weights_of_turn,
    write_system,
)
from cagepose.kernels.driven.stiffness import hold_carried, least_stiffness
from cagepose.kernels.driven.workspace import HITS_LIMIT, OF_CARRYING, DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.edge_crossing import beyond_end, reach_within
from cagepose.kernels.quasistatic.first_contact import Hit
from cagepose.kernels.quasistatic.path import gap_of
from cagepose.kernels.quasistatic.pushing_out import is_fixed

STILL = 1e-6
"""In sizes of the scene: so little is always allowed, as contacts are put on their faces, and where forces jump."""
LEAP = 8.0
"""Times the way that the object, or a body, would go on: a rest that is farther away is another one."""
NEXT_TO_NOTHING = 1e-12
"""In sizes of the scene, in slips: so far a guard may be below zero."""
NO_FORCE = 1e-9
"""In greatest forces. Likewise: what a rest leaves of the balance, contacts that carry nothing share."""
OF_NO_LOAD = 1e-4
"""In what a load is measured by where there is none: forces are compared with so much at least, as all are rounding."""
TURNS_BACK = 1e-6
"""In speeds: a slip that turns back by less still goes on."""
LITTLE = 1e-5
"""Of a step: so far a mode is tried."""
BEGINS = 1e-9
"""In sizes of the scene: a contact that begins to slip is taken to have slipped so far, so that its friction has a
direction."""
KEPT_GAP = 1e-10
"""In sizes of the scene: a gap that a contact which sticks keeps, and where one does any other contact, too, as nothing
can close it then; but for gaps that will do as closed."""
LEAST_STABLE = 1e-9
"""In the stiffness: what is no more unstable than this is indifferent."""


@kernel
def first_of_others() -> int:
    """Return the place of the guards of contacts that do not carry, behind those that do."""
    return OF_CARRYING * CARRYING_LIMIT


@kernel
def one_sticks(newton: NewtonWorkspace) -> bool:
    found = False
    for place in range(newton.n_carrying):
        found = found or newton.modes[place] == STICKS
    return found


@kernel
def begin_trial(drive: DriveSetting, share: float, ahead: float, work: DriveWorkspace) -> None:
    """Copy the contacts with their mode, and how far they slip on an advance: one that has stuck so far begins to slip
    where its friction resists it.
    """
    contacts, trial, rest = work.run.contacts, work.run.ahead, work.scratch[0].rest
    way = work.scratch[0].way
    still = (0.0, 0.0, 0.0)
    slow = NO_SLIP * max(speed_of(contacts, way), fastest_of(drive, share, still, still, work))
    trial.used[0] = contacts.used[0]
    copy_pressing(work.memory.pressing, work.memory.tried)
    for i in range(contacts.used[0]):
        copy_contact(contacts, i, trial, i)
    list_carrying(trial, drive.setting.friction.greatest, rest)
    size_m, sticks = drive.setting.size_m, one_sticks(rest.newton)
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        forces, gap = contacts.states[i].forces, contacts.rows[i].gap
        least = 0.0 if rest.newton.modes[place] == STICKS else NEARLY_ON_FACE * size_m
        is_kept = sticks and least <= abs(gap) <= KEPT_GAP * size_m
        rest.gaps[place] = gap if is_kept else 0.0
        one, two = slip_of(contacts, i, way)
        resists = math.sqrt(forces[1] ** 2 + forces[2] ** 2)
        begins = rest.newton.modes[place] == SLIPS and math.sqrt(one * one + two * two) <= slow
        rest.slips[place, 0], rest.slips[place, 1] = one * ahead, two * ahead
        if begins and resists > 0.0:
            least_m = max(slow * ahead, BEGINS * drive.setting.size_m)
            for which in range(2):
                rest.slips[place, which] = least_m * forces[1 + which] / resists


@kernel
def worst_gap(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> float:
    """Return the greatest gap, in or out, of what carries at a pose, metres; inf: one of them meets nothing there."""
    setting, trial, newton, worst = drive.setting, work.run.ahead, work.scratch[0].rest.newton, 0.0
    frame = frame_at(setting.body, quaternion)
    for place in range(newton.n_carrying):
        i = newton.contacts[place]
        if not follow_contact(setting.geometry, work.run.placement, trial, i, position, quaternion, frame).is_one:
            return math.inf
        worst = max(worst, abs(trial.rows[i].gap))
    return worst


@kernel
def go_on(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> tuple[Vector, Quaternion]:
    """Return a pose where the way of the scratch leads to: a screw, as of what turns about a corner; or straight on, as
    of what rolls, if that keeps what carries nearer to its faces. What sticks has slipped there by the mean of how fast
    it slips at both ends, as its place moves where it rolls.
    """
    setting, trial, rest, ahead = drive.setting, work.run.ahead, work.scratch[0].rest, to_share - share
    velocity, spin = twist_of(work.scratch[0].way, frame_at(setting.body, quaternion))
    press_on_by(setting.geometry, work.memory.tried, work.scratch[0].way, ahead)
    if norm(velocity) + norm(spin) == 0.0:
        return position, quaternion
    end, turned = moved_along_twist(position, quaternion, velocity, spin, ahead)
    goes = plus(velocity, cross(spin, minus(end, position)))
    if not one_sticks(rest.newton):
        return end, turned
    off, straight = worst_gap(drive, end, turned, work), plus(position, scaled(velocity, ahead))
    if off > NEXT_TO_NOTHING * setting.size_m:
        if worst_gap(drive, straight, turned, work) < off:
            end, goes = straight, velocity
        else:
            worst_gap(drive, end, turned, work)
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        if rest.newton.modes[place] != STICKS:
            continue
        write_drift(trial, i, end, to_share - APART, work.memory)
        row = trial.rows[i]
        along = plus(goes, cross(spin, vector_from(row.arm)))
        for which in range(2):
            slips = (dot(vector_from(row.directions[1 + which]), along) + row.drift[1 + which]) * ahead
            rest.slips[place, which] = 0.5 * (rest.slips[place, which] + slips)
    return end, turned


@kernel
def try_share(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Return whether the mode of ``work.run.contacts`` has a rest where the bodies are after another share, and its
    pose. Filled: ``work.run.ahead``, with what the contacts do there.
    """
    scratch, setting = work.scratch[0], drive.setting
    ahead = to_share - share
    begin_trial(drive, share, ahead, work)
    move_bodies(setting.geometry, drive.phase, to_share, work.memory)
    end, turned = go_on(drive, position, quaternion, share, to_share, work)
    found, end, turned = rest_of_mode(setting, work.run.placement, work.run.ahead, end, turned, scratch.rest)
    moved = way_between(position, quaternion, end, turned, setting.body.reach_m)
    velocity, spin = twist_of(scratch.way, frame_at(setting.body, quaternion))
    most = LEAP * ahead * fastest_of(drive, share, velocity, spin, work) + STILL * setting.size_m
    scratch.leap = (most - moved) / most
    return found, end, turned


@kernel
def fastest_of(drive: DriveSetting, share: float, velocity: Vector, spin: Vector, work: DriveWorkspace) -> float:
    """Return how fast the object goes at most, or a body that is driven, metres for a unit share; at least a little."""
    reach_m, memory = drive.setting.body.reach_m, work.memory
    fastest = norm(velocity) + reach_m * norm(spin)
    for body in range(len(memory.n_legs)):
        body_velocity, body_spin = twist_of_body(memory, body, share)
        fastest = max(fastest, norm(body_velocity) + drive.setting.size_m * norm(body_spin))
    return fastest


@kernel
def write_way(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, apart: float, work: DriveWorkspace
) -> None:
    """Write how the rest of ``work.run.ahead`` goes on, or has come, for a unit share, into the scratch."""
    scratch, setting, trial = work.scratch[0], drive.setting, work.run.ahead
    rest, n_freedoms, frame = scratch.rest, trial.n_freedoms, frame_at(setting.body, quaternion)
    n = n_freedoms
    for place in range(rest.newton.n_carrying):
        n += n_forces(rest.newton.modes[place])
    for i in range(trial.used[0]):
        write_drift(trial, i, position, share + min(apart, 0.0), work.memory)
    write_change(drive, trial, position, quaternion, frame, share, apart, work.memory.tried, work)
    stiff = write_system(trial, setting.friction.greatest, rest.least_stiffness, n, rest)
    newton = rest.newton
    for k in range(n_freedoms):
        newton.matrix[k, n] = scratch.change[k]
    for place in range(newton.n_carrying):
        i, first = newton.contacts[place], newton.first_unknowns[place]
        for which in range(3 if newton.modes[place] == STICKS else 1):
            newton.matrix[first + which, n] = -stiff * trial.rows[i].drift[which]
        if newton.modes[place] == SLIPS:
            size, one, two = along_slip(place, rest)
            turning, _ = weights_of_turn(setting.friction.greatest * trial.states[i].forces[0], stiff * size)
            drift = trial.rows[i].drift
            newton.matrix[first + 1, n] = -stiff * turning * (one * drift[2] - two * drift[1])
    eliminate(newton.matrix, newton.order, newton.greatest_of, n)
    for k in range(n):
        newton.changes[newton.order[k]] = newton.matrix[k, n]
    for k in range(n_freedoms):
        scratch.end_way[k] = newton.changes[k]


@kernel
def has_reach(drive: DriveSetting, i: int, met: Meeting, work: DriveWorkspace) -> bool:
    """Whether the features of a contact of ``work.run.ahead``, placed where the object is, reach where they meet."""
    row, geometry = work.run.ahead.rows[i], drive.setting.geometry
    moved, touch_m = held_moved(geometry, work.run.placement), drive.setting.tolerances.touch_m
    return reach_within(geometry, moved, row.feature, row.cage_feature, met, touch_m, 0.0)


@kernel
def way_to_end(drive: DriveSetting, i: int, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> float:
    """Return how far a contact of ``work.run.ahead`` is from where it ends, in sizes of the scene, where it is one of a
    vertex and a face; else inf: its features still reach where they meet, or -1: they do not.
    """
    setting, row, frame = drive.setting, work.run.ahead.rows[i], frame_at(drive.setting.body, quaternion)
    met = follow_contact(setting.geometry, work.run.placement, work.run.ahead, i, position, quaternion, frame)
    reaches = met.is_one and has_reach(drive, i, met, work)
    moved, cage = held_moved(setting.geometry, work.run.placement), cage_at(setting.geometry, row.cage_body)
    left = -beyond_end(moved, row.feature, cage, row.cage_feature, setting.tolerances.touch_m) / setting.size_m
    if left > -math.inf and (left > 0.0) == reaches:
        return left
    return math.inf if reaches else -1.0


@kernel
def write_guards(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace, out: FloatArray
) -> float:
    """Write the guards at a rest of ``work.run.ahead``; return the least: above zero as long as the mode lasts."""
    setting, scratch, trial, contacts = drive.setting, work.scratch[0], work.run.ahead, work.run.contacts
    rest, friction, n = scratch.rest, setting.friction.greatest, trial.n_freedoms
    for k in range(len(out)):
        out[k] = math.inf
    frame = frame_at(setting.body, quaternion)

    # What carries: forces above zero, inside their cones, and along the slip.
    greatest = scratch.rest.least_terms * OF_NO_LOAD
    for i in range(trial.used[0]):
        if trial.states[i].counts:
            greatest = max(greatest, trial.states[i].forces[0] * length(trial.rows[i].columns[0], n))
    greatest = max(greatest, length(rest.load, n))
    slips = False
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        forces, size = trial.states[i].forces, length(trial.rows[i].columns[0], n)
        out[OF_CARRYING * place] = forces[0] * size / greatest + NO_FORCE
        if rest.newton.modes[place] == STICKS:
            spare = friction * forces[0] - math.sqrt(forces[1] ** 2 + forces[2] ** 2)
            out[OF_CARRYING * place + 1] = spare * size / greatest + NO_FORCE
        slips = slips or rest.newton.modes[place] == SLIPS
    if slips:
        write_way(drive, position, quaternion, share, -APART, work)
        speed = speed_of(trial, scratch.end_way)
        for place in range(rest.newton.n_carrying):
            i = rest.newton.contacts[place]
            one, two = slip_of(trial, i, scratch.end_way)
            size = math.sqrt(rest.slips[place, 0] ** 2 + rest.slips[place, 1] ** 2)
            if rest.newton.modes[place] == SLIPS and size > 0.0:
                along = (one * rest.slips[place, 0] + two * rest.slips[place, 1]) / size
                out[OF_CARRYING * place + 2] = along / speed + TURNS_BACK

    # Its features reach where they meet.
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        if not is_fixed(trial, i):
            out[OF_CARRYING * place + 3] = way_to_end(drive, i, position, quaternion, work)

    # What touches beside: gaps do not close.
    for i in range(trial.used[0]):
        if trial.states[i].counts or not trial.states[i].chosen:
            continue
        before = min(contacts.rows[i].gap, 0.0)
        met = follow_contact(setting.geometry, work.run.placement, trial, i, position, quaternion, frame)
        if met.is_one and has_reach(drive, i, met, work):
            out[first_of_others() + i] = (trial.rows[i].gap - before) / setting.size_m + NEXT_TO_NOTHING

    # What may be met; stability; and the driver's force.
    after = first_of_others() + len(contacts.rows)
    work.run.path.constraints.scratch[0].used = 0
    for which in range(scratch.n_hits):
        hit = Hit(0.0, scratch.hit_features[which, 0], scratch.hit_features[which, 1], scratch.hit_angles[which])
        gap = gap_of(setting, hit, position, quaternion, work.run)
        out[after + which] = gap / setting.size_m + NEXT_TO_NOTHING
    hold_carried(trial, work)
    out[after + HITS_LIMIT] = least_stiffness(drive, trial, rest.curvature, work) + LEAST_STABLE
    out[after + HITS_LIMIT + 1] = scratch.leap
    if has_limit(drive.stop_at, work.memory):
        along = write_drivers(trial, position, quaternion, setting.load, share - APART, work.memory, work.drivers)
        out[after + HITS_LIMIT + 2] = left_to_limit(drive.stop_at, along, share, work.drivers, work.memory)
    least = math.inf
    for k in range(len(out)):
        least = min(least, out[k])
    return least
