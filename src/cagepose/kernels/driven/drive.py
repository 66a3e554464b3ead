"""The drive of a phase: from rest to rest as bodies of the cage move, until they have got there or the object stops
them.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import WRENCH, length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, norm
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.edges import EVERY, first_choice, has_one_choice, next_choice
from cagepose.kernels.contact.loads import total_load, write_load
from cagepose.kernels.contact.metric import frame_at, way_between
from cagepose.kernels.contact.pressing import copy_pressing
from cagepose.kernels.driven.advance import furthest_share, met_on_chord
from cagepose.kernels.driven.bodies import (
    is_driven_by,
    left_to_limit,
    move_bodies,
    next_leg,
    slack_at,
    twist_of_body,
    write_drift,
    write_drivers,
)
from cagepose.kernels.driven.came_off import one_came_off
from cagepose.kernels.driven.could_jam import note_jams
from cagepose.kernels.driven.history import add_work, keep_greatest, note_snap, write_driven, write_jump
from cagepose.kernels.driven.pivot import hold_still, keep_mode, mode_lasts, return_to_mode
from cagepose.kernels.driven.rate import APART, find_mode
from cagepose.kernels.driven.rested import begin_at_rest, find_rested, keep_forces
from cagepose.kernels.driven.snap import MOVED, opened_pose, rests_ahead, snaps
from cagepose.kernels.driven.stopped import OPENS, stopped_verdict
from cagepose.kernels.driven.trial import write_way
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import ESCAPES, LIMIT, RESTS, STALLED, STOPS
from cagepose.kernels.quasistatic.state import State, at_rest, write_state
from cagepose.kernels.quasistatic.step import note_touching, stand_at

LONGEST = 1.0 / 64.0
"""In shares: a step of a drive."""
LONGEST_TURN = 0.5
"""Radians that a body turns in one step, where the object stands still."""
LEAST_ADVANCE = 1e-11
"""In shares: less is no progress."""
UNLOADED = 1e-8
"""In lengths of the load's terms: what is left of a load that is in balance by itself."""
MOST_CHOICES = 32
"""Choices of faces that are asked at one place."""
AT_LIMIT = 1e-9
"""Of the limit: a force so near to it has got there."""
STILL_LIMIT = 6
"""Steps without progress, one after the other, after which a drive has stalled."""


