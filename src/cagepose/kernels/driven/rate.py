"""How a rest goes on as bodies of the cage begin to move: the rate problem.

For a short advance from a rest, with the forces that carry there as S,

    (rho 1 + S) y = b + b' ds - A f,    a_i . y + w_i ds <= 0 (complementary to f_n),    friction of a_t . y + w_t ds,

which is the problem of the motion from rest, (5.7), in the coordinates of the stiffness, with contacts that drift. What
contacts that carry hold goes with their bodies: that motion is taken out first, with the load that it takes, so that S
counts along what is free and across alike, and only there has to be positive.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.dense import add_across, cholesky, frobenius_norm, solve_lower, solve_upper
from cagepose.kernels.algebra.least_squares import WRENCH, append_column, clear, inner, length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.contact.cone import clear_cone, cone_residual, write_forces
from cagepose.kernels.contact.contact_set import ContactSet, count_chosen, is_smooth
from cagepose.kernels.contact.coulomb import coulomb_error
from cagepose.kernels.contact.curvature import clear_matrix, write_curvature
from cagepose.kernels.contact.loads import PhaseLoad, arm_of, spring_vector
from cagepose.kernels.contact.metric import Frame, frame_at, twist_of, write_scaled_wrench
from cagepose.kernels.contact.on_circle import keeps_on_circle
from cagepose.kernels.contact.onset import motion_with_faces
from cagepose.kernels.contact.pressing import Pressing, write_whole_load
from cagepose.kernels.driven.bodies import DriveMemory, place_bodies, twist_of_body, write_drift
from cagepose.kernels.driven.rest_of_mode import follow_contact
from cagepose.kernels.driven.workspace import DriveScratch, DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

SHORT = 1e-4
"""In sizes of the scene, and in lengths of the load: an advance for which the linear problem is asked."""
RHO = 1e-3
"""In lengths of the load over the size: a stiffness that what is free has at least."""
JUMPS = 6
"""How often it is asked what carries after forces have jumped."""
STIFFER, TIMES_STIFFER = 100.0, 4
"""What is held is made so many times stiffer, and so often, until S is positive."""
APART = 1e-6
"""In shares: how far apart two places of the bodies are from which a change is told."""
NO_FORCE, NO_SLIP, LAW = 1e-7, 1e-7, 1e-6
"""In speeds: a contact that would close, or slips, by less carries nothing, or sticks; and how far the law may be off.
"""


@kernel
def write_load_rate(
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    share: float,
    memory: DriveMemory,
    out: FloatArray,
) -> None:
    """Write how the load changes for a unit share, as the anchors of springs ride on bodies."""
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for which in range(len(load)):
        action = load[which]
        if action.body == 0:
            continue
        velocity, spin = twist_of_body(memory, action.body, share)
        moves = plus(velocity, cross(spin, vector_from(action.anchor)))
        arm = arm_of(action, quaternion)
        way = spring_vector(action, position, arm)
        stretched, more = norm(way), scaled(moves, action.stiffness)
        if action.tension_at_zero != 0.0 and stretched > 0.0:  # what it pulls with beside turns with it
            across = minus(moves, scaled(way, dot(way, moves) / (stretched * stretched)))
            more = plus(more, scaled(across, action.tension_at_zero / stretched))
        force, moment = plus(force, more), plus(moment, cross(arm, more))
    write_scaled_wrench(force, moment, frame, out)


@kernel
def write_change(
    drive: DriveSetting,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    share: float,
    apart: float,
    pressing: Rows[Pressing],
    work: DriveWorkspace,
) -> None:
    """Write how the balance b - A f changes for a unit share where the object stands still, from the bodies at their
    places and ``apart`` from there.
    """
    setting, other, change = drive.setting, work.run.turned, work.scratch[0].change
    write_load_rate(setting.load, position, quaternion, frame, share + min(apart, 0.0), work.memory, change)
    for k in range(WRENCH, contacts.n_freedoms):
        change[k] = 0.0
    place_bodies(setting.geometry, drive.phase, share + apart, work.memory, pressing)
    for i in range(contacts.used[0]):
        row, forces = contacts.rows[i], contacts.states[i].forces
        if forces[0] == 0.0 or work.memory.n_legs[row.cage_body] == 0:
            continue
        copy_contact(contacts, i, other, i)
        if follow_contact(setting.geometry, work.run.placement, other, i, position, quaternion, frame).is_one:
            for j in range(3):
                for k in range(contacts.n_freedoms):
                    change[k] -= forces[j] * (other.rows[i].columns[j, k] - row.columns[j, k]) / apart
    place_bodies(setting.geometry, drive.phase, share, work.memory, pressing)


@kernel
def copy_contact(contacts: ContactSet, i: int, other: ContactSet, place: int) -> None:
    other.rows[place] = contacts.rows[i]  # type: ignore[index]
    other.states[place] = contacts.states[i]  # type: ignore[index]
    other.bends[place] = contacts.bends[i]  # type: ignore[index]


@kernel
def go_with_bodies(contacts: ContactSet, with_sticking: bool, scratch: DriveScratch) -> None:
    """Write the shortest motion with which what carries stays on its bodies, for a unit share, and what is held."""
    held, guided, n = scratch.held, scratch.guided, contacts.n_freedoms
    clear(held, n, 1.0)
    for k in range(n):
        guided[k] = 0.0
    for i in range(contacts.used[0]):
        row, state = contacts.rows[i], contacts.states[i]
        if not state.counts or state.forces[0] <= 0.0:
            continue
        for which in range(3 if state.is_sticking and with_sticking else 1):
            column = row.columns[which]
            if append_column(held, column, which, 0.0):
                vector = held.basis[held.used - 1]
                lacks = -row.drift[which] - inner(column, guided, n)
                share = lacks / inner(column, vector, n)
                for k in range(n):
                    guided[k] += share * vector[k]


@kernel
def factor_stiffness(rho: float, n: int, scratch: DriveScratch) -> bool:
    """Factor rho 1 + S, with what is held made stiff; False: it is not positive along what is free."""
    stiff = frobenius_norm(scratch.stiffness, n) + rho
    for _ in range(TIMES_STIFFER):
        for j in range(n):
            for k in range(n):
                scratch.factor[j, k] = scratch.stiffness[j, k]
            scratch.factor[j, j] += rho
        add_across(scratch.factor, scratch.held, stiff)
        if cholesky(scratch.factor, 1e-6 * rho, n):
            return True
        stiff *= STIFFER
    return False


@kernel
def longest_short(setting_size: float, contacts: ContactSet, terms: float, scratch: DriveScratch) -> float:
    """Return the share for which the rate problem is asked: all that moves goes a short way."""
    n, fastest = contacts.n_freedoms, length(scratch.guided, contacts.n_freedoms)
    for i in range(contacts.used[0]):
        fastest = max(fastest, length(contacts.rows[i].drift, 3))
    ahead = SHORT * setting_size / fastest if fastest > 0.0 else math.inf
    grows = length(scratch.change, n)
    return min(ahead, SHORT * terms / grows if grows > 0.0 else math.inf, 1.0)


@kernel
def find_mode(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> bool:
    """Find what the contacts at a rest do as the drive goes on; False: no motion obeys the law.

    Given, in ``work.run.contacts``: forces of the rest, and which contacts stick; which of them are chosen. Filled:
    what counts carries, with forces, and sticks or slips; and in the scratch the motion, for a unit share. Where
    friction holds what it need not, forces may jump as the drive goes on: it is asked again with what carries then.
    """
    for turn in range(JUMPS if drive.setting.friction.greatest > 0.0 else 1):
        found, same = solve_rate(drive, position, quaternion, share, work)
        if not found and turn == 0:
            return False
        if not found:  # what was found before that stands
            for i in range(work.run.contacts.used[0]):
                state = work.run.contacts.states[i]
                state.counts = state.chosen and state.forces[0] > 0.0
            break
        if same:
            break
    return True


@kernel
def solve_rate(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> tuple[bool, bool]:
    """As `find_mode`, with what carries now; return whether all of that carries on, too."""
    setting, scratch, contacts, turned = drive.setting, work.scratch[0], work.run.contacts, work.run.turned
    friction, n, solver = setting.friction.greatest, contacts.n_freedoms, work.run.scratch[0].solver
    frame = frame_at(setting.body, quaternion)
    count_chosen(contacts)
    for i in range(contacts.used[0]):
        write_drift(contacts, i, position, share, work.memory)
    whole = write_whole_load(
        setting.load, contacts.pressing, position, quaternion, frame, contacts.n_freedoms, scratch.load
    )
    terms = max(whole, scratch.rest.least_terms)
    write_change(drive, contacts, position, quaternion, frame, share, APART, work.memory.pressing, work)
    write_curvature(contacts, setting.load, position, quaternion, frame, False, scratch.stiffness)
    go_with_bodies(contacts, False, scratch)
    rho = RHO * terms / setting.size_m
    if not factor_stiffness(rho, n, scratch):
        go_with_bodies(contacts, True, scratch)
        if not factor_stiffness(rho, n, scratch):  # as if equally stiff all around: forces jump, whatever bends
            rho += frobenius_norm(scratch.stiffness, n)
            clear_matrix(scratch.stiffness, n)
            factor_stiffness(rho, n, scratch)

    # The problem in the coordinates of the stiffness, without the motion that goes with the bodies.
    ahead = longest_short(setting.size_m, contacts, terms, scratch)
    turned.used[0] = contacts.used[0]
    for i in range(contacts.used[0]):
        row, state = contacts.rows[i], contacts.states[i]
        copy_contact(contacts, i, turned, i)
        for j in range(3):
            solve_lower(scratch.factor, row.columns[j], turned.rows[i].columns[j], n)
            speed, fastest = row.drift[j] + inner(row.columns[j], scratch.guided, n), length(row.drift, 3)
            goes_along = state.counts and state.forces[0] > 0.0 and (j == 0 or state.is_sticking)
            if goes_along and abs(speed) <= NO_SLIP * (fastest + length(scratch.guided, n)):
                speed = 0.0
            turned.rows[i].drift[j] = speed * ahead
    for j in range(n):
        taken = rho * scratch.guided[j] + inner(scratch.stiffness[j], scratch.guided, n)
        scratch.load[j] += ahead * (scratch.change[j] - taken)
    b, y = solver.load, solver.y
    solve_lower(scratch.factor, scratch.load, b, n)
    scale = length(b, n)
    clear_cone(solver.cone, b, n, scale if scale > 0.0 else terms / math.sqrt(rho))
    cone_residual(turned, friction, solver.cone)
    if not motion_with_faces(turned, friction, b, y, solver):
        return False, True
    if friction == 0.0:
        write_forces(solver.cone, 0.0, turned)
    speed = fastest_in(turned, y, n)
    if coulomb_error(turned, friction, y) > LAW * speed:
        return False, True
    solve_upper(scratch.factor, y, n)
    for k in range(n):
        scratch.way[k] = scratch.guided[k] + y[k] / ahead
    return True, read_mode(drive, position, frame, share, speed, work)


@kernel
def fastest_in(contacts: ContactSet, y: FloatArray, n: int) -> float:
    """Return the length of a motion, or the speed of the fastest contact that drifts."""
    fastest = length(y, n)
    for i in range(contacts.used[0]):
        fastest = max(fastest, length(contacts.rows[i].drift, 3) / length(contacts.rows[i].columns[0], n))
    return fastest


@kernel
def read_mode(
    drive: DriveSetting, position: Vector, frame: Frame, share: float, speed: float, work: DriveWorkspace
) -> bool:
    """Read off which contacts carry, and which of them stick and slip, given the speed of the fastest in the problem;
    return whether all that carried do. One carries as much as it would close without its force.
    """
    same = True
    contacts, turned, scratch = work.run.contacts, work.run.turned, work.scratch[0]
    n, touch_m = contacts.n_freedoms, drive.setting.tolerances.touch_m
    velocity, spin = twist_of(scratch.way, frame)
    fastest, has_friction = speed_of(contacts, scratch.way), drive.setting.friction.greatest > 0.0
    for i in range(contacts.used[0]):
        row, state, found = contacts.rows[i], contacts.states[i], turned.states[i].forces
        closes = found[0] * length(turned.rows[i].columns[0], n)
        state.counts = state.chosen and closes > NO_FORCE * speed
        same = same and (state.counts or state.forces[0] == 0.0)
        stuck = state.is_sticking and state.forces[0] > 0.0
        for j in range(3):
            state.forces[j] = found[j] if state.counts else 0.0
        (one, two), size = slip_of(contacts, i, scratch.way), length(row.columns[0], n)
        slow = NO_SLIP * fastest * size
        is_slow = math.sqrt(one * one + two * two) <= slow * norm(vector_from(row.directions[1]))
        state.is_sticking = state.counts and is_slow and has_friction and not is_smooth(contacts, i)
        same = same and (state.is_sticking or not stuck)
        body_velocity, body_spin = twist_of_body(work.memory, row.cage_body, share)
        beside = minus(velocity, plus(body_velocity, cross(body_spin, position)))
        state.stays_flat = keeps_on_circle(contacts, i, beside, minus(spin, body_spin), touch_m, slow)
    return same


@kernel
def speed_of(contacts: ContactSet, way: FloatArray) -> float:
    """Return how fast all that moves does, for a unit share: what a slip is measured by."""
    fastest = 0.0
    for i in range(contacts.used[0]):
        fastest = max(fastest, length(contacts.rows[i].drift, 3))
    return fastest + length(way, contacts.n_freedoms)


@kernel
def slip_of(contacts: ContactSet, i: int, way: FloatArray) -> tuple[float, float]:
    """Return how fast a contact slips along its tangents in a motion for a unit share."""
    row, n = contacts.rows[i], contacts.n_freedoms
    return row.drift[1] + inner(row.columns[1], way, n), row.drift[2] + inner(row.columns[2], way, n)
