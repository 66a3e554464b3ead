"""The verdict on one pose, with its proof: forces that balance the load, or the motion that nothing stops."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.cone import (
    BALANCED,
    HELD,
    N_ROWS,
    WRENCH,
    ConeRoom,
    clear_cone,
    cone_residual,
    steepest_tangent,
    write_forces,
)
from cagepose.kernels.contact_set import (
    CONTACTS_PER_POINT,
    ContactSet,
    choose_next_faces,
    empty_contact_set,
    find_contacts,
)
from cagepose.kernels.geometry import FloatArray, Geometry, Placement, place_object
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.least_squares import length, rounding_scale
from cagepose.kernels.metric import Body, DeadLoads, frame_at, write_load
from cagepose.kernels.onset import (
    COMBINATIONS_LIMIT,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    OnsetRoom,
    empty_onset_room,
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
RESERVE = 1e-6
"""A balance that needs all but this part of the friction is at its limit."""
FRICTION_GREATEST = 1e4
"""A coefficient above which a balance counts as none."""
BISECTIONS = 100
SURE = 1e-6
"""In lengths of the terms: a residual small enough for one last step, and large enough to have its digits."""


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
    sum_only
        A load of nothing but a sum of the normal forces, (7,).
    wedged
        Whether the contacts can press against each other without a load; asked only where the object may rest, (1,).
    """

    placement: Placement
    contacts: ContactSet
    load: FloatArray
    solver: OnsetRoom
    modes: ModesRoom
    rest: StabilityRoom
    sum_only: FloatArray
    wedged: NDArray[np.bool_]


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
        np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        np.zeros(1, np.bool_),
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


@kernel
def has_self_stress(contacts: ContactSet, friction: float, room: ProofRoom) -> bool:
    """Whether contact forces other than zero, inside their cones, balance each other: a wedge (5.16).

    The sum of their normal forces is asked to be 1, and nothing else.
    """
    cone = room.solver.cone
    clear_cone(cone, room.sum_only, N_ROWS)
    charged = bool(np.bool_(False))
    left = cone_residual(
        contacts.columns, contacts.chosen, contacts.used[0], friction, room.sum_only, N_ROWS, charged, cone
    )
    return left <= HELD * rounding_scale(cone.passive, room.sum_only, N_ROWS)


@kernel
def left_by_friction(contacts: ContactSet, friction: float, b: FloatArray, cone: ConeRoom) -> float:
    """Return what contact forces with this friction leave of the load, in lengths of the terms."""
    clear_cone(cone, b, WRENCH)
    charged = bool(np.bool_(False))
    left = cone_residual(contacts.columns, contacts.chosen, contacts.used[0], friction, b, WRENCH, charged, cone)
    return left / rounding_scale(cone.passive, b, 6)


@kernel
def spare_friction(contacts: ContactSet, friction: float, room: ProofRoom) -> None:
    """Take the forces of a balance with a little less friction, if there is one: they lie inside the cones, not on
    them, so that no contact looks as if it were about to slip.
    """
    left = left_by_friction(contacts, friction, room.load, room.solver.cone)
    if left <= HELD:
        write_forces(room.solver.cone, contacts.used[0], friction, contacts.forces)
        room.solver.residual[0] = left


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
        room.solver.residual[0] = left_by_friction(room.contacts, friction, room.load, room.solver.cone)
        if code != MOVES:  # no balance, and no motion found either: what is left of the load separates them
            for k in range(6):
                room.solver.y[k] = room.solver.cone.passive.residual[k]
        return PROVEN_MOVES, STABLE_REST, 0
    proof = PROVEN_WITHOUT_FRICTION
    if code != HELD_WITHOUT_FRICTION:
        spare_friction(room.contacts, (1.0 - RESERVE) * friction, room)
        answer = other_onset(room.contacts, friction, room.load, room.modes, room.solver.coulomb)
        proof = PROVEN_UNIQUE if answer == UNIQUE else UNIQUENESS_NOT_SHOWN
        if answer == OTHER_FOUND:
            proof = OTHER_ONSET
        room.wedged[0] = proof != PROVEN_UNIQUE and has_self_stress(room.contacts, friction, room)
    frame = frame_at(body, quaternion)
    steady, n_undetermined = stability(
        room.contacts, friction, loads, phase, quaternion, frame, room.load, size_m, room.rest
    )
    return proof, steady, n_undetermined


@kernel
def step_to_balance(contacts: ContactSet, friction: float, cone: ConeRoom, forces: FloatArray) -> float:
    """Return by how much more friction the residual r would vanish, to first order: |r|^2 / sum f_n |r_t|."""
    write_forces(cone, contacts.used[0], friction, forces)
    gain = 0.0
    for i in range(contacts.used[0]):
        gain += forces[i, 0] * steepest_tangent(contacts.columns[i], cone.passive.residual)[0]
    left = length(cone.passive.residual, 6)
    return left * left / gain if gain > 0.0 else math.inf


@kernel
def least_friction(contacts: ContactSet, b: FloatArray, cone: ConeRoom) -> float:
    """Return the least coefficient at which one choice of faces balances the load (5.17); inf: none.

    Bisection, and Newton's method where the residual falls straight to zero: there the last step is taken from a
    residual that is still large enough to be sure of its digits.
    """
    low, high = float(np.float64(0.0)), 1.0
    if left_by_friction(contacts, low, b, cone) <= BALANCED:
        return 0.0
    while left_by_friction(contacts, high, b, cone) > HELD:
        low, high = high, 4.0 * high
        if high > FRICTION_GREATEST:
            return math.inf
    for _ in range(BISECTIONS):
        left = left_by_friction(contacts, low, b, cone)
        following = low + step_to_balance(contacts, low, cone, contacts.forces)
        if left <= SURE:
            return min(following, high)
        if not low < following < high:
            following = 0.5 * (low + high)
        if following in (low, high):
            break
        if left_by_friction(contacts, following, b, cone) <= HELD:
            high = following
            following = 0.5 * (low + high)
            if left_by_friction(contacts, following, b, cone) <= HELD:
                high = following
                continue
        low = following
    return high


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
    least = 0.0
    for _ in range(COMBINATIONS_LIMIT):
        least = max(least, least_friction(room.contacts, room.load, room.solver.cone))
        if not choose_next_faces(room.contacts):
            break
    return least
