"""What the contacts do from an event on: the mode that lasts, found by changing what some of them do.

A mode is tried for a little of a step. Where its forces are beyond what contacts can give, or it has no rest, the
forces say who gives way first (`forces_jump`). Else guards below zero say who does something else: all that would go in
carry, then one that would slip back sticks, or one whose features end there opens.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.contact.contact_set import is_smooth
from cagepose.kernels.contact.coulomb_newton import CARRYING_LIMIT
from cagepose.kernels.driven.bodies import write_drift
from cagepose.kernels.driven.forces_jump import gives_way, go_along
from cagepose.kernels.driven.rate import APART, NO_SLIP, slip_of, speed_of
from cagepose.kernels.driven.trial import LITTLE, first_of_others, try_share, write_guards, write_way
from cagepose.kernels.driven.workspace import OF_CARRYING, DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

PIVOTS, FIRST_PIVOTS = 24, 8
"""How many changes are made; after the first ones it is the first guard that counts, not the least: so none is made
again and again.
"""
SLOW = 1e-2
"""Of all speeds: what slips so slowly may stick, where it is not found how it slips on."""
HARDLY = 1e-5
"""Likewise: what slips so slowly was let slip by rounding."""


@kernel
def mode_lasts(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    to_share: float,
    work: DriveWorkspace,
) -> bool:
    """Change what the contacts of ``work.run`` do until it lasts; False: no such mode was found. Filled: how the object
    goes on.
    """
    run, scratch = work.run, work.scratch[0]
    ahead = LITTLE * (to_share - share)
    scratch.n_hits = 0
    for i in range(run.contacts.used[0]):
        write_drift(run.contacts, i, position, share, work.memory)
    goes_along = False
    for pivot in range(PIVOTS):
        found, end, turned = try_share(drive, position, quaternion, share, share + ahead, work)
        if not found:
            if gives_way(drive, False, work) or not goes_along:
                go_along(drive.setting.friction.greatest, work)
                goes_along = True
            elif not hold_slowest(drive, work):
                return False
            continue
        write_guards(drive, end, turned, share + ahead, work, work.middle)
        if least_of_mode(work) >= 0.0:
            take_forces(work)
            write_way(drive, end, turned, share + ahead, -min(APART, ahead), work)
            for k in range(run.contacts.n_freedoms):
                scratch.way[k] = scratch.end_way[k]
            for i in range(run.contacts.used[0]):
                write_drift(run.contacts, i, position, share, work.memory)
            return True
        if has_forces_beyond(work):
            if not gives_way(drive, True, work):
                return False
            continue
        take_forces(work)
        if carry_closing(drive, work):
            continue
        at, least = -1, 0.0
        for k in range(len(work.middle) - 1):
            if work.middle[k] < least and (pivot < FIRST_PIVOTS or at < 0):
                at, least = k, work.middle[k]
        if not change_one(at, work):
            return False
    return False


@kernel
def keep_mode(work: DriveWorkspace) -> None:
    """Keep what the contacts do, and their forces; of those that carry, as many as a mode can have."""
    contacts, scratch = work.run.contacts, work.scratch[0]
    scratch.n_kept = 0
    for i in range(contacts.used[0]):
        if not contacts.states[i].counts or scratch.n_kept == CARRYING_LIMIT:
            continue
        scratch.kept_contacts[scratch.n_kept] = i
        scratch.kept_sticking[scratch.n_kept] = contacts.states[i].is_sticking
        for j in range(3):
            scratch.kept_forces[scratch.n_kept, j] = contacts.states[i].forces[j]
        scratch.n_kept += 1


@kernel
def return_to_mode(work: DriveWorkspace) -> None:
    """Let the contacts do what was kept."""
    contacts, scratch = work.run.contacts, work.scratch[0]
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.counts = state.is_sticking = False
        for j in range(3):
            state.forces[j] = 0.0
    for place in range(scratch.n_kept):
        state = contacts.states[scratch.kept_contacts[place]]
        state.counts, state.is_sticking = True, scratch.kept_sticking[place] != 0
        for j in range(3):
            state.forces[j] = scratch.kept_forces[place, j]


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
def hold_slowest(drive: DriveSetting, work: DriveWorkspace) -> bool:
    """Let the contact stick that slips most slowly of those that have slipped so far; False: all slip fast."""
    contacts, scratch, at = work.run.contacts, work.scratch[0], -1
    slowest = SLOW * speed_of(contacts, scratch.way)
    for place in range(scratch.n_kept if drive.setting.friction.greatest > 0.0 else 0):
        i = scratch.kept_contacts[place]
        state, (one, two) = contacts.states[i], slip_of(contacts, i, scratch.way)
        speed = math.sqrt(one * one + two * two)
        has_slipped = state.counts and not state.is_sticking and scratch.kept_sticking[place] == 0
        if has_slipped and not is_smooth(contacts, i) and speed <= slowest:
            at, slowest = i, speed
    if at < 0:
        return False
    contacts.states[at].is_sticking = True
    return True


@kernel
def hold_still(drive: DriveSetting, work: DriveWorkspace) -> bool:
    """Let all contacts stick, with no friction to begin with, that were let slip and hardly do; False: there is none.

    Where contacts share a load in many ways, one may leave its cone while forces rise, and yet stay where it is in the
    mode which that leads to. Its friction then has the direction of rounding.
    """
    contacts, friction, found = work.run.contacts, drive.setting.friction.greatest, False
    slow = HARDLY * speed_of(contacts, work.scratch[0].way)
    for i in range(contacts.used[0] if friction > 0.0 else 0):
        state, (one, two) = contacts.states[i], slip_of(contacts, i, work.scratch[0].way)
        slips = state.counts and not state.is_sticking and not is_smooth(contacts, i)
        if slips and math.sqrt(one * one + two * two) <= slow:
            state.is_sticking = found = True
            state.forces[1] = state.forces[2] = 0.0
    return found


@kernel
def take_forces(work: DriveWorkspace) -> None:
    """Let the contacts that carry have the forces of the trial."""
    newton, contacts, trial = work.scratch[0].rest.newton, work.run.contacts, work.run.ahead
    for place in range(newton.n_carrying):
        i = newton.contacts[place]
        for j in range(3):
            contacts.states[i].forces[j] = trial.states[i].forces[j]


@kernel
def carry_closing(drive: DriveSetting, work: DriveWorkspace) -> bool:
    """Let all contacts carry that would go in; False: there is none."""
    contacts, scratch, friction = work.run.contacts, work.scratch[0], drive.setting.friction.greatest
    slow, found = NO_SLIP * speed_of(contacts, scratch.way), False
    for i in range(contacts.used[0]):
        if work.middle[first_of_others() + i] >= 0.0:
            continue
        state, (one, two) = contacts.states[i], slip_of(contacts, i, scratch.way)
        is_slow = math.sqrt(one * one + two * two) <= slow
        state.counts = found = True
        state.is_sticking = friction > 0.0 and not is_smooth(contacts, i) and is_slow
        for k in range(3):
            state.forces[k] = 0.0
    return found


@kernel
def change_one(guard: int, work: DriveWorkspace) -> bool:
    """Let the contact of a guard stick whose slip turns back, or open whose features end; False: it is not of one that
    carries.
    """
    contacts, scratch = work.run.contacts, work.scratch[0]
    if guard >= first_of_others():
        return False
    state = contacts.states[scratch.rest.newton.contacts[guard // OF_CARRYING]]
    kind = guard % OF_CARRYING
    if kind == 2:
        state.is_sticking = True
    else:
        state.counts = state.is_sticking = False
        for k in range(3):
            state.forces[k] = 0.0
    return True
