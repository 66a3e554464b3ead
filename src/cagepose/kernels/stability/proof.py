"""The verdict on one pose, with its proof: forces that balance the load, or a twist that none of them resists."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, WRENCH, System, clear, empty_system
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.geometry import Geometry, Placement, empty_placement, most_rows, place_object
from cagepose.kernels.contact.contact_set import ContactSet, contact_set_for
from cagepose.kernels.contact.edges import (
    CHOICES_LIMIT,
    EVERY,
    first_choice,
    has_one_choice,
)
from cagepose.kernels.contact.equilibrium import (
    AT_REST,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    UNSOLVED,
    equilibrium,
    equilibrium_of_choice,
    next_choice_unlocked,
    return_to_choice,
)
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.friction import Friction
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Body, Frame, ScaledVector, frame_at
from cagepose.kernels.contact.on_circle import drop_idle
from cagepose.kernels.contact.pressing import number_pressing, write_whole_load
from cagepose.kernels.contact.self_stress import forget_locked, write_locked
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.clamp import hangs_on_a_clamp
from cagepose.kernels.stability.contact_status import ContactStatus
from cagepose.kernels.stability.relaxation import N_COLUMNS
from cagepose.kernels.stability.second_order import (
    MARGINAL,
    STABLE_REST,
    UNSTABLE,
    StabilityWorkspace,
    find_held,
    find_shared,
    stability,
)
from cagepose.kernels.stability.strong import ModeTree

PROVEN_WITHOUT_FRICTION, PROVEN_UNIQUE, OTHER_ONSET, UNIQUENESS_NOT_SHOWN = 0, 1, 2, 3
TOO_MANY_CHOICES, PROVEN_MOVES, TOO_MANY_CONTACTS = 4, 5, 6
"""Codes of a proof."""


class AnalysisWorkspace:
    """Workspace of fixed size, and the answer; a record.

    Attributes
    ----------
    solver
        ``solver.residual``: what is left of the load; ``solver.y``: motion that begins, see `first_motion`.
    twist, twist_residual
        Scaled twist along which the load works and that no contact force resists (5.6), and what is left then.
    tree, n_asked
        The search for another onset. ``tree.y``: that of one that Coulomb's law allows. How many contacts were asked:
        behind those of the rest are further points of rims.
    rest
        Undetermined freedoms.
    wedged
        Whether the contacts can press against each other without a load; asked only by `proof_search`.
    is_clamped
        Whether a rest is marginal because it hangs on that.
    """

    solver: ContactWorkspace
    twist: ScaledVector
    twist_residual: float
    tree: ModeTree
    n_asked: int
    rest: StabilityWorkspace
    wedged: bool
    is_clamped: bool


class ProofWorkspace(NamedTuple):
    """Workspace for one proof: what is at the pose, where ``contacts`` hold the forces of a rest, scratch for all else,
    and that of a system.
    """

    placement: Placement
    contacts: ContactSet
    statuses: Rows[ContactStatus]
    scratch: Rows[AnalysisWorkspace]
    system: System


@kernel
def with_all_freedoms(at: ProofWorkspace) -> ProofWorkspace:
    """Return a workspace whose contacts are asked with the freedoms of the bodies that press, besides the object's."""
    contacts = at.contacts
    n_freedoms = WRENCH + number_pressing(contacts.pressing)
    asked = ContactSet(contacts.used, contacts.rows, contacts.states, contacts.bends, contacts.pressing, n_freedoms)
    return ProofWorkspace(at.placement, asked, at.statuses, at.scratch, at.system)


def empty_proof_workspace(geometry: Geometry) -> ProofWorkspace:
    """Return a workspace for one proof (plain Python)."""
    n_contacts, n_bodies = most_rows(geometry), len(geometry.cage.first_nodes) - 1
    n_freedoms = min(WRENCH + n_bodies - 1, MOST_FREEDOMS)  # what stands still does not press
    return ProofWorkspace(
        empty_placement(geometry),
        contact_set_for(geometry),
        empty_rows(ContactStatus, n_contacts),
        empty_rows(AnalysisWorkspace, 1),
        empty_system(max(N_COLUMNS, n_contacts), n_freedoms + 1),
    )


@kernel
def stand_at(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: Friction,
    at: ProofWorkspace,
) -> bool:
    """Fill placement, contacts and load at a pose; False: too many contacts."""
    frame = frame_at(body, quaternion)
    place_object(geometry, position, quaternion, at.placement)
    solver = at.scratch[0].solver
    contacts = at.contacts
    solver.load_terms = write_whole_load(
        load, contacts.pressing, position, quaternion, frame, contacts.n_freedoms, solver.load
    )
    return find_contacts(geometry, at.placement, friction, position, frame, at.contacts)


@kernel
def are_balanced(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: Friction,
    at: ProofWorkspace,
) -> bool:
    """Whether forces in the cones balance the object and all that presses at a pose. Filled: as by `stand_at`, and the
    forces.
    """
    if not stand_at(geometry, body, position, quaternion, load, friction, at):
        return False
    code = equilibrium(at.contacts, frame_at(body, quaternion), friction.greatest, AT_REST, at.scratch[0].solver)
    return code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION)


