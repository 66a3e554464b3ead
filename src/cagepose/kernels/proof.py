"""The verdict on one pose, with its proof: forces that balance the load, or the motion that nothing stops."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.cone import (
    BALANCED,
    HELD,
    N_ROWS,
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
    has_one_choice,
    put_best_faces_back,
)
from cagepose.kernels.coulomb import keep_forces, put_forces_back
from cagepose.kernels.geometry import Geometry, Placement, empty_placement, place_object
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.least_squares import System, clear, empty_system, length, rounding_scale
from cagepose.kernels.metric import WRENCH, Body, Frame, PhaseLoad, ScaledVector, frame_at, write_load
from cagepose.kernels.onset import (
    COMBINATIONS_LIMIT,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    OnsetRoom,
    onset,
    onset_with_faces,
)
from cagepose.kernels.pose import Quaternion
from cagepose.kernels.record import Rows, empty_rows
from cagepose.kernels.stability import MARGINAL, STABLE_REST, StabilityRoom, find_held, find_shared, stability
from cagepose.kernels.sure_contacts import SureRoom, rest_is_sure
from cagepose.kernels.tolerances import KernelTolerances
from cagepose.kernels.uniqueness import (
    N_COLUMNS,
    OTHER_FOUND,
    UNIQUE,
    ModesRoom,
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


class JudgeRoom:
    """Room of fixed size, and the answer; a record.

    Attributes
    ----------
    solver
        ``solver.y``: scaled twist of the motion that nothing stops.
    modes
        ``modes.y``: that of another onset that Coulomb's law allows.
    sure
        See there.
    rest
        Undetermined freedoms.
    sum_only
        A load of nothing but a sum of the normal forces.
    wedged
        Whether the contacts can press against each other without a load; asked only where the object may rest.
    """

    solver: OnsetRoom
    modes: ModesRoom
    sure: SureRoom
    rest: StabilityRoom
    sum_only: ScaledVector
    wedged: bool


class ProofRoom(NamedTuple):
    """Room for one proof: what is at the pose, where ``contacts`` hold the forces of a rest, one room for all else,
    and that of a system.
    """

    placement: Placement
    contacts: ContactSet
    rooms: Rows[JudgeRoom]
    system: System


def empty_proof_room(geometry: Geometry) -> ProofRoom:
    """Return room for one proof (plain Python)."""
    n_contacts = CONTACTS_PER_POINT * len(geometry.points_world)
    rooms = empty_rows(JudgeRoom, 1)
    rooms[0].sum_only[6] = 1.0
    return ProofRoom(
        empty_placement(geometry), empty_contact_set(n_contacts), rooms, empty_system(max(N_COLUMNS, n_contacts))
    )


@kernel
def stand_at(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    touch_m: float,
    at: ProofRoom,
) -> bool:
    """Fill placement, contacts and load at a pose; False: too many contacts."""
    frame = frame_at(body, quaternion)
    place_object(geometry, position, quaternion, at.placement)
    solver = at.rooms[0].solver
    solver.load_terms = write_load(load, quaternion, frame, solver.load)
    return find_contacts(geometry, at.placement, position, frame, touch_m, at.contacts)


@kernel
def has_self_stress(contacts: ContactSet, friction: float, room: JudgeRoom) -> bool:
    """Whether contact forces other than zero, inside their cones, balance each other: a wedge (5.16).

    The sum of their normal forces is asked to be 1, and nothing else.
    """
    cone = room.solver.cone
    clear_cone(cone, room.sum_only, N_ROWS, 1.0)
    charged = bool(np.bool_(False))
    left = cone_residual(contacts.rows, contacts.used[0], friction, room.sum_only, charged, cone)
    return left <= HELD * rounding_scale(cone.passive)


@kernel
def left_by_friction(contacts: ContactSet, friction: float, solver: OnsetRoom) -> float:
    """Return what contact forces with this friction leave of the load, in lengths of the terms."""
    cone = solver.cone
    clear_cone(cone, solver.load, WRENCH, solver.load_terms)
    charged = bool(np.bool_(False))
    left = cone_residual(contacts.rows, contacts.used[0], friction, solver.load, charged, cone)
    return left / rounding_scale(cone.passive)


@kernel
def spare_friction(contacts: ContactSet, friction: float, room: JudgeRoom) -> None:
    """Take the forces of a balance with a little less friction, if there is one: they lie inside the cones, not on
    them, so that no contact looks as if it were about to slip.
    """
    left = left_by_friction(contacts, friction, room.solver)
    if left <= HELD:
        write_forces(room.solver.cone, friction, contacts.rows, contacts.used[0])
        room.solver.residual = left


@entry_kernel
def prove(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: float,
    size_m: float,
    tolerances: KernelTolerances,
    at: ProofRoom,
) -> tuple[int, int, int]:
    """Judge a pose; return (code of the proof, code of stability, number of undetermined freedoms).

    Parameters
    ----------
    geometry, body, load
        The scene, boxes as seen from the centre of gravity, and the load that acts.
    position, quaternion
        Centre of gravity, metres, and unit quaternion (w, x, y, z).
    friction, size_m, tolerances
        Coefficient of friction, the scene's size in metres, and what counts as touching.
    at
        Filled: the proof.
    """
    if not stand_at(geometry, body, position, quaternion, load, tolerances.touch_m, at):
        return TOO_MANY_CONTACTS, STABLE_REST, 0
    contacts, room = at.contacts, at.rooms[0]
    code = onset(contacts, friction, room.solver)
    if code > HELD_BY_FRICTION:
        if code != MOVES:  # no balance, and no motion found either: what is left of the load separates them
            room.solver.residual = left_by_friction(contacts, friction, room.solver)
            for k in range(6):
                room.solver.y[k] = room.solver.cone.passive.residual[k]
        return PROVEN_MOVES, STABLE_REST, 0
    frame = frame_at(body, quaternion)
    clear(room.rest.ways, WRENCH, 1.0)
    one_choice = has_one_choice(contacts)
    proof, steady = judge_faces(at, code, one_choice, friction, load, quaternion, frame, size_m)
    if not one_choice:
        put_best_faces_back(contacts)
    if code != HELD_WITHOUT_FRICTION:
        room.wedged = proof != PROVEN_UNIQUE and has_self_stress(contacts, friction, room)
    if not one_choice:
        if code != HELD_WITHOUT_FRICTION:
            spare_friction(contacts, (1.0 - RESERVE) * friction, room)
        find_held(contacts, friction, room.rest, at.system)
    find_shared(contacts, room.rest)
    return proof, steady, room.rest.ways.used


@kernel
def judge_faces(
    at: ProofRoom,
    code: int,
    one_choice: bool,
    friction: float,
    load: PhaseLoad,
    quaternion: Quaternion,
    frame: Frame,
    size_m: float,
) -> tuple[int, int]:
    """Return (code of the proof, code of stability) of a rest: the least sure of all combinations of faces.

    Where there is one choice of faces only, its onset, with this code, has been solved, and its forces stay.
    """
    contacts, room, solver = at.contacts, at.rooms[0], at.rooms[0].solver
    every = bool(np.bool_(True))
    proof, steady = PROVEN_WITHOUT_FRICTION, STABLE_REST
    for _ in range(COMBINATIONS_LIMIT):
        if not one_choice:
            code = onset_with_faces(
                contacts.rows, contacts.used[0], friction, solver.load, solver.load_terms, solver.trial, solver
            )
        if code != HELD_WITHOUT_FRICTION:
            spare_friction(contacts, (1.0 - RESERVE) * friction, room)
        with_these = stability(
            contacts, friction, load, quaternion, frame, solver.load_terms, size_m, room.rest, at.system
        )
        steady = max(steady, with_these)
        if code != HELD_WITHOUT_FRICTION:
            answer = UNIQUE
            if not rest_is_sure(contacts, friction, solver.load, solver.load_terms, room.sure, room.rest, at.system):
                keep_forces(contacts.rows, contacts.used[0])
                answer = other_onset(contacts, friction, solver.load, room.modes, solver.newton, at.system)
                put_forces_back(contacts.rows, contacts.used[0])
            if answer == OTHER_FOUND:
                return OTHER_ONSET, steady
            proof = max(proof, PROVEN_UNIQUE if answer == UNIQUE else UNIQUENESS_NOT_SHOWN)
        if not choose_next_faces(contacts, every):
            return proof, steady
    return (proof if proof == PROVEN_WITHOUT_FRICTION else UNIQUENESS_NOT_SHOWN), max(steady, MARGINAL)


@kernel
def step_to_balance(contacts: ContactSet, friction: float, cone: ConeRoom) -> float:
    """Return by how much more friction the residual r would vanish, to first order: |r|^2 / sum f_n |r_t|."""
    write_forces(cone, friction, contacts.rows, contacts.used[0])
    gain = 0.0
    for i in range(contacts.used[0]):
        gain += contacts.rows[i].forces[0] * steepest_tangent(contacts.rows[i], cone.passive.residual)[0]
    left = length(cone.passive.residual, 6)
    return left * left / gain if gain > 0.0 else math.inf


@kernel
def least_friction(contacts: ContactSet, solver: OnsetRoom) -> float:
    """Return the least coefficient at which one choice of faces balances the load (5.17); inf: none.

    Bisection, and Newton's method where the residual falls straight to zero: there the last step is taken from a
    residual that is still large enough to be sure of its digits.
    """
    low, high = float(np.float64(0.0)), 1.0
    if left_by_friction(contacts, low, solver) <= BALANCED:
        return 0.0
    while left_by_friction(contacts, high, solver) > HELD:
        low, high = high, 4.0 * high
        if high > FRICTION_GREATEST:
            return math.inf
    for _ in range(BISECTIONS):
        left = left_by_friction(contacts, low, solver)
        following = low + step_to_balance(contacts, low, solver.cone)
        if left <= SURE:
            return min(following, high)
        if not low < following < high:
            following = 0.5 * (low + high)
        if following in (low, high):
            break
        if left_by_friction(contacts, following, solver) <= HELD:
            high = following
            following = 0.5 * (low + high)
            if left_by_friction(contacts, following, solver) <= HELD:
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
    load: PhaseLoad,
    tolerances: KernelTolerances,
    at: ProofRoom,
) -> float:
    """Return the least coefficient of friction at which the contacts can balance the load at a pose (5.17); inf: none.

    Parameters as for `prove`.
    """
    if not stand_at(geometry, body, position, quaternion, load, tolerances.touch_m, at):
        return math.nan
    least = 0.0
    every = bool(np.bool_(False))
    for _ in range(COMBINATIONS_LIMIT):
        least = max(least, least_friction(at.contacts, at.rooms[0].solver))
        write_forces(at.rooms[0].solver.cone, least, at.contacts.rows, at.contacts.used[0])
        if least == math.inf or not choose_next_faces(at.contacts, every):
            return least
    return math.nan
