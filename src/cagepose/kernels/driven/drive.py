"""The drive of a phase: from rest to rest as bodies of the cage move, until they have got there or the object stops
them.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import clear
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, vector_from
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.contact_set import ContactSet, choose, is_smooth
from cagepose.kernels.contact.edges import EVERY, first_choice, has_one_choice, last_of_group, next_choice
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.loads import total_load, work_done
from cagepose.kernels.contact.metric import frame_at, way_between
from cagepose.kernels.contact.sharing import share_evenly
from cagepose.kernels.driven.advance import furthest_share, met_on_chord
from cagepose.kernels.driven.bodies import (
    energy_of_riding,
    is_driven_by,
    move_bodies,
    next_leg,
    twist_of_body,
    write_drift,
    write_drivers,
)
from cagepose.kernels.driven.could_jam import note_jams
from cagepose.kernels.driven.pivot import keep_mode, mode_lasts, return_to_mode
from cagepose.kernels.driven.rate import APART, FOUND, copy_contact, find_mode
from cagepose.kernels.driven.snap import opened_pose, rests_ahead, snaps
from cagepose.kernels.driven.stopped import OPENS, stopped_verdict
from cagepose.kernels.driven.trial import write_way
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import LIMIT, NONE, PLAIN, RESTS, SCREW, STALLED, STOPS
from cagepose.kernels.quasistatic.step import DRIVEN, State, note_touching, stand_at, write_state, write_step
from cagepose.kernels.quasistatic.touched_before import place_before

LONGEST = 1.0 / 64.0
"""In shares: a step of a drive."""
LONGEST_TURN = 0.5
"""Radians that a body turns in one step, where the object stands still."""
LEAST_ADVANCE = 1e-11
"""In shares: less is no progress."""
MOST_CHOICES = 32
"""Choices of faces that are asked at one place."""
JUMP = 1e-6
"""Of the drivers' force and the load: a greater change at one place is told. The force is that a little ahead."""
PARALLEL = 1.0 - 1e-12
"""Cosine: two contacts at one place push the same way."""
STILL_LIMIT = 6
"""Steps without progress, one after the other, after which a drive has stalled."""


