"""What contacts do and carry from one rest of a drive to the next, where they are found anew."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import clear
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, vector_from
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.contact_set import ContactSet, choose, is_smooth
from cagepose.kernels.contact.edges import last_of_group
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.contact.sharing import share_evenly
from cagepose.kernels.driven.rate import copy_contact
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.touched_before import place_before

WHATEVER_THEY_HOLD = 2.0
"""A part of a wrench that is more than all of it: no contact is left out because others hold what it does."""
AT_CORNER = 10.0
"""In touch tolerances: so near to where a contact has ended, another one may take it over."""
PARALLEL = 1.0 - 1e-12
"""Cosine: two contacts at one place push the same way."""


@kernel
def find_rested(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Find the contacts anew where a step has ended, with what they did in ``work.run.ahead``; return whether they are
    the same.
    """
    setting, contacts, before = drive.setting, work.run.contacts, work.run.ahead
    place_object(setting.geometry, position, quaternion, work.run.placement)
    frame = frame_at(setting.body, quaternion)
    if not find_contacts(setting.geometry, work.run.placement, setting.friction, position, frame, contacts):
        return False
    n_carried, n_before, all_known = 0, 0, True
    for i in range(before.used[0]):
        if before.states[i].counts:
            n_before += 1
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.is_sticking = state.stays_flat = state.is_locked = False
        for j in range(3):
            state.forces[j] = 0.0
    for i in range(contacts.used[0]):
        state, at = contacts.states[i], place_before(before, contacts.rows[i])
        all_known = all_known and at >= 0
        if at < 0:
            at = taken_over(contacts, i, before, setting.tolerances.touch_m)
        if at < 0 or not before.states[at].counts:
            state.counts = False
            continue
        n_carried += 1
        first = contacts.rows[i].group
        for k in range(first, last_of_group(contacts, first) + 1):
            choose(contacts, k, k == i)
        state.is_sticking, state.stays_flat = before.states[at].is_sticking, before.states[at].stays_flat
        for j in range(3):
            state.forces[j] = before.states[at].forces[j]
    return all_known and n_carried == n_before


@kernel
def taken_over(contacts: ContactSet, i: int, before: ContactSet, touch_m: float) -> int:
    """Return which of the contacts before, that has ended at a corner, goes on as another; -1: none does."""
    row = contacts.rows[i]
    for k in range(before.used[0]):
        ended = before.rows[k]
        if not before.states[k].counts or ended.cage_body != row.cage_body:
            continue
        away = norm(minus(vector_from(row.arm), vector_from(ended.arm)))
        along = dot(vector_from(row.directions[0]), vector_from(ended.directions[0]))
        if away <= AT_CORNER * touch_m and along >= PARALLEL and place_before(contacts, ended) < 0:
            return k
    return -1


@kernel
def keep_forces(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> None:
    """Find the contacts anew where the object stands still, with what they carry."""
    contacts, before = work.run.contacts, work.run.ahead
    before.used[0] = contacts.used[0]
    for i in range(contacts.used[0]):
        copy_contact(contacts, i, before, i)
        before.states[i].counts = contacts.states[i].forces[0] > 0.0
    find_rested(drive, position, quaternion, work)


@kernel
def begin_at_rest(drive: DriveSetting, work: DriveWorkspace) -> None:
    """Let all contacts that carry at rest stick, as far as they have friction; where none needs it, all that touch
    share the load as if they were equally stiff: so that all of a flat foot stays down, not three points of it.
    """
    contacts, held, friction = work.run.contacts, work.scratch[0].held, drive.setting.friction.greatest
    solver, is_rubbed, n = work.run.scratch[0].solver, False, contacts.n_freedoms
    for i in range(contacts.used[0]):
        forces = contacts.states[i].forces
        is_rubbed = is_rubbed or forces[1] != 0.0 or forces[2] != 0.0
    if not is_rubbed and solver.locked.used == 0:
        clear(held, n, 1.0)
        held.dependent = WHATEVER_THEY_HOLD
        for k in range(n):
            solver.y[k] = 0.0
        share_evenly(contacts, held, solver.y, solver.load_terms, work.run.scratch[0].stiff.sharing)
    for i in range(contacts.used[0]):
        state = contacts.states[i]
        state.is_sticking = state.forces[0] > 0.0 and friction > 0.0 and not is_smooth(contacts, i)
        state.counts, state.stays_flat = state.forces[0] > 0.0, False
