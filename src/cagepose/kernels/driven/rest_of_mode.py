"""The rest of one contact mode: where given contacts carry, slide or stick, and balance the load, to full digits.

Balance and gaps are one system, of the object's motion and of the forces of the contacts (a saddle point),

    (rho 1 + S) delta + A df = b - A f,    a_i . delta = g_i,    t_i . delta = -s_i where what sticks slipped by s_i,

with the friction of a contact that slides along its slip: along the way that it has slipped since the last rest, as in
an implicit step. Friction turns with that way, and so it resists what slips aside: a peg that slides down its hole does
not turn about its axis. Newton's method solves it, with S that of the forces as they are: a step is right but for how
friction turns with the normals.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.dense import frobenius_norm
from cagepose.kernels.algebra.elimination import eliminate
from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, WRENCH, inner, length
from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, minus, norm, vector_from
from cagepose.kernels.boundary.bend import curvatures, write_bend
from cagepose.kernels.boundary.features import place_feature, place_feature_at
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_at, held_moved
from cagepose.kernels.boundary.kept import meeting_kept
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth, write_directions
from cagepose.kernels.contact.coulomb_newton import (
    CARRYING_LIMIT,
    SLIDES,
    SLIPS,
    STICKS,
    NewtonWorkspace,
    add_carrying,
    n_forces,
)
from cagepose.kernels.contact.curvature import write_curvature
from cagepose.kernels.contact.metric import Frame, ScaledVector, frame_at, moved_along_twist, twist_of
from cagepose.kernels.contact.pressing import write_whole_load
from cagepose.kernels.driven.bodies import press_on_by
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.pushing_out import is_fixed
from cagepose.kernels.quasistatic.setting import Setting

MOST_STEPS = 40
LEAST_STIFFNESS = 1e-6
"""In lengths of the load over the size: what moves freely goes the shortest way."""
ON_FACE, BALANCED = 4e-16, 1e-14
"""In sizes of the scene, and in lengths of the load's terms: rounding."""
SOFT = 1e-7
"""In stiffnesses: how much contacts give way in one step of Newton's method, so that those of which some would do share
what they carry."""
FARTHEST = 100.0
"""In sizes of the scene: a step of Newton's method that is longer leads nowhere."""
STUCK = 1e-14
"""In sizes of the scene: what a contact that sticks may slip."""
TURNS_BACK = 0.9
"""Of a slip: so much of it may be taken back in one step."""
NEARLY_ON_FACE, NEARLY_BALANCED = 4e-13, 1e-11
"""Likewise: what will do where rounding does not let it come nearer."""


class RestWorkspace:
    """Memory for one rest; a record.

    Attributes
    ----------
    newton, curvature, load, delta
        The system, S, the load, and a step.
    least_terms
        Given: what the terms of the load are measured by where there is next to no load.
    least_stiffness
        What the stiffness is made greater by.
    slips
        How far each contact that counts, in their order, has slipped since the last rest, along its tangents, metres
        times their length. Given: up to the pose to start from.
    gaps
        The gap that each of them keeps, metres: rounding of an earlier rest, which one that sticks cannot close.
    """

    newton: NewtonWorkspace
    curvature: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    load: ScaledVector
    delta: ScaledVector
    least_terms: float
    least_stiffness: float
    slips: Annotated[FloatArray, CARRYING_LIMIT, 2]
    gaps: Annotated[FloatArray, CARRYING_LIMIT]


@kernel
def follow_contact(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    i: int,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
) -> Meeting:
    """Write where the features of a contact meet with the object at a pose, and how they bend; return the meeting."""
    row, moved = contacts.rows[i], held_moved(geometry, placement)
    cage, share = cage_at(geometry, row.cage_body), norm(vector_from(row.directions[1]))
    place_feature_at(moved, row.feature, position, matrix_from_quaternion(quaternion))
    place_feature(cage, row.cage_feature)
    places = placement.memory.places
    fixed = is_fixed(contacts, i)
    met = meeting_kept(moved, row.feature, cage, row.cage_feature, row.angle, fixed, geometry.touch_m, places)
    if not met.is_one:
        return met
    arm = minus(met.place, position)
    row.gap = met.gap
    write_directions(contacts, i, met.normal, arm, share, frame)
    found = curvatures(moved, row.feature, cage, row.cage_feature, met, False)
    write_bend(found, met.normal, arm, frame.axes, frame.radii, contacts.bends[i])
    return met


