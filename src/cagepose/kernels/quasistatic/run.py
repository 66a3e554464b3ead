"""The quasistatic method: its phases, run one after the other, for one scene or for many cases of it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.overlap import forget_shells
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.outcome.cases import Cases, Part, Start, is_valid, start_of
from cagepose.kernels.outcome.endings import INVALID, Endings, write_ending
from cagepose.kernels.outcome.publish import begin, end_phase, is_no_rest, judge_end, publish_events
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import LIMIT, RESTS, STALLED, StepRecord
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.step import GOES_ON, State, next_step, stand_at, state_of
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace


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


@kernel
def steps_from(setting: Setting, state: State, step_limit: int, work: QuasistaticWorkspace) -> tuple[int, int, State]:
    """Make steps from a state until the phase ends; return (verdict code, number of steps, state at the end)."""
    fits = stand_at(setting, state.position, state.quaternion, work)
    for step in range(step_limit):
        verdict, state, fits = next_step(setting, state, fits, step, work)
        if verdict != GOES_ON:
            return verdict, step + 1, state
    return LIMIT, step_limit, state


@kernel
def phase_from(
    start: Start,
    part: Part,
    turn_step_rad: float,
    phase: int,
    state: State,
    step_limit: int,
    work: QuasistaticWorkspace,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase of a case from a state; return (verdict code, number of steps, position, quaternion)."""
    setting = Setting(
        start.geometry,
        part.body,
        start.actions[phase],
        start.size_m,
        start.friction,
        turn_step_rad,
        start.tolerances,
    )
    verdict, n_steps, end = steps_from(setting, state, step_limit, work)
    return verdict, n_steps, end.position, end.quaternion


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
    """Run one phase of a case from its beginning; see `phase_from`."""
    state = State(position, quaternion, rules.turn_step_rad, 0, 0)
    return phase_from(start, part, rules.turn_step_rad, phase, state, rules.step_limit, work)


@entry
def run_quasistatic(
    part: Part, cases: Cases, rules: QuasistaticRules, work: QuasistaticWorkspace, outcome: Outcome
) -> None:
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
    start = start_of(0, part, cases, work.cage)
    position, quaternion = start.position, start.quaternion
    for phase in range(len(start.actions)):
        verdict, n_steps, end, turned = run_phase(start, part, rules, phase, position, quaternion, work)
        publish_events(work.trace, n_steps, True, position, quaternion, start, part, outcome)
        verdict = end_phase(verdict, phase, end, turned, start, part, work.proof, outcome)
        if verdict != RESTS:
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
    forget_shells(work.cage.overlap)
    for case in range(first, last):
        start = start_of(case, part, cases, work.cage)
        if not is_valid(start, farthest, len(cases.points_cage) > 1, work.placement, work.cage):
            endings.verdicts[case, 0] = INVALID
            continue
        position, quaternion = start.position, start.quaternion
        for phase in range(len(start.actions)):
            verdict, n_steps, position, quaternion = run_phase(start, part, rules, phase, position, quaternion, work)
            if verdict == RESTS:
                proof, _, _ = judge_end(phase, position, quaternion, start, part, work.proof)
                endings.proofs[case, phase] = proof
                if is_no_rest(proof, phase, position, quaternion, start):
                    verdict = STALLED
            write_ending(endings, case, phase, verdict, n_steps, position, quaternion, start, part)
            for i in range(work.contacts.used[0]):
                endings.touching[case, phase, work.contacts.rows[i].cage_part] = True
            if verdict != RESTS:
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
    work: QuasistaticWorkspace,
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
    start, state = start_of(0, part, cases, work.cage), state_of(first[0])
    phase_from(start, part, rules.turn_step_rad, phase, state, n_steps, work)
    publish_events(work.trace, n_steps, True, state.position, state.quaternion, start, part, outcome)
