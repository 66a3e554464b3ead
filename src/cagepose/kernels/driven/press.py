"""Bodies of the cage that press: they go on, or give way, until each is held by as much force as it presses with.

What presses is slow: at each place of it the object is at rest. So a body that lacks force is driven along its
direction until its driver's force is that of its press, and one that is pushed harder is driven back: drives with a
limit of force, one after the other. It ends where forces in the cones balance the object and all that presses.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, dot, vector_from
from cagepose.kernels.boundary.features import number_of_bodies
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.equilibrium import AT_REST, HELD_BY_FRICTION, HELD_WITHOUT_FRICTION, equilibrium
from cagepose.kernels.contact.metric import frame_at, way_between
from cagepose.kernels.contact.pressing import copy_pressing, number_pressing, write_whole_load
from cagepose.kernels.driven.bodies import move_bodies, pose_from, write_drivers
from cagepose.kernels.driven.came_off import FARTHEST
from cagepose.kernels.driven.drive import drive_on
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.presses import press_at
from cagepose.kernels.outcome.trace import BLOCKED, ESCAPES, JAMS, LIMIT, NONE, RESTS, STALLED
from cagepose.kernels.quasistatic.run import steps_from
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.state import State, at_rest, write_state
from cagepose.kernels.quasistatic.step import HELD, STUCK, note_touching, stand_at, write_step
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace
from cagepose.kernels.stability.proof import are_balanced, with_all_freedoms

ENOUGH = 1e-9
"""Of what a body presses with: a force that is so near to it is it."""
LETS_GO = 1e-3
"""In sizes of the scene: so far all that presses gives way where it can neither go on nor hold."""
ALL, LET_GO = 0, 1
"""Attempts of a sweep. Beyond these one body goes alone, first while the others press, and then while they stand."""
MOST_LET_GO = 4
"""So often it does in a phase."""
SWEEPS = 64
"""Drives of a phase, after which it has stalled."""
NO_WAY = 1e-11
"""In sizes of the scene: a shorter way is none."""


@kernel
def begin_pressing(geometry: Geometry, cases: Cases, phase: int, work: DriveWorkspace) -> None:
    """Write how all bodies press in a phase where they stand."""
    pressing = work.run.proof.contacts.pressing
    for body in range(1, number_of_bodies(geometry.cage)):
        position, quaternion = pose_from(work.memory.reached[body])
        press_at(cases.drives.presses[phase][body], geometry, position, quaternion, pressing[body])


@kernel
def is_balanced(setting: Setting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Whether forces in the cones balance the object and all that presses, with the bodies where they stand."""
    asked = with_all_freedoms(work.run.proof)
    return are_balanced(setting.geometry, setting.body, position, quaternion, setting.load, setting.friction, asked)


@kernel
def lacks(body: int, work: DriveWorkspace) -> float:
    """Return by how much more a body presses than the contacts resist it, with the drivers that were written last;
    zero: by next to nothing, or it does not press.
    """
    pressing = work.run.proof.contacts.pressing[body]
    if pressing.freedom == 0:
        return 0.0
    resisted = dot(vector_from(work.drivers[body]), vector_from(pressing.direction))
    missing = pressing.force - resisted
    return missing if abs(missing) > ENOUGH * max(abs(pressing.force), abs(resisted)) else 0.0


@kernel
def rests_with(setting: Setting, state: State, asked: DriveWorkspace) -> bool:
    """Whether forces in the cones balance the object and what presses in a workspace. Filled: its contacts at the pose
    of a state, and their forces.
    """
    contacts, solver, frame = asked.run.contacts, asked.run.scratch[0].solver, frame_at(setting.body, state.quaternion)
    if not stand_at(setting, state.position, state.quaternion, asked.run):
        return False
    solver.load_terms = write_whole_load(
        setting.load,
        contacts.pressing,
        state.position,
        state.quaternion,
        frame,
        contacts.n_freedoms,
        solver.load,
    )
    code = equilibrium(contacts, frame, setting.friction.greatest, AT_REST, solver)
    return code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION)


@kernel
def begin_leg(body: int, missing: float, way: float, work: DriveWorkspace) -> None:
    """Let a body that is resisted by so much too little go on along its direction, or give way where that is below
    zero, by so much, metres, until its driver's force is what it presses with.
    """
    one, twist, side = work.run.proof.contacts.pressing[body], work.memory.twists[body, 0], math.copysign(1.0, missing)
    work.memory.n_legs[body] = 1
    for k in range(3):
        twist[k], twist[3 + k] = side * way * one.direction[k], 0.0
    twist[6] = way
    work.memory.limits[body, 0], work.memory.limits[body, 1] = side * one.force, -one.stiffness * way