@kernel
def list_carrying(contacts: ContactSet, friction: float, work: RestWorkspace) -> int:
    """List the contacts that carry, and what they do; return the number of unknowns, -1: too many."""
    newton = work.newton
    newton.n_carrying, n = 0, contacts.n_freedoms
    for i in range(contacts.used[0]):
        if not contacts.states[i].counts:
            continue
        slides = friction == 0.0 or is_smooth(contacts, i)
        mode = SLIDES if slides else STICKS if contacts.states[i].is_sticking else SLIPS
        add_carrying(newton, i, mode)
        if newton.n_carrying < 0:
            return -1
        newton.first_unknowns[newton.n_carrying - 1] = n
        n += n_forces(mode)
    return n


@kernel
def along_slip(place: int, work: RestWorkspace) -> tuple[float, float, float]:
    """Return (length of a contact's slip, its direction); a contact that has not slipped has no friction."""
    one, two = work.slips[place, 0], work.slips[place, 1]
    size = math.sqrt(one * one + two * two)
    if work.newton.modes[place] != SLIPS or size == 0.0:
        return 0.0, 0.0, 0.0
    return size, one / size, two / size


@kernel
def weights_of_turn(friction: float, slip: float) -> tuple[float, float]:
    """Return by what the slip aside and the friction aside are multiplied where these are in proportion, as a friction
    is to a slip: no more than one, as of two numbers one may be much greater.
    """
    greater = max(friction, slip)
    return (friction / greater, slip / greater) if greater > 0.0 else (0.0, 1.0)


@kernel
def write_system(contacts: ContactSet, friction: float, least: float, n: int, work: RestWorkspace) -> float:
    """Write the system of one step for the forces and gaps as they are, and the load; return the stiffness that forces
    are measured in: the numbers of the contacts are as large as S then, and none is taken for rounding beside it.
    """
    newton, n_freedoms = work.newton, contacts.n_freedoms
    m, stiff = newton.matrix, frobenius_norm(work.curvature, contacts.n_freedoms) + least
    for j in range(n):
        for k in range(n + 1):
            m[j, k] = 0.0
    for j in range(n_freedoms):
        for k in range(n_freedoms):
            m[j, k] = work.curvature[j, k]
        m[j, j] += least
        m[j, n] = work.load[j]
    for place in range(newton.n_carrying):
        i, first = newton.contacts[place], newton.first_unknowns[place]
        columns, forces, n_own = contacts.rows[i].columns, contacts.states[i].forces, 1
        if newton.modes[place] == STICKS:
            n_own = 3
        size, one, two = along_slip(place, work)
        for which in range(n_own):
            for k in range(n_freedoms):
                along = columns[which, k] + friction * (one * columns[1, k] + two * columns[2, k])
                m[k, first + which] = stiff * along
                m[first + which, k] = stiff * columns[which, k]
                m[k, n] -= along * forces[which]
        m[first, first] = -SOFT * stiff
        m[first, n] = stiff * (contacts.rows[i].gap - work.gaps[place])
        for which in range(1, n_own):  # what sticks goes back to where it has slipped from
            m[first + which, first + which] = -SOFT * stiff
            m[first + which, n] = -stiff * work.slips[place, which - 1]
        if newton.modes[place] == SLIPS:  # friction turns with the slip
            turning, turned = weights_of_turn(friction * forces[0], stiff * size)
            for k in range(n_freedoms):
                aside = one * columns[2, k] - two * columns[1, k]
                m[k, first + 1] = stiff * aside
                m[first + 1, k] = stiff * turning * aside
            m[first + 1, first + 1] = -stiff * turned
    return stiff


@kernel
def before_turning_back(contacts: ContactSet, work: RestWorkspace) -> float:
    """Return how much of a step may be made before a slip turns back, and its friction with it; at most 1."""
    newton, most = work.newton, 1.0
    for place in range(newton.n_carrying):
        if newton.modes[place] != SLIPS:
            continue
        columns, along, size = contacts.rows[newton.contacts[place]].columns, 0.0, 0.0
        for which in range(2):
            slip = work.slips[place, which]
            along += slip * inner(columns[1 + which], newton.changes, contacts.n_freedoms)
            size += slip * slip
        if along < 0.0 < size:
            most = min(most, TURNS_BACK * size / -along)
    return most


