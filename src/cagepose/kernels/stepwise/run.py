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

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, dot, minus, plus, row, vector_from
from cagepose.kernels.collision.first_contact import first_contact_travel
from cagepose.kernels.collision.geometry import Geometry, Placement, empty_placement, is_clear_of, place_object
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.stepwise.slip import SlipRules, slip_step
from cagepose.kernels.stepwise.support import (
    PointLoad,
    SupportRules,
    pairwise_stability,
    turn_about_one,
    turn_about_two,
)
from cagepose.kernels.stepwise.touching import Touching, choose_below, empty_touching, find_touching, has_face_tie
from cagepose.kernels.trace import (
    CYCLING,
    EDGE_TIE,
    ESCAPES,
    LIMIT,
    NONE,
    PLAIN,
    SPINS,
    STABLE,
    TRAVEL,
    Step,
    Trace,
    empty_trace,
    pose_during,
    write_event,
)

RULE_NAMES = ("A-1", "A-2", "A-3", "A-4", "B-1", "B-2", "B-3", "B-4", "Slp-1", "Slp-2")
PHASE_A, PHASE_B = 0, 4  # codes of A-1 and B-1; steps 2, 3 and 4 follow


class StepwiseRules(NamedTuple):
    """All numbers of the method.

    Attributes
    ----------
    support, slip
        See `SupportRules` and `SlipRules`.
    event_limit
        Greatest number of events in a phase.
    """

    support: SupportRules
    slip: SlipRules
    event_limit: int


class PhaseLoads(NamedTuple):
    """One row for each phase.

    Attributes
    ----------
    directions_world
        Unit vectors, (n_phases, 3).
    points_object
        Application points in the object's frame, (n_phases, 3), metres.
    is_push
        True: phase B (a force); False: phase A (gravity alone), (n_phases,).
    """

    directions_world: FloatArray
    points_object: FloatArray
    is_push: NDArray[np.bool_]


@kernel
def turn_or_hold(
    geometry: Geometry,
    placement: Placement,
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
    geometry: Geometry,
    placement: Placement,
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
def was_met(trace: Trace, first: int, last: int, size_m: float, resolution_m: float) -> bool:
    """Whether an event from ``first`` to before ``last`` ended at the pose and with the contacts of ``last`` (R10).

    The method has no other memory (but for the order of touching, which only tells at a tie), so it would repeat itself
    for ever.
    """
    for event in range(first, last):
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
def load_at(loads: PhaseLoads, phase: int, position: Vector, quaternion: Quaternion) -> PointLoad:
    """Return the load of a phase on the object at a pose: the direction is the world's, the point the object's."""
    point = plus(position, rotated(quaternion, row(loads.points_object, phase)))
    return PointLoad(row(loads.directions_world, phase), point)


@kernel
def phase_run(
    geometry: Geometry,
    placement: Placement,
    touching: Touching,
    position: Vector,
    quaternion: Quaternion,
    loads: PhaseLoads,
    phase: int,
    rules: StepwiseRules,
    size_m: float,
    tolerances: KernelTolerances,
    trace: Trace,
    first_event: int,
) -> tuple[int, int, Vector, Quaternion]:
    """Run one phase from where ``placement`` is; return (verdict code, events so far, position, quaternion)."""
    load = load_at(loads, phase, position, quaternion)
    find_touching(geometry, placement, load, tolerances, touching)
    for event in range(first_event, first_event + rules.event_limit):
        step = next_step(geometry, placement, touching, load, loads.is_push[phase], rules, tolerances)
        if loads.is_push[phase] and step.note == PLAIN and has_face_tie(touching):
            step = Step(step.rule, step.motion, step.along, step.through, step.amount, step.hit_point, EDGE_TIE)
        if step.motion == NONE:
            write_event(trace, event, phase, step, position, quaternion)
            for point in range(len(geometry.points_world)):
                trace.touching[event, point], trace.hit[event, point] = touching.is_touching[point], False
            return STABLE, event + 1, position, quaternion
        halfway = pose_during(step, position, quaternion, 0.5)
        halfway_rotation = matrix_from_quaternion(halfway[1])
        position, quaternion = pose_during(step, position, quaternion, 1.0)
        write_event(trace, event, phase, step, position, quaternion)
        load = load_at(loads, phase, position, quaternion)
        place_object(geometry, position, quaternion, placement)
        find_touching(geometry, placement, load, tolerances, touching)
        for point in range(len(geometry.points_world)):
            is_hit = touching.is_touching[point]
            trace.touching[event, point] = is_hit
            if is_hit and touching.was_touching[point] and point != step.hit_point:
                # Reached anew, if it did not touch halfway, as in a swing back.
                is_hit = is_clear_of(geometry, halfway[0], halfway_rotation, point, tolerances.touch_m)
            trace.hit[event, point] = is_hit
        if step.amount == math.inf:
            return (ESCAPES if step.motion == TRAVEL else SPINS), event + 1, position, quaternion
        if was_met(trace, first_event, event, size_m, tolerances.resolution_m):
            return CYCLING, event + 1, position, quaternion
    return LIMIT, first_event + rules.event_limit, position, quaternion


@kernel
def forget_contacts(touching: Touching) -> None:
    """Begin a run: nothing has touched yet."""
    touching.n_touching[0] = 0
    for point in range(len(touching.is_touching)):
        touching.is_touching[point] = False


class Workspace(NamedTuple):
    """All arrays that a run writes to, so that compiled code makes none.

    Attributes
    ----------
    placement, touching
        The state at the present pose.
    trace
        Events of all phases, one after the other.
    verdicts
        Verdict code of each phase, (n_phases,).
    """

    placement: Placement
    touching: Touching
    trace: Trace
    verdicts: NDArray[np.int64]


def empty_workspace(geometry: Geometry, n_phases: int, rules: StepwiseRules) -> Workspace:
    """Return room for one run (plain Python)."""
    n_points = len(geometry.points_world)
    return Workspace(
        empty_placement(geometry),
        empty_touching(n_points),
        empty_trace(n_phases * rules.event_limit, n_points),
        np.empty(n_phases, np.int64),
    )


@entry
def stepwise_run(
    geometry: Geometry,
    start_position: Vector,
    start_quaternion: Quaternion,
    loads: PhaseLoads,
    rules: StepwiseRules,
    size_m: float,
    tolerances: KernelTolerances,
    workspace: Workspace,
) -> tuple[int, int]:
    """Run the phases one after the other; return how many (phases were run, events were written).

    Parameters
    ----------
    geometry, loads
        The scene.
    start_position, start_quaternion
        Pose of the object at the start: metres, unit quaternion (w, x, y, z).
    rules, tolerances
        Numbers of the method and of the kernels.
    size_m
        The scene's size, metres.
    workspace
        Filled: trace and verdicts.

    A phase that does not end stable is the last one that is run.
    """
    placement, touching, trace, verdicts = workspace
    forget_contacts(touching)
    position, quaternion = start_position, start_quaternion
    place_object(geometry, position, quaternion, placement)
    n_events = int(np.int64(0))  # a plain 0 would compile `phase_run` twice, once for the literal
    for phase in range(len(verdicts)):
        verdicts[phase], n_events, position, quaternion = phase_run(
            geometry,
            placement,
            touching,
            position,
            quaternion,
            loads,
            phase,
            rules,
            size_m,
            tolerances,
            trace,
            n_events,
        )
        if verdicts[phase] != STABLE:
            return phase + 1, n_events
    return len(verdicts), n_events
