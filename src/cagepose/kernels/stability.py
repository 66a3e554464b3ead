"""What a rest leaves free: freedoms, their curvature, and forces that are not unique, equations (5.14) and (5.15)."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contact_set import ContactSet
from cagepose.kernels.curvature import write_curvature
from cagepose.kernels.eigen import symmetric_eigen
from cagepose.kernels.geometry import FloatArray
from cagepose.kernels.jit import kernel
from cagepose.kernels.least_squares import (
    PassiveSet,
    append_column,
    empty_passive_set,
    inner,
    length,
    nonnegative_least_squares,
    orthogonalise,
)
from cagepose.kernels.metric import DeadLoads, Frame
from cagepose.kernels.pose import Quaternion
from cagepose.kernels.stiff import greatest_curvature

STABLE_REST, MARGINAL, UNSTABLE = 0, 1, 2
"""Codes of stability: the index into `STABILITY_NAMES`."""
STABILITY_NAMES: tuple[Literal["stable", "marginal", "unstable"], ...] = ("stable", "marginal", "unstable")

AT_LIMIT = 1e-9
"""A tangential force this near to its cone (relative) is at the limit of friction."""
IN_SPAN = 1e-9
"""A wrench whose part outside a span is smaller than this fraction of it lies in it."""
FLAT = 1e-9
"""In greatest curvatures (or loads for each size of the scene): a smaller one is rounding."""


class StabilityRoom(NamedTuple):
    """Room for one rest, and the answer.

    Attributes
    ----------
    held, free
        Basis of what the carrying contacts hold, and then of all; scaled twists that are free, (6, 6).
    is_equality
        Which contacts may carry in some balance, so that they can never open without work, (n_contacts,).
    is_sticking
        Which contacts stick, (n_contacts,).
    is_shared
        Contacts whose normal force is not unique, (n_contacts,).
    others, rejected, rest
        Room of the solver: columns, (n_contacts, 6), ..., one vector (6,).
    curvature, reduced, vectors
        S, its part over the free twists, and its eigenvectors, (6, 6).
    undetermined
        Free twists without curvature, scaled, (6, 6): rows.
    scratch
        Room.
    """

    held: PassiveSet
    free: FloatArray
    is_equality: NDArray[np.bool_]
    is_sticking: NDArray[np.bool_]
    is_shared: NDArray[np.bool_]
    others: FloatArray
    rejected: NDArray[np.bool_]
    rest: FloatArray
    curvature: FloatArray
    reduced: FloatArray
    vectors: FloatArray
    undetermined: FloatArray
    scratch: PassiveSet


def empty_stability_room(n_contacts: int) -> StabilityRoom:
    """Return room for ``n_contacts`` contacts (plain Python)."""
    return StabilityRoom(
        empty_passive_set(6),
        np.zeros((6, 6)),
        np.zeros(n_contacts, np.bool_),
        np.zeros(n_contacts, np.bool_),
        np.zeros(n_contacts, np.bool_),
        np.zeros((n_contacts, 6)),
        np.zeros(n_contacts, np.bool_),
        np.zeros(6),
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        np.zeros((6, 6)),
        empty_passive_set(6),
    )


@kernel
def write_outside(basis: PassiveSet, column: FloatArray, out: FloatArray) -> bool:
    """Write the part of a column outside the span of a basis; False: there is none, and zero is written."""
    for k in range(6):
        out[k] = column[k]
    for _ in range(2):
        for place in range(basis.used[0]):
            part = inner(basis.basis[place], out, 6)
            for k in range(6):
                out[k] -= part * basis.basis[place, k]
    if length(out, 6) > IN_SPAN * length(column, 6):
        return True
    for k in range(6):
        out[k] = 0.0
    return False


@kernel
def hold(basis: PassiveSet, column: FloatArray, room: StabilityRoom) -> None:
    """Add a column to a basis unless it lies in its span."""
    if write_outside(basis, column, room.rest):
        append_column(basis, column, 0, 0.0, 6)


@kernel
def find_held(contacts: ContactSet, friction: float, room: StabilityRoom) -> bool:
    """Find what the contacts hold; return whether one is at the limit of friction.

    A contact without force holds too if another balance loads it: then it cannot open without work. That is so where
    -a_j lies in the cone of the others, seen outside the span of those that carry.
    """
    at_limit = False
    room.held.used[0] = 0
    n = contacts.used[0]
    for i in range(n):
        carried = contacts.forces[i, 0]
        room.is_equality[i] = contacts.chosen[i] and carried > 0.0
        room.is_sticking[i] = False
        if room.is_equality[i]:
            hold(room.held, contacts.columns[i, 0], room)
            if friction > 0.0:
                tangential = math.hypot(contacts.forces[i, 1], contacts.forces[i, 2])
                room.is_sticking[i] = tangential < (1.0 - AT_LIMIT) * friction * carried
                at_limit = at_limit or not room.is_sticking[i]
    for i in range(n):
        if room.is_sticking[i]:
            hold(room.held, contacts.columns[i, 1], room)
            hold(room.held, contacts.columns[i, 2], room)
    found = True
    while found:
        found = False
        for i in range(n):
            if contacts.chosen[i] and not room.is_equality[i] and cannot_open(contacts, i, room):
                room.is_equality[i] = True
                hold(room.held, contacts.columns[i, 0], room)
                found = True
    return at_limit


@kernel
def cannot_open(contacts: ContactSet, i: int, room: StabilityRoom) -> bool:
    """Whether no free twist opens a contact that carries nothing."""
    n_others = 0
    for k in range(contacts.used[0]):
        if k != i and contacts.chosen[k] and not room.is_equality[k]:
            write_outside(room.held, contacts.columns[k, 0], room.others[n_others])
            n_others += 1
    if not write_outside(room.held, contacts.columns[i, 0], room.rest):
        return True
    for k in range(6):
        room.rest[k] = -room.rest[k]
    room.scratch.used[0] = 0
    size = length(room.rest, 6)
    left = nonnegative_least_squares(room.others, n_others, 6, room.rest, room.scratch, room.rejected)
    return left <= IN_SPAN * size


@kernel
def find_shared(contacts: ContactSet, room: StabilityRoom) -> None:
    """Mark the contacts whose normal force could be another: their wrench lies in the span of the rest."""
    n = contacts.used[0]
    for i in range(n):
        room.is_shared[i] = False
        if not room.is_equality[i]:
            continue
        room.scratch.used[0] = 0
        for k in range(n):
            if room.is_equality[k]:
                if k != i:
                    hold(room.scratch, contacts.columns[k, 0], room)
                if room.is_sticking[k]:
                    hold(room.scratch, contacts.columns[k, 1], room)
                    hold(room.scratch, contacts.columns[k, 2], room)
        room.is_shared[i] = not write_outside(room.scratch, contacts.columns[i, 0], room.rest)


@kernel
def find_free(room: StabilityRoom) -> int:
    """Complete the basis of what is held; write what is added into ``free`` and return how many there are."""
    n_held = int(room.held.used[0])
    for place in range(n_held, 6):
        best, best_size = 0, -1.0
        for axis in range(6):
            left = 1.0
            for k in range(place):
                left -= room.held.basis[k, axis] * room.held.basis[k, axis]
            if left > best_size:
                best, best_size = axis, left
        for k in range(6):
            room.held.columns[place, k] = 1.0 if k == best else 0.0
        orthogonalise(room.held, place, 6)
        for k in range(6):
            room.free[place - n_held, k] = room.held.basis[place, k]
    return 6 - n_held


@kernel
def is_feasible(contacts: ContactSet, twist: FloatArray, sign: float, room: StabilityRoom) -> bool:
    """Whether a scaled twist closes none of the contacts that may open."""
    for i in range(contacts.used[0]):
        if contacts.chosen[i] and not room.is_equality[i]:
            column = contacts.columns[i, 0]
            if sign * inner(column, twist, 6) > IN_SPAN * length(column, 6):
                return False
    return True


@kernel
def stability(
    contacts: ContactSet,
    friction: float,
    loads: DeadLoads,
    phase: int,
    quaternion: Quaternion,
    frame: Frame,
    b: FloatArray,
    size_m: float,
    room: StabilityRoom,
) -> tuple[int, int]:
    """Return (code of stability, number of undetermined freedoms) of a rest with the forces in ``contacts``."""
    at_limit = find_held(contacts, friction, room)
    find_shared(contacts, room)
    n_free = find_free(room)
    write_curvature(contacts, room.is_sticking, loads, phase, quaternion, frame, room.curvature)
    for i in range(n_free):
        for j in range(n_free):
            room.reduced[i, j] = 0.0
            for k in range(6):
                room.reduced[i, j] += room.free[i, k] * inner(room.curvature[k], room.free[j], 6)
    symmetric_eigen(room.reduced, room.vectors, n_free)
    flat = FLAT * max(greatest_curvature(room.curvature), length(b, 6) / size_m)
    code = MARGINAL if at_limit else STABLE_REST
    n_undetermined = 0
    for e in range(n_free):
        if room.reduced[e, e] > flat:
            continue
        for k in range(6):
            room.rest[k] = 0.0
            for i in range(n_free):
                room.rest[k] += room.vectors[i, e] * room.free[i, k]
        forward = is_feasible(contacts, room.rest, 1.0, room)
        if not forward and not is_feasible(contacts, room.rest, -1.0, room):
            continue
        if room.reduced[e, e] < -flat:
            code = UNSTABLE
        else:
            code = max(code, MARGINAL)
            for k in range(6):
                room.undetermined[n_undetermined, k] = room.rest[k]
            n_undetermined += 1
    return code, n_undetermined