@kernel
def take_step(contacts: ContactSet, friction: float, stiff: float, n: int, work: RestWorkspace) -> None:
    """Solve the system; change the forces, and write the motion."""
    newton, n_freedoms = work.newton, contacts.n_freedoms
    eliminate(newton.matrix, newton.order, newton.greatest_of, n)
    for k in range(n):
        newton.changes[newton.order[k]] = newton.matrix[k, n]
    shorter = before_turning_back(contacts, work)
    for k in range(n):
        newton.changes[k] *= shorter
    for k in range(n_freedoms):
        work.delta[k] = newton.changes[k]
    for place in range(newton.n_carrying):
        i, first, mode = newton.contacts[place], newton.first_unknowns[place], newton.modes[place]
        columns, forces = contacts.rows[i].columns, contacts.states[i].forces
        for which in range(3 if mode == STICKS else 1):
            forces[which] += stiff * newton.changes[first + which]
        for which in range(2 if mode != SLIDES else 0):
            work.slips[place, which] += inner(columns[1 + which], work.delta, n_freedoms)
        if mode == SLIPS:
            _, one, two = along_slip(place, work)
            forces[1], forces[2] = friction * forces[0] * one, friction * forces[0] * two


@kernel
def rest_of_mode(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    work: RestWorkspace,
) -> tuple[bool, Vector, Quaternion]:
    """Return whether there is a rest of a mode near a pose, and its pose; forces and wrenches are those there.

    Parameters
    ----------
    setting
        With the load as it is. What presses goes on with the object.
    placement
        Memory, with the bodies of the cage where they are.
    contacts
        Those that count carry, with forces to start from. They stick if their states say so, and slide else.
    position, quaternion
        Where to start from.
    work
        Given: the slips, and the gaps.
    """
    friction, least_worst, done = setting.friction.greatest, math.inf, False
    n = list_carrying(contacts, friction, work)
    for _ in range(MOST_STEPS if n > 0 else 0):
        frame = frame_at(setting.body, quaternion)
        worst_m = 0.0
        for place in range(work.newton.n_carrying):
            i = work.newton.contacts[place]
            if not follow_contact(setting.geometry, placement, contacts, i, position, quaternion, frame).is_one:
                return False, position, quaternion
            worst_m = max(worst_m, abs(contacts.rows[i].gap - work.gaps[place]))
            if work.newton.modes[place] == STICKS:
                slipped_m = math.sqrt(work.slips[place, 0] ** 2 + work.slips[place, 1] ** 2)
                worst_m = max(worst_m, slipped_m * ON_FACE / STUCK)
        whole = write_whole_load(
            setting.load, contacts.pressing, position, quaternion, frame, contacts.n_freedoms, work.load
        )
        terms = max(whole, work.least_terms)
        write_curvature(contacts, setting.load, position, quaternion, frame, False, work.curvature)
        work.least_stiffness = LEAST_STIFFNESS * terms / setting.size_m
        stiff = write_system(contacts, friction, work.least_stiffness, n, work)
        for k in range(contacts.n_freedoms):
            work.delta[k] = work.newton.matrix[k, n]
        left = length(work.delta, contacts.n_freedoms) / terms
        worst = max(worst_m / (ON_FACE * setting.size_m), left / BALANCED)
        done = worst_m <= NEARLY_ON_FACE * setting.size_m and left <= NEARLY_BALANCED
        if worst <= 1.0 or (worst >= least_worst and done):
            return True, position, quaternion
        least_worst = min(least_worst, worst)
        take_step(contacts, friction, stiff, n, work)
        if not length(work.delta, contacts.n_freedoms) <= FARTHEST * setting.size_m:  # NaN neither
            return False, position, quaternion
        velocity, spin = twist_of(work.delta, frame)
        if contacts.n_freedoms > WRENCH:
            press_on_by(setting.geometry, contacts.pressing, work.delta, 1.0)
        position, quaternion = moved_along_twist(position, quaternion, velocity, spin, 1.0)
    return done, position, quaternion
