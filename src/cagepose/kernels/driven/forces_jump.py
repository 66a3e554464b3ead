"""Forces jump where contacts that carry cannot all go with their bodies: until one of them gives way.

Contacts c_i that carry and drift with w_i go on together if a motion y has c_i . y = -w_i for all of them. If none has,
what the best one leaves, r_i = w_i + c_i . y, balances among them, sum c_i r_i = 0: so would contacts press on each
other that give way a little and alike. The forces rise and fall along r where the bodies stand, until the first of them
is zero, or leaves its cone; that contact opens, or slips. If none ever does, they resist the drive without bound.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.eigen import symmetric_eigen
from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import is_smooth
from cagepose.kernels.contact.coulomb_newton import SLIPS, STICKS
from cagepose.kernels.driven.rest_of_mode import list_carrying
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

AGREE = 1e-8
"""In the fastest drift: contacts that press on each other by less go on together."""
LEAST_FORCE = 1e-9
"""In greatest forces: what a contact carries that slips before it carries anything."""
SAME = 1e-9
"""Relative. Contacts that give way after rates that differ by less do so together; less of the greatest rate is none.
"""
ROUNDS = 12
"""How often contacts without a force are let in and out."""
DEPENDENT = 1e-12
"""Of the greatest: motions with less than this square of a rate are held by none of the contacts."""


@kernel
def along_friction(place: int, work: DriveWorkspace) -> tuple[float, float]:
    """Return the direction of the friction of a contact that slips; (0, 0): it sticks, or has none."""
    newton = work.scratch[0].rest.newton
    forces = work.run.contacts.states[newton.contacts[place]].forces
    size = math.sqrt(forces[1] ** 2 + forces[2] ** 2)
    if newton.modes[place] != SLIPS or size == 0.0:
        return 0.0, 0.0
    return forces[1] / size, forces[2] / size


@kernel
def write_force_column(friction: float, place: int, which: int, work: DriveWorkspace) -> float:
    """Write a column of a contact into ``scratch.beside``, that of its force with friction where it slips, in lengths
    of its normal's, and return its drift along it.
    """
    scratch, rest, contacts = work.scratch[0], work.scratch[0].rest, work.run.contacts
    n, row = contacts.n_freedoms, contacts.rows[rest.newton.contacts[place]]
    one, two = along_friction(place, work)
    rubs = friction if which == 0 else 0.0
    for k in range(n):
        slips = one * row.columns[1, k] + two * row.columns[2, k]
        scratch.beside[k] = row.columns[which, k] + rubs * slips
    size = length(row.columns[0], n)
    for k in range(n):
        scratch.beside[k] /= size
    drift: float = row.drift[which] + rubs * (one * row.drift[1] + two * row.drift[2])
    return drift / size


@kernel
def write_best_motion(friction: float, work: DriveWorkspace) -> float:
    """Write the shortest motion with which what carries goes best with its bodies into ``scratch.guided``, as seen
    along forces with friction; return the fastest drift.
    """
    scratch, rest, n = work.scratch[0], work.scratch[0].rest, work.run.contacts.n_freedoms
    normal, vectors, y, fastest = scratch.factor, scratch.vectors, scratch.guided, 0.0
    for j in range(n):
        y[j] = scratch.change[j] = 0.0
        for k in range(n):
            normal[j, k] = 0.0
    for place in range(rest.newton.n_carrying):
        for which in range(3 if rest.newton.modes[place] == STICKS else 1):
            drift = write_force_column(friction, place, which, work)
            fastest = max(fastest, abs(drift))
            for j in range(n):
                scratch.change[j] -= scratch.beside[j] * drift
                for k in range(n):
                    normal[j, k] += scratch.beside[j] * scratch.beside[k]
    symmetric_eigen(normal, vectors, n)
    greatest = 0.0
    for e in range(n):
        greatest = max(greatest, normal[e, e])
    for e in range(n):
        if normal[e, e] > DEPENDENT * greatest:
            along = 0.0
            for k in range(n):
                along += vectors[k, e] * scratch.change[k]
            for k in range(n):
                y[k] += along / normal[e, e] * vectors[k, e]
    return fastest


@kernel
def write_presses(friction: float, work: DriveWorkspace) -> tuple[float, float]:
    """Write the best motion, and how fast each contact would still close and slip in it, a row for each, in lengths of
    its normal's column; return (the fastest drift, the fastest of these).
    """
    scratch, newton, hardest = work.scratch[0], work.scratch[0].rest.newton, 0.0
    fastest = write_best_motion(friction, work)
    for place in range(newton.n_carrying):
        for which in range(3 if newton.modes[place] == STICKS else 1):
            drift = write_force_column(friction, place, which, work)
            presses = drift + inner(scratch.beside, scratch.guided, work.run.contacts.n_freedoms)
            hardest = max(hardest, abs(presses))
            newton.matrix[place, which] = presses
    return fastest, hardest


@kernel
def leaves_cone(forces: FloatArray, rates: FloatArray, friction: float) -> float:
    """Return after how much of the rates a force inside its cone leaves it; inf: it never does."""
    a = rates[1] ** 2 + rates[2] ** 2 - (friction * rates[0]) ** 2
    b = forces[1] * rates[1] + forces[2] * rates[2] - friction * friction * forces[0] * rates[0]
    c = min(forces[1] ** 2 + forces[2] ** 2 - (friction * forces[0]) ** 2, 0.0)
    if c == 0.0:
        return 0.0 if b > 0.0 or (b == 0.0 and a > 0.0) else math.inf
    root = b * b - a * c
    if root < 0.0 or (a <= 0.0 and b <= 0.0):
        return math.inf
    way = b + math.sqrt(root)
    return -c / way if way > 0.0 else math.inf


@kernel
def write_rates_apart(drive: DriveSetting, work: DriveWorkspace) -> tuple[bool, bool]:
    """Write how the forces rise and fall where what carries cannot go with its bodies, a row for each contact; return
    (whether it cannot, whether other contacts carry now). Of contacts without a force those count that would close.
    """
    newton, friction = work.scratch[0].rest.newton, drive.setting.friction.greatest
    fastest, hardest, changed = 0.0, 0.0, False
    for _ in range(ROUNDS):
        fastest, hardest = write_presses(friction, work)
        if hardest <= AGREE * fastest or not count_closing(friction, SAME * fastest, work):
            break
        changed = True
    for place in range(newton.n_carrying):
        for which in range(3 if newton.modes[place] == STICKS else 1):
            presses = newton.matrix[place, which]
            size = length(work.run.contacts.rows[newton.contacts[place]].columns[0], work.run.contacts.n_freedoms)
            newton.matrix[place, which] = presses / size if abs(presses) > SAME * hardest else 0.0
    return hardest > AGREE * fastest, changed


@kernel
def count_closing(friction: float, least: float, work: DriveWorkspace) -> bool:
    """Let contacts without a force carry if they close in the best motion, and not if they open; return whether any
    changed.
    """
    scratch, contacts, newton = work.scratch[0], work.run.contacts, work.scratch[0].rest.newton
    n, changed, none = contacts.n_freedoms, False, 0.0
    for place in range(newton.n_carrying):
        none = max(none, LEAST_FORCE * contacts.states[newton.contacts[place]].forces[0])
    for place in range(newton.n_carrying):
        state = contacts.states[newton.contacts[place]]
        if state.forces[0] < none:
            state.forces[0] = state.forces[1] = state.forces[2] = 0.0
        if state.forces[0] <= 0.0 and newton.matrix[place, 0] < -least:
            state.counts = state.is_sticking = False
            changed = True
    for i in range(contacts.used[0]):
        row, state = contacts.rows[i], contacts.states[i]
        if state.counts or not state.chosen:
            continue
        closes = row.drift[0] + inner(row.columns[0], scratch.guided, n)
        if closes > least * length(row.columns[0], n):
            state.counts = changed = True
            state.is_sticking = friction > 0.0 and not is_smooth(contacts, i)
            for j in range(3):
                state.forces[j] = 0.0
    if changed:
        list_carrying(contacts, friction, scratch.rest)
    return changed


@kernel
def write_rates_to_trial(work: DriveWorkspace) -> None:
    """Write how the forces change up to those of the trial, a row for each contact."""
    newton, contacts, trial = work.scratch[0].rest.newton, work.run.contacts, work.run.ahead
    for place in range(newton.n_carrying):
        i = newton.contacts[place]
        for j in range(3):
            newton.matrix[place, j] = trial.states[i].forces[j] - contacts.states[i].forces[j]


@kernel
def gives_way(drive: DriveSetting, found: bool, work: DriveWorkspace) -> bool:
    """Let forces change until the first of the contacts that carry opens or slips, and let it do so; False: none does,
    and the same contacts carry.

    Given: the contacts of ``work.run``, with their drifts, and what they do in a trial; whether that was ``found``:
    then forces change to those of the trial, and else as what carries presses on each other.
    """
    rest, contacts, friction = work.scratch[0].rest, work.run.contacts, drive.setting.friction.greatest
    rates, amount, greatest, is_first = rest.newton.matrix, math.inf, 0.0, True
    if found:
        write_rates_to_trial(work)
    else:
        is_apart, changed = write_rates_apart(drive, work)
        if not is_apart:
            return changed
    for place in range(rest.newton.n_carrying):
        amount = min(amount, lasts(drive, place, work)[0])
        greatest = max(greatest, contacts.states[rest.newton.contacts[place]].forces[0])
    if amount == math.inf or (found and amount >= 1.0):
        return False

    # What leaves its cone at the same time slips, too.
    for place in range(rest.newton.n_carrying):
        state, rate = contacts.states[rest.newton.contacts[place]], rates[place]
        last, opens = lasts(drive, place, work)
        forces, (one, two) = state.forces, along_friction(place, work)
        forces[0] = max(forces[0] + amount * rate[0], 0.0)
        for j in range(1, 3):
            if rest.newton.modes[place] == STICKS:
                forces[j] += amount * rate[j]
            else:
                forces[j] = friction * forces[0] * (one if j == 1 else two)
        if last > amount * (1.0 + SAME):
            continue
        if not opens:
            state.is_sticking = False
            begin_friction(friction, LEAST_FORCE * greatest, place, work)
        elif is_first:
            state.counts = state.is_sticking = is_first = False
            for j in range(3):
                forces[j] = 0.0
    return True


@kernel
def lasts(drive: DriveSetting, place: int, work: DriveWorkspace) -> tuple[float, bool]:
    """Return (after how much of the rates a contact gives way, whether it opens then)."""
    newton = work.scratch[0].rest.newton
    forces, rate = work.run.contacts.states[newton.contacts[place]].forces, newton.matrix[place]
    amount = max(forces[0], 0.0) / -rate[0] if rate[0] < 0.0 else math.inf
    if newton.modes[place] == STICKS:
        leaves = leaves_cone(forces, rate, drive.setting.friction.greatest)
        if leaves < amount:
            return leaves, False
    return amount, True


@kernel
def begin_friction(friction: float, least: float, place: int, work: DriveWorkspace) -> None:
    """Give a contact that slips before it carries anything a little force, so that its friction has a direction."""
    newton = work.scratch[0].rest.newton
    forces, rate = work.run.contacts.states[newton.contacts[place]].forces, newton.matrix[place]
    aside = math.sqrt(rate[1] ** 2 + rate[2] ** 2)
    if forces[0] > least or aside == 0.0:
        return
    forces[0] = least
    for j in range(1, 3):
        forces[j] = friction * least * rate[j] / aside


@kernel
def go_along(friction: float, work: DriveWorkspace) -> None:
    """Let the object go on the shortest way with which what carries goes with its bodies."""
    scratch = work.scratch[0]
    list_carrying(work.run.contacts, friction, scratch.rest)
    write_best_motion(0.0, work)
    for k in range(work.run.contacts.n_freedoms):
        scratch.way[k] = scratch.guided[k]


@kernel
def go_with_all(work: DriveWorkspace) -> None:
    """Let the object go on the shortest way with which it goes with its bodies, and into none of them: of contacts
    without a force those carry that would close.
    """
    scratch, contacts = work.scratch[0], work.run.contacts
    list_carrying(contacts, 0.0, scratch.rest)
    for _ in range(ROUNDS):
        fastest, _ = write_presses(0.0, work)
        if not count_closing(0.0, SAME * fastest, work):
            break
    for k in range(contacts.n_freedoms):
        scratch.way[k] = scratch.guided[k]
