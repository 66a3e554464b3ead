"""The verdict on one pose, with its proof: forces that balance the load, or the motion that nothing stops."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.contact_set import CONTACTS_PER_POINT, ContactSet, empty_contact_set, find_contacts
from cagepose.kernels.geometry import FloatArray, Geometry, Placement, place_object
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.least_squares import length
from cagepose.kernels.metric import Body, DeadLoads, frame_at, write_load
from cagepose.kernels.onset import (
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    OnsetRoom,
    empty_onset_room,
    is_held,
    onset,
)
from cagepose.kernels.pose import Quaternion
from cagepose.kernels.stability import STABLE_REST, StabilityRoom, empty_stability_room, stability
from cagepose.kernels.tolerances import KernelTolerances
from cagepose.kernels.uniqueness import (
    OTHER_FOUND,
    UNIQUE,
    ModesRoom,
    empty_modes_room,
    other_onset,
)
from cagepose.kernels.vector import Vector

PROVEN_WITHOUT_FRICTION, PROVEN_UNIQUE, OTHER_ONSET, UNIQUENESS_NOT_SHOWN, PROVEN_MOVES, TOO_MANY_CONTACTS = (
    0,
    1,
    2,
    3,
    4,
    5,
)
"""Codes of a proof."""
FRICTION_GREATEST = 1e4
"""A coefficient above which a balance counts as none."""
BISECTIONS = 100


class ProofRoom(NamedTuple):
    """Room for one proof, and its parts.

    Attributes
    ----------
    placement, contacts
        At the pose; ``contacts.forces`` are the proof of rest.
    load
        Scaled wrench of the load, (6,).
    solver
        ``solver.y``: scaled twist of the motion that nothing stops.
    modes
        ``modes.y``: that of another onset that Coulomb's law allows.
    rest
        Freedoms, and forces that are not unique.
    """

    placement: Placement
    contacts: ContactSet
    load: FloatArray
    solver: OnsetRoom
    modes: ModesRoom
    rest: StabilityRoom


def empty_proof_room(n_boxes: int, n_points: int) -> ProofRoom:
    """Return room for one proof (plain Python); ``n_boxes`` counts bridges too."""
    n_contacts = CONTACTS_PER_POINT * n_points
    return ProofRoom(
        Placement(
            np.empty((n_boxes, 3)), np.empty((n_boxes, 3, 3)), np.empty((n_boxes, n_points, 3)), np.empty(n_points)
        ),
        empty_contact_set(n_contacts),
        np.zeros(6),
        empty_onset_room(n_contacts),
        empty_modes_room(n_contacts),
        empty_stability_room(n_contacts),
    )


@kernel
def stand_at(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    loads: DeadLoads,
    phase: int,
    touch_m: float,
    room: ProofRoom,
) -> bool:
    """Fill placement, contacts and load at a pose; False: too many contacts."""
    frame = frame_at(body, quaternion)
    place_object(geometry, position, quaternion, room.placement)
    write_load(loads, phase, quaternion, frame, room.load)
    return find_contacts(geometry, room.placement, position, frame, touch_m, room.contacts)


@entry_kernel
def prove(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    loads: DeadLoads,
    phase: int,
    friction: float,
    size_m: float,
    tolerances: KernelTolerances,
    room: ProofRoom,
) -> tuple[int, int, int]:
    """Judge a pose; return (code of the proof, code of stability, number of undetermined freedoms).

    Parameters
    ----------
    geometry, body, loads, phase
        The scene, boxes as seen from the centre of gravity, and which load acts.
    position, quaternion
        Centre of gravity, metres, and unit quaternion (w, x, y, z).
    friction, size_m, tolerances
        Coefficient of friction, the scene's size in metres, and what counts as touching.
    room
        Filled: the proof.
    """
    if not stand_at(geometry, body, position, quaternion, loads, phase, tolerances.touch_m, room):
        return TOO_MANY_CONTACTS, STABLE_REST, 0
    code = onset(room.contacts, friction, room.load, room.solver)
    if code > HELD_BY_FRICTION:
        if code != MOVES:  # no balance, and no motion found either: what is left of the load separates them
            for k in range(6):
                room.solver.y[k] = room.solver.cone.passive.residual[k]
            room.solver.residual[0] = length(room.solver.y, 6) / length(room.load, 6)
        return PROVEN_MOVES, STABLE_REST, 0
    proof = PROVEN_WITHOUT_FRICTION
    if code != HELD_WITHOUT_FRICTION:
        answer = other_onset(room.contacts, friction, room.load, room.modes, room.solver.coulomb)
        proof = PROVEN_UNIQUE if answer == UNIQUE else UNIQUENESS_NOT_SHOWN
        if answer == OTHER_FOUND:
            proof = OTHER_ONSET
    frame = frame_at(body, quaternion)
    steady, n_undetermined = stability(
        room.contacts, friction, loads, phase, quaternion, frame, room.load, size_m, room.rest
    )
    return proof, steady, n_undetermined


@entry_kernel
def critical_friction(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    loads: DeadLoads,
    phase: int,
    tolerances: KernelTolerances,
    room: ProofRoom,
) -> float:
    """Return the least coefficient of friction at which the contacts can balance the load at a pose (5.17); inf: none.

    Parameters as for `prove`.
    """
    if not stand_at(geometry, body, position, quaternion, loads, phase, tolerances.touch_m, room):
        return math.nan
    none = float(np.float64(0.0))
    if is_held(room.contacts, none, room.load, room.solver):
        return 0.0
    low, high = 0.0, 1.0
    while not is_held(room.contacts, high, room.load, room.solver):
        low, high = high, 4.0 * high
        if high > FRICTION_GREATEST:
            return math.inf
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if is_held(room.contacts, middle, room.load, room.solver):
            high = middle
        else:
            low = middle
    return high
