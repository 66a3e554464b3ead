"""What a rest leaves free: freedoms, their curvature, and forces that are not unique, equations (5.14) and (5.15)."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from cagepose.kernels.algebra.dense import frobenius_norm
from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import (
    MOST_FREEDOMS,
    WRENCH,
    PassiveSet,
    System,
    append_column,
    clear,
    inner,
    length,
    nonnegative_least_squares,
)
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.span import extend, write_complement, write_outside, write_reduced
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.contact.contact_set import ContactSet, is_smooth
from cagepose.kernels.contact.curvature import write_circulation, write_curvature
from cagepose.kernels.contact.load_curvature import has_circulation
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Frame, ScaledVector, hold_freedoms
from cagepose.kernels.contact.pressing import number_pressing
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.contact_status import ContactStatus
from cagepose.kernels.stability.other_balance import OtherBalance, may_be_stopped
from cagepose.kernels.stability.tolerances import (
    CLOSING_OF_TWIST,
    FLAT_CURVATURE,
    LIMIT_OF_FRICTION,
    OPENING_OF_TWIST,
    PART_OUTSIDE_SPAN,
)

STABLE_REST, MARGINAL, UNSTABLE, STABILITY_NOT_SHOWN = 0, 1, 2, 3
"""Codes of stability: the index into `STABILITY_NAMES`."""
STABILITY_NAMES: tuple[Literal["stable", "marginal", "unstable", "not shown"], ...] = (
    "stable",
    "marginal",
    "unstable",
    "not shown",
)

FEW_CONTACTS = 32
"""So many contacts are asked first whether another one lies in their cone."""
ONE_SIDED_LIMIT = 10
"""So many contacts may open if all sets of them are asked; with more, a rest is called marginal at best."""


class StabilityWorkspace:
    """Workspace for one rest, and the answer; a record.

    Attributes
    ----------
    held, free
        Basis of what the carrying contacts hold, and then of all; scaled twists that are free, rows.
    one_sided
        Contacts that may open and that no others make superfluous.
    few, n_few
        Contacts in whose cone others were found to lie, and how many.
    rest
        Memory for one vector.
    curvature, reduced, vectors
        S, its part over the free twists, and its eigenvectors.
    ways
        Basis of the free twists without curvature.
    scratch
        Scratch.
    other
        Memory for the question whether another balance stops a motion.
    """

    held: PassiveSet
    free: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    one_sided: Annotated[IntArray, ONE_SIDED_LIMIT]
    few: Annotated[IntArray, FEW_CONTACTS]
    n_few: int
    rest: ScaledVector
    curvature: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    reduced: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    vectors: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    ways: PassiveSet
    scratch: PassiveSet
    other: OtherBalance


@kernel
def find_held(
    contacts: ContactSet,
    statuses: Rows[ContactStatus],
    friction: float,
    locked: PassiveSet,
    frame: Frame,
    work: StabilityWorkspace,
    system: System,
) -> bool:
    """Find what the contacts hold, with what those without play lock and what is held anyway; return whether one is at
    the limit of friction.

    A contact without force holds too if another balance loads it: then it cannot open without work. That is so where
    -a_j lies in the cone of the others, seen outside the span of those that carry.
    """
    at_limit = False
    clear(work.held, contacts.n_freedoms, 1.0)
    hold_freedoms(frame, work.held)
    for place in range(locked.used):
        extend(work.held, locked.basis[place], PART_OUTSIDE_SPAN)
    n = contacts.used[0]
    # contacts that carry hold along their normals, and those that stick along their faces, too
    for i in range(n):
        state, status = contacts.states[i], statuses[i]
        carried, one, two = state.forces
        status.is_equality = state.counts and carried > 0.0
        status.is_implied = status.opens = state.is_sticking = False
        if status.is_equality:
            extend(work.held, contacts.rows[i].columns[0], PART_OUTSIDE_SPAN)
            if friction > 0.0 and not is_smooth(contacts, i):
                tangential = math.sqrt(one * one + two * two)
                state.is_sticking = tangential < (1.0 - LIMIT_OF_FRICTION) * friction * carried
                at_limit = at_limit or not state.is_sticking
    for i in range(n):
        if contacts.states[i].is_sticking:
            extend(work.held, contacts.rows[i].columns[1], PART_OUTSIDE_SPAN)
            extend(work.held, contacts.rows[i].columns[2], PART_OUTSIDE_SPAN)
    # contacts without force that another balance loads; each that is found may load others
    found = True
    while found:
        found = False
        for i in range(n):
            if statuses[i].opens or not may_open(contacts, statuses, i):
                continue
            if lies_in_cone(contacts, statuses, i, -1.0, work, system):
                statuses[i].is_equality = True
                for which in range(3 if friction > 0.0 else 1):  # that balance may leave all of its friction to spare
                    extend(work.held, contacts.rows[i].columns[which], PART_OUTSIDE_SPAN)
                found = True
            else:
                note_opened(contacts, statuses, work.scratch.residual)
    return at_limit


@kernel
def may_open(contacts: ContactSet, statuses: Rows[ContactStatus], i: int) -> bool:
    """Whether a contact is chosen and no balance is known that loads it."""
    return bool(contacts.states[i].counts and not statuses[i].is_equality)


@kernel
def note_opened(contacts: ContactSet, statuses: Rows[ContactStatus], twist: FloatArray) -> None:
    """Mark all contacts that a twist opens, if it closes none: none of them is in any balance, so that n contacts are
    not n problems of n columns.
    """
    n = contacts.n_freedoms
    size = length(twist, n)
    for i in range(contacts.used[0]):
        column = contacts.rows[i].columns[0]
        if may_open(contacts, statuses, i) and inner(column, twist, n) > CLOSING_OF_TWIST * size * length(column, n):
            return
    for i in range(contacts.used[0]):
        column = contacts.rows[i].columns[0]
        if inner(column, twist, n) < -OPENING_OF_TWIST * size * length(column, n):
            statuses[i].opens = True


@kernel
def lies_in_cone(
    contacts: ContactSet,
    statuses: Rows[ContactStatus],
    i: int,
    sign: float,
    work: StabilityWorkspace,
    system: System,
) -> bool:
    """Whether ``sign`` times a contact's wrench lies in the cone of the others that may open, seen outside the span of
    what is held.

    With -1 no free twist opens it; with +1 no free twist that the others allow closes it.
    """
    if not write_outside(work.held, contacts.rows[i].columns[0], PART_OUTSIDE_SPAN, system.right_side):
        return True
    n_others = 0
    for k in range(contacts.used[0]):
        if k != i and may_open(contacts, statuses, k) and not statuses[k].is_implied:
            write_outside(work.held, contacts.rows[k].columns[0], PART_OUTSIDE_SPAN, system.columns[n_others])
            n_others += 1
    for k in range(contacts.n_freedoms):
        system.right_side[k] *= sign
    size = length(system.right_side, contacts.n_freedoms)
    clear(work.scratch, contacts.n_freedoms, size)
    return nonnegative_least_squares(system, n_others, work.scratch) <= PART_OUTSIDE_SPAN * size


@kernel
def lies_in_cone_of_few(
    contacts: ContactSet, statuses: Rows[ContactStatus], i: int, work: StabilityWorkspace, system: System
) -> bool:
    """Whether a contact's wrench lies in the cone of few others; False: it is not known.

    What is outside of their cone points to the contact that widens it most, which joins them: most of thousands of
    contacts are then told by the few at the outline.
    """
    if not write_outside(work.held, contacts.rows[i].columns[0], PART_OUTSIDE_SPAN, system.right_side):
        return True
    size = length(system.right_side, contacts.n_freedoms)
    for _ in range(FEW_CONTACTS):
        n_others, vacant = 0, work.n_few
        for place in range(work.n_few):
            k = work.few[place]
            if statuses[k].is_implied:
                vacant = place
            elif k != i:
                write_outside(work.held, contacts.rows[k].columns[0], PART_OUTSIDE_SPAN, system.columns[n_others])
                n_others += 1
        clear(work.scratch, contacts.n_freedoms, size)
        if nonnegative_least_squares(system, n_others, work.scratch) <= PART_OUTSIDE_SPAN * size:
            return True
        widest = farthest_along(contacts, statuses, i, work.scratch.residual)
        if widest < 0 or vacant == FEW_CONTACTS:
            return False
        work.few[vacant] = widest
        work.n_few = max(work.n_few, vacant + 1)
    return False


@kernel
def farthest_along(contacts: ContactSet, statuses: Rows[ContactStatus], i: int, twist: FloatArray) -> int:
    """Return which of the other contacts that may open points most along a twist; -1: none does."""
    n = contacts.n_freedoms
    farthest, most = -1, PART_OUTSIDE_SPAN * length(twist, n)
    for k in range(contacts.used[0]):
        if k != i and may_open(contacts, statuses, k) and not statuses[k].is_implied:
            column = contacts.rows[k].columns[0]
            size = length(column, n)  # zero: it is locked
            if inner(column, twist, n) > most * size:
                farthest, most = k, inner(column, twist, n) / size
    return farthest


@kernel
def list_one_sided(
    contacts: ContactSet, statuses: Rows[ContactStatus], work: StabilityWorkspace, system: System
) -> int:
    """List the contacts that may open and that no others make superfluous; return how many, -1: too many."""
    n_one_sided = work.n_few = 0
    for i in range(contacts.used[0]):
        if not may_open(contacts, statuses, i):
            continue
        if lies_in_cone_of_few(contacts, statuses, i, work, system) or lies_in_cone(
            contacts, statuses, i, 1.0, work, system
        ):
            statuses[i].is_implied = True
            continue
        if n_one_sided == ONE_SIDED_LIMIT:
            return -1
        work.one_sided[n_one_sided] = i
        n_one_sided += 1
    return n_one_sided


@kernel
def is_listed_twice(contacts: ContactSet, i: int, k: int) -> bool:
    """Whether two rows are one, or one contact that is in two groups."""
    one, other = contacts.rows[i], contacts.rows[k]
    is_same = one.group != other.group
    for row in range(contacts.n_freedoms):
        is_same = is_same and one.wrenches[0, row] == other.wrenches[0, row]
    return i == k or is_same


@kernel
def extend_by_equalities(contacts: ContactSet, statuses: Rows[ContactStatus], without: int, span: PassiveSet) -> None:
    """Write the span of what sticking contacts carry along their faces and of the normals that may carry, without that
    of one face (-1: of all); labels say which contact's normal each basis vector is, -1: none.
    """
    rows = contacts.rows
    clear(span, contacts.n_freedoms, 1.0)
    for i in range(contacts.used[0]):
        if contacts.states[i].is_sticking:
            extend(span, rows[i].columns[1], PART_OUTSIDE_SPAN)
            extend(span, rows[i].columns[2], PART_OUTSIDE_SPAN)
    for place in range(span.used):
        span.labels[place] = -1
    for i in range(contacts.used[0]):
        if statuses[i].is_equality and not (without >= 0 and is_listed_twice(contacts, i, without)):
            span.labels[span.used] = i
            extend(span, rows[i].columns[0], PART_OUTSIDE_SPAN)


@kernel
def find_shared(contacts: ContactSet, statuses: Rows[ContactStatus], work: StabilityWorkspace) -> None:
    """Mark the contacts whose normal force could be another: their wrench lies in the span of the rest.

    One that adds nothing to the span of all lies in the span of those that do; only for these the rest has to be asked.
    """
    rows, n, whole = contacts.rows, contacts.used[0], work.scratch
    extend_by_equalities(contacts, statuses, -1, whole)
    for i in range(n):
        statuses[i].is_shared = False
        if not statuses[i].is_equality:
            continue
        adds = False
        for place in range(whole.used):
            k = whole.labels[place]
            adds = adds or (k >= 0 and is_listed_twice(contacts, k, i))
        span = whole
        if adds:
            span = work.held
            extend_by_equalities(contacts, statuses, i, span)
        statuses[i].is_shared = not write_outside(span, rows[i].columns[0], PART_OUTSIDE_SPAN, work.rest)


@kernel
def is_feasible(
    contacts: ContactSet, n_one_sided: int, twist: FloatArray, sign: float, work: StabilityWorkspace
) -> bool:
    """Whether a scaled twist closes none of the contacts that may open."""
    for k in range(n_one_sided):
        column = contacts.rows[work.one_sided[k]].columns[0]
        if sign * inner(column, twist, contacts.n_freedoms) > PART_OUTSIDE_SPAN * length(column, contacts.n_freedoms):
            return False
    return True


@kernel
def hold_some(contacts: ContactSet, n_one_sided: int, chosen: int, work: StabilityWorkspace) -> bool:
    """Hold those of the one-sided contacts whose bit is set, too; False: they depend on each other."""
    for k in range(n_one_sided):
        if (chosen >> k) & 1:
            column = contacts.rows[work.one_sided[k]].columns[0]
            if not write_outside(work.held, column, PART_OUTSIDE_SPAN, work.rest):
                return False
            append_column(work.held, column, k, 0.0)
    return True


@kernel
def has_twins(contacts: ContactSet) -> bool:
    """Whether a contact that carries is where features meet that bend by different amounts."""
    found = False
    for i in range(contacts.used[0]):
        found = found or (contacts.bends[i].has_twin and contacts.states[i].forces[0] > 0.0)
    return found


@kernel
def stability(
    contacts: ContactSet,
    statuses: Rows[ContactStatus],
    friction: float,
    locked: PassiveSet,
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    terms: float,
    size_m: float,
    work: StabilityWorkspace,
    system: System,
) -> int:
    """Return the code of stability of a rest with the forces in ``contacts``; free twists without curvature are added
    to ``work.ways``.

    On the cone of twists that close no contact, the least curvature is an eigenvalue over the span of one of its faces,
    and its eigenvector lies in that face. So all sets of contacts that may open are held in turn. Where the load turns
    round on what is held free, only positive curvature says something (5.29). Where a contact is at the seam of
    features that bend by different amounts, one way off it may be stable and another not: unless those that bend least
    and those that bend most say the same, nothing is shown. Nor is it where another balance may stop a motion (5.38).
    """
    if contacts.n_freedoms != WRENCH + number_pressing(contacts.pressing):
        return STABILITY_NOT_SHOWN  # curvatures are of one free body, and of what presses on it
    at_limit = find_held(contacts, statuses, friction, locked, frame, work, system)
    n_held, n_ways = work.held.used, work.ways.used
    n_one_sided = list_one_sided(contacts, statuses, work, system)
    code, flat = STABLE_REST, 0.0
    for curved in range(2 if has_twins(contacts) else 1):
        told, work.ways.used = code, n_ways
        code = MARGINAL if at_limit or n_one_sided < 0 else STABLE_REST
        write_curvature(contacts, load, position, quaternion, frame, curved == 1, work.curvature)
        flat = FLAT_CURVATURE * max(frobenius_norm(work.curvature, contacts.n_freedoms), terms / size_m)
        for chosen in range(1 << max(n_one_sided, 0)):
            work.held.used = n_held
            if hold_some(contacts, n_one_sided, chosen, work):
                found = least_curvature(contacts, n_one_sided, flat, work)
                if found == UNSTABLE and may_be_stopped(
                    contacts, statuses, friction, flat, frame, curved == 1, size_m, work.other
                ):
                    found = STABILITY_NOT_SHOWN
                code = max(code, found)
        work.held.used = n_held
        if curved == 1 and code != told:
            work.ways.used = n_ways
            return STABILITY_NOT_SHOWN
    if code != STABLE_REST and has_circulation(load):
        write_circulation(contacts, load, position, quaternion, frame, work.curvature)
        n_free = write_complement(work.held, work.free)
        write_reduced(work.curvature, work.free, n_free, contacts.n_freedoms, work.reduced)
        if greatest_entry(work.reduced, n_free) > flat:
            work.ways.used = n_ways
            return STABILITY_NOT_SHOWN
    return code


@kernel
def greatest_entry(matrix: FloatArray, n: int) -> float:
    """Return the greatest magnitude in the leading (n, n) block."""
    greatest = 0.0
    for i in range(n):
        for j in range(n):
            greatest = max(greatest, abs(matrix[i, j]))
    return greatest


@kernel
def least_curvature(contacts: ContactSet, n_one_sided: int, flat: float, work: StabilityWorkspace) -> int:
    """Return the code of stability over the twists that what is held leaves free, and the twist that is unstable."""
    n_free = write_complement(work.held, work.free)
    write_reduced(work.curvature, work.free, n_free, contacts.n_freedoms, work.reduced)
    symmetric_eigen(work.reduced, work.vectors, n_free)
    code = STABLE_REST
    for e in range(n_free):
        if work.reduced[e, e] > flat:
            continue
        for k in range(contacts.n_freedoms):
            work.rest[k] = 0.0
            for i in range(n_free):
                work.rest[k] += work.vectors[i, e] * work.free[i, k]
        forward = is_feasible(contacts, n_one_sided, work.rest, 1.0, work)
        if not forward and not is_feasible(contacts, n_one_sided, work.rest, -1.0, work):
            continue
        if work.reduced[e, e] < -flat:
            work.other.least = work.reduced[e, e]
            for k in range(contacts.n_freedoms):
                work.other.twist[k] = work.rest[k]
            return UNSTABLE
        code = MARGINAL
        append_column(work.ways, work.rest, e, 0.0)
    return code
