"""How much friction lets the object jam at each place of a drive: `jam_friction_along` (8.7), by cutting planes.

A motion y of the object gives way to the drive at a contact that it opens at least as fast as friction could use the
slip: c_n + mu |c_t| <= 0, c_n and c_t being how fast y and the body of the cage close the contact and slip there. Where
one motion does so at all contacts the object cannot jam, with this coefficient and below. Each cone is a few of its
rays, and the shortest motion that these allow says which ones are missing.

The kernels ask the same along a run, for the least coefficient of all places. The search here is another one.
"""

from __future__ import annotations

import math

import numpy as np

from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import WRENCH, PassiveSet, empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.model.checks import FloatArray
from cagepose.runs.run import Run
from cagepose.studies.drifting_contacts import DriftingContacts, drifting_contacts
from cagepose.studies.tolerances import (
    JAM_FRICTION_WITHIN,
    LEAST_JAM_FRICTION,
    MOST_JAM_FRICTION,
    SPEED_OF_JAM,
)

MOST_CUTS = 100
"""Rounds of cutting planes; most questions take fewer than ten."""
EVEN_RAYS = 8
"""Rays of each cone to begin with."""


def jam_friction_along(run: Run, phase: int) -> FloatArray:
    """Return the least coefficient of friction with which the object could jam at each place of a phase's curve, (n,);
    inf: none up to 10.

    It is the greatest coefficient of all contacts; the others keep their proportion to it. Where faces take turns at an
    edge the first one counts.

    Parameters
    ----------
    run
        By the quasistatic method.
    phase
        Its number, from 0; it has driven something.
    """
    drive = run.phases[phase].drive
    assert drive is not None
    places = [drifting_contacts(run, phase, share, pose) for share, _, pose in drive.curve.places()]
    return np.array([least_jam_friction(contacts) for contacts in places])


def least_jam_friction(contacts: DriftingContacts) -> float:
    """Return the least coefficient with which contacts could jam the object; inf: none up to 10."""
    angles = 2.0 * np.pi * np.arange(EVEN_RAYS) / EVEN_RAYS
    even = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rays = [(which, ray) for which in np.flatnonzero(contacts.friction).tolist() for ray in even]
    rays += [(which, np.zeros(2)) for which in np.flatnonzero(contacts.friction == 0.0).tolist()]
    low, high = 0.0, MOST_JAM_FRICTION
    if _gives_way_up_to(contacts, high, rays) is not None:
        return math.inf
    while high - low > max(JAM_FRICTION_WITHIN * high, LEAST_JAM_FRICTION):
        middle = 0.5 * (low + high)
        found = _gives_way_up_to(contacts, middle, rays)
        if found is None:
            high = middle
        else:
            low = min(max(middle, found), high)
    return high if high > LEAST_JAM_FRICTION else 0.0


def _gives_way_up_to(contacts: DriftingContacts, friction: float, rays: list[tuple[int, FloatArray]]) -> float | None:
    """Return up to which coefficient of friction the shortest motion gives way that does so with this one; None: no
    motion does. Rays that are missing are added.
    """
    own = friction * contacts.friction
    sizes = np.linalg.norm(contacts.columns[:, 0], axis=1)
    for _ in range(MOST_CUTS):
        which = np.array([contact for contact, _ in rays], np.int64)
        across = own[which, None] * np.array([ray for _, ray in rays]).reshape(-1, 2)
        rows = contacts.columns[which, 0] + np.einsum("ij,ijk->ik", across, contacts.columns[which, 1:])
        bounds = -contacts.drift[which, 0] - np.einsum("ij,ij->i", across, contacts.drift[which, 1:])
        motion = np.zeros(WRENCH)
        if not shortest_inside(rows, bounds, empty_system(len(rows)), empty_record(PassiveSet), motion):
            return None
        speeds = contacts.columns @ motion + contacts.drift
        slips = np.linalg.norm(speeds[:, 1:], axis=1)
        allowed = SPEED_OF_JAM * max(1.0, float(np.linalg.norm(motion))) * sizes
        is_violated = speeds[:, 0] + own * slips > allowed
        if not is_violated.any():
            slides = contacts.friction * slips > allowed
            return float((-speeds[slides, 0] / (contacts.friction * slips)[slides]).min(initial=math.inf))
        new = np.flatnonzero(is_violated & (slips > allowed)).tolist()
        if not new:
            return None
        rays += [(contact, speeds[contact, 1:] / slips[contact]) for contact in new]
    return None
