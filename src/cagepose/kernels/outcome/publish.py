"""From what a run has noted to its `Outcome`: steps to events, contacts with their forces, and the proof."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.pose import Quaternion, rotation_vector, write_upright
from cagepose.kernels.algebra.vector import Vector, plus, vector_from
from cagepose.kernels.boundary.features import FACE
from cagepose.kernels.boundary.geometry import held_at
from cagepose.kernels.boundary.surface_end import ends_near
from cagepose.kernels.contact.loads import pulls_nowhere
from cagepose.kernels.contact.metric import frame_at, twist_of
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.cases import Part, Start, object_position
from cagepose.kernels.outcome.motion import motion_between, motion_of_twist
from cagepose.kernels.outcome.records import Outcome, PhaseRecord
from cagepose.kernels.outcome.trace import AT_EDGE, COULD_STAY, LET_GO, NONE, RESTS, SCREW, STALLED, Trace
from cagepose.kernels.stability.proof import (
    OTHER_ONSET,
    PROVEN_MOVES,
    TOO_MANY_CONTACTS,
    ProofWorkspace,
    with_all_freedoms,
)
from cagepose.kernels.stability.proof_search import judge

PHASES, EVENTS, STEPS, CONTACTS = 0, 1, 2, 3
"""Places in `Outcome.counts`."""
NO_BALANCE = (PROVEN_MOVES, TOO_MANY_CONTACTS)
"""Proofs of a pose that is not shown as rest, whatever a run says."""


@kernel
def begin(outcome: Outcome) -> None:
    """Start with nothing written."""
    for place in range(4):
        outcome.counts[place] = 0


@kernel
def judge_end(
    phase: int, position: Vector, quaternion: Quaternion, start: Start, part: Part, at: ProofWorkspace
) -> tuple[int, int, int]:
    """Judge the pose at the end of a phase under its load, with what presses there; see `judge`."""
    return judge(
        start.geometry,
        part.body,
        position,
        quaternion,
        start.actions[phase],
        start.friction,
        start.size_m,
        with_all_freedoms(at),
    )


@kernel
def is_no_rest(code: int, phase: int, position: Vector, quaternion: Quaternion, start: Start) -> bool:
    """Whether a pose at which a run came to rest is not shown as rest: the last correction has taken it out of balance,
    or a spring pulls nowhere there.
    """
    return code in NO_BALANCE or pulls_nowhere(start.actions[phase], position, quaternion, start.size_m)


@kernel
def end_phase(
    verdict: int,
    phase: int,
    position: Vector,
    quaternion: Quaternion,
    start: Start,
    part: Part,
    at: ProofWorkspace,
    outcome: Outcome,
) -> int:
    """Judge the end of a phase whose events are published, write all that is known of it, and return the code of the
    verdict.
    """
    code, stability, n_undetermined = judge_end(phase, position, quaternion, start, part, at)
    if verdict == RESTS and is_no_rest(code, phase, position, quaternion, start):
        verdict = STALLED
    record = outcome.phases[phase]
    record.verdict = verdict
    publish_proof(code, stability, n_undetermined, position, quaternion, start, part, at, record)
    publish_contacts(start, position, at, outcome)
    record.n_events, record.n_steps, record.n_contacts = (
        outcome.counts[EVENTS],
        outcome.counts[STEPS],
        outcome.counts[CONTACTS],
    )
    outcome.counts[PHASES] = phase + 1
    return verdict


@kernel
def goes_on(trace: Trace, step: int) -> bool:
    """Whether the next step is of the same event: of one kind, with the same contacts."""
    for point in range(trace.hit.shape[1]):
        if trace.hit[step, point]:
            return False
    return bool(trace.rows[step].rule == trace.rows[step + 1].rule and trace.rows[step].note != LET_GO)


@kernel
def publish_events(
    trace: Trace,
    n_steps: int,
    joins_steps: bool,
    position: Vector,
    quaternion: Quaternion,
    start: Start,
    part: Part,
    outcome: Outcome,
) -> None:
    """Append the steps of a phase that began at a pose, as events.

    ``joins_steps``: steps of one kind between two changes of the contacts are one event, whose motion leads from its
    first pose to its last. Otherwise each step is an event with a motion of its own.
    """
    first_step = outcome.counts[STEPS]
    before, turns = quaternion, (0.0, 0.0, 0.0)
    for step in range(n_steps):
        # where the step ends, in the world
        record = trace.rows[step]
        end, turned = (
            vector_from(record.position),
            (
                record.quaternion[0],
                record.quaternion[1],
                record.quaternion[2],
                record.quaternion[3],
            ),
        )
        turns, before = plus(turns, rotation_vector(before, turned)), turned
        placed = object_position(start, part, end, turned)
        # the step itself
        place = outcome.counts[STEPS]
        outcome.counts[STEPS] += 1
        outcome.steps[place] = record  # type: ignore[index]
        for point in range(trace.order.shape[1]):
            outcome.order[place, point] = trace.order[step, point]
        for k in range(3):
            outcome.path[place, k] = placed[k]
        write_upright(turned, outcome.path[place, 3:])
        # the event that it closes, with the motion of all of its steps
        if joins_steps and step + 1 < n_steps and goes_on(trace, step):
            continue
        event = outcome.events[outcome.counts[EVENTS]]
        event.rule, event.note, event.motion = record.rule, record.note, record.motion
        for of_event in range(first_step, outcome.counts[STEPS]):
            if outcome.steps[of_event].could_stay:
                event.note = COULD_STAY
        if outcome.steps[first_step].is_at_edge:
            event.note = AT_EDGE
        event.n_steps = outcome.counts[STEPS] - first_step
        first_step = outcome.counts[STEPS]
        along, through = vector_from(record.along), vector_from(record.through)
        event.distance, event.angle = record.distance, record.angle
        if joins_steps and record.motion != NONE and record.distance < math.inf:
            moved = motion_between(position, quaternion, end, turned, start.size_m, turns)
            event.motion, along, through = moved.motion, moved.along, moved.through
            event.distance, event.angle = moved.distance, moved.angle
        for k in range(3):
            event.position[k] = placed[k]
            event.along[k], event.through[k] = along[k], through[k] + start.origin_world[k]
        write_upright(turned, event.quaternion)
        for point in range(trace.hit.shape[1]):
            outcome.touching[outcome.counts[EVENTS], point] = trace.touching[step, point]
            outcome.hit[outcome.counts[EVENTS], point] = trace.hit[step, point]
        outcome.counts[EVENTS] += 1
        position, quaternion, turns = end, turned, (0.0, 0.0, 0.0)


@kernel
def is_at_edge(start: Start, position: Vector, at: ProofWorkspace, i: int) -> bool:
    """Whether a contact is of a point of the cage within the touch tolerance of where the object's surface ends."""
    found, geometry = at.contacts.rows[i], start.geometry
    if geometry.held.features[found.feature].kind != FACE or geometry.cage.own.parts[found.cage_part].point < 0:
        return False
    held, place = held_at(geometry, at.placement), plus(position, vector_from(found.arm))
    return ends_near(held, found.feature, place, geometry.touch_m, at.placement.memory.waiting)


