"""One step of the quasistatic method: from a state to the next, along the motion that the mechanics gives.

At a pose: find the contacts and solve the onset of motion. Held: the end. Else move along its twist, with the contacts
that carry on their faces, up to the first contact, to the end of one that carries, to where the loads do no more work,
or as far as the motion keeps its direction. The loads do work in every step, but for what it takes to bring contacts
out that are deep within the touch tolerance: no pose comes twice from farther than that.

A step depends on its state alone, so that any step of a run can be made again.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.tolerances import DEPENDENT_COLUMN
from cagepose.kernels.algebra.vector import Vector, norm, scaled
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.contact_set import ContactSet, stays_on_face
from cagepose.kernels.contact.curvature import curvature_along, write_circulation, write_curvature
from cagepose.kernels.contact.equilibrium import (
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    MOVES_SOMEHOW,
    UNSOLVED,
)
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.load_curvature import has_circulation
from cagepose.kernels.contact.loads import longest_pull, write_load
from cagepose.kernels.contact.metric import Frame, frame_at, twist_of, way_between, write_scaled_twist
from cagepose.kernels.contact.on_circle import is_under_circle
from cagepose.kernels.contact.onset import find_sticking, goes_on, holds_with_some_faces, onset
from cagepose.kernels.contact.sharing import share_evenly
from cagepose.kernels.contact.tolerances import RESIDUAL_AT_LIMIT
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import (
    ESCAPES,
    LET_GO,
    NONE,
    PLAIN,
    RESTS,
    SCREW,
    STALLED,
    TRAVEL,
)
from cagepose.kernels.quasistatic.event_search import begins_to_tip, furthest_step, power_ends
from cagepose.kernels.quasistatic.first_contact import Twist
from cagepose.kernels.quasistatic.flight import nothing_ahead
from cagepose.kernels.quasistatic.guards import power_of
from cagepose.kernels.quasistatic.implicit_step import (
    hold_carrying,
    implicit_step,
    is_convex,
    keep_along_faces,
    keep_along_held,
    rho_against_circulation,
    shared_step,
)
from cagepose.kernels.quasistatic.path import Path, along_faces
from cagepose.kernels.quasistatic.projection import DEPENDENT, FIXED, ON_FACE, constrain_features, keep_stopped
from cagepose.kernels.quasistatic.pushing_out import allow_depths, constrain_contacts, pushed_out
from cagepose.kernels.quasistatic.seat import seated
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.state import State, write_state
from cagepose.kernels.quasistatic.step_length import longest_step, straightened, turn_of_normals
from cagepose.kernels.quasistatic.tipping import may_tip
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace
from cagepose.kernels.stability.strong import OTHER_FOUND, other_onset_on_circles

RULE_NAMES = ("free", "slide", "pivot", "held", "stalled", "escapes", "driven")
FREE, SLIDE, PIVOT, HELD, STUCK, AWAY, DRIVEN = 0, 1, 2, 3, 4, 5, 6
"""No contact carries; those that carry slide; one of them sticks; the contacts hold the object; nothing was found;
nothing is ahead; a body of the cage moves."""

STIFF = 0.25
"""Curvature times step above which the explicit step would no longer follow the path: then it is made implicit."""
ROUND, LONGER = 4.0, 6
"""Where normals turn so many times faster than the object, the explicit step is short because of them: how often an
implicit one, which turns them less, is made longer."""
STILL = 1e-14
"""In sizes of the scene: a shorter step is no progress."""
STILL_STEPS = 6
"""Steps without progress after which the run has stalled."""
AS_IT_TIPS = 64.0
"""By so much a step is shorter where the object begins to tip: its spin grows from nothing."""
REFINEMENTS = 3
"""How often, in a phase, a rest is put on its faces and looked at again: what balanced before may not quite, then."""

GOES_ON = -1
"""Instead of the code of a verdict: the phase goes on."""


@kernel
def carried_by(contacts: ContactSet) -> int:
    """Return the rule of a motion: FREE, SLIDE or PIVOT."""
    rule = FREE
    for i in range(contacts.used[0]):
        if stays_on_face(contacts, i):
            rule = max(rule, PIVOT if contacts.states[i].is_sticking else SLIDE)
    return rule


@kernel
def impending_motion(setting: Setting, frame: Frame, work: QuasistaticWorkspace) -> int:
    """Return the code of the onset from rest at the pose, with the motion in the solver.

    Where Newton's method does not find it, it is looked for among all contact modes, as another onset beside a rest is.
    """
    contacts, solver, proof = work.contacts, work.scratch[0].solver, work.proof
    friction = setting.friction.greatest
    code = onset(contacts, frame, friction, solver)
    if code != MOVES_SOMEHOW or friction == 0.0:
        return code
    tree, load, terms = proof.scratch[0].tree, solver.load, solver.load_terms
    found = other_onset_on_circles(contacts, frame, friction, load, terms, tree, solver.newton, proof.system)
    if found != OTHER_FOUND:
        return MOVES_SOMEHOW
    for k in range(contacts.n_freedoms):
        solver.y[k] = tree.y[k]
    return MOVES


@kernel
def motion_there(setting: Setting, state: State, frame: Frame, work: QuasistaticWorkspace) -> tuple[int, bool]:
    """Return the code of what an object does that comes to a pose as the state says, with the motion in the solver, and
    whether friction could hold it there: an object that moves goes on as long as Coulomb's law lets it (5.62).
    """
    contacts, scratch, friction = work.contacts, work.scratch[0], setting.friction.greatest
    code = impending_motion(setting, frame, work)
    if code != HELD_BY_FRICTION or state.n_still > 0:
        return code, False
    write_scaled_twist(state.velocity, state.spin, frame, scratch.before)
    if length(scratch.before, contacts.n_freedoms) == 0.0:
        return code, False
    if goes_on(contacts, frame, friction, scratch.before, scratch.solver.y, scratch.solver):
        return MOVES, True
    return impending_motion(setting, frame, work), False


@kernel
def is_shared(
    setting: Setting, position: Vector, quaternion: Quaternion, frame: Frame, rho: float, work: QuasistaticWorkspace
) -> bool:
    """Whether there is a step to a stable balance with forces that are shared evenly; else all is as it was."""
    contacts, stiff, solver = work.contacts, work.scratch[0].stiff, work.scratch[0].solver
    hold_carrying(contacts, solver.locked, DEPENDENT, stiff)
    if not share_evenly(contacts, stiff.held, solver.y, solver.load_terms, stiff.sharing):
        return False
    write_curvature(contacts, setting.load, position, quaternion, frame, False, stiff.curvature)
    keep_along_held(stiff)
    if shared_step(contacts, rho, stiff, solver):
        return True
    for i in range(contacts.used[0]):
        contacts.states[i].forces[0] = contacts.states[i].kept_forces[0]
    write_curvature(contacts, setting.load, position, quaternion, frame, False, stiff.curvature)
    keep_along_faces(contacts, solver.locked, DEPENDENT_COLUMN, stiff)
    return False


@kernel
def twist_of_step(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    turn_step_rad: float,
    slides: bool,
    work: QuasistaticWorkspace,
) -> tuple[Twist, float]:
    """Return the twist of an implicit step, as far as it may go, and how much of it keeps its direction."""
    velocity, spin = twist_of(work.scratch[0].stiff.delta, frame)
    spin = straightened(velocity, spin, setting.body.reach_m, 0.0)
    longest = min(
        longest_step(work.contacts, velocity, spin, slides, turn_step_rad, setting.size_m),
        longest_pull(
            setting.load, position, quaternion, velocity, spin, turn_step_rad, setting.size_m, setting.body.reach_m
        ),
    )
    return Twist(velocity, spin, min(1.0, longest)), longest


@kernel
def next_twist(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    turn_step_rad: float,
    is_still: bool,
    could_stay: bool,
    work: QuasistaticWorkspace,
) -> tuple[Twist, bool]:
    """Return the twist to follow from a pose that moves, and whether it is that of an implicit step in a stable valley,
    whose end is known; forces and sticking are then those of the step. ``is_still``: a step before it led nowhere;
    ``could_stay``: friction could hold it.
    """
    contacts, scratch, friction = work.contacts, work.scratch[0], setting.friction.greatest
    y, is_stable = scratch.solver.y, False
    find_sticking(contacts, frame, friction, setting.tolerances.touch_m, scratch.solver.load_terms, y)
    carries = carried_by(contacts) != FREE
    velocity, spin = twist_of(y, frame)
    spin = straightened(velocity, spin, setting.body.reach_m, scratch.solver.load_terms)
    load, size_m = setting.load, setting.size_m
    end = min(
        longest_step(contacts, velocity, spin, carries, turn_step_rad, size_m),
        longest_pull(load, position, quaternion, velocity, spin, turn_step_rad, size_m, setting.body.reach_m),
    )
    twist = Twist(velocity, spin, end)
    if end < math.inf:
        write_curvature(contacts, load, position, quaternion, frame, False, scratch.stiff.curvature)
        least_rho = keep_along_faces(contacts, scratch.solver.locked, DEPENDENT_COLUMN, scratch.stiff)
        if has_circulation(load):
            write_circulation(contacts, load, position, quaternion, frame, scratch.stiff.circulation)
            least_rho = max(least_rho, rho_against_circulation(scratch.stiff))
        rho = max(least_rho, 1.0 / end)
        is_valley = is_convex(least_rho, scratch.stiff)
        asks_shared = friction == 0.0 and carries and (is_still or not (is_valley or is_convex(rho, scratch.stiff)))
        if asks_shared and is_shared(setting, position, quaternion, frame, rho, work):
            return twist_of_step(setting, position, quaternion, frame, turn_step_rad, True, work)[0], False
        is_stiff = abs(curvature_along(scratch.stiff.curvature, y, contacts.n_freedoms)) * end > STIFF
        turns = turn_of_normals(contacts, velocity, spin)
        is_round = turns * end > STIFF * turn_step_rad and turns > ROUND * norm(spin)
        for _ in range(LONGER if is_round else 1):
            if not (is_stiff or is_round) or not implicit_step(
                contacts,
                work.turned,
                friction,
                rho,
                could_stay,
                setting.tolerances.rounding_m,
                scratch.stiff,
                scratch.solver,
            ):
                break
            is_stable = is_valley
            twist, longest = twist_of_step(setting, position, quaternion, frame, turn_step_rad, carries, work)
            if longest < 2.0 or rho <= least_rho:
                break
            rho = max(rho / longest, least_rho)
    return twist, is_stable


@kernel
def gap_left(contacts: ContactSet) -> float:
    """Return the greatest distance, to either side, of a contact that stays on its face from it."""
    greatest = 0.0
    for i in range(contacts.used[0]):
        if stays_on_face(contacts, i):
            greatest = max(greatest, abs(contacts.rows[i].gap))
    return greatest


@kernel
def gap_under_circles(contacts: ContactSet, touch_m: float) -> float:
    """Return the greatest distance, to either side, of a rim that lies flat from what it lies on.

    A face is on all of a rim with its full digits or not at all: tilted by the touch tolerance it is a slope.
    """
    greatest = 0.0
    for i in range(contacts.used[0]):
        if is_under_circle(contacts, i, touch_m):
            greatest = max(greatest, abs(contacts.rows[i].gap))
    return greatest


@kernel
def refined(
    setting: Setting, position: Vector, quaternion: Quaternion, is_rest: bool, work: QuasistaticWorkspace
) -> tuple[Vector, Quaternion]:
    """Close the gaps, within the touch tolerance, of the contacts that carry (5.12); or, before a rest, under rims."""
    contacts, constraints = work.contacts, work.path.constraints
    for i in range(contacts.used[0]):
        contacts.states[i].is_sticking = contacts.states[i].stays_flat = False
    allow_depths(setting.geometry, work.placement, setting.tolerances, work.path)
    if is_rest:
        constrain_contacts(contacts, math.inf, constraints)
    else:
        constraints.scratch[0].used = 0
        for i in range(contacts.used[0]):
            if is_under_circle(contacts, i, setting.tolerances.touch_m):
                row = contacts.rows[i]
                constrain_features(constraints, row.feature, row.cage_feature, row.angle, FIXED, 0.0)
    done, new_position, new_quaternion = pushed_out(setting, work.placement, position, quaternion, work.path)
    if done:
        return new_position, new_quaternion
    place_object(setting.geometry, position, quaternion, work.placement)
    return position, quaternion


@kernel
def note_touching(work: QuasistaticWorkspace) -> None:
    """Remember which points touch before a step."""
    for point in range(len(work.touched)):
        work.touched[point] = False
    for i in range(work.contacts.used[0]):
        work.touched[work.contacts.rows[i].cage_part] = True


@kernel
def write_step(
    work: QuasistaticWorkspace,
    step: int,
    rule: int,
    motion: int,
    is_at_edge: bool,
    position: Vector,
    quaternion: Quaternion,
) -> None:
    """Write a step; which points touch, and which were reached, follows from the contacts after it. ``is_at_edge``: it
    moves only because a contact is on an edge.
    """
    trace = work.trace
    record = trace.rows[step]
    record.rule, record.motion, record.note = rule, motion, PLAIN
    record.is_at_edge, record.could_stay = is_at_edge, False
    record.distance = record.share = record.driving = 0.0  # the way is told by the poses
    record.could_jam = False
    for k in range(len(record.pressed)):
        record.pressed[k] = 0.0
    for k in range(3):
        record.position[k] = position[k]
    for k in range(4):
        record.quaternion[k] = quaternion[k]
    for point in range(len(work.touched)):
        trace.touching[step, point] = False
    for i in range(work.contacts.used[0]):
        trace.touching[step, work.contacts.rows[i].cage_part] = True
    for point in range(len(work.touched)):
        trace.hit[step, point] = trace.touching[step, point] and not work.touched[point]
        if work.touched[point] and not trace.touching[step, point]:
            record.note = LET_GO


@kernel
def write_escape(
    work: QuasistaticWorkspace,
    step: int,
    is_at_edge: bool,
    velocity: Vector,
    position: Vector,
    quaternion: Quaternion,
) -> None:
    """Write the last step of an object that gets away, from a pose: its centre of gravity travels without end."""
    write_step(work, step, AWAY, TRAVEL, is_at_edge, position, quaternion)
    along = scaled(velocity, 1.0 / norm(velocity))
    work.trace.rows[step].distance = math.inf
    for k in range(3):
        work.trace.rows[step].along[k] = along[k]


@kernel
def stand_at(setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> bool:
    """Place the object at a pose and find its contacts there; False: there are more than a workspace has room for."""
    place_object(setting.geometry, position, quaternion, work.placement)
    return find_placed_contacts(setting, position, quaternion, work)


@kernel
def find_placed_contacts(
    setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace
) -> bool:
    """Find the contacts where the object is placed already; see `stand_at`."""
    frame = frame_at(setting.body, quaternion)
    return find_contacts(setting.geometry, work.placement, setting.friction, position, frame, work.contacts)


@kernel
def next_step(
    setting: Setting, state: State, fits: bool, step: int, work: QuasistaticWorkspace
) -> tuple[int, State, bool]:
    """Make one step; return (GOES_ON or the code of the verdict, state after it, whether its contacts fit).

    Parameters
    ----------
    setting
        What does not change during the phase.
    state, fits
        Where it begins, and what `stand_at` said there. The workspace is that of this pose before, and of the next
        pose after.
    step
        Place in the trace to write it to.
    work
        See there.
    """
    solver = work.scratch[0].solver
    position, quaternion, n_refined = state.position, state.quaternion, state.n_refined
    write_state(work.trace.rows[step], state)

    # Does it move there? A rest is put on its faces, and looked at again; where it is none then but for little, it ends
    # where it was.
    code, is_rest, would_hold, could_stay = UNSOLVED, False, False, False
    rest, has_rested = (position, quaternion), False
    for _ in range(REFINEMENTS + 2):
        note_touching(work)
        frame = frame_at(setting.body, quaternion)
        solver.load_terms = write_load(setting.load, position, quaternion, frame, solver.load)
        would_hold = fits and holds_with_some_faces(work.contacts, frame, setting.friction.greatest, solver)
        if fits and not has_rested:
            code, could_stay = motion_there(setting, state, frame, work)
        else:
            code = impending_motion(setting, frame, work) if fits else UNSOLVED
        keep_stopped(solver.stopped, position, frame, work.path.constraints)
        is_rest = code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION)
        if has_rested and code == MOVES and solver.residual <= RESIDUAL_AT_LIMIT:
            (position, quaternion), n_refined, has_rested = rest, REFINEMENTS, False
            fits = stand_at(setting, position, quaternion, work)
            continue
        left = gap_left(work.contacts) if is_rest else gap_under_circles(work.contacts, setting.tolerances.touch_m)
        if n_refined == REFINEMENTS or left <= ON_FACE * setting.size_m:
            break
        rest, has_rested = (position, quaternion), is_rest
        position, quaternion = refined(setting, position, quaternion, is_rest, work)
        fits = find_placed_contacts(setting, position, quaternion, work)
        n_refined += 1
    if code == HELD_BY_FRICTION:  # in the balance beside it that needs none, if there is one
        position, quaternion = seated(setting, position, quaternion, work)
        fits = find_placed_contacts(setting, position, quaternion, work)
    here = State(position, quaternion, state.velocity, state.spin, state.turn_step_rad, state.n_still, n_refined)
    if code != MOVES:
        write_step(work, step, HELD if is_rest else STUCK, NONE, False, position, quaternion)
        return (RESTS if is_rest else STALLED), here, fits

    # Which way, and how far?
    would_hold = would_hold and not could_stay
    frame, is_still = frame_at(setting.body, quaternion), state.n_still > 0
    velocity, spin = twist_of(solver.y, frame)
    for k in range(work.contacts.n_freedoms):
        work.scratch[0].before[k] = solver.y[k]
    twist, is_stable = next_twist(setting, position, quaternion, frame, state.turn_step_rad, is_still, could_stay, work)
    rule = carried_by(work.contacts)
    if rule == FREE and nothing_ahead(setting, position, quaternion, velocity, spin):
        write_escape(work, step, would_hold, velocity, position, quaternion)
        return ESCAPES, here, fits
    path, is_whole = along_faces(setting, Path(position, quaternion, twist), work)
    motion = TRAVEL if norm(path.twist.spin) == 0.0 else SCREW
    amount, as_planned, end, turned = furthest_step(setting, path, work)
    if amount == math.inf:
        write_escape(work, step, would_hold, path.twist.velocity, position, quaternion)
        return ESCAPES, here, fits
    turn_step = 0.25 * state.turn_step_rad
    if as_planned and is_whole:
        turn_step = min(2.0 * state.turn_step_rad, setting.turn_step_rad)

    # Does it tip on the way, or is it held, or would it turn back?
    if rule != FREE and amount > 0.0:
        begun, may_rest, is_held = power_of(solver.y, frame, path.twist), setting.friction.greatest > 0.0, False
        if may_rest:
            is_held, could, amount, (end, turned) = power_ends(setting, path, amount, (end, turned), begun, work)
            could_stay = could_stay or could
        if not (is_held or is_stable) and may_tip(setting, path.twist, amount):
            begins, amount, (end, turned) = begins_to_tip(setting, path, amount, (end, turned), work)
            if begins:
                turn_step = setting.turn_step_rad / AS_IT_TIPS
                if may_rest:
                    _, could, _, (end, turned) = power_ends(setting, path, amount, (end, turned), begun, work)
                    could_stay = could_stay or could

    # Go there.
    moved = way_between(position, quaternion, end, turned, setting.body.reach_m)
    n_still = 0 if moved > STILL * setting.size_m else state.n_still + 1
    fits = find_placed_contacts(setting, end, turned, work)
    write_step(work, step, rule, motion, would_hold, end, turned)
    work.trace.rows[step].could_stay = could_stay
    there = State(end, turned, velocity, spin, turn_step, n_still, n_refined)
    return (STALLED if n_still == STILL_STEPS else GOES_ON), there, fits