@kernel
def begin_sweep(
    setting: Setting, state: State, lets_go: bool, only: int, longest: float, work: DriveWorkspace
) -> float:
    """Let bodies that press go on which are resisted too little, and those give way that are resisted too much, all or
    ``only`` one; return how far they may go, metres; 0: none has anywhere to go. Or all that presses ``lets_go`` a
    little, whatever resists it, as between contacts that hold it fast, but only with more force than it has.
    """
    memory, pressing, goes = work.memory, work.run.proof.contacts.pressing, 0.0
    write_drivers(work.run.contacts, state.position, state.quaternion, setting.load, 0.0, memory, work.drivers)
    for body in range(1, len(memory.n_legs)):
        missing = lacks(body, work)
        if lets_go and pressing[body].freedom > 0:
            goes = LETS_GO * setting.size_m
            begin_leg(body, -1.0, goes, work)
            memory.limits[body, 0] = math.inf
        elif not lets_go and missing != 0.0 and only in (0, body):
            goes = longest
            begin_leg(body, missing, goes, work)
    return goes


@kernel
def let_others_press(
    setting: Setting, state: State, only: int, longest: float, work: DriveWorkspace
) -> tuple[float, DriveWorkspace]:
    """Let ``only`` one body go on, or give way, while the others press where they are; return how far it may go,
    metres, and the workspace with their freedoms; 0: it is in balance, or the others are not.
    """
    memory, pressing, n_pressing = work.memory, work.run.proof.contacts.pressing, 0
    copy_pressing(pressing, memory.pressing)
    for body in range(1, len(pressing)):
        one = memory.pressing[body]
        n_pressing += 1 if one.freedom > 0 and body != only else 0
        one.freedom = WRENCH + n_pressing - 1 if one.freedom > 0 and body != only else 0
    asked = with_pressing(work)
    if pressing[only].freedom == 0 or n_pressing == 0 or not rests_with(setting, state, asked):
        return 0.0, asked
    write_drivers(asked.run.contacts, state.position, state.quaternion, setting.load, 0.0, memory, work.drivers)
    missing = lacks(only, work)
    if missing == 0.0:
        return 0.0, asked
    begin_leg(only, missing, longest, work)
    return longest, asked


@kernel
def note_sweep(first: int, last: int, begun: float, way: float, work: DriveWorkspace) -> None:
    """Write into the steps ``first`` up to, without, ``last`` how far all that presses has gone, ``begun`` being the
    way of all sweeps before, and ``way`` that of this one. Their share becomes the sum of both, metres.
    """
    rows, memory, pressing = work.run.trace.rows, work.memory, work.run.proof.contacts.pressing
    for step in range(first, last):
        share, others = rows[step].share, rows[step].pressed
        for body in range(len(pressing) - 1, 0, -1):  # those that pressed beside a drive have lower numbers there
            if pressing[body].freedom == 0:
                continue
            at, beside, goes = pressing[body].freedom - WRENCH, memory.pressing[body].freedom - WRENCH, 0.0
            if memory.n_legs[body] > 0:
                goes = share * dot(vector_from(memory.twists[body, 0]), vector_from(pressing[body].direction))
            elif beside >= 0:
                goes = others[beside]
            others[at] = goes + (rows[first - 1].pressed[at] if first > 0 else 0.0)
        rows[step].share = begun + way * share


@kernel
def stand_still(work: DriveWorkspace) -> None:
    """Let no body be driven, or press beside a drive, from where they are now."""
    for body in range(len(work.memory.n_legs)):
        work.memory.n_legs[body] = work.memory.pressing[body].freedom = 0
        work.memory.pressing[body].gone, work.memory.limits[body, 0] = 0.0, math.inf
        for k in range(7):
            work.memory.begun[body, k] = work.memory.reached[body, k]


