"""What the contacts do from an event on: the mode that lasts, found by changing one contact at a time.

A mode is tried for a little of a step. Each guard that is below zero there says which contact does something else: one
that would pull opens, one that would go in carries, one beyond its cone slips, one that would slip back sticks. This is
principal pivoting (Murty) on the contacts that are at the edge of what they do; those that carry for good keep doing
so.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.contact.cone import write_forces
from cagepose.kernels.contact.contact_set import is_smooth
from cagepose.kernels.contact.coulomb_newton import STICKS
from cagepose.kernels.contact.equilibrium import least_residual
from cagepose.kernels.contact.loads import write_load
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.contact.tolerances import RESIDUAL_AT_LIMIT
from cagepose.kernels.driven.bodies import write_drift
from cagepose.kernels.driven.rate import APART, NO_SLIP, copy_contact, slip_of, speed_of
from cagepose.kernels.driven.rest_of_mode import along_slip
from cagepose.kernels.driven.trial import first_of_others, try_share, write_guards, write_way
from cagepose.kernels.driven.workspace import OF_CARRYING, DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

SPARED = (0.3, 0.1, 0.01, 0.001, 1e-5)
"""Parts of the friction of contacts that stick which a share of the load may leave."""
PIVOTS, FIRST_PIVOTS = 24, 8
"""How many changes are made; after the first ones it is the first guard that counts, not the least: so none is made
again and again.
"""
LITTLE = 1e-5
"""Of a step: so far a mode is tried."""


@kernel
def mode_lasts(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    to_share: float,
    may_share: bool,
    work: DriveWorkspace,
) -> bool:
    """Change what the contacts of ``work.run`` do until it lasts; False: no such mode was found. Filled: how the object
    goes on. ``may_share``: before one slips or opens, all share the load anew, where they can do so in many ways.
    """
    run, scratch = work.run, work.scratch[0]
    ahead = LITTLE * (to_share - share)
    scratch.n_hits = 0
    for i in range(run.contacts.used[0]):
        write_drift(run.contacts, i, position, share, work.memory)
    is_shared = not may_share
    for pivot in range(PIVOTS):
        found, end, turned = try_share(drive, position, quaternion, share, share + ahead, work)
        if not found:
            return False
        write_guards(drive, end, turned, share + ahead, work, work.middle)
        if least_of_mode(work) >= 0.0:
            write_way(drive, end, turned, share + ahead, -min(APART, ahead), work)
            for k in range(run.contacts.n_freedoms):
                scratch.way[k] = scratch.end_way[k]
            for i in range(run.contacts.used[0]):
                write_drift(run.contacts, i, position, share, work.memory)
            return True
        if not is_shared and has_forces_beyond(work):
            is_shared = True
            if share_inside(drive, position, quaternion, work):
                continue
        at, least = -1, 0.0
        for k in range(len(work.middle) - 1):
            if work.middle[k] < least and (pivot < FIRST_PIVOTS or at < 0):
                at, least = k, work.middle[k]
        if not change_one(drive, at, work):
            return False
    return False


@kernel
def least_of_mode(work: DriveWorkspace) -> float:
    """Return the least guard but for the last, which is the force at which the drive stops, in whatever mode."""
    least = math.inf
    for k in range(len(work.middle) - 1):
        least = min(least, work.middle[k])
    return least


@kernel
def has_forces_beyond(work: DriveWorkspace) -> bool:
    """Whether a contact would pull, or carry beyond its cone."""
    for place in range(work.scratch[0].rest.newton.n_carrying):
        for kind in range(2):
            if work.middle[OF_CARRYING * place + kind] < 0.0:
                return True
    return False


@kernel
def share_inside(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Share the load among the contacts of the mode as far inside their cones as it can be, with the friction of those
    that slip as it is; False: they do not balance it.
    """
    contacts, out, rest = work.run.contacts, work.run.turned, work.scratch[0].rest
    solver, friction, n = work.run.scratch[0].solver, drive.setting.friction.greatest, contacts.n_freedoms
    frame = frame_at(drive.setting.body, quaternion)
    terms = max(write_load(drive.setting.load, position, quaternion, frame, solver.load), rest.least_terms)
    out.used[0] = rest.newton.n_carrying
    for place in range(rest.newton.n_carrying):
        i = rest.newton.contacts[place]
        copy_contact(contacts, i, out, place)
        columns, (_, one, two) = out.rows[place].columns, along_slip(place, rest)
        for j in range(3):
            out.rows[place].drift[j] = 0.0
        for k in range(n if rest.newton.modes[place] != STICKS else 0):
            columns[0, k] += friction * (one * columns[1, k] + two * columns[2, k])
            columns[1, k] = columns[2, k] = 0.0
    for spared in SPARED:
        used = (1.0 - spared) * friction
        if least_residual(out, used, solver.load, terms, solver) <= RESIDUAL_AT_LIMIT:
            write_forces(solver.cone, used, out)
            for place in range(rest.newton.n_carrying):
                forces, (_, one, two) = contacts.states[rest.newton.contacts[place]].forces, along_slip(place, rest)
                found, slips = out.states[place].forces, rest.newton.modes[place] != STICKS
                forces[0] = found[0]
                forces[1] = friction * found[0] * one if slips else found[1]
                forces[2] = friction * found[0] * two if slips else found[2]
            return True
    return False


@kernel
def change_one(drive: DriveSetting, guard: int, work: DriveWorkspace) -> bool:
    """Let the contact of a guard do what the guard says; False: it is not of a contact."""
    contacts, scratch = work.run.contacts, work.scratch[0]
    first, friction = first_of_others(), drive.setting.friction.greatest
    if guard >= first + len(contacts.rows):
        return False
    if guard >= first:
        i = guard - first
        state, (one, two) = contacts.states[i], slip_of(contacts, i, scratch.way)
        state.counts = True
        is_slow = math.sqrt(one * one + two * two) <= NO_SLIP * speed_of(contacts, scratch.way)
        state.is_sticking = friction > 0.0 and not is_smooth(contacts, i) and is_slow
        for k in range(3):
            state.forces[k] = 0.0
        return True
    state = contacts.states[scratch.rest.newton.contacts[guard // OF_CARRYING]]
    kind = guard % OF_CARRYING
    if kind == 1:
        state.is_sticking = False
    elif kind == 2:
        state.is_sticking = True
    else:
        state.counts = state.is_sticking = False
        for k in range(3):
            state.forces[k] = 0.0
    return True
