"""The quasistatic method: its phases, run one after the other, for one scene or for many cases of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.overlap import forget_shells
from cagepose.kernels.contact.pressing import number_pressing
from cagepose.kernels.driven.bodies import begin_drives, begin_phase, move_bodies, write_displacement, write_drivers
from cagepose.kernels.driven.drive import drive_on
from cagepose.kernels.driven.press import begin_pressing, drive_pressed, press_on
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.outcome.cases import Cases, Part, Start, is_valid, start_of
from cagepose.kernels.outcome.endings import INVALID, Endings, write_ending
from cagepose.kernels.outcome.publish import CONTACTS, begin, end_phase, is_no_rest, judge_end, publish_events
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import BLOCKED, JAMS, RESTS, STALLED, STOPS, StepRecord
from cagepose.kernels.quasistatic.run import QuasistaticRules, steps_from
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.state import State, at_rest, state_of
from cagepose.kernels.quasistatic.touched_before import place_before


@kernel
def phase_from(
    start: Start,
    part: Part,
    cases: Cases,
    phase: int,
    state: State,
    rules: QuasistaticRules,
    is_driven: bool,
    work: DriveWorkspace,
) -> tuple[int, int, Vector, Quaternion, float]:
    """Run a phase of a case from a state, with its drive if it is driven, or what presses; return (verdict code, number
    of steps, position, quaternion, share of the drive, or way of what presses in metres).
    """
    setting = Setting(
        start.geometry,
        part.body,
        start.actions[phase],
        start.size_m,
        start.friction,
        rules.turn_step_rad,
        start.tolerances,
    )
    drive = DriveSetting(setting, phase, cases.drives.stop_at[phase])
    work.scratch[0].greatest = work.scratch[0].least_jam = math.nan  # of what is not driven
    if number_pressing(work.run.proof.contacts.pressing) > 0:
        if is_driven:
            verdict, n_steps, end, share = drive_pressed(drive, cases, state, rules.step_limit, work)
        else:
            verdict, n_steps, end, share = press_on(drive, cases, state, rules.step_limit, work)
        return verdict, n_steps, end.position, end.quaternion, share
    verdict, n_steps, end = steps_from(setting, state, 0, rules.step_limit, work.run)
    share = 0.0
    if is_driven and verdict == RESTS:
        verdict, n_steps, end, share = drive_on(drive, end, n_steps, rules.step_limit, work)
    return verdict, n_steps, end.position, end.quaternion, share


@kernel
def run_phase(
    start: Start,
    part: Part,
    cases: Cases,
    rules: QuasistaticRules,
    phase: int,
    position: Vector,
    quaternion: Quaternion,
    work: DriveWorkspace,
) -> tuple[int, int, Vector, Quaternion, float]:
    """Run one phase of a case from its beginning; see `phase_from`."""
    is_driven = begin_phase(phase, start, cases, work.memory)
    begin_pressing(start.geometry, cases, phase, work)
    move_bodies(start.geometry, phase, 0.0, work.memory)
    state = at_rest(position, quaternion, rules.turn_step_rad, 0)
    return phase_from(start, part, cases, phase, state, rules, is_driven, work)


@kernel
def publish_drive(
    phase: int,
    share: float,
    position: Vector,
    quaternion: Quaternion,
    start: Start,
    work: DriveWorkspace,
    outcome: Outcome,
) -> None:
    """Write where the bodies of the cage are after a phase, and what their drivers do there; contacts carry then what
    they carried along the drive.
    """
    record, scratch, n_bodies = outcome.phases[phase], work.scratch[0], len(work.drivers)
    is_driven, n_contacts = False, outcome.counts[CONTACTS]
    for body in range(n_bodies):
        is_driven = is_driven or work.memory.n_legs[body] > 0
        write_displacement(start.geometry, work.memory, body, outcome.displaced[phase, body])
        for k in range(7):
            outcome.drivers[phase, body, k] = 0.0
    record.share = share
    record.driving = record.greatest = record.greatest_at = record.work = record.rubbed = record.lost = 0.0
    record.least_jam = math.inf
    if number_pressing(work.run.proof.contacts.pressing) > 0 and not is_driven:
        publish_pressing(phase, position, quaternion, start, work, outcome)
        return
    if not is_driven or (share == 0.0 and record.verdict not in (BLOCKED, JAMS, STOPS)):
        return
    record.work, record.rubbed, record.lost = scratch.work, scratch.rubbed, scratch.lost
    record.least_jam = scratch.least_jam
    record.greatest, record.greatest_at = scratch.greatest, scratch.greatest_at
    for body in range(n_bodies):
        for k in range(7):
            outcome.drivers[phase, body, k] = work.drivers[body, k]
        record.driving += work.drivers[body, 6]
    first = outcome.phases[phase - 1].n_contacts if phase > 0 else 0
    proof, driven = work.run.proof.contacts, work.run.contacts
    for i in range(min(proof.used[0], n_contacts - first) if record.verdict in (RESTS, STOPS) else 0):
        contact, at = outcome.contacts[first + i], place_before(driven, proof.rows[i])
        if at < 0:
            contact.force_normal = 0.0
            for k in range(3):
                contact.force_tangential[k] = 0.0
            continue
        forces, directions = driven.states[at].forces, driven.rows[at].directions
        contact.force_normal = forces[0]
        for k in range(3):
            contact.force_tangential[k] = -(forces[1] * directions[1, k] + forces[2] * directions[2, k])


@kernel
def publish_pressing(
    phase: int, position: Vector, quaternion: Quaternion, start: Start, work: DriveWorkspace, outcome: Outcome
) -> None:
    """Write what pushes each body that presses, its guide's forces too, in balance with the contacts of the proof."""
    if outcome.phases[phase].verdict == RESTS:
        load, drivers = start.actions[phase], outcome.drivers[phase]
        write_drivers(work.run.proof.contacts, position, quaternion, load, 0.0, work.memory, drivers)