@kernel
def publish_contacts(start: Start, position: Vector, at: ProofWorkspace, outcome: Outcome) -> None:
    """Append the contacts of a proof."""
    for i in range(at.contacts.used[0]):
        found, forces = at.contacts.rows[i], at.contacts.states[i].forces
        contact = outcome.contacts[outcome.counts[CONTACTS]]
        contact.part, contact.cage_part, contact.gap, contact.group = (
            found.part,
            found.cage_part,
            found.gap,
            found.group,
        )
        contact.near_edge = is_at_edge(start, position, at, i)
        contact.force_normal, contact.is_shared = forces[0], at.statuses[i].is_shared
        for k in range(3):
            contact.place[k] = start.origin_world[k] + position[k] + found.arm[k]
            contact.normal[k] = found.directions[0, k]
            contact.force_tangential[k] = -(forces[1] * found.directions[1, k] + forces[2] * found.directions[2, k])
        outcome.counts[CONTACTS] += 1


@kernel
def publish_proof(
    code: int,
    stability: int,
    n_undetermined: int,
    position: Vector,
    quaternion: Quaternion,
    start: Start,
    part: Part,
    at: ProofWorkspace,
    phase: PhaseRecord,
) -> None:
    """Write what a proof says of the pose at the end of a phase."""
    scratch = at.scratch[0]
    phase.proof, phase.stability, phase.wedged = code, stability, scratch.wedged
    phase.residual = scratch.solver.residual
    phase.is_second_order, phase.is_chained = scratch.solver.is_second_order, scratch.solver.is_chained
    phase.is_clamped = scratch.is_clamped
    phase.n_undetermined = min(n_undetermined, WRENCH)
    for i in range(phase.n_undetermined):
        for k in range(WRENCH):
            phase.undetermined[i, k] = scratch.rest.ways.basis[i, k]
    phase.motion = NONE
    if code in (PROVEN_MOVES, OTHER_ONSET):
        y = scratch.solver.y if code == PROVEN_MOVES else scratch.tree.y
        frame = frame_at(part.body, quaternion)
        velocity, spin = twist_of(y, frame)
        begins = motion_of_twist(velocity, spin, position, frame.extent_m)
        phase.motion = begins.motion
        phase.pitch = begins.distance if begins.motion == SCREW else 0.0
        for k in range(3):
            phase.along[k], phase.through[k] = begins.along[k], begins.through[k] + start.origin_world[k]