@kernel
def press_on(
    drive: DriveSetting, cases: Cases, state: State, step_limit: int, work: DriveWorkspace
) -> tuple[int, int, State, float]:
    """Run a phase in which bodies press, from a state; return (verdict code, number of steps, state, way of all sweeps
    in metres).
    """
    setting, phase = drive.setting, drive.phase
    run, reach_m, attempt, step, done, here = work.run, setting.body.reach_m, ALL, 0, 0.0, state
    goes_on, longest, n_let_go, n_bodies = False, reach_m, 0, len(work.memory.n_legs)
    if is_balanced(setting, here.position, here.quaternion, work):
        stand_at(setting, here.position, here.quaternion, run)
        note_touching(run)
        write_state(run.trace.rows[0], here)
        write_step(run, 0, HELD, NONE, False, here.position, here.quaternion)
        return RESTS, 1, here, done
    for _ in range(SWEEPS):
        # The object comes to rest while all bodies stand, unless it is at the end of a way, and goes on.
        if not goes_on:
            first, begun = step, at_rest(here.position, here.quaternion, state.turn_step_rad, 0)
            verdict, step, here = steps_from(setting, begun, first, step_limit, run)
            note_sweep(first, step, done, 0.0, work)
            if verdict != RESTS:
                return verdict, step, here, done

        # What presses goes on, or gives way.
        first, share, before, asked = step, 0.0, here, work
        only = max(attempt - LET_GO, 0)
        if 0 < only < n_bodies:
            way, asked = let_others_press(setting, here, only, longest, work)
        else:
            way = begin_sweep(setting, here, attempt == LET_GO, max(only - n_bodies + 1, 0), longest, work)
        if way > 0.0:
            verdict, step, here, share = drive_on(drive, here, first, step_limit, asked)
            note_sweep(first, step, done, way, work)
            done += way * share
            move_bodies(setting.geometry, phase, share, work.memory)
            begin_pressing(setting.geometry, cases, phase, work)
        stand_still(work)
        if verdict in (ESCAPES, LIMIT):
            return verdict, step, here, done
        if way > 0.0 and is_balanced(setting, here.position, here.quaternion, work):
            return RESTS, step, here, done
        if done > FARTHEST * setting.size_m:
            return ESCAPES, step, here, done

        # Where nothing stops it, it goes farther; where it is stopped at once it is tried otherwise.
        goes_on = verdict == RESTS and attempt == ALL
        moved = way_between(before.position, before.quaternion, here.position, here.quaternion, reach_m)
        if way * share > NO_WAY * setting.size_m:
            most = setting.size_m if moved > 0.0 else math.inf
            longest = min(2.0 * longest, max(most, reach_m)) if share == 1.0 and attempt != LET_GO else reach_m
            attempt = ALL if attempt == LET_GO or share < 1.0 else attempt
        elif attempt < LET_GO + 2 * (n_bodies - 1):
            lets_go = attempt == ALL and verdict in (BLOCKED, JAMS) and n_let_go < MOST_LET_GO
            n_let_go += 1 if lets_go else 0
            attempt = LET_GO if lets_go else max(attempt, LET_GO) + 1
        else:
            break
    return STALLED, step, here, done


@kernel
def with_pressing(work: DriveWorkspace) -> DriveWorkspace:
    """Return a workspace whose contacts are asked with the freedoms of the bodies that press, where they are in memory
    at a rest, and in a trial.
    """
    run, memory = work.run, work.memory
    n = WRENCH + number_pressing(memory.pressing)
    copy_pressing(memory.pressing, memory.tried)
    copy_pressing(memory.pressing, run.turned.pressing)
    contacts, ahead, turned = run.contacts, run.ahead, run.turned
    asked = QuasistaticWorkspace(
        run.placement,
        ContactSet(contacts.used, contacts.rows, contacts.states, contacts.bends, memory.pressing, n),
        ContactSet(ahead.used, ahead.rows, ahead.states, ahead.bends, memory.tried, n),
        ContactSet(turned.used, turned.rows, turned.states, turned.bends, turned.pressing, n),
        run.scratch,
        run.path,
        run.touched,
        run.trace,
        run.cage,
        run.proof,
    )
    return DriveWorkspace(asked, memory, work.scratch, work.low, work.high, work.middle, work.drivers)


@kernel
def drive_pressed(
    drive: DriveSetting, cases: Cases, state: State, step_limit: int, work: DriveWorkspace
) -> tuple[int, int, State, float]:
    """Drive bodies while others, or they themselves, press, from a rest of all; return (verdict code, number of steps,
    state, share). All that presses goes on with the object: a rest has as many freedoms more.
    """
    setting, memory = drive.setting, work.memory
    copy_pressing(work.run.proof.contacts.pressing, memory.pressing)
    asked = with_pressing(work)
    is_rest = rests_with(setting, state, asked)
    note_touching(asked.run)
    write_state(asked.run.trace.rows[0], state)
    write_step(asked.run, 0, HELD if is_rest else STUCK, NONE, False, state.position, state.quaternion)
    verdict, step, here, share = STALLED, 1, state, 0.0
    if is_rest:
        verdict, step, here, share = drive_on(drive, state, 1, step_limit, asked)
    move_bodies(setting.geometry, drive.phase, share, memory)
    begin_pressing(setting.geometry, cases, drive.phase, work)
    for body in range(len(memory.pressing)):
        memory.pressing[body].freedom, memory.pressing[body].gone = 0, 0.0
    return verdict, step, here, share
