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

from cagepose.kernels.algebra.pose import Quaternion, turned_by
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, minus, norm
from cagepose.kernels.collision.geometry import Geometry, Placement, empty_placement, place_object
from cagepose.kernels.contact.contact_set import (
    CONTACTS_PER_POINT,
    ContactRow,
    ContactSet,
    empty_contact_set,
    find_contacts,
)
from cagepose.kernels.contact.curvature import write_curvature
from cagepose.kernels.contact.metric import Frame, frame_at, twist_of, write_load
from cagepose.kernels.contact.onset import (
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    UNSOLVED,
    OnsetRoom,
    is_held,
    onset,
    sticks,
)
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.outcome.cases import Cases, Part, Start, is_valid, start_of
from cagepose.kernels.outcome.endings import INVALID, Endings, write_ending
from cagepose.kernels.outcome.publish import NO_BALANCE, begin, end_phase, judge_end, publish_events
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import (
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
from cagepose.kernels.quasistatic.implicit_step import StiffRoom, curvature_along, keep_along_faces, stiff_step
from cagepose.kernels.quasistatic.projection import ON_FACE
from cagepose.kernels.quasistatic.step import (
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
from cagepose.kernels.stability.proof import ProofRoom, empty_proof_room

RULE_NAMES = ("free", "slide", "pivot", "held", "stalled")
FREE, SLIDE, PIVOT, HELD, STUCK = 0, 1, 2, 3, 4
"""No contact carries; those that carry slide; one of them sticks; the contacts hold the object; nothing was found."""

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
    turn_step_rad
        Longest turn in one step.
    step_limit
        Greatest number of steps in a phase.
    """

    turn_step_rad: float
    step_limit: int


class RunRoom:
    """Room of fixed size: what the solvers need; a record."""

    solver: OnsetRoom
    stiff: StiffRoom


class QuasistaticWorkspace(NamedTuple):
    """All arrays that a run writes to, so that compiled code makes none.

    Attributes
    ----------
    placement, contacts
        The state at the present pose.
    ahead
        Room for contacts at a pose that is tried.
    turned
        Room for the contacts in the coordinates of an implicit step.
    rooms
        One room of fixed size.
    path
        Room of the steps.
    touched
        Which points touched before the step, (n_points,).
    trace
        Steps of one phase.
    points_world
        Cage points of the case that is run, (n_points, 3).
    proof
        Room for the proof of a phase's end.
    """

    placement: Placement
    contacts: ContactSet
    ahead: ContactSet
    turned: Rows[ContactRow]
    rooms: Rows[RunRoom]
    path: PathRoom
    touched: NDArray[np.bool_]
    trace: Trace
    points_world: FloatArray
    proof: ProofRoom


def empty_quasistatic_workspace(geometry: Geometry, step_limit: int) -> QuasistaticWorkspace:
    """Return room for one run at a time (plain Python)."""
    n_points = len(geometry.points_world)
    n_contacts = CONTACTS_PER_POINT * n_points
    return QuasistaticWorkspace(
        empty_placement(geometry),
        empty_contact_set(n_contacts),
        empty_contact_set(n_contacts),
        empty_rows(ContactRow, n_contacts),
        empty_rows(RunRoom, 1),
        empty_path_room(n_points),
        np.zeros(n_points, np.bool_),
        empty_trace(step_limit, n_points),
        np.zeros((n_points, 3)),
        empty_proof_room(geometry),
    )


@kernel
def carried_by(contacts: ContactSet) -> int:
    """Return the rule of a motion: FREE, SLIDE or PIVOT."""
    rule = FREE
    for i in range(contacts.used[0]):
        if contacts.rows[i].step_forces[0] > 0.0:
            rule = max(rule, PIVOT if contacts.rows[i].is_sticking else SLIDE)
    return rule


@kernel
def carry_as_at_onset(contacts: ContactSet) -> None:
    """Take the forces of the onset for the step."""
    for i in range(contacts.used[0]):
        for j in range(3):
            contacts.rows[i].step_forces[j] = contacts.rows[i].forces[j]


@kernel
def next_twist(
    setting: Setting, quaternion: Quaternion, frame: Frame, turn_step_rad: float, work: QuasistaticWorkspace
) -> Twist:
    """Return the twist to follow from a pose that moves; the contacts' ``step_forces`` belong to it."""
    contacts, room = work.contacts, work.rooms[0]
    y = room.solver.y
    carries = False
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        contact.is_sticking = sticks(contact, setting.friction, room.solver.load_terms, y)
        carries = carries or contact.forces[0] > 0.0
    carry_as_at_onset(contacts)
    velocity, spin = twist_of(y, frame)
    spin = straightened(velocity, spin, setting.body.reach_m, room.solver.load_terms)
    end = longest_step(velocity, spin, carries, turn_step_rad, setting.size_m)
    if end < math.inf:
        write_curvature(contacts, setting.load, quaternion, frame, room.stiff.curvature)
        rho = max(keep_along_faces(contacts, room.stiff), 1.0 / end)
        if abs(curvature_along(room.stiff.curvature, y)) * end > STIFF:
            if stiff_step(contacts, work.turned, setting.friction, rho, room.stiff, room.solver):
                velocity, spin = twist_of(room.stiff.delta, frame)
                end = min(1.0, longest_step(velocity, spin, carries, turn_step_rad, setting.size_m))
                for i in range(contacts.used[0]):
                    contact = contacts.rows[i]
                    contact.is_sticking = contact.is_sticking and contact.step_forces[0] > 0.0
            else:
                carry_as_at_onset(contacts)
    return Twist(velocity, spin, end)


@kernel
def is_held_on_the_way(setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> bool:
    """Whether friction holds the object at a pose of a step, by the points that touched the same boxes before it.

    What the step reaches does not count: it touches at the end only, and what it holds is asked there.
    """
    frame = frame_at(setting.body, quaternion)
    if not find_contacts(setting.geometry, work.placement, position, frame, setting.tolerances.touch_m, work.ahead):
        return False
    kept = 0
    for i in range(work.ahead.used[0]):
        if touches_box(work.contacts, work.ahead.rows[i].point, work.ahead.rows[i].box):
            copy_contact(work.ahead.rows, i, kept)
            kept += 1
    work.ahead.used[0] = kept
    work.rooms[0].solver.load_terms = write_load(setting.load, quaternion, frame, work.rooms[0].solver.load)
    return is_held(work.ahead, setting.friction, work.rooms[0].solver)


@kernel
def touches_box(contacts: ContactSet, point: int, box: int) -> bool:
    """Whether a point touches a box at the pose of the contacts."""
    found = False
    for i in range(contacts.used[0]):
        found = found or (contacts.rows[i].point == point and contacts.rows[i].box == box)
    return found


@kernel
def copy_contact(rows: Rows[ContactRow], source: int, target: int) -> None:
    """Move what an onset needs of one row to another (groups begin anew at the target)."""
    if source == target:
        return
    old, new = rows[source], rows[target]
    new.point, new.box = old.point, old.box
    same_group = target > 0 and rows[target - 1].point == new.point and rows[target - 1].box == new.box
    counts = old.group >= 0
    new.group = -1 if not counts else rows[target - 1].group if same_group else target
    new.chosen = counts and not same_group
    for j in range(3):
        for k in range(6):
            new.columns[j, k] = old.columns[j, k]


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
    best = (position, quaternion)
    for _ in range(HALVES_TO_REST):
        middle = 0.5 * (low + high)
        place_object(setting.geometry, position, quaternion, work.placement)
        done, new_position, new_quaternion = stepped(
            setting,
            work.placement,
            work.contacts,
            position,
            quaternion,
            twist,
            middle,
            -1,
            -1,
            work.path,
        )
        if done and is_held_on_the_way(setting, new_position, new_quaternion, work):
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
        if contacts.rows[i].forces[0] > 0.0:
            greatest = max(greatest, abs(contacts.rows[i].gap))
    return greatest


@kernel
def polished(
    setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace
) -> tuple[Vector, Quaternion]:
    """Close the gaps, within the touch tolerance, of the contacts that carry (5.12)."""
    carry_as_at_onset(work.contacts)
    for i in range(work.contacts.used[0]):
        work.contacts.rows[i].is_sticking = False
    allow_depths(work.placement, setting.tolerances, work.path)
    pin_contacts(setting.geometry, work.placement, work.contacts, work.path.pins)
    done, new_position, new_quaternion = pushed_out(setting, work.placement, position, quaternion, work.path)
    if done:
        return new_position, new_quaternion
    place_object(setting.geometry, position, quaternion, work.placement)
    return position, quaternion


@kernel
def write_step(
    work: QuasistaticWorkspace, step: int, rule: int, motion: int, position: Vector, quaternion: Quaternion
) -> None:
    """Write a step; which points touch, and which were reached, follows from the contacts after it."""
    trace = work.trace
    record = trace.rows[step]
    record.rule, record.motion, record.note = rule, motion, PLAIN
    for k in range(3):
        record.position[k] = position[k]
    for k in range(4):
        record.quaternion[k] = quaternion[k]
    for point in range(len(work.touched)):
        trace.touching[step, point] = False
    for i in range(work.contacts.used[0]):
        trace.touching[step, work.contacts.rows[i].point] = True
    for point in range(len(work.touched)):
        trace.hit[step, point] = trace.touching[step, point] and not work.touched[point]
        if work.touched[point] and not trace.touching[step, point]:
            record.note = LET_GO


@kernel
def note_touching(work: QuasistaticWorkspace) -> None:
    """Remember which points touch before a step."""
    for point in range(len(work.touched)):
        work.touched[point] = False
    for i in range(work.contacts.used[0]):
        work.touched[work.contacts.rows[i].point] = True


@kernel
def phase_run(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    step_limit: int,
    work: QuasistaticWorkspace,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase; return (verdict code, number of steps, position, quaternion)."""
    touch_m = setting.tolerances.touch_m
    place_object(setting.geometry, position, quaternion, work.placement)
    frame = frame_at(setting.body, quaternion)
    fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
    turn_step = setting.turn_step_rad
    still, n_polished = 0, 0
    step = 0
    while step < step_limit:
        note_touching(work)
        work.rooms[0].solver.load_terms = write_load(setting.load, quaternion, frame, work.rooms[0].solver.load)
        code = onset(work.contacts, setting.friction, work.rooms[0].solver) if fits else UNSOLVED
        is_rest = code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION)
        if is_rest and n_polished < POLISHES and gap_left(work.contacts) > ON_FACE * setting.size_m:
            position, quaternion = polished(setting, position, quaternion, work)
            frame = frame_at(setting.body, quaternion)
            fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
            n_polished += 1
            continue
        if code != MOVES:
            rule = STUCK if code == UNSOLVED else HELD
            write_step(work, step, rule, NONE, position, quaternion)
            return (STALLED if code == UNSOLVED else RESTS), step + 1, position, quaternion
        twist = next_twist(setting, quaternion, frame, turn_step, work)
        rule = carried_by(work.contacts)
        motion = TRAVEL if norm(twist.spin) == 0.0 else SCREW
        if rule == FREE and nothing_ahead(setting, position):
            write_step(work, step, rule, TRAVEL, position, quaternion)
            return ESCAPES, step + 1, position, quaternion
        amount, as_planned, new_position, new_quaternion = furthest_step(
            setting,
            work.placement,
            work.contacts,
            position,
            quaternion,
            twist,
            work.path,
        )
        if amount == math.inf:
            write_step(work, step, rule, TRAVEL, position, quaternion)
            return ESCAPES, step + 1, position, quaternion
        could_rest = setting.friction > 0.0 and rule != FREE and amount > 0.0
        if could_rest and is_held_on_the_way(setting, new_position, new_quaternion, work):
            new_position, new_quaternion = first_rest(setting, position, quaternion, twist, amount, work)
        moved = norm(minus(new_position, position)) + setting.body.reach_m * turned_by(quaternion, new_quaternion)
        still = 0 if moved > STILL * setting.size_m else still + 1
        turn_step = min(2.0 * turn_step, setting.turn_step_rad) if as_planned else 0.25 * turn_step
        position, quaternion = new_position, new_quaternion
        frame = frame_at(setting.body, quaternion)
        fits = find_contacts(setting.geometry, work.placement, position, frame, touch_m, work.contacts)
        write_step(work, step, rule, motion, position, quaternion)
        step += 1
        if still == STILL_STEPS:
            return STALLED, step, position, quaternion
    return LIMIT, step_limit, position, quaternion


@kernel
def run_phase(
    start: Start,
    part: Part,
    rules: QuasistaticRules,
    phase: int,
    position: Vector,
    quaternion: Quaternion,
    work: QuasistaticWorkspace,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase of a case; see `phase_run`."""
    setting = Setting(
        start.geometry,
        part.body,
        start.loads[phase],
        start.size_m,
        start.friction,
        rules.turn_step_rad,
        start.tolerances,
    )
    return phase_run(setting, position, quaternion, rules.step_limit, work)


@entry
def run_quasistatic(
    part: Part, cases: Cases, rules: QuasistaticRules, work: QuasistaticWorkspace, outcome: Outcome
) -> bool:
    """Run the phases of a scene one after the other, and judge where each of them ends.

    Parameters
    ----------
    part, cases
        The scene: the first of the cases.
    rules
        Numbers of the method.
    work
        Written over.
    outcome
        Filled. A phase that does not end at rest is the last one.

    Returns
    -------
    bool
        False: the outcome has no room for all contacts.
    """
    begin(outcome)
    start = start_of(0, part, cases, work.points_world)
    position, quaternion = start.position, start.quaternion
    for phase in range(len(start.loads)):
        verdict, n_steps, end, turned = run_phase(start, part, rules, phase, position, quaternion, work)
        publish_events(work.trace, n_steps, True, position, quaternion, start, part, outcome)
        verdict, fits = end_phase(verdict, phase, end, turned, start, part, work.proof, outcome)
        if verdict != RESTS or not fits:
            return fits
        position, quaternion = end, turned
    return True


@entry
def run_quasistatic_cases(
    first: int,
    last: int,
    part: Part,
    cases: Cases,
    farthest: float,
    rules: QuasistaticRules,
    work: QuasistaticWorkspace,
    endings: Endings,
) -> None:
    """Run the cases ``first`` up to, without, ``last``, and judge where a phase comes to rest.

    Parameters
    ----------
    part, cases, rules, work
        As in `run_quasistatic`.
    farthest
        Sizes of the scene from the cage beyond which no start is valid.
    endings
        Filled.
    """
    for case in range(first, last):
        start = start_of(case, part, cases, work.points_world)
        if not is_valid(start, farthest, len(cases.points_cage) > 1, work.placement):
            endings.verdicts[case, 0] = INVALID
            continue
        position, quaternion = start.position, start.quaternion
        for phase in range(len(start.loads)):
            verdict, n_steps, position, quaternion = run_phase(start, part, rules, phase, position, quaternion, work)
            if verdict == RESTS:
                endings.proofs[case, phase], _, _ = judge_end(phase, position, quaternion, start, part, work.proof)
                if endings.proofs[case, phase] in NO_BALANCE:
                    verdict = STALLED
            write_ending(endings, case, phase, verdict, n_steps, position, quaternion, start, part)
            for i in range(work.contacts.used[0]):
                endings.touching[case, phase, work.contacts.rows[i].point] = True
            if verdict != RESTS:
                break
