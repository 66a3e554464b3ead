"""The stepwise method: the paper's rules as one compiled state machine (docs/theory, rules R1 to R11).

Phase A (gravity alone): A-1 travel, A-2 turn about one contact, A-3 turn about two, A-4 stable or a new axis. Phase B
(a push): the same, after slip has been looked at (B-5): contacts that all slip on one or two faces slide (Slp-1,
Slp-2) instead.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.geometry import Geometry, PlacedCage, empty_cage
from cagepose.kernels.boundary.overlap import forget_shells
from cagepose.kernels.collision.boxes import (
    BoxesAndPoints,
    PlacedBoxes,
    empty_placed_boxes,
    is_clear_of,
    place_boxes_at,
)
from cagepose.kernels.collision.first_contact import first_contact_travel
from cagepose.kernels.contact.loads import PhaseLoad, arm_of
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.outcome.cases import Cases, Part, Start, is_valid, start_of
from cagepose.kernels.outcome.endings import INVALID, Endings, write_ending
from cagepose.kernels.outcome.publish import begin, end_phase, publish_events
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import (
    CYCLING,
    EDGE_TIE,
    ESCAPES,
    LIMIT,
    NONE,
    PLAIN,
    SPINS,
    STABLE,
    TRAVEL,
    StepRecord,
    Trace,
    empty_trace,
)
from cagepose.kernels.stability.proof import ProofWorkspace, empty_proof_workspace
from cagepose.kernels.stepwise.slip import SlipRules, slip_step
from cagepose.kernels.stepwise.step import Step, pose_during, write_step
from cagepose.kernels.stepwise.support import (
    PointLoad,
    SupportRules,
    pairwise_stability,
    turn_about_one,
    turn_about_two,
)
from cagepose.kernels.stepwise.touching import Touching, choose_below, empty_touching, find_touching, has_face_tie

RULE_NAMES = ("A-1", "A-2", "A-3", "A-4", "B-1", "B-2", "B-3", "B-4", "Slp-1", "Slp-2")
PHASE_A, PHASE_B = 0, 4  # codes of A-1 and B-1; steps 2, 3 and 4 follow


class StepwiseRules(NamedTuple):
    """All numbers of the method.

    Attributes
    ----------
    support, slip
        See `SupportRules` and `SlipRules`.
    step_limit
        Greatest number of events in a phase.
    """

    support: SupportRules
    slip: SlipRules
    step_limit: int


@kernel
def turn_or_hold(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    touching: Touching,
    n_chosen: int,
    load: PointLoad,
    phase_code: int,
    rules: StepwiseRules,
    tolerances: KernelTolerances,
) -> Step:
    """Steps 2 to 4 of a phase: one chosen contact turns (R1), two turn (R2), three or more are tested (R3)."""
    chosen = touching.chosen
    if n_chosen == 1:
        return turn_about_one(geometry, placement, chosen[0], load, phase_code + 1, phase_code + 3, tolerances)
    if n_chosen == 2:
        return turn_about_two(geometry, placement, chosen[0], chosen[1], load, phase_code + 2, tolerances)
    return pairwise_stability(
        geometry, placement, chosen, n_chosen, load, phase_code + 2, phase_code + 3, rules.support, tolerances
    )


@kernel
def next_step(
    geometry: BoxesAndPoints,
    placement: PlacedBoxes,
    touching: Touching,
    load: PointLoad,
    is_push: bool,
    rules: StepwiseRules,
    tolerances: KernelTolerances,
) -> Step:
    """One decision of the method. Under gravity (phase A) every contact counts and none slips."""
    phase_code = PHASE_B if is_push else PHASE_A
    n_chosen = choose_below(touching, rules.slip.contactless_angle_rad if is_push else math.inf)
    if n_chosen == 0:
        distance, hit_point, _ = first_contact_travel(geometry, placement, load.direction, -math.inf, tolerances)
        return Step(phase_code, TRAVEL, load.direction, (0.0, 0.0, 0.0), distance, hit_point, PLAIN)
    if is_push:
        slide = slip_step(
            geometry,
            placement,
            touching.chosen,
            n_chosen,
            touching.alphas,
            touching.normals,
            load,
            rules.slip,
            tolerances,
        )
        if slide.motion != NONE:
            return slide
    step = turn_or_hold(geometry, placement, touching, n_chosen, load, phase_code, rules, tolerances)
    if step.amount == -math.inf and n_chosen < touching.n_touching[0]:
        # R8: blocked at once by points that were taken for contactless, so they are contacts after all.
        n_chosen = choose_below(touching, math.inf)
        step = turn_or_hold(geometry, placement, touching, n_chosen, load, phase_code, rules, tolerances)
    return step


@kernel
def was_met(trace: Trace, last: int, size_m: float, resolution_m: float) -> bool:
    """Whether a step before ``last`` ended at the pose and with the contacts of ``last`` (R10).

    The method has no other memory (but for the order of touching, which only tells at a tie), so it would repeat itself
    for ever.
    """
    for event in range(last):
        then, now = trace.rows[event], trace.rows[last]
        offset = minus(vector_from(then.position), vector_from(now.position))
        if dot(offset, offset) > resolution_m * resolution_m:
            continue
        overlap = 0.0
        for k in range(4):
            overlap += then.quaternion[k] * now.quaternion[k]
        sign = math.copysign(1.0, overlap)
        turned = 0.0
        for k in range(4):
            turned = max(turned, abs(then.quaternion[k] - sign * now.quaternion[k]))
        if turned * size_m <= resolution_m:
            same_contacts = True
            for point in range(trace.touching.shape[1]):
                same_contacts = same_contacts and trace.touching[event, point] == trace.touching[last, point]
            if same_contacts:
                return True
    return False


@kernel
def is_push(load: PhaseLoad) -> bool:
    """Whether a phase has a force: gravity beside it is ignored then (R8b)."""
    return len(load) > 1 and norm(vector_from(load[1].vector)) > 0.0


@kernel
def load_at(load: PhaseLoad, position: Vector, quaternion: Quaternion) -> PointLoad:
    """Return the load on the object at a pose: its direction is the world's, its point the object's (R8b)."""
    action = load[1 if is_push(load) else 0]
    force = vector_from(action.vector)
    return PointLoad(scaled(force, 1.0 / norm(force)), plus(position, arm_of(action, quaternion)))


@kernel
def phase_run(
    start: Start,
    boxes: BoxesAndPoints,
    phase: int,
    position: Vector,
    quaternion: Quaternion,
    of_size: StepwiseRules,
    step_limit: int,
    work: StepwiseWorkspace,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase; return (verdict code, number of steps, position, quaternion). ``of_size``: for a scene of size 1.

    The contacts of the phase before keep their order. A step depends on the pose and on that order alone, so that any
    step of a run can be made again.
    """
    tolerances, actions = start.tolerances, start.actions[phase]
    placement, touching, trace = work.placement, work.touching, work.trace
    rules = rules_of(of_size, start.friction.scene, start.size_m)
    pushes = is_push(actions)
    place_boxes_at(boxes, position, quaternion, placement)
    load = load_at(actions, position, quaternion)
    find_touching(boxes, placement, load, tolerances, touching)
    for count in range(step_limit):
        # Decide.
        write_start(trace, count, position, quaternion, touching)
        step = next_step(boxes, placement, touching, load, pushes, rules, tolerances)
        if pushes and step.note == PLAIN and has_face_tie(touching):
            step = Step(step.rule, step.motion, step.along, step.through, step.amount, step.hit_point, EDGE_TIE)
        if step.motion == NONE:
            write_step(trace.rows[count], step, position, quaternion)
            for point in range(len(boxes.points_world)):
                trace.touching[count, point], trace.hit[count, point] = touching.is_touching[point], False
            return STABLE, count + 1, position, quaternion
        # Move.
        halfway = pose_during(step, position, quaternion, 0.5)
        halfway_rotation = matrix_from_quaternion(halfway[1])
        position, quaternion = pose_during(step, position, quaternion, 1.0)
        write_step(trace.rows[count], step, position, quaternion)
        # Find the contacts there, and which of them the motion has reached.
        load = load_at(actions, position, quaternion)
        place_boxes_at(boxes, position, quaternion, placement)
        find_touching(boxes, placement, load, tolerances, touching)
        for point in range(len(boxes.points_world)):
            is_hit = touching.is_touching[point]
            trace.touching[count, point] = is_hit
            if is_hit and touching.was_touching[point] and point != step.hit_point:
                # Reached anew, if it did not touch halfway, as in a swing back.
                is_hit = is_clear_of(boxes, halfway[0], halfway_rotation, point, tolerances.touch_m)
            trace.hit[count, point] = is_hit
        # Look for an end.
        if step.amount == math.inf:
            return (ESCAPES if step.motion == TRAVEL else SPINS), count + 1, position, quaternion
        if was_met(trace, count, start.size_m, tolerances.resolution_m):
            return CYCLING, count + 1, position, quaternion
    return LIMIT, step_limit, position, quaternion


