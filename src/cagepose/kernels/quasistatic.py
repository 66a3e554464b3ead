"""The quasistatic method: from rest to rest along the motion that the mechanics gives, as one compiled loop.

At each pose: find the contacts and solve the onset of motion. Held: the end. Else move along its twist, an exact screw,
up to the first contact, to the edge of a face that carries, or as far as the motion keeps its direction; put the
sliding contacts back on their faces; and begin again. The loads do work in every step, so no pose comes twice.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact_set import CONTACTS_PER_POINT, ContactSet, empty_contact_set, find_contacts
from cagepose.kernels.curvature import write_curvature
from cagepose.kernels.geometry import FloatArray, Geometry, Placement, place_object
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.metric import Body, DeadLoads, Frame, frame_at, twist_of, write_load
from cagepose.kernels.onset import (
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    UNSOLVED,
    OnsetRoom,
    empty_onset_room,
    is_held,
    onset,
    sticks,
)
from cagepose.kernels.path import (
    PathRoom,
    Setting,
    Twist,
    allow_depths,
    empty_path_room,
    furthest_step,
    longest_step,
    nothing_ahead,
    pin_contacts,
    pushed_out,
    stepped,
    straightened,
)
from cagepose.kernels.pose import Quaternion
from cagepose.kernels.projection import ON_FACE
from cagepose.kernels.stiff import StiffRoom, curvature_along, empty_stiff_room, stiff_step
from cagepose.kernels.tolerances import KernelTolerances
from cagepose.kernels.trace import (
    ESCAPES,
    LET_GO,
    LIMIT,
    NONE,
    PLAIN,
    RESTS,
    SCREW,
    STALLED,
    TRAVEL,
    Trace,
    empty_trace,
)
from cagepose.kernels.vector import Vector, norm

RULE_NAMES = ("free", "slide", "pivot", "held")
FREE, SLIDE, PIVOT, HELD = 0, 1, 2, 3
"""No contact carries; those that carry slide; one of them sticks; the contacts hold the object."""

STIFF = 0.25
"""Curvature times step above which the explicit step would no longer follow the path: then it is made implicit."""
HALVES_TO_REST = 45
"""Halvings of a step in which friction brings the object to rest: to rounding."""
STILL = 1e-14
"""In sizes of the scene: a shorter step is no progress."""
STILL_STEPS = 6
"""Steps without progress after which the run has stalled."""
POLISHES = 3
"""How often, in a phase, a rest is put on its faces and looked at again: what balanced before may not quite, then."""


class QuasistaticRules(NamedTuple):
    """All numbers of the method.

    Attributes
    ----------
    friction
        Coefficient of friction.
    turn_step_rad
        Longest turn in one step.
    step_limit
        Greatest number of steps in a phase.
    """

    friction: float
    turn_step_rad: float
    step_limit: int


class QuasistaticWorkspace(NamedTuple):
    """All arrays that a run writes to, so that compiled code makes none.

    Attributes
    ----------
    placement, contacts
        The state at the present pose.
    ahead
        Room for contacts at a pose that is tried.
    load
        Scaled wrench of the load, (6,).
    solver, stiff, path
        Room of the steps.
    touched
        Which points touched before the step, (n_points,).
    trace
        Steps of all phases, one after the other.
    verdicts
        Verdict code of each phase, (n_phases,).
    """

    placement: Placement
    contacts: ContactSet
    ahead: ContactSet
    load: FloatArray
    solver: OnsetRoom
    stiff: StiffRoom
    path: PathRoom
    touched: NDArray[np.bool_]
    trace: Trace
    verdicts: NDArray[np.int64]


def empty_quasistatic_workspace(n_boxes: int, n_points: int, n_phases: int, step_limit: int) -> QuasistaticWorkspace:
    """Return room for one run (plain Python); ``n_boxes`` counts bridges too."""
    n_contacts = CONTACTS_PER_POINT * n_points
    return QuasistaticWorkspace(
        Placement(
            np.empty((n_boxes, 3)), np.empty((n_boxes, 3, 3)), np.empty((n_boxes, n_points, 3)), np.empty(n_points)
        ),
        empty_contact_set(n_contacts),
        empty_contact_set(n_contacts),
        np.zeros(6),
        empty_onset_room(n_contacts),
        empty_stiff_room(n_contacts),
        empty_path_room(n_points),
        np.zeros(n_points, np.bool_),
        empty_trace(n_phases * step_limit, n_points),
        np.zeros(n_phases, np.int64),
    )


@kernel
def carried_by(contacts: ContactSet, forces: FloatArray, stiff: StiffRoom) -> int:
    """Return the rule of a motion: FREE, SLIDE or PIVOT."""
    rule = FREE
    for i in range(contacts.used[0]):
        if forces[i, 0] > 0.0:
            rule = max(rule, PIVOT if stiff.is_sticking[i] else SLIDE)
    return rule


@kernel
def next_twist(
    setting: Setting, quaternion: Quaternion, frame: Frame, turn_step_rad: float, work: QuasistaticWorkspace
) -> tuple[Twist, bool]:
    """Return the twist to follow from a pose that moves, and whether it is the implicit one.

    The forces that belong to it are in ``work.stiff.forces``.
    """
    contacts, stiff, y = work.contacts, work.stiff, work.solver.y
    carries = False
    for i in range(contacts.used[0]):
        stiff.is_sticking[i] = sticks(contacts, i, setting.friction, work.load, y)
        carries = carries or contacts.forces[i, 0] > 0.0
        for j in range(3):
            stiff.forces[i, j] = contacts.forces[i, j]
    velocity, spin = twist_of(y, frame)
    spin = straightened(velocity, spin, setting.body.reach_m)
    end = longest_step(velocity, spin, carries, turn_step_rad, setting.size_m)
    if end < math.inf:
        write_curvature(contacts, stiff.is_sticking, setting.loads, setting.phase, quaternion, frame, stiff.curvature)
        if abs(curvature_along(stiff.curvature, y)) * end > STIFF:
            if stiff_step(contacts, setting.friction, work.load, y, 1.0 / end, stiff, work.solver):
                velocity, spin = twist_of(stiff.delta, frame)
                end = min(1.0, longest_step(velocity, spin, carries, turn_step_rad, setting.size_m))
                for i in range(contacts.used[0]):
                    stiff.is_sticking[i] = stiff.is_sticking[i] and stiff.forces[i, 0] > 0.0
                return Twist(velocity, spin, end), True
            for i in range(contacts.used[0]):
                for j in range(3):
                    stiff.forces[i, j] = contacts.forces[i, j]
    return Twist(velocity, spin, end), False


@kernel
def is_held_on_the_way(
    setting: Setting, position: Vector, quaternion: Quaternion, new_point: int, work: QuasistaticWorkspace
) -> bool:
    """Whether friction holds the object at a pose of a step, without the point that the step has just reached."""
    frame = frame_at(setting.body, quaternion)
    if not find_contacts(setting.geometry, work.placement, position, frame, setting.tolerances.touch_m, work.ahead):
        return False
    kept = 0
    if new_point >= 0:  # its rows are taken out
        for i in range(work.ahead.used[0]):
            if work.ahead.points[i] != new_point:
                copy_contact(work.ahead, i, kept)
                kept += 1
        work.ahead.used[0] = kept
    write_load(setting.loads, setting.phase, quaternion, frame, work.load)
    return is_held(work.ahead, setting.friction, work.load, work.solver)


@kernel
def copy_contact(contacts: ContactSet, source: int, target: int) -> None:
    """Move what an onset needs of one row to another (groups begin anew at the target)."""
    if source == target:
        return
    contacts.points[target] = contacts.points[source]
    contacts.boxes[target] = contacts.boxes[source]
    same_group = target > 0 and (
        contacts.points[target - 1] == contacts.points[target] and contacts.boxes[target - 1] == contacts.boxes[target]
    )
    contacts.groups[target] = contacts.groups[target - 1] if same_group else target
    contacts.chosen[target] = not same_group
    for j in range(3):
        for k in range(6):
            contacts.columns[target, j, k] = contacts.columns[source, j, k]


@kernel
def first_rest(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    work: QuasistaticWorkspace,
) -> tuple[Vector, Quaternion]:
    """Return the first pose of a step that friction holds; at ``amount`` it does. The placement is that of the pose."""
    low, high = 0.0, amount
    no_point = int(np.int64(-1))  # a literal would compile its callees again
    best = (position, quaternion)
    for _ in range(HALVES_TO_REST):
        middle = 0.5 * (low + high)
        place_object(setting.geometry, position, quaternion, work.placement)
        done, new_position, new_quaternion = stepped(
            setting,
            work.placement,
            work.contacts,
            work.stiff.forces,
            work.stiff,
            position,
            quaternion,
            twist,
            middle,
            no_point,
            no_point,
            work.path,
        )
        if done and is_held_on_the_way(setting, new_position, new_quaternion, no_point, work):
            high = middle
            best = (new_position, new_quaternion)
        else:
            low = middle
    place_object(setting.geometry, best[0], best[1], work.placement)
    return best


@kernel
def gap_left(contacts: ContactSet) -> float:
    """Return the greatest distance, to either side, of a contact that carries from its face."""
    greatest = 0.0
    for i in range(contacts.used[0]):
        if contacts.forces[i, 0] > 0.0:
            greatest = max(greatest, abs(contacts.gaps[i]))
    return greatest


@kernel
def polished(
    setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace
) -> tuple[Vector, Quaternion]:
    """Close the gaps, within the touch tolerance, of the contacts that carry (5.12)."""
    for i in range(work.contacts.used[0]):
        work.stiff.is_sticking[i] = False
    allow_depths(work.placement, setting.tolerances, work.path)
    pin_contacts(setting.geometry, work.placement, work.contacts, work.contacts.forces, work.stiff, work.path.pins)
    done, new_position, new_quaternion = pushed_out(setting, work.placement, position, quaternion, work.path)
    if done:
        return new_position, new_quaternion
    place_object(setting.geometry, position, quaternion, work.placement)
    return position, quaternion


@kernel
def write_step(
    work: QuasistaticWorkspace, event: int, phase: int, rule: int, motion: int, position: Vector, quaternion: Quaternion
) -> None:
    """Write a step; which points touch, and which were reached, follows from the contacts after it."""
    trace = work.trace
    trace.phases[event], trace.rules[event], trace.motions[event] = phase, rule, motion
    trace.notes[event] = PLAIN
    for k in range(3):
        trace.positions[event, k] = position[k]
    for k in range(4):
        trace.quaternions[event, k] = quaternion[k]
    for point in range(len(work.touched)):
        trace.touching[event, point] = False
    for i in range(work.contacts.used[0]):
        trace.touching[event, work.contacts.points[i]] = True
    for point in range(len(work.touched)):
        trace.hit[event, point] = trace.touching[event, point] and not work.touched[point]
        if work.touched[point] and not trace.touching[event, point]:
            trace.notes[event] = LET_GO


@kernel
def note_touching(work: QuasistaticWorkspace) -> None:
    """Remember which points touch before a step."""
    for point in range(len(work.touched)):
        work.touched[point] = False
    for i in range(work.contacts.used[0]):
        work.touched[work.contacts.points[i]] = True


@kernel
def phase_run(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    step_limit: int,
    first_event: int,
    work: QuasistaticWorkspace,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase; return (verdict code, number of steps so far, position, quaternion)."""
    touch_m = setting.tolerances.touch_m
    place_object(setting.geometry, position, quaternion, work.placement)
    frame = frame_at(setting.body, quaternion)
    fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
    turn_step = setting.turn_step_rad
    still, n_polished = 0, 0
    event = first_event
    while event < first_event + step_limit:
        note_touching(work)
        write_load(setting.loads, setting.phase, quaternion, frame, work.load)
        code = onset(work.contacts, setting.friction, work.load, work.solver) if fits else UNSOLVED
        if code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION):
            if n_polished < POLISHES and gap_left(work.contacts) > ON_FACE * setting.size_m:
                position, quaternion = polished(setting, position, quaternion, work)
                frame = frame_at(setting.body, quaternion)
                fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
                n_polished += 1
                continue
        if code != MOVES:
            write_step(work, event, setting.phase, HELD, NONE, position, quaternion)
            return (STALLED if code == UNSOLVED else RESTS), event + 1, position, quaternion
        twist, _ = next_twist(setting, quaternion, frame, turn_step, work)
        rule = carried_by(work.contacts, work.stiff.forces, work.stiff)
        motion = TRAVEL if norm(twist.spin) == 0.0 else SCREW
        if rule == FREE and nothing_ahead(setting, position):
            write_step(work, event, setting.phase, rule, TRAVEL, position, quaternion)
            return ESCAPES, event + 1, position, quaternion
        amount, hit_point, as_planned, new_position, new_quaternion = furthest_step(
            setting,
            work.placement,
            work.contacts,
            work.stiff.forces,
            work.stiff,
            position,
            quaternion,
            twist,
            work.path,
        )
        if amount == math.inf:
            write_step(work, event, setting.phase, rule, TRAVEL, position, quaternion)
            return ESCAPES, event + 1, position, quaternion
        could_rest = setting.friction > 0.0 and rule != FREE and amount > 0.0
        if could_rest and is_held_on_the_way(setting, new_position, new_quaternion, hit_point, work):
            new_position, new_quaternion = first_rest(setting, position, quaternion, twist, amount, work)
        speed = norm(twist.velocity) + norm(twist.spin) * setting.body.reach_m
        still = 0 if amount * speed > STILL * setting.size_m else still + 1
        turn_step = min(2.0 * turn_step, setting.turn_step_rad) if as_planned else 0.25 * turn_step
        position, quaternion = new_position, new_quaternion
        frame = frame_at(setting.body, quaternion)
        fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
        write_step(work, event, setting.phase, rule, motion, position, quaternion)
        event += 1
        if still == STILL_STEPS:
            return STALLED, event, position, quaternion
    return LIMIT, first_event + step_limit, position, quaternion