@kernel
def stands_still(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> bool:
    """Whether nothing that acts on the object changes as the drive goes on, before it meets something."""
    contacts, memory, load = work.run.contacts, work.memory, work.scratch[0].load
    if is_driven_by(memory, drive.setting.load):
        return False
    carries, touches = False, False
    for i in range(contacts.used[0]):
        carries = carries or contacts.states[i].forces[0] > 0.0
        if memory.n_legs[contacts.rows[i].cage_body] > 0:
            touches = True
            write_drift(contacts, i, position, share, memory)
            if contacts.states[i].forces[0] > 0.0 or contacts.rows[i].drift[0] > 0.0:
                return False
    if carries or not touches:
        return True
    # A rest that hangs on contacts without play, which press on each other, has no forces of its own.
    terms = write_load(drive.setting.load, position, quaternion, frame_at(drive.setting.body, quaternion), load)
    return length(load, WRENCH) <= UNLOADED * terms


@kernel
def longest_advance(memory_turn: float, share: float, ends: float) -> float:
    """Return the share up to which bodies may go, that turn so fast, while the object stands still."""
    return min(ends, share + LONGEST_TURN / memory_turn) if memory_turn > 0.0 else ends


@kernel
def fastest_turn(share: float, work: DriveWorkspace) -> float:
    fastest = 0.0
    for body in range(len(work.memory.n_legs)):
        _, spin = twist_of_body(work.memory, body, share)
        fastest = max(fastest, norm(spin))
    return fastest


@kernel
def choose_mode(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> bool:
    """Choose faces and a mode with which the drive goes on; return whether there is one: the mode that was, changed
    where it has to be; or that of the rate problem, with one choice of faces after the other.
    """
    contacts = work.run.contacts
    keep_mode(work)
    if mode_lasts(drive, position, quaternion, share, to_share, work):
        return True
    return_to_mode(work)
    if rate_lasts(drive, position, quaternion, share, to_share, work):
        return True
    if has_one_choice(contacts):
        return False
    first_choice(contacts)
    for _ in range(MOST_CHOICES):
        if rate_lasts(drive, position, quaternion, share, to_share, work):
            return True
        if not next_choice(contacts, EVERY):
            break
    return False


@kernel
def rate_lasts(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, to_share: float, work: DriveWorkspace
) -> bool:
    """Whether the rate problem has a solution with the faces that are chosen, and its mode lasts."""
    found = find_mode(drive, position, quaternion, share, work)
    return found and mode_lasts(drive, position, quaternion, share, to_share, work)


@kernel
def has_moved(drive: DriveSetting, state: State, after: State) -> bool:
    reach_m = drive.setting.body.reach_m
    away = way_between(state.position, state.quaternion, after.position, after.quaternion, reach_m)
    return away > MOVED * drive.setting.size_m


@kernel
def leave_rest(
    drive: DriveSetting,
    state: State,
    share: float,
    to_share: float,
    first: int,
    step_limit: int,
    work: DriveWorkspace,
) -> tuple[int, int, State, float]:
    """Go to another rest where no mode lasts: the object snaps, or opens its contacts to second order, or the bodies go
    on a little; return (verdict code, number of steps, state, share), RESTS: the drive goes on from there.
    """
    position, quaternion, reached = state.position, state.quaternion, share
    verdict, step, after = snaps(drive, state, first, step_limit, work)
    if verdict == RESTS and not has_moved(drive, state, after):
        stopped = stopped_verdict(drive, position, quaternion, share, work)
        if stopped == OPENS:
            return open_contacts(drive, state, share, step, step_limit, work)
        if stopped != STALLED or state.n_still >= STILL_LIMIT:
            return stopped, step, state, share
        return_to_mode(work)
        may_stay = drive.setting.friction.greatest == 0.0 or find_mode(drive, position, quaternion, share, work)
        return_to_mode(work)
        verdict, step, after, reached = rests_ahead(drive, state, share, to_share, step, step_limit, may_stay, work)
        if reached == share:
            return STALLED, step, state, share
    note_snap(drive, state, after, first, step, share, reached, verdict, work)
    if verdict == RESTS:
        begin_at_rest(drive, work)
    return verdict, step, after, reached


@kernel
def open_contacts(
    drive: DriveSetting, state: State, share: float, step: int, step_limit: int, work: DriveWorkspace
) -> tuple[int, int, State, float]:
    """Let the object go a little where that opens its contacts to second order; see `leave_rest`."""
    if step >= step_limit:
        return LIMIT, step, state, share
    opened, end, turned = opened_pose(drive, state.position, state.quaternion, work)
    after = at_rest(end, turned, state.turn_step_rad, 0)
    if not opened or state.n_still + 1 >= STILL_LIMIT:
        return STALLED, step, state, share
    write_state(work.run.trace.rows[step], state)
    if not stand_at(drive.setting, end, turned, work.run):
        return STALLED, step, after, share
    begin_at_rest(drive, work)
    write_driven(drive, step, share, end, turned, True, work)
    return RESTS, step + 1, after, share


@kernel
def drive_on(
    drive: DriveSetting, state: State, first_step: int, step_limit: int, work: DriveWorkspace
) -> tuple[int, int, State, float]:
    """Go on from a rest, whose contacts are those of ``work.run``, until the drive ends; return (verdict code, number
    of steps, state, share).
    """
    setting, scratch, run = drive.setting, work.scratch[0], work.run
    position, quaternion, share, step, n_still = state.position, state.quaternion, 0.0, first_step, 0
    goes_on = False
    total = total_load(setting.load, position, quaternion, setting.size_m)
    scratch.rest.least_terms = 1e-9 * total if total > 0.0 else 1.0
    begin_at_rest(drive, work)
    scratch.least_jam = math.inf
    run.trace.rows[first_step - 1].could_jam = note_jams(drive, position, quaternion, 0.0, work)
    driving = write_drivers(run.contacts, position, quaternion, setting.load, 0.0, work.memory, work.drivers)
    run.trace.rows[first_step - 1].driving = driving
    scratch.greatest = scratch.greatest_at = 0.0
    keep_greatest(0.0, driving, work)
    scratch.work = scratch.rubbed = scratch.lost = 0.0
    for k in range(run.contacts.n_freedoms):
        scratch.way[k] = scratch.end_way[k] = 0.0
    while step < step_limit:
        if share >= 1.0:
            return RESTS, step, at_rest(position, quaternion, state.turn_step_rad, 0), share
        here = at_rest(position, quaternion, state.turn_step_rad, n_still)
        ends = next_leg(work.memory, share)
        note_touching(run)
        if run.contacts.n_freedoms > WRENCH and one_came_off(drive, position, quaternion, share, work):
            return ESCAPES, step, here, share

        # Nothing happens before something is met.
        if stands_still(drive, position, quaternion, share, work):
            slack = slack_at(share, work.memory)
            to_share = min(longest_advance(fastest_turn(share, work), share, ends), slack)
            copy_pressing(work.memory.pressing, work.memory.tried)
            hit = met_on_chord(
                drive, position, quaternion, share, position, quaternion, to_share, work.memory.pressing, work
            )
            reached = to_share if hit.amount == math.inf else share + hit.amount * (to_share - share)
            write_state(run.trace.rows[step], here)
            move_bodies(setting.geometry, drive.phase, reached, work.memory)
            place_object(setting.geometry, position, quaternion, run.placement)
            keep_forces(drive, position, quaternion, work)
            write_driven(drive, step, reached, position, quaternion, False, work)
            n_still = 0 if reached - share > LEAST_ADVANCE else n_still + 1
            share, step, goes_on = reached, step + 1, False
            if share >= slack:
                return STOPS, step, here, share
            if n_still == STILL_LIMIT:
                break
            continue

        # What do the contacts do, and how far does that last?
        to_share, is_mode = min(ends, share + LONGEST), True
        if not goes_on:
            is_mode = choose_mode(drive, position, quaternion, share, to_share, work)
            if is_mode and step > first_step:
                step = write_jump(drive, step, share, position, quaternion, work)
                driving = run.trace.rows[step - 1].driving
                if left_to_limit(drive.stop_at, driving, share, work.drivers, work.memory) <= 0.0:
                    return STOPS, step, here, share
        reached, end, turned = share, position, quaternion
        if is_mode and step < step_limit:
            reached, end, turned = furthest_share(drive, position, quaternion, share, to_share, work)
            if reached <= share and not goes_on and hold_still(drive, work):
                is_mode = mode_lasts(drive, position, quaternion, share, to_share, work)
                if is_mode:
                    reached, end, turned = furthest_share(drive, position, quaternion, share, to_share, work)
        if reached - share > LEAST_ADVANCE or (is_mode and reached > share and n_still < STILL_LIMIT):
            write_state(run.trace.rows[step], here)
            add_work(drive, position, quaternion, share, end, turned, reached, work)
            if run.contacts.n_freedoms > WRENCH:  # what presses has gone on as well
                copy_pressing(work.memory.tried, work.memory.pressing)
                move_bodies(setting.geometry, drive.phase, reached, work.memory)
            same = find_rested(drive, end, turned, work)
            moved = way_between(position, quaternion, end, turned, setting.body.reach_m) > 0.0
            write_driven(drive, step, reached, end, turned, moved, work)
            goes_on = same and reached == to_share and reached < ends
            if goes_on:
                write_way(drive, end, turned, reached, -APART, work)
                for k in range(run.contacts.n_freedoms):
                    scratch.way[k] = scratch.end_way[k]
                for i in range(run.contacts.used[0]):
                    write_drift(run.contacts, i, end, reached, work.memory)
            n_still = 0 if reached - share > LEAST_ADVANCE else n_still + 1
            share, step, position, quaternion = reached, step + 1, end, turned
            driving = run.trace.rows[step - 1].driving
            if left_to_limit(drive.stop_at, driving, share, work.drivers, work.memory) <= AT_LIMIT:
                return STOPS, step, at_rest(position, quaternion, state.turn_step_rad, 0), share
            continue

        # The rest is lost, or there is no way on.
        move_bodies(setting.geometry, drive.phase, share, work.memory)
        if goes_on:  # the mode did not last: which one does?
            goes_on = False
            continue
        return_to_mode(work)
        if run.contacts.n_freedoms > WRENCH:  # an ordinary run knows the object's freedoms alone
            verdict = stopped_verdict(drive, position, quaternion, share, work)
            return STALLED if verdict == OPENS else verdict, step, here, share
        verdict, step, after, share = leave_rest(drive, here, share, to_share, step, step_limit, work)
        if verdict != RESTS:
            return verdict, step, after, share
        position, quaternion, n_still = after.position, after.quaternion, n_still + 1
        if n_still > STILL_LIMIT:
            break
    verdict = LIMIT if step >= step_limit else STALLED
    return verdict, step, at_rest(position, quaternion, state.turn_step_rad, 0), share
