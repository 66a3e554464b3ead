"""How stiff an object is along what its contacts leave free: whether a rest is stable there.

Of contacts that touch and carry nothing, each stops one side of a motion. The least stiffness counts along motions that
none of them stops: where both sides of one are stopped, contacts that do are held, too, and it is asked again.
"""

from __future__ import annotations

from cagepose.kernels.algebra.dense import add_across, confine, frobenius_norm
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import append_column, clear, inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb_newton import STICKS
from cagepose.kernels.driven.rest_of_mode import along_slip
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

STOPS = 1e-9
"""Sine. A contact that closes in a motion by less does not stop it."""
ROUNDING = 1e3
"""Of the stiffness that the rest of a mode has at least: what is added where nothing has any."""
STABLE = -1e-9
"""In the stiffness: what is no more unstable than this is indifferent."""


@kernel
def hold_carried(contacts: ContactSet, work: DriveWorkspace) -> None:
    """Hold what the contacts of a mode do that carry. One that slips holds what it would slip aside: there friction
    gives way as slowly as the drive goes.
    """
    scratch, n, held = work.scratch[0], contacts.n_freedoms, work.scratch[0].held
    rest, aside = scratch.rest, scratch.beside
    clear(held, n, 1.0)
    for place in range(rest.newton.n_carrying):
        columns, mode = contacts.rows[rest.newton.contacts[place]].columns, rest.newton.modes[place]
        for which in range(3 if mode == STICKS else 1):
            append_column(held, columns[which], which, 0.0)
        size, one, two = along_slip(place, rest)
        if size > 0.0:
            for k in range(n):
                aside[k] = one * columns[2, k] - two * columns[1, k]
            append_column(held, aside, 1, 0.0)


@kernel
def least_stiffness(drive: DriveSetting, contacts: ContactSet, stiffness: FloatArray, work: DriveWorkspace) -> float:
    """Return the least stiffness along what is free, in that of all; its direction is the first column of the vectors.

    Given: what is held. Filled: what is held beside by contacts that touch.
    """
    scratch, n, held = work.scratch[0], contacts.n_freedoms, work.scratch[0].held
    whole = frobenius_norm(stiffness, n) + ROUNDING * scratch.rest.least_stiffness
    if whole == 0.0:
        return 1.0
    least = 1.0
    for _ in range(n):
        if held.used == n:
            return 1.0
        least = write_softest(stiffness, whole, n, work) / whole
        if least >= STABLE or not hold_touching(drive, contacts, work):
            break
    return least


@kernel
def write_softest(stiffness: FloatArray, whole: float, n: int, work: DriveWorkspace) -> float:
    """Write the softest motion of what is not held into the first column of the vectors; return its stiffness."""
    scratch = work.scratch[0]
    matrix, vectors = scratch.factor, scratch.vectors
    for j in range(n):
        for k in range(n):
            matrix[j, k] = stiffness[j, k]
    confine(matrix, scratch.held)
    add_across(matrix, scratch.held, 2.0 * whole)
    symmetric_eigen(matrix, vectors, n)
    at = 0
    for k in range(1, n):
        if matrix[k, k] < matrix[at, at]:
            at = k
    for k in range(n):
        vectors[k, 0], vectors[k, at] = vectors[k, at], vectors[k, 0]
    softest: float = matrix[at, at]
    return softest


@kernel
def hold_touching(drive: DriveSetting, contacts: ContactSet, work: DriveWorkspace) -> bool:
    """Hold, beside, the two contacts that stop both sides of the softest motion; False: one side is free."""
    scratch, n, touch_m = work.scratch[0], contacts.n_freedoms, drive.setting.tolerances.touch_m
    motion = scratch.beside
    for k in range(n):
        motion[k] = scratch.vectors[k, 0]
    one, other, at_one, at_other = -1, -1, STOPS, STOPS
    for i in range(contacts.used[0]):
        if contacts.rows[i].gap > touch_m or not contacts.states[i].chosen:
            continue
        column = contacts.rows[i].columns[0]
        closes = inner(column, motion, n) / length(column, n)
        if closes > at_one:
            one, at_one = i, closes
        if -closes > at_other:
            other, at_other = i, -closes
    if one < 0 or other < 0:
        return False
    added = append_column(scratch.held, contacts.rows[one].columns[0], 0, 0.0)
    return append_column(scratch.held, contacts.rows[other].columns[0], 0, 0.0) or added