@kernel
def stands_still(drive: DriveSetting, position: Vector, share: float, work: DriveWorkspace) -> bool:
    """Whether nothing that acts on the object changes as the drive goes on, before it meets something."""
    contacts, memory = work.run.contacts, work.memory
    if is_driven_by(memory, drive.setting.load):
        return False
    for i in range(contacts.used[0]):
        if memory.n_legs[contacts.rows[i].cage_body] > 0:
            write_drift(contacts, i, position, share, memory)
            if contacts.states[i].forces[0] > 0.0 or contacts.rows[i].drift[0] > 0.0:
                return False
    return True


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
def find_rested(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Find the contacts anew where a step has ended, with what they did in ``work.run.ahead``; return whether they are
    the same.
    """
    setting, contacts, before = drive.setting, work.run.contacts, work.run.ahead
    place_object(setting.geometry, position, quaternion, work.run.placement)
    frame = frame_at(setting.body, quaternion)
    if not find_contacts(setting.geometry, work.run.placement, setting.friction, position, frame, contacts):
        return False
    n_carried, n_before, all_known = 0, 0, True
    for i in range(before.used[0]):
        if before.states[i].counts:
            n_before += 1
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.is_sticking = state.stays_flat = state.is_locked = False
        for j in range(3):
            state.forces[j] = 0.0
    for i in range(contacts.used[0]):
        state, at = contacts.states[i], place_before(before, contacts.rows[i])
        all_known = all_known and at >= 0
        if at < 0:
            at = taken_over(contacts, i, before, setting.tolerances.touch_m)
        if at < 0 or not before.states[at].counts:
            state.counts = False
            continue
        n_carried += 1
        first = contacts.rows[i].group
        for k in range(first, last_of_group(contacts, first) + 1):
            choose(contacts, k, k == i)
        state.is_sticking, state.stays_flat = before.states[at].is_sticking, before.states[at].stays_flat
        for j in range(3):
            state.forces[j] = before.states[at].forces[j]
    return all_known and n_carried == n_before


@kernel
def taken_over(contacts: ContactSet, i: int, before: ContactSet, touch_m: float) -> int:
    """Return which of the contacts before, that has ended at a corner, goes on as another; -1: none does."""
    row = contacts.rows[i]
    for k in range(before.used[0]):
        ended = before.rows[k]
        if not before.states[k].counts or ended.cage_body != row.cage_body:
            continue
        away = norm(minus(vector_from(row.arm), vector_from(ended.arm)))
        along = dot(vector_from(row.directions[0]), vector_from(ended.directions[0]))
        if away <= 10.0 * touch_m and along >= PARALLEL and place_before(contacts, ended) < 0:
            return k
    return -1


@kernel
def keep_forces(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> None:
    """Find the contacts anew where the object stands still, with what they carry."""
    contacts, before = work.run.contacts, work.run.ahead
    before.used[0] = contacts.used[0]
    for i in range(contacts.used[0]):
        copy_contact(contacts, i, before, i)
        before.states[i].counts = contacts.states[i].forces[0] > 0.0
    find_rested(drive, position, quaternion, work)


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
    if find_mode(drive, position, quaternion, share, work) != FOUND:
        return False
    return mode_lasts(drive, position, quaternion, share, to_share, work)


@kernel
def write_driven(
    drive: DriveSetting,
    step: int,
    share: float,
    position: Vector,
    quaternion: Quaternion,
    moved: bool,
    work: DriveWorkspace,
) -> None:
    """Write a step of a drive, with what the contacts carry after it."""
    run = work.run
    write_step(run, step, DRIVEN, SCREW if moved else NONE, False, position, quaternion)
    record = run.trace.rows[step]
    record.share = share
    record.driving = write_drivers(
        run.contacts, position, quaternion, drive.setting.load, share - APART, work.memory, work.drivers
    )
    record.could_jam = note_jams(drive, position, quaternion, share, work)
    if record.driving > work.scratch[0].greatest:
        work.scratch[0].greatest, work.scratch[0].greatest_at = record.driving, share


@kernel
def write_jump(
    drive: DriveSetting, step: int, share: float, position: Vector, quaternion: Quaternion, work: DriveWorkspace
) -> int:
    """Write a step in which nothing moves, if the drivers' force jumps as contacts begin to do something else; return
    the number of steps.
    """
    load, rows = drive.setting.load, work.run.trace.rows
    before = rows[step - 1].driving
    after = write_drivers(work.run.ahead, position, quaternion, load, share, work.memory, work.drivers)
    size = total_load(load, position, quaternion, drive.setting.size_m)
    if abs(after - before) <= JUMP * (abs(before) + abs(after) + size):
        return step
    rows[step] = rows[step - 1]  # type: ignore[index]
    for element in range(len(work.run.touched)):
        work.run.trace.touching[step, element] = work.run.trace.touching[step - 1, element]
        work.run.trace.hit[step, element] = False
    row = rows[step]
    row.rule, row.motion, row.note, row.share, row.driving = DRIVEN, NONE, PLAIN, share, after
    row.could_jam = note_jams(drive, position, quaternion, share, work)
    if after > work.scratch[0].greatest:
        work.scratch[0].greatest, work.scratch[0].greatest_at = after, share
    return step + 1


@kernel
def add_work(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    end: Vector,
    turned: Quaternion,
    to_share: float,
    work: DriveWorkspace,
) -> None:
    """Add the work of the drivers in a step, which is what the potential rises and friction takes, the latter with the
    mean of the forces before and after it. ``work.run.ahead`` is at its end.
    """
    geometry, load, memory, scratch = drive.setting.geometry, drive.setting.load, work.memory, work.scratch[0]
    rest, before, after = scratch.rest, work.run.contacts, work.run.ahead
    move_bodies(geometry, drive.phase, share, memory)
    at_start = energy_of_riding(load, position, quaternion)
    move_bodies(geometry, drive.phase, to_share, memory)
    rises = energy_of_riding(load, position, quaternion) - at_start
    rises -= work_done(load, position, quaternion, end, turned)
    rubbed = 0.0
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        for which in range(2):
            force = 0.5 * (before.states[i].forces[1 + which] + after.states[i].forces[1 + which])
            rubbed += force * rest.slips[place, which]
    scratch.rubbed += rubbed
    scratch.work += rises + rubbed


@kernel
def begin_at_rest(drive: DriveSetting, work: DriveWorkspace) -> None:
    """Let all contacts that carry at rest stick, as far as they have friction; where none needs it, all that touch
    share the load as if they were equally stiff: so that all of a flat foot stays down, not three points of it.
    """
    contacts, held, friction = work.run.contacts, work.scratch[0].held, drive.setting.friction.greatest
    solver, is_rubbed, n = work.run.scratch[0].solver, False, contacts.n_freedoms
    for i in range(contacts.used[0]):
        forces = contacts.states[i].forces
        is_rubbed = is_rubbed or forces[1] != 0.0 or forces[2] != 0.0
    if not is_rubbed and solver.locked.used == 0:
        clear(held, n, 1.0)
        held.dependent = 2.0  # whatever they hold
        for k in range(n):
            solver.y[k] = 0.0
        share_evenly(contacts, held, solver.y, solver.load_terms, work.run.scratch[0].stiff.sharing)
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.is_sticking = state.forces[0] > 0.0 and friction > 0.0 and not is_smooth(contacts, i)
        state.counts, state.stays_flat = state.forces[0] > 0.0, False


@kernel
def has_moved(drive: DriveSetting, state: State, after: State) -> bool:
    reach_m = drive.setting.body.reach_m
    away = way_between(state.position, state.quaternion, after.position, after.quaternion, reach_m)
    return away > 1e-9 * drive.setting.size_m


@kernel
def note_snap(
    drive: DriveSetting,
    state: State,
    after: State,
    first: int,
    last: int,
    share: float,
    reached: float,
    verdict: int,
    work: DriveWorkspace,
) -> None:
    """Note in the steps ``first`` up to, without, ``last`` at which share the object has snapped, with which forces of
    the drivers before and after it, and what was lost.
    """
    load, rows, scratch = drive.setting.load, work.run.trace.rows, work.scratch[0]
    for step in range(first, last):
        rows[step].share = reached
        rows[step].driving = rows[first - 1].driving if step < last - 1 else 0.0
    if last == first or verdict != RESTS:
        return
    rows[last - 1].driving = write_drivers(
        work.run.contacts, after.position, after.quaternion, load, reached, work.memory, work.drivers
    )
    move_bodies(drive.setting.geometry, drive.phase, share, work.memory)
    before = energy_of_riding(load, state.position, state.quaternion)
    move_bodies(drive.setting.geometry, drive.phase, reached, work.memory)
    scratch.work += energy_of_riding(load, state.position, state.quaternion) - before
    scratch.lost += work_done(load, state.position, state.quaternion, after.position, after.quaternion)


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
    scratch.greatest = scratch.greatest_at = 0.0
    scratch.work = scratch.rubbed = scratch.lost = 0.0
    for k in range(run.contacts.n_freedoms):
        scratch.way[k] = scratch.end_way[k] = 0.0
    while step < step_limit:
        if share >= 1.0:
            return RESTS, step, State(position, quaternion, state.turn_step_rad, 0, 0), share
        here = State(position, quaternion, state.turn_step_rad, n_still, 0)
        ends = next_leg(work.memory, share)
        note_touching(run)

        # Nothing happens before something is met.
        if stands_still(drive, position, share, work):
            to_share = longest_advance(fastest_turn(share, work), share, ends)
            hit = met_on_chord(drive, position, quaternion, share, position, quaternion, to_share, work)
            reached = to_share if hit.amount == math.inf else share + hit.amount * (to_share - share)
            write_state(run.trace.rows[step], here)
            move_bodies(setting.geometry, drive.phase, reached, work.memory)
            place_object(setting.geometry, position, quaternion, run.placement)
            keep_forces(drive, position, quaternion, work)
            write_driven(drive, step, reached, position, quaternion, False, work)
            n_still = 0 if reached - share > LEAST_ADVANCE else n_still + 1
            share, step, goes_on = reached, step + 1, False
            if n_still == STILL_LIMIT:
                break
            continue

        # What do the contacts do, and how far does that last?
        to_share, is_mode = min(ends, share + LONGEST), True
        if not goes_on:
            is_mode = choose_mode(drive, position, quaternion, share, to_share, work)
            if is_mode and step > first_step:
                step = write_jump(drive, step, share, position, quaternion, work)
                if run.trace.rows[step - 1].driving >= drive.stop_at:
                    return STOPS, step, here, share
        reached, end, turned = share, position, quaternion
        if is_mode and step < step_limit:
            reached, end, turned = furthest_share(drive, position, quaternion, share, to_share, work)
        if reached - share > LEAST_ADVANCE or (is_mode and reached > share and n_still < STILL_LIMIT):
            write_state(run.trace.rows[step], here)
            add_work(drive, position, quaternion, share, end, turned, reached, work)
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
            if drive.stop_at < math.inf and run.trace.rows[step - 1].driving >= drive.stop_at * (1.0 - 1e-9):
                return STOPS, step, State(position, quaternion, state.turn_step_rad, 0, 0), share
            continue

        # The rest is lost, or there is no way on.
        move_bodies(setting.geometry, drive.phase, share, work.memory)
        if goes_on:  # the mode did not last: which one does?
            goes_on = False
            continue
        return_to_mode(work)
        first, reached = step, share
        verdict, step, after = snaps(drive, here, step, step_limit, work)
        if verdict == RESTS and not has_moved(drive, here, after):
            stopped = stopped_verdict(drive, position, quaternion, share, work)
            if stopped == OPENS:
                opened, end, turned = opened_pose(drive, position, quaternion, work)
                n_still += 1
                if not opened or n_still >= STILL_LIMIT:
                    break
                write_state(run.trace.rows[step], here)
                position, quaternion = end, turned
                if not stand_at(setting, position, quaternion, run):
                    break
                begin_at_rest(drive, work)
                write_driven(drive, step, share, position, quaternion, True, work)
                step += 1
                continue
            if stopped != STALLED or n_still >= STILL_LIMIT:
                return stopped, step, here, share
            return_to_mode(work)
            may_stay = setting.friction.greatest == 0.0 or find_mode(drive, position, quaternion, share, work) == FOUND
            return_to_mode(work)
            verdict, step, after, reached = rests_ahead(drive, here, share, to_share, step, step_limit, may_stay, work)
            if reached == share:
                return STALLED, step, here, share
        note_snap(drive, here, after, first, step, share, reached, verdict, work)
        if verdict != RESTS:
            return verdict, step, after, reached
        position, quaternion, share, n_still = after.position, after.quaternion, reached, n_still + 1
        begin_at_rest(drive, work)
        if n_still > STILL_LIMIT:
            break
    verdict = LIMIT if step >= step_limit else STALLED
    return verdict, step, State(position, quaternion, state.turn_step_rad, 0, 0), share