@kernel
def rules_of(of_size: StepwiseRules, friction: float, size_m: float) -> StepwiseRules:
    """Scale rules that are given for a scene of size 1; below the angle of friction a contact does not slip (R4)."""
    support, slip = of_size.support, of_size.slip
    return StepwiseRules(
        SupportRules(support.least_moment, support.blocked_key, support.unseen_key, support.equal_distance_m * size_m),
        SlipRules(math.atan(friction), slip.contactless_angle_rad, slip.parallel_sine, slip.equal_distance_m * size_m),
        of_size.step_limit,
    )


@kernel
def write_start(trace: Trace, step: int, position: Vector, quaternion: Quaternion, touching: Touching) -> None:
    """Write what a step begins from."""
    record = trace.rows[step]
    for k in range(3):
        record.start_position[k] = position[k]
    for k in range(4):
        record.start_quaternion[k] = quaternion[k]
    for place in range(trace.order.shape[1]):
        trace.order[step, place] = touching.order[place] if place < touching.n_touching[0] else -1


@kernel
def forget_contacts(touching: Touching) -> None:
    """Begin a run: nothing has touched yet."""
    touching.n_touching[0] = 0
    for point in range(len(touching.is_touching)):
        touching.is_touching[point] = False


class StepwiseWorkspace(NamedTuple):
    """All arrays that a run writes to, so that compiled code makes none.

    Attributes
    ----------
    placement, touching
        The state at the present pose.
    trace
        Steps of one phase.
    cage
        That of the case that is run.
    proof
        Workspace for the proof of a phase's end.
    """

    placement: PlacedBoxes
    touching: Touching
    trace: Trace
    cage: PlacedCage
    proof: ProofWorkspace