@entry_kernel
def quasistatic_run(
    geometry: Geometry,
    body: Body,
    start_position: Vector,
    start_quaternion: Quaternion,
    loads: DeadLoads,
    rules: QuasistaticRules,
    size_m: float,
    tolerances: KernelTolerances,
    work: QuasistaticWorkspace,
) -> tuple[int, int]:
    """Run the phases one after the other; return how many (phases were run, steps were written).

    Parameters
    ----------
    geometry, body, loads
        The scene; boxes as seen from the centre of gravity.
    start_position, start_quaternion
        Centre of gravity at the start, metres, and the object's unit quaternion (w, x, y, z).
    rules, tolerances
        Numbers of the method and of the kernels.
    size_m
        The scene's size, metres.
    work
        Filled: trace and verdicts.

    A phase that does not end at rest is the last one that is run.
    """
    position, quaternion = start_position, start_quaternion
    n_events = int(np.int64(0))  # a plain 0 would compile `phase_run` twice, once for the literal
    for phase in range(len(work.verdicts)):
        setting = Setting(geometry, body, loads, phase, size_m, rules.friction, rules.turn_step_rad, tolerances)
        work.verdicts[phase], n_events, position, quaternion = phase_run(
            setting, position, quaternion, rules.step_limit, n_events, work
        )
        if work.verdicts[phase] != RESTS:
            return phase + 1, n_events
    return len(work.verdicts), n_events