@kernel
def prove(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    load: PhaseLoad,
    friction: Friction,
    size_m: float,
    at: ProofWorkspace,
) -> tuple[int, int, int]:
    """Judge a pose; return (code of the proof, code of stability, number of undetermined freedoms).

    Whether a rest that needs friction is the only onset is not asked here, but by `search_onsets` in `proof_search`;
    where the object moves, `first_motion` says how.

    Parameters
    ----------
    geometry, body, load
        The scene, boxes as seen from the centre of gravity, and the load that acts.
    position, quaternion
        Centre of gravity, metres, and unit quaternion (w, x, y, z).
    friction, size_m
        Coefficients of friction, and the scene's size, metres.
    at
        Filled: the proof.
    """
    if not stand_at(geometry, body, position, quaternion, load, friction, at):
        at.scratch[0].solver.residual = 1.0  # no forces were asked for: all of the load is left
        return TOO_MANY_CONTACTS, STABLE_REST, 0
    contacts, scratch = at.contacts, at.scratch[0]
    frame = frame_at(body, quaternion)
    greatest, scratch.is_clamped = friction.greatest, False
    code = equilibrium(contacts, frame, greatest, AT_REST, scratch.solver)
    if code == MOVES:
        scratch.twist_residual = scratch.solver.residual
        for k in range(contacts.n_freedoms):
            scratch.twist[k] = scratch.solver.cone.passive.residual[k]
        return PROVEN_MOVES, STABLE_REST, 0
    drop_idle(contacts, scratch.solver.cone)
    left = scratch.solver.residual
    clear(scratch.rest.ways, contacts.n_freedoms, 1.0)
    if code == UNSOLVED:
        find_held(contacts, at.statuses, greatest, scratch.solver.locked, frame, scratch.rest, at.system)
        find_shared(contacts, at.statuses, scratch.rest)
        return TOO_MANY_CHOICES, MARGINAL, 0
    one_choice = has_one_choice(contacts)
    proof, steady = judge_faces(at, code, one_choice, greatest, load, position, quaternion, frame, size_m)
    if not one_choice:
        scratch.solver.residual = left
        find_held(contacts, at.statuses, greatest, scratch.solver.locked, frame, scratch.rest, at.system)
    find_shared(contacts, at.statuses, scratch.rest)
    return proof, steady, scratch.rest.ways.used


@kernel
def stability_of_rest(
    at: ProofWorkspace,
    friction: float,
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    size_m: float,
) -> int:
    """Return the code of stability of a rest with these faces; where it is not stable to first order and by curvature,
    what contacts without play stop counts as well.
    """
    contacts, rest, solver = at.contacts, at.scratch[0].rest, at.scratch[0].solver
    n_ways, terms, found = rest.ways.used, solver.load_terms, UNSTABLE
    for _ in range(2):
        rest.ways.used = n_ways
        code = stability(
            contacts,
            at.statuses,
            friction,
            solver.locked,
            load,
            position,
            quaternion,
            frame,
            terms,
            size_m,
            rest,
            at.system,
        )
        if code == STABLE_REST or solver.locked.used > 0:
            break
        found = code
        write_locked(contacts, frame, solver)
    if not solver.is_chained:
        return code
    solver.is_chained = solver.is_second_order or code < found  # else it makes no difference
    return max(code, MARGINAL)


@kernel
def judge_faces(
    at: ProofWorkspace,
    code: int,
    one_choice: bool,
    friction: float,
    load: PhaseLoad,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    size_m: float,
) -> tuple[int, int]:
    """Return (code of the proof, code of stability) of a rest: the least sure of all combinations of faces.

    Where there is one choice of faces only, its balance has this code; else those that are kept are chosen again.
    """
    contacts, solver = at.contacts, at.scratch[0].solver
    proof, steady, is_chained = PROVEN_WITHOUT_FRICTION, STABLE_REST, False
    if not one_choice:
        forget_locked(contacts, solver)
        first_choice(contacts)
    for _ in range(CHOICES_LIMIT):
        if not one_choice:
            code = equilibrium_of_choice(contacts, frame, friction, AT_REST, solver)
        steady = max(steady, stability_of_rest(at, friction, load, position, quaternion, frame, size_m))
        is_chained = is_chained or solver.is_chained
        if code != HELD_WITHOUT_FRICTION:
            proof = UNIQUENESS_NOT_SHOWN
            if steady == STABLE_REST and hangs_on_a_clamp(contacts, friction, solver):
                steady, at.scratch[0].is_clamped = MARGINAL, True
        if one_choice:
            return proof, steady
        if not next_choice_unlocked(contacts, EVERY, solver):
            break
    else:
        steady = max(steady, MARGINAL)
    return_to_choice(contacts, frame, friction, AT_REST, solver)
    solver.is_chained = is_chained
    return proof, steady
