"""What a proof leaves open: whether rest is the only onset, and how an object that moves begins to."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.contact.edges import CHOICES_LIMIT, EVERY, first_choice, has_one_choice, keep_choice
from cagepose.kernels.contact.equilibrium import (
    AT_REST,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    equilibrium_of_choice,
    equilibrium_with_faces,
    next_choice_unlocked,
    return_to_choice,
)
from cagepose.kernels.contact.friction import Friction
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Body, Frame, frame_at
from cagepose.kernels.contact.onset import freest_motion
from cagepose.kernels.contact.self_stress import forget_locked, self_stress
from cagepose.kernels.contact.tolerances import RESIDUAL_AT_LIMIT
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.stability.clamp import parts_for_good
from cagepose.kernels.stability.proof import (
    OTHER_ONSET,
    PROVEN_MOVES,
    PROVEN_UNIQUE,
    UNIQUENESS_NOT_SHOWN,
    ProofWorkspace,
    prove,
)
from cagepose.kernels.stability.second_order import MARGINAL, STABLE_REST
from cagepose.kernels.stability.strong import OTHER_FOUND, UNIQUE, other_onset, other_onset_on_circles


@entry
def balance_with_faces(friction: float, at: ProofWorkspace) -> int:
    """Balance the load with the contacts that count, to first order; return the code, see `equilibrium_with_faces`.

    Parameters
    ----------
    friction
        Coefficient of friction.
    at
        As left by the proof of a rest. Filled: the forces.
    """
    solver = at.scratch[0].solver
    return equilibrium_with_faces(at.contacts, friction, AT_REST, solver.load, solver.load_terms, solver)


@entry
def search_with_faces(friction: float, at: ProofWorkspace) -> int:
    """Search for another onset with the contacts that count; return UNIQUE, OTHER_FOUND or NOT_SHOWN.

    Parameters
    ----------
    friction
        Coefficient of friction.
    at
        As left by the proof of a rest. Filled: the tree; the forces are those of another onset, or lost.
    """
    solver = at.scratch[0].solver
    return other_onset(at.contacts, friction, solver.load, at.scratch[0].tree, solver.newton, at.system)


@kernel
def search_faces(friction: float, frame: Frame, at: ProofWorkspace) -> int:
    """Return the code of the proof, that of the first combination of faces with which rest is not the only onset."""
    contacts, work, solver = at.contacts, at.scratch[0], at.scratch[0].solver
    forget_locked(contacts, solver)
    first_choice(contacts)
    one_choice = has_one_choice(contacts)
    is_known = one_choice and not solver.has_locked  # by the proof: friction balances the load, and nothing is locked
    for _ in range(CHOICES_LIMIT):
        code = HELD_BY_FRICTION
        if not is_known:
            code = equilibrium_of_choice(contacts, frame, friction, AT_REST, solver)
        if code == MOVES and not one_choice:
            return UNIQUENESS_NOT_SHOWN
        n_asked = contacts.used[0]
        if code != HELD_WITHOUT_FRICTION:  # MOVES of the one choice, which was balanced before, is rounding
            if solver.locked.used > 0:  # wrenches are without what that stops: no point is added
                answer = search_with_faces(friction, at)
            else:
                answer = other_onset_on_circles(
                    contacts, frame, friction, solver.load, solver.load_terms, work.tree, solver.newton, at.system
                )
            if answer != UNIQUE:
                return OTHER_ONSET if answer == OTHER_FOUND else UNIQUENESS_NOT_SHOWN
        if contacts.used[0] > n_asked and not one_choice:  # the choices before are asked with these points, too
            forget_locked(contacts, solver)
            first_choice(contacts)
            continue
        if not next_choice_unlocked(contacts, EVERY, solver):
            return PROVEN_UNIQUE
    return UNIQUENESS_NOT_SHOWN


@kernel
def search_onsets(friction: float, frame: Frame, at: ProofWorkspace) -> int:
    """Ask whether a rest that needs friction is the only onset (5.13).

    Parameters
    ----------
    friction, frame
        Coefficient of friction; the scaled coordinates at the pose.
    at
        As left by the proof. Filled: the other onset, if one is found, and whether the contacts are wedged; and, behind
        the contacts, further points of rims that were asked.

    Returns
    -------
    int
        PROVEN_UNIQUE, OTHER_ONSET or UNIQUENESS_NOT_SHOWN.
    """
    contacts, work = at.contacts, at.scratch[0]
    left, n_listed = work.solver.residual, contacts.used[0]
    keep_choice(contacts)
    proof = search_faces(friction, frame, at)
    forget_locked(contacts, work.solver)
    work.n_asked, contacts.used[0] = contacts.used[0], n_listed
    return_to_choice(contacts, frame, friction, AT_REST, work.solver)
    work.solver.residual = left
    work.wedged = proof != PROVEN_UNIQUE and self_stress(contacts, friction, work.solver.stress) <= RESIDUAL_AT_LIMIT
    return proof


@kernel
def is_lost(friction: float, frame: Frame, at: ProofWorkspace) -> bool:
    """Whether a rest beside which another motion can begin hangs on a contact that no load keeps closed."""
    contacts, work = at.contacts, at.scratch[0]
    left = work.solver.residual
    keep_choice(contacts)
    work.is_clamped = parts_for_good(contacts, friction, work.solver)
    return_to_choice(contacts, frame, friction, AT_REST, work.solver)
    work.solver.residual = left
    return bool(work.is_clamped)


@kernel
def first_motion(friction: float, frame: Frame, at: ProofWorkspace) -> None:
    """Write into ``at.scratch[0].solver.y`` how an object begins to move that does so by `prove`.

    It is the onset that obeys Coulomb's law (5.7), and the residual is then the least that contact forces leave of the
    load. Where none is found, it is the twist of the proof (5.6), with the residual of that.

    Parameters
    ----------
    friction, frame
        Coefficient of friction; the scaled coordinates at the pose.
    at
        As left by the proof.
    """
    contacts, work, solver = at.contacts, at.scratch[0], at.scratch[0].solver
    if freest_motion(contacts, frame, friction, solver) != MOVES:
        solver.residual = work.twist_residual
        for k in range(contacts.n_freedoms):
            solver.y[k] = work.twist[k]


@kernel
def judge(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: Friction,
    size_m: float,
    at: ProofWorkspace,
) -> tuple[int, int, int]:
    """Judge a pose, with the search for another onset where rest needs friction, and the motion where the object moves.

    Parameters and result as for `cagepose.kernels.stability.proof.prove`.
    """
    at.scratch[0].wedged = False
    code, steady, n_undetermined = prove(geometry, body, position, quaternion, load, friction, size_m, at)
    at.scratch[0].n_asked = at.contacts.used[0]
    if code == UNIQUENESS_NOT_SHOWN:
        frame = frame_at(body, quaternion)
        code = search_onsets(friction.greatest, frame, at)
        if code != PROVEN_UNIQUE and steady == STABLE_REST and is_lost(friction.greatest, frame, at):
            steady = MARGINAL
    elif code == PROVEN_MOVES:
        first_motion(friction.greatest, frame_at(body, quaternion), at)
    return code, steady, n_undetermined
