"""What a proof leaves open: whether rest is the only onset, and how an object that moves begins to."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import rounding_scale
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.contact.balance import balance_with_faces
from cagepose.kernels.contact.cone import HELD, N_ROWS, clear_cone, cone_residual
from cagepose.kernels.contact.contact_set import (
    ContactSet,
    choose_first_faces,
    choose_next_faces,
    keep_faces,
    put_best_faces_back,
)
from cagepose.kernels.contact.metric import Body, PhaseLoad
from cagepose.kernels.contact.onset import COMBINATIONS_LIMIT, HELD_BY_FRICTION, MOVES, onset
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.proof import (
    OTHER_ONSET,
    PROVEN_MOVES,
    PROVEN_UNIQUE,
    UNIQUENESS_NOT_SHOWN,
    AnalysisWorkspace,
    ProofWorkspace,
    prove,
)
from cagepose.kernels.stability.strong import OTHER_FOUND, UNIQUE, other_onset


@kernel
def has_self_stress(contacts: ContactSet, friction: float, room: AnalysisWorkspace) -> bool:
    """Whether contact forces other than zero, inside their cones, balance each other: a wedge (5.16).

    The sum of their normal forces is asked to be 1, and nothing else.
    """
    cone = room.solver.cone
    clear_cone(cone, room.sum_only, N_ROWS, 1.0)
    charged = False
    left = cone_residual(contacts.rows, contacts.used[0], friction, room.sum_only, charged, cone)
    return left <= HELD * rounding_scale(cone.passive)


@kernel
def search_faces(friction: float, at: ProofWorkspace) -> int:
    """Return the code of the proof, that of the first combination of faces with which rest is not the only onset."""
    contacts, room, solver = at.contacts, at.rooms[0], at.rooms[0].solver
    every = True
    choose_first_faces(contacts)
    for _ in range(COMBINATIONS_LIMIT):
        code = balance_with_faces(contacts.rows, contacts.used[0], friction, solver)
        if code == HELD_BY_FRICTION:
            answer = other_onset(contacts, friction, solver.load, room.tree, solver.newton, at.system)
            if answer != UNIQUE:
                return OTHER_ONSET if answer == OTHER_FOUND else UNIQUENESS_NOT_SHOWN
        if not choose_next_faces(contacts, every):
            return PROVEN_UNIQUE
    return UNIQUENESS_NOT_SHOWN


@kernel
def search_onsets(friction: float, at: ProofWorkspace) -> int:
    """Ask whether a rest that needs friction is the only onset (5.13).

    Parameters
    ----------
    friction
        Coefficient of friction.
    at
        As left by the proof. Filled: the other onset, if one is found, and whether the contacts are wedged.

    Returns
    -------
    int
        PROVEN_UNIQUE, OTHER_ONSET or UNIQUENESS_NOT_SHOWN.
    """
    contacts, room = at.contacts, at.rooms[0]
    left = room.solver.residual
    keep_faces(contacts)
    proof = search_faces(friction, at)
    put_best_faces_back(contacts)
    room.solver.residual = left
    room.wedged = proof != PROVEN_UNIQUE and has_self_stress(contacts, friction, room)
    return proof


@kernel
def first_motion(friction: float, at: ProofWorkspace) -> None:
    """Write into ``at.rooms[0].solver.y`` how an object begins to move that does so by `prove`.

    It is the onset that obeys Coulomb's law (5.7), and the residual is then the least that contact forces leave of the
    load. Where none is found, it is the twist of the proof (5.6), with the residual of that.

    Parameters
    ----------
    friction
        Coefficient of friction.
    at
        As left by the proof.
    """
    contacts, room, solver = at.contacts, at.rooms[0], at.rooms[0].solver
    choose_first_faces(contacts)
    if onset(contacts, friction, solver) != MOVES:
        solver.residual = room.twist_residual
        for k in range(6):
            solver.y[k] = room.twist[k]


@kernel
def judge(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: float,
    size_m: float,
    tolerances: KernelTolerances,
    at: ProofWorkspace,
) -> tuple[int, int, int]:
    """Judge a pose, with the search for another onset where rest needs friction, and the motion where the object moves.

    Parameters and result as for `cagepose.kernels.stability.proof.prove`.
    """
    at.rooms[0].wedged = False
    code, steady, n_undetermined = prove(geometry, body, position, quaternion, load, friction, size_m, tolerances, at)
    if code == UNIQUENESS_NOT_SHOWN:
        code = search_onsets(friction, at)
    elif code == PROVEN_MOVES:
        first_motion(friction, at)
    return code, steady, n_undetermined
