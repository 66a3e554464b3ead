"""Whether the object is caged, with bounds that no motion can pass: equations (7.7) to (7.10).

The polytope of the start, each row moved out by more than what linearising leaves out over the whole polytope, has in
every pose on its boundary a point inside the object. No way leads out, then, and its extents bound the play.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.linear_program import FAILED, OPTIMAL, UNBOUNDED, solve_program
from cagepose.kernels.algebra.program_bound import dual_bound
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_record
from cagepose.kernels.algebra.vector import Vector, cross, norm, row, scaled, vector_from
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.goal import PITCH, SHIFT, YAW, Goal, write_slope
from cagepose.kernels.play.remainder import gap_left_out, spread, turning_left_out
from cagepose.kernels.play.rows import PlayRoom, write_start

CAGED, FREE, RAN_OFF, TOO_LARGE, UNSOLVED = range(5)
KEPT, OFF_EDGE, THROUGH = range(3)
"""What becomes of a row: its point may run off the face sideways, or come out behind the box."""
ROUNDS = 60
"""Each moves the rows out once; some five are usual, and what has not closed by then grows without end."""
SPARE = 1.02
"""Rows are moved out by this much more than they must be, so that the next round closes."""
MOST_LEFT_OVER = 0.01
"""Of an objective: a program whose multipliers miss it by more has no proof."""
LARGEST_TURN = 1.0
"""Radians. The bounds hold up to pi, but are of no use beyond this."""
ROUNDING = 1e-12
"""Lengths of the scene, and radians. Added to each bound: a thousand times the rounding of one gap."""


class Certificate:
    """The polytope that holds every pose, or why there is none; a record.

    Attributes
    ----------
    outcome
        CAGED, FREE (it is unbounded), RAN_OFF (it is, without the rows of points that may leave their faces),
        TOO_LARGE: what linearising leaves out grows with the polytope without end, or UNSOLVED: a program failed.
    worst
        The row that grew most; where the outcome is RAN_OFF, the one with the smallest gap of those given up; -1: none.
    n_rounds
        How often the rows were moved out.
    least, greatest
        Extents of the polytope, travel in lengths of the scene, turn in radians.
    travel, turn
        The largest magnitudes of each component.
    reach
        The largest of all magnitudes; infinite before it is known.
    slack
        Lengths of the scene: how deep a point may be without being inside.
    """

    outcome: int
    worst: int
    n_rounds: int
    least: Annotated[FloatArray, 6]
    greatest: Annotated[FloatArray, 6]
    travel: Annotated[FloatArray, 3]
    turn: Annotated[FloatArray, 3]
    reach: float
    slack: float


class CertificateRoom(NamedTuple):
    """Room for one certificate.

    Attributes
    ----------
    gaps, moved_out
        Bounds of the rows at the start, and how far they are moved out, (n_points * n_boxes,), lengths of the scene.
    fates
        KEPT, or why a row no longer counts.
    lost_at
        The twist of the polytope at which such a row's point is farthest off its face, (n_points * n_boxes, 6); NaN:
        none is known.
    certificate
        The result.
    """

    gaps: FloatArray
    moved_out: FloatArray
    fates: IntArray
    lost_at: FloatArray
    certificate: Certificate


def empty_certificate_room(n_pairs: int) -> CertificateRoom:
    """Return room for a scene (plain Python)."""
    return CertificateRoom(
        np.zeros(n_pairs),
        np.zeros(n_pairs),
        np.zeros(n_pairs, np.int64),
        np.zeros((n_pairs, 6)),
        empty_record(Certificate),
    )


@kernel
def bound_program(room: PlayRoom, certificate: Certificate) -> float:
    """Bound ``room.program.objective`` over the polytope from above (7.12); inf: there is no bound."""
    room.program.basis[0] = -1
    if solve_program(room.rows, room.bounds, room.program) != OPTIMAL:
        return math.inf
    bound, left_over = dual_bound(room.rows, room.bounds, room.program)
    return bound + (left_over * certificate.reach if left_over > 0.0 else 0.0)


@kernel
def bound_extents(room: PlayRoom, certificate: Certificate) -> int:
    """Bound each unknown over the polytope (7.12); OPTIMAL, UNBOUNDED, or how a program failed."""
    objective = room.program.objective
    largest, most_left_over = 0.0, 0.0
    for side in range(12):
        k, sign = side % 6, (1.0 if side < 6 else -1.0)
        for other in range(6):
            objective[other] = sign if other == k else 0.0
        room.program.basis[0] = -1
        outcome = solve_program(room.rows, room.bounds, room.program)
        if outcome != OPTIMAL:
            return outcome
        bound, left_over = dual_bound(room.rows, room.bounds, room.program)
        largest, most_left_over = max(largest, bound), max(most_left_over, left_over)
        if side < 6:
            certificate.greatest[k] = bound
        else:
            certificate.least[k] = -bound
    if most_left_over > MOST_LEFT_OVER:
        return FAILED
    certificate.reach = largest / (1.0 - most_left_over)
    spare = most_left_over * certificate.reach
    for k in range(6):
        certificate.greatest[k] += spare
        certificate.least[k] -= spare
    for k in range(3):
        certificate.travel[k] = max(-certificate.least[k], certificate.greatest[k])
        certificate.turn[k] = max(-certificate.least[3 + k], certificate.greatest[3 + k])
    return OPTIMAL


@kernel
def is_within(
    room: PlayRoom,
    certificate: Certificate,
    axis: Vector,
    moment: Vector,
    here: float,
    left: float,
    lost_at: FloatArray,
) -> bool:
    """Whether |here - (axis . t + moment . w)| stays below ``left`` in the whole polytope; if not, write where.

    Asked of the extents first, then of the polytope itself.
    """
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    if abs(here) + spread(axis, travel) + spread(moment, turn) < left:
        return True
    objective = room.program.objective
    for side in range(2):
        sign = 2.0 * side - 1.0
        for k in range(3):
            objective[k] = sign * axis[k]
            objective[3 + k] = sign * moment[k]
        if bound_program(room, certificate) - sign * here >= left:
            for k in range(6):
                lost_at[k] = room.program.x_near[k]
            return False
    return True


@kernel
def fate_of(geometry: Geometry, pair: int, length_m: float, room: PlayRoom, work: CertificateRoom) -> int:
    """Return KEPT if the point stays over its face and above the opposite one in the whole polytope (7.9)."""
    certificate = work.certificate
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    point, box, face = pair // geometry.n_own_boxes, pair % geometry.n_own_boxes, room.faces[pair]
    arm = row(room.arms, pair)
    _, left_out = gap_left_out(row(room.rows, pair), arm, travel, turn)
    deepest = work.moved_out[pair] + left_out + certificate.slack  # a point that starts inside is within the slack
    if deepest + certificate.slack >= 2.0 * geometry.half_sizes[box, face % 3] / length_m:
        for k in range(6):
            work.lost_at[pair, k] = math.nan
        return THROUGH
    for step in range(1, 3):
        k = (face + step) % 3
        columns = room.placement.box_rotations[box]
        axis = (columns[0, k], columns[1, k], columns[2, k])
        here = room.placement.points_box[box, k, point] / length_m
        _, left_out = gap_left_out(axis, arm, travel, turn)
        left = geometry.half_sizes[box, k] / length_m - left_out - certificate.slack
        if not is_within(room, certificate, axis, cross(arm, axis), here, left, work.lost_at[pair]):
            return OFF_EDGE
    return KEPT


@kernel
def move_out(geometry: Geometry, length_m: float, room: PlayRoom, work: CertificateRoom) -> bool:
    """Compare each row with what linearising leaves out; True: every row is far enough out, and its point stays."""
    certificate = work.certificate
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    closed = True
    most = 0.0
    for pair in range(len(work.gaps)):
        if work.fates[pair] != KEPT:
            continue
        work.fates[pair] = fate_of(geometry, pair, length_m, room, work)
        if work.fates[pair] != KEPT:
            closed = False
            continue
        above, _ = gap_left_out(row(room.rows, pair), row(room.arms, pair), travel, turn)
        if above + certificate.slack >= work.moved_out[pair]:
            if above - work.moved_out[pair] > most:
                most, certificate.worst = above - work.moved_out[pair], pair
            work.moved_out[pair] = SPARE * above + 2.0 * certificate.slack
            closed = False
    return closed


@kernel
def write_bounds(room: PlayRoom, work: CertificateRoom) -> None:
    for pair in range(len(work.gaps)):
        room.bounds[pair] = work.gaps[pair] + work.moved_out[pair] if work.fates[pair] == KEPT else math.inf


@kernel
def tightest_given_up(work: CertificateRoom) -> int:
    """Return the row with the smallest gap of those that no longer count; -1: all do."""
    tightest = -1
    for pair in range(len(work.gaps)):
        if work.fates[pair] != KEPT and (tightest < 0 or work.gaps[pair] < work.gaps[tightest]):
            tightest = pair
    return tightest


@kernel
def close_polytope(geometry: Geometry, length_m: float, room: PlayRoom, work: CertificateRoom) -> int:
    """Move the rows out until what linearising leaves out is less (7.7)."""
    certificate = work.certificate
    for n_rounds in range(ROUNDS):
        certificate.n_rounds = n_rounds + 1
        write_bounds(room, work)
        outcome = bound_extents(room, certificate)
        if outcome == UNBOUNDED:
            certificate.worst = tightest_given_up(work)
            return FREE if certificate.worst < 0 else RAN_OFF
        if outcome != OPTIMAL:
            return UNSOLVED
        if norm(vector_from(certificate.turn)) > LARGEST_TURN:
            return TOO_LARGE
        if move_out(geometry, length_m, room, work):
            return CAGED
    return TOO_LARGE


@kernel
def angle_bound(goal: Goal, certificate: Certificate) -> float:
    """Bound a yaw, pitch or roll (7.10), its sign applied."""
    turn = certificate.turn
    k = 5 - goal.kind  # components of w: roll about x, pitch about y, yaw about z
    one, other = (k + 1) % 3 + 3, (k + 2) % 3 + 3
    bound = certificate.greatest[k] if goal.sign > 0.0 else -certificate.least[k]
    sine = max(bound, 0.0) + 0.5 * turn[one - 3] * turn[other - 3] + ROUNDING
    if goal.kind == PITCH:
        return math.asin(min(sine, 1.0))
    cosine = 1.0 - 0.5 * (turn[1] ** 2 + (turn[2] ** 2 if goal.kind == YAW else turn[0] ** 2))
    return math.atan2(sine, cosine)


@kernel
def shift_bound(goal: Goal, length_m: float, room: PlayRoom, certificate: Certificate) -> float:
    """Bound how far points go, its sign applied, metres: by a program, and by (7.8) for what it leaves out."""
    factor = write_slope(goal, (1.0, 0.0, 0.0, 0.0), length_m, room)
    above = 0.0
    for i in range(2):
        direction = scaled(row(goal.directions, i), goal.sign)
        arm = scaled(row(goal.starts, i), 1.0 / length_m)
        above += turning_left_out(direction, arm, vector_from(certificate.turn))[0]
    return length_m * (factor * bound_program(room, certificate) + above + ROUNDING)


@entry
def certify(
    geometry: Geometry,
    length_m: float,
    touch_m: float,
    goals: Rows[Goal],
    bounds: FloatArray,
    room: PlayRoom,
    work: CertificateRoom,
) -> None:
    """Prove that the object is caged, and bound each goal.

    Parameters
    ----------
    geometry, length_m, goals
        As in `cagepose.kernels.play.search.find_play`.
    touch_m
        A point that is no deeper than this only touches: the proof holds for poses that are so deep, too. It is far
        more than the rounding of the scene.
    bounds
        Where caged: the greatest value that each goal could have, its sign applied, (n_goals,), radians or metres.
    room, work
        See there; ``work.certificate`` is the result.
    """
    write_start(geometry, length_m, room)
    for pair in range(len(work.gaps)):
        work.gaps[pair] = room.bounds[pair]
        work.moved_out[pair] = 0.0
        work.fates[pair] = KEPT
    certificate = work.certificate
    certificate.worst = -1
    certificate.reach = math.inf
    certificate.slack = touch_m / length_m + ROUNDING
    certificate.outcome = close_polytope(geometry, length_m, room, work)
    if certificate.outcome == CAGED:
        for i in range(len(goals)):
            if goals[i].kind == SHIFT:
                bounds[i] = shift_bound(goals[i], length_m, room, certificate)
            else:
                bounds[i] = angle_bound(goals[i], certificate)
