"""Whether the object is caged, with bounds that no motion can pass: equations (7.7) to (7.10).

The polytope of the start, each row moved out by more than what linearising leaves out over the whole polytope, has in
every pose on its boundary a point inside the object. No way leads out, then, and its extents bound the play.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.linear_program import FAILED, OPTIMAL, UNBOUNDED, solve_program
from cagepose.kernels.algebra.program_bound import dual_bound, extents
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_record
from cagepose.kernels.algebra.vector import Vector, cross, norm, row, scaled, vector_from
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.goal import PITCH, SHIFT, YAW, Goal, write_slope
from cagepose.kernels.play.polytope import START_MOTION, PlayWorkspace, write_start
from cagepose.kernels.play.remainder import gap_left_out, spread, turning_left_out
from cagepose.kernels.play.tolerances import MOST_MISSING, ROUNDING_OF_TERMS

CAGED, FREE, RAN_OFF, TOO_LARGE, UNSOLVED = range(5)
KEPT, OFF_EDGE, THROUGH = range(3)
"""Status of a row: kept, or given up, as its point may run off the face sideways, or come out behind the box."""
MOST_ROUNDS = 60
"""Each round moves the rows out once. Some five are usual, and what has not closed by then grows without end."""
SPARE_FACTOR = 1.02
"""Rows are moved out by this much more than they must be, so that the next round closes."""
LARGEST_TURN_RAD = 1.0
"""Radians. The bounds hold up to pi, but are of no use beyond this."""


class Certificate:
    """The polytope that holds every pose, or why there is none; a record.

    Attributes
    ----------
    outcome
        CAGED, FREE (it is unbounded), RAN_OFF (it is, without the rows of points that may leave their faces),
        TOO_LARGE: what linearising leaves out grows with the polytope without end, or UNSOLVED: a program failed.
    worst
        The row that grew most; where the outcome is RAN_OFF, the one with the smallest gap of those given up; -1: none.
    least, greatest
        Extents of the polytope, travel in lengths of the scene, turn in radians.
    travel, turn
        The largest magnitudes of each component.
    reach
        The largest of all magnitudes.
    slack
        Lengths of the scene: how deep a point may be without being inside.
    """

    outcome: int
    worst: int
    least: Annotated[FloatArray, 6]
    greatest: Annotated[FloatArray, 6]
    travel: Annotated[FloatArray, 3]
    turn: Annotated[FloatArray, 3]
    reach: float
    slack: float


class CertificateWorkspace(NamedTuple):
    """Memory for one certificate.

    Attributes
    ----------
    gaps, moved_out
        Bounds of the rows at the start, and how far they are moved out, (n_pairs,), lengths of the scene.
    status
        KEPT, or why a row no longer counts, (n_pairs,).
    lost_at
        The twist of the polytope at which such a row's point is farthest off its face, (n_pairs, 6); NaN: none is
        known.
    certificate
        The result.
    """

    gaps: FloatArray
    moved_out: FloatArray
    status: IntArray
    lost_at: FloatArray
    certificate: Certificate


def empty_certificate_workspace(n_pairs: int) -> CertificateWorkspace:
    """Return a workspace for a scene (plain Python)."""
    return CertificateWorkspace(
        np.zeros(n_pairs),
        np.zeros(n_pairs),
        np.zeros(n_pairs, np.int64),
        np.zeros((n_pairs, 6)),
        empty_record(Certificate),
    )


@kernel
def bound_program(work: PlayWorkspace, certificate: Certificate) -> float:
    """Bound ``work.program.objective`` over the polytope from above (7.12); inf: there is no bound."""
    work.program.passive.used = 0
    if solve_program(work.rows, work.bounds, work.program) != OPTIMAL:
        return math.inf
    bound, missing = dual_bound(work.rows, work.bounds, work.program)
    return bound + missing * certificate.reach


@kernel
def bound_extents(work: PlayWorkspace, certificate: Certificate) -> int:
    """Bound each unknown over the polytope (7.12); OPTIMAL, UNBOUNDED, or how a program failed."""
    least, greatest = certificate.least, certificate.greatest
    outcome, missing = extents(work.rows, work.bounds, work.program, least, greatest)
    if outcome != OPTIMAL:
        return outcome
    if missing > MOST_MISSING:
        return FAILED
    largest = 0.0
    for k in range(6):
        largest = max(largest, greatest[k], -least[k])
    if largest == math.inf:
        return UNBOUNDED
    certificate.reach = largest / (1.0 - missing)
    for k in range(6):
        greatest[k] += missing * certificate.reach
        least[k] -= missing * certificate.reach
    for k in range(3):
        certificate.travel[k] = max(-least[k], greatest[k])
        certificate.turn[k] = max(-least[3 + k], greatest[3 + k])
    return OPTIMAL


@kernel
def is_within(
    work: PlayWorkspace,
    certificate: Certificate,
    axis: Vector,
    moment: Vector,
    here: float,
    limit: float,
    lost_at: FloatArray,
) -> bool:
    """Whether |here - (axis . t + moment . w)| stays below ``limit`` in the whole polytope; if not, write where.

    Asked of the extents first, then of the polytope itself.
    """
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    if abs(here) + spread(axis, travel) + spread(moment, turn) < limit:
        return True
    objective = work.program.objective
    for side in range(2):
        sign = 2.0 * side - 1.0
        for k in range(3):
            objective[k] = sign * axis[k]
            objective[3 + k] = sign * moment[k]
        if bound_program(work, certificate) - sign * here >= limit:
            for k in range(6):
                lost_at[k] = work.program.x[k]
            return False
    return True


@kernel
def status_of(geometry: BoxesAndPoints, pair: int, work: PlayWorkspace, proof: CertificateWorkspace) -> int:
    """Return KEPT if the point stays over its face and above the opposite one in the whole polytope (7.9)."""
    certificate = proof.certificate
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    point, box, face = work.points[pair], work.boxes[pair], work.faces[pair]
    arm = row(work.arms, pair)
    _, left_out = gap_left_out(row(work.rows, pair), arm, travel, turn)
    deepest = proof.moved_out[pair] + left_out + certificate.slack  # a point that starts inside is within the slack
    if deepest + certificate.slack >= 2.0 * geometry.half_sizes[box, face % 3]:
        for k in range(6):
            proof.lost_at[pair, k] = math.nan
        return THROUGH
    columns = work.placement.box_rotations[box]
    for step in range(1, 3):
        k = (face + step) % 3
        axis = (columns[0, k], columns[1, k], columns[2, k])
        _, left_out = gap_left_out(axis, arm, travel, turn)
        limit = geometry.half_sizes[box, k] - left_out - certificate.slack
        here = work.placement.points_box[box, k, point]
        if not is_within(work, certificate, axis, cross(arm, axis), here, limit, proof.lost_at[pair]):
            return OFF_EDGE
    return KEPT


@kernel
def move_out(geometry: BoxesAndPoints, work: PlayWorkspace, proof: CertificateWorkspace) -> bool:
    """Compare each row with what linearising leaves out; True: every row is far enough out, and its point stays."""
    certificate = proof.certificate
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    is_closed, most = True, 0.0
    for pair in range(len(proof.gaps)):
        if proof.status[pair] != KEPT:
            continue
        proof.status[pair] = status_of(geometry, pair, work, proof)
        if proof.status[pair] != KEPT:
            is_closed = False
            continue
        above, _ = gap_left_out(row(work.rows, pair), row(work.arms, pair), travel, turn)
        if above + certificate.slack >= proof.moved_out[pair]:
            if above - proof.moved_out[pair] > most:
                most, certificate.worst = above - proof.moved_out[pair], pair
            proof.moved_out[pair] = SPARE_FACTOR * above + 2.0 * certificate.slack
            is_closed = False
    return is_closed


@kernel
def tightest_given_up(proof: CertificateWorkspace) -> int:
    """Return the row with the smallest gap of those that no longer count; -1: all do."""
    tightest = -1
    for pair in range(len(proof.gaps)):
        if proof.status[pair] != KEPT and (tightest < 0 or proof.gaps[pair] < proof.gaps[tightest]):
            tightest = pair
    return tightest


@kernel
def close_polytope(geometry: BoxesAndPoints, work: PlayWorkspace, proof: CertificateWorkspace) -> int:
    """Move the rows out until what linearising leaves out is less (7.7)."""
    certificate = proof.certificate
    for _ in range(MOST_ROUNDS):
        for pair in range(len(proof.gaps)):
            is_kept = proof.status[pair] == KEPT
            work.bounds[pair] = proof.gaps[pair] + proof.moved_out[pair] if is_kept else math.inf
        outcome = bound_extents(work, certificate)
        if outcome == UNBOUNDED:
            certificate.worst = tightest_given_up(proof)
            return FREE if certificate.worst < 0 else RAN_OFF
        if outcome != OPTIMAL:
            return UNSOLVED
        if norm(vector_from(certificate.turn)) > LARGEST_TURN_RAD:
            return TOO_LARGE
        if move_out(geometry, work, proof):
            return CAGED
    return TOO_LARGE


@kernel
def angle_bound(goal: Goal, certificate: Certificate) -> float:
    """Bound a yaw, pitch or roll (7.10), its sign applied."""
    turn = certificate.turn
    k = 5 - goal.kind  # components of w: roll about x, pitch about y, yaw about z
    one, other = (k + 1) % 3, (k + 2) % 3
    bound = certificate.greatest[k] if goal.sign > 0.0 else -certificate.least[k]
    sine = max(bound, 0.0) + 0.5 * turn[one] * turn[other] + ROUNDING_OF_TERMS
    if goal.kind == PITCH:
        return math.asin(min(sine, 1.0))
    cosine = 1.0 - 0.5 * (turn[1] ** 2 + (turn[2] ** 2 if goal.kind == YAW else turn[0] ** 2))
    return math.atan2(sine, cosine)


@kernel
def shift_bound(goal: Goal, work: PlayWorkspace, certificate: Certificate) -> float:
    """Bound how far points go, its sign applied: by a program, and by (7.8) for what it leaves out."""
    factor = write_slope(goal, START_MOTION, work.program.objective)
    above = 0.0
    for i in range(2):
        direction = scaled(row(goal.directions, i), goal.sign)
        above += turning_left_out(direction, row(goal.starts, i), vector_from(certificate.turn))[0]
    return factor * bound_program(work, certificate) + above + ROUNDING_OF_TERMS


@entry
def certify(
    geometry: BoxesAndPoints,
    touch: float,
    goals: Rows[Goal],
    bounds: FloatArray,
    work: PlayWorkspace,
    proof: CertificateWorkspace,
) -> None:
    """Prove that the object is caged, and bound each goal.

    Parameters
    ----------
    geometry, goals
        As in `cagepose.kernels.play.search.find_play`.
    touch
        A point that is no deeper than this only touches, lengths of the scene: the proof holds for poses that are so
        deep, too. It is far more than the rounding of the scene.
    bounds
        Where caged: the greatest value that each goal could have, its sign applied, (n_goals,), radians or lengths of
        the scene.
    work, proof
        See there; ``proof.certificate`` is the result.
    """
    write_start(geometry, work)
    for pair in range(len(proof.gaps)):
        proof.gaps[pair] = work.bounds[pair]
        proof.moved_out[pair] = 0.0
        proof.status[pair] = KEPT
    certificate = proof.certificate
    certificate.worst = -1
    certificate.slack = touch + ROUNDING_OF_TERMS
    certificate.outcome = close_polytope(geometry, work, proof)
    if certificate.outcome == CAGED:
        for i in range(len(goals)):
            if goals[i].kind == SHIFT:
                bounds[i] = shift_bound(goals[i], work, certificate)
            else:
                bounds[i] = angle_bound(goals[i], certificate)