@kernel
def goes_on_after(verdict: int) -> bool:
    """Whether the next phase begins after one with this verdict."""
    return verdict in (RESTS, BLOCKED, JAMS, STOPS)


@entry
def run_quasistatic(part: Part, cases: Cases, rules: QuasistaticRules, work: DriveWorkspace, outcome: Outcome) -> None:
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

    """
    begin(outcome)
    run = work.run
    forget_shells(run.cage.overlap)
    start = begin_drives(start_of(0, part, cases, run.cage), cases, work.memory)
    position, quaternion = start.position, start.quaternion
    for phase in range(len(start.actions)):
        verdict, n_steps, end, turned, share = run_phase(start, part, cases, rules, phase, position, quaternion, work)
        publish_events(run.trace, n_steps, True, position, quaternion, start, part, outcome)
        verdict = end_phase(verdict, phase, end, turned, start, part, run.proof, outcome)
        publish_drive(phase, share, end, turned, start, work, outcome)
        if not goes_on_after(verdict):
            return
        position, quaternion = end, turned


@entry
def run_quasistatic_cases(
    first: int,
    last: int,
    part: Part,
    cases: Cases,
    farthest: float,
    rules: QuasistaticRules,
    work: DriveWorkspace,
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
    run = work.run
    forget_shells(run.cage.overlap)
    for case in range(first, last):
        start = begin_drives(start_of(case, part, cases, run.cage), cases, work.memory)
        if not is_valid(start, farthest, len(cases.points_cage) > 1, run.placement, run.cage):
            endings.verdicts[case, 0] = INVALID
            continue
        position, quaternion = start.position, start.quaternion
        for phase in range(len(start.actions)):
            verdict, n_steps, position, quaternion, share = run_phase(
                start, part, cases, rules, phase, position, quaternion, work
            )
            if verdict == RESTS:
                proof, _, _ = judge_end(phase, position, quaternion, start, part, run.proof)
                endings.proofs[case, phase] = proof
                if is_no_rest(proof, phase, position, quaternion, start):
                    verdict = STALLED
            write_ending(endings, case, phase, verdict, n_steps, position, quaternion, start, part)
            endings.shares[case, phase] = share
            endings.greatest[case, phase] = work.scratch[0].greatest
            endings.least_jams[case, phase] = work.scratch[0].least_jam
            for i in range(run.contacts.used[0]):
                endings.touching[case, phase, run.contacts.rows[i].cage_part] = True
            if not goes_on_after(verdict):
                break


@entry
def repeat_quasistatic(
    phase: int,
    first: Rows[StepRecord],
    _order: NDArray[np.int64],
    n_steps: int,
    part: Part,
    cases: Cases,
    rules: QuasistaticRules,
    work: DriveWorkspace,
    outcome: Outcome,
) -> None:
    """Make steps of a run again, from the state that the record of their first one holds.

    Parameters
    ----------
    phase, first, _order, n_steps
        Index of the phase, the record (one row), the order of touching, which this method does not ask for, and how
        many steps.
    part, cases, rules, work
        As in `run_quasistatic`.
    outcome
        Filled: the events that these steps are.
    """
    begin(outcome)
    start, state = start_of(0, part, cases, work.run.cage), state_of(first[0])
    phase_from(start, part, cases, phase, state, QuasistaticRules(rules.turn_step_rad, n_steps), False, work)
    publish_events(work.run.trace, n_steps, True, state.position, state.quaternion, start, part, outcome)
