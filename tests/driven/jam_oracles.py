"""Could forces stand against a drive, and does a mode of motion go on? Linear programs with cones of many sides.

All that is taken from cagepose is where things touch; SciPy's HiGHS answers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog

from cagepose.model.checks import FloatArray
from cagepose.studies.driven_contacts import DrivenContacts

SIDES = 64
"""Of the cones in which it is asked whether forces stand."""
SECTORS, SECTORS_OF_CONE = 4, 24
"""Of slips, at first, and of the cones of what may stick."""
NARROWEST, VIOLATED = 1e-4, 1e-6
"""Radians, of sectors that are not halved again; and power by which a motion may violate Coulomb's law."""
MOST_NODES = 4000
EXACT = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""The least that HiGHS takes."""
TOUCHES = 1e-9
"""Of what HiGHS leaves: a work of so little is none."""


class TooManyModesError(Exception):
    """The search of modes was given up."""


def wider(mu: FloatArray, sides: int = SIDES) -> FloatArray:
    """Coefficients whose cone of so many sides goes around the round one."""
    return mu / math.cos(math.pi / sides)


def most_work(contacts: DrivenContacts, friction: FloatArray, sides: int = SIDES) -> float:
    """The most that forces which add up to one do on the drive, in its fastest drift, if they cancel but for what they
    take of the growth of the load; -inf: none cancel. Friction is of all contacts, (n,), with pyramids inside of cones.
    """
    problem, speed = contacts.problem, contacts.speed
    if not problem.faces:
        return -math.inf
    columns = problem.scaled(problem.wrenches)
    angles = 2.0 * np.pi * np.arange(sides) / sides
    along = np.stack([np.ones(sides), np.cos(angles), np.sin(angles)], axis=1)
    rays, work = [], []
    for column, drift, mu in zip(columns, contacts.drifts / speed, friction, strict=True):
        of_contact = along[: sides if mu > 0.0 else 1] * (1.0, mu, mu)
        size = np.linalg.norm(column[0])
        rays.append(of_contact @ column / size)
        work.append(of_contact @ drift / size)
    matrix, gain = np.concatenate(rays), np.concatenate(work)
    if contacts.growth_size > 0.0:
        matrix = np.vstack([matrix, -problem.scaled(contacts.growth) / contacts.growth_size])
        gain = np.append(gain, contacts.fastest / speed)
    rows = np.vstack([matrix.T, np.ones(len(matrix))])
    found = linprog(-gain, A_eq=rows, b_eq=np.eye(7)[6], bounds=(0, None), options=EXACT)
    return -float(found.fun) if found.status == 0 else -math.inf


def stands(contacts: DrivenContacts, friction: FloatArray, sides: int = SIDES) -> bool:
    return most_work(contacts, friction, sides) > TOUCHES


def least_friction(contacts: DrivenContacts, shares: FloatArray, high: float) -> float:
    """The least coefficient with which forces in pyramids stand, by bisection; inf: not with ``high``."""
    low = 0.0
    if not stands(contacts, high * shares):
        return math.inf
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        if stands(contacts, middle * shares):
            high = middle
        else:
            low = middle
    return high


@dataclass(frozen=True)
class Mode:
    """What is decided of a contact: whether it is open (None: not yet), and whether it slips, between two angles."""

    is_open: bool | None = None
    slips: bool | None = None
    start: float = 0.0
    width: float = 2.0 * math.pi


def way_on(contacts: DrivenContacts, drag: float) -> FloatArray | None:
    """How the object and its contacts go on with the drive, velocities (n, 3), in a motion that obeys Coulomb's law to
    VIOLATED; None: no mode has one.

    With ``drag`` 0 forces balance the load; with 1 they also push the object along, against a resistance as its metric.

    Raises
    ------
    TooManyModesError
        There are too many cases, or a narrow sector neither has a motion nor has none.
    """
    waiting, n_asked = [[Mode()] * len(contacts.problem.faces)], 0
    while waiting:
        modes, n_asked = waiting.pop(), n_asked + 1
        if n_asked > MOST_NODES:
            raise TooManyModesError
        found = _motion(contacts, drag, modes)
        if found is None:
            continue
        velocities, forces = found
        worst, is_opening, most = _worst(velocities, forces, contacts.problem.friction, modes)
        if most <= VIOLATED:
            return velocities
        mode = modes[worst]
        if not is_opening and mode.slips and mode.width < NARROWEST:
            raise TooManyModesError
        angle = math.atan2(velocities[worst, 2], velocities[worst, 1])
        waiting += [[*modes[:worst], part, *modes[worst + 1 :]] for part in _parts(mode, is_opening, angle)]
    return None


def _worst(
    velocities: FloatArray, forces: FloatArray, friction: FloatArray, modes: list[Mode]
) -> tuple[int, bool, float]:
    """Which contact violates the law most, whether because it carries and opens, and by how much power."""
    opening = np.where([mode.is_open is None for mode in modes], -velocities[:, 0] * forces[:, 0], 0.0)
    slips = np.hypot(velocities[:, 1], velocities[:, 2])
    against = friction * forces[:, 0] * slips - np.einsum("ij,ij->i", forces[:, 1:], velocities[:, 1:])
    against = np.where([mode.slips is False for mode in modes], 0.0, against)
    if opening.max() >= against.max():
        return int(opening.argmax()), True, float(opening.max())
    return int(against.argmax()), False, float(against.max())


def _parts(mode: Mode, is_opening: bool, angle: float) -> list[Mode]:
    if is_opening:
        return [replace(mode, is_open=False), replace(mode, is_open=True)]
    if mode.slips:
        half = 0.5 * mode.width
        return [replace(mode, start=mode.start + k * half, width=half) for k in range(2)]
    sector = 2.0 * math.pi / SECTORS
    parts = [replace(mode, slips=True, start=angle + (k - 0.4) * sector, width=sector) for k in range(SECTORS)]
    return [replace(mode, slips=False), *parts[::-1]]


def _motion(contacts: DrivenContacts, drag: float, modes: list[Mode]) -> tuple[FloatArray, FloatArray] | None:
    """Velocities at the contacts and forces there, as these modes allow, the drive's rate being one; None: none."""
    problem = contacts.problem
    columns, drifts = problem.scaled(problem.wrenches), contacts.drifts / contacts.speed
    n = len(columns)
    equal, equal_to, most, at_most = [], [], [], []
    rays, owners, parts = [], [], []
    for contact, (column, drift, mu, mode) in enumerate(zip(columns, drifts, problem.friction, modes, strict=True)):
        rows, bounds = (equal, equal_to) if mode.is_open is False else (most, at_most)
        rows.append(column[0])
        bounds.append(-drift[0])
        if mode.slips is False:
            equal += [column[1], column[2]]
            equal_to += [-drift[1], -drift[2]]
        if mode.slips:  # on the inner sides of the sector's two edges
            for angle, sign in ((mode.start, 1.0), (mode.start + mode.width, -1.0)):
                across = sign * np.array([math.sin(angle), -math.cos(angle)])
                most.append(across @ column[1:])
                at_most.append(-float(across @ drift[1:]))
        if mode.is_open:
            continue
        of_contact = [(0.0, 0.0)]
        if mu > 0.0 and mode.slips:
            half = 0.5 * mode.width
            angles, much = np.array([0.0, half, mode.width]) + mode.start, np.array([1.0, 1.0 / math.cos(half), 1.0])
            of_contact = [(mu * m * math.cos(a), mu * m * math.sin(a)) for a, m in zip(angles, much, strict=True)]
        elif mu > 0.0:
            angles, much = 2.0 * np.pi * np.arange(SECTORS_OF_CONE) / SECTORS_OF_CONE, wider(mu, SECTORS_OF_CONE)
            of_contact = [(much * math.cos(a), much * math.sin(a)) for a in angles]
        for one, two in of_contact:
            rays.append(column[0] + one * column[1] + two * column[2])
            owners.append(contact)
            parts.append((1.0, one, two))
    matrix = np.array(rays).reshape(-1, 6).T
    load = problem.scaled(problem.load)
    if drag:  # at whatever scale the load acts
        moved = np.hstack([np.eye(6), matrix, -load[:, None]])
        balance_to, more = np.zeros(6), 1
    else:
        moved, balance_to, more = np.hstack([np.zeros((6, 6)), matrix]), load, 0
    wide = np.zeros(len(rays) + more)
    rows_equal = np.vstack([*(np.append(row, wide) for row in equal), moved])
    found = linprog(
        np.append(np.zeros(6), np.append(np.ones(len(rays)), np.zeros(more))),
        A_eq=rows_equal,
        b_eq=np.append(equal_to, balance_to),
        A_ub=np.array([np.append(row, wide) for row in most]) if most else None,
        b_ub=at_most if most else None,
        bounds=[(None, None)] * 6 + [(0, None)] * len(wide),
        options=EXACT,
    )
    if found.status != 0:
        return None
    forces = np.zeros((n, 3))
    np.add.at(forces, owners, found.x[6 : 6 + len(rays), None] * np.array(parts).reshape(-1, 3))
    return columns @ found.x[:6] + drifts, forces