def empty_stepwise_workspace(geometry: Geometry, boxes: BoxesAndPoints, step_limit: int) -> StepwiseWorkspace:
    """Return a workspace for one run at a time (plain Python)."""
    n_points = len(boxes.points_world)
    return StepwiseWorkspace(
        empty_placed_boxes(boxes),
        empty_touching(n_points),
        empty_trace(step_limit, n_points, n_points),
        empty_cage(geometry),
        empty_proof_workspace(geometry),
    )


@kernel
def boxes_of(part: Part, cage: PlacedCage) -> BoxesAndPoints:
    """Return the boxes of the object, and the cage points of a case."""
    return BoxesAndPoints(part.half_sizes, part.box_positions, part.box_rotations, part.n_own_boxes, cage.points_world)


@entry
def run_stepwise(part: Part, cases: Cases, rules: StepwiseRules, work: StepwiseWorkspace, outcome: Outcome) -> None:
    """Run the phases of a scene one after the other, and judge by the mechanics where each of them ends.

    Parameters
    ----------
    part, cases
        The scene: the first of the cases.
    rules
        Numbers of the method, for a scene of size 1; the angle of slip is that of the case's friction.
    work
        Written over.
    outcome
        Filled. A phase that does not end stable is the last one.

    """
    begin(outcome)
    start, boxes = start_of(0, part, cases, work.cage), boxes_of(part, work.cage)
    position, quaternion = start.position, start.quaternion
    forget_contacts(work.touching)
    for phase in range(len(start.actions)):
        verdict, n_steps, end, turned = phase_run(
            start, boxes, phase, position, quaternion, rules, rules.step_limit, work
        )
        publish_events(work.trace, n_steps, False, position, quaternion, start, part, outcome)
        verdict = end_phase(verdict, phase, end, turned, start, part, work.proof, outcome)
        if verdict != STABLE:
            return
        position, quaternion = end, turned


@entry
def run_stepwise_cases(
    first: int,
    last: int,
    part: Part,
    cases: Cases,
    farthest: float,
    rules: StepwiseRules,
    work: StepwiseWorkspace,
    endings: Endings,
) -> None:
    """Run the cases ``first`` up to, without, ``last``.

    Parameters
    ----------
    part, cases, rules, work
        As in `run_stepwise`.
    farthest
        Sizes of the scene from the cage beyond which no start is valid.
    endings
        Filled.
    """
    forget_shells(work.cage.overlap)
    for case in range(first, last):
        start, boxes = start_of(case, part, cases, work.cage), boxes_of(part, work.cage)
        if not is_valid(start, farthest, len(cases.points_cage) > 1, work.proof.placement, work.cage):
            endings.verdicts[case, 0] = INVALID
            continue
        position, quaternion = start.position, start.quaternion
        forget_contacts(work.touching)
        for phase in range(len(start.actions)):
            verdict, n_steps, position, quaternion = phase_run(
                start, boxes, phase, position, quaternion, rules, rules.step_limit, work
            )
            write_ending(endings, case, phase, verdict, n_steps, position, quaternion, start, part)
            for point in range(len(work.cage.points_world)):
                endings.touching[case, phase, point] = work.touching.is_touching[point]
            if verdict != STABLE:
                break


@entry
def repeat_stepwise(
    phase: int,
    first: Rows[StepRecord],
    order: NDArray[np.int64],
    n_steps: int,
    part: Part,
    cases: Cases,
    rules: StepwiseRules,
    work: StepwiseWorkspace,
    outcome: Outcome,
) -> None:
    """Make steps of a run again, from what the record of their first one holds.

    Parameters
    ----------
    phase, first, order, n_steps
        Index of the phase, the record (one row), the points in the order of touching before it, (n_points,), and how
        many steps.
    part, cases, rules, work
        As in `run_stepwise`.
    outcome
        Filled: the events that these steps are.
    """
    begin(outcome)
    start, q = start_of(0, part, cases, work.cage), first[0].start_quaternion
    position, quaternion = vector_from(first[0].start_position), (q[0], q[1], q[2], q[3])
    touching = work.touching
    forget_contacts(touching)
    for place in range(len(order)):
        if order[place] >= 0:
            touching.order[place] = order[place]
            touching.is_touching[order[place]] = True
            touching.n_touching[0] = place + 1
    phase_run(start, boxes_of(part, work.cage), phase, position, quaternion, rules, n_steps, work)
    publish_events(work.trace, n_steps, False, position, quaternion, start, part, outcome)
