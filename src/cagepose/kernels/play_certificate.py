"""Whether the object is caged, with bounds that no motion can pass: equations (7.7) to (7.10).

The polytope of the start, each row moved out by more than what linearising leaves out over the whole polytope, has in
every pose on its boundary a point inside the object. No way leads out, then, and its extents bound the play.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.geometry import Geometry, place_object
from cagepose.kernels.jit import entry_kernel, kernel
from cagepose.kernels.linear_program import OPTIMAL, extents, solve_program
from cagepose.kernels.play import PITCH, SHIFT, YAW, Goal, promised, write_slope
from cagepose.kernels.play_rows import PlayRoom, choose_faces, write_trust_region
from cagepose.kernels.record import FloatArray, IntArray, Rows, empty_record
from cagepose.kernels.vector import Vector, cross, dot, minus, norm, row, scaled, vector_from

CAGED, FREE, RAN_OFF, TOO_LARGE = range(4)
ROUNDS = 60
"""Each moves the rows out once; some five are usual, and what has not closed by then grows without end."""
SPARE = 1.02
"""Rows are moved out by this much more than they must be, so that the next round closes."""
LARGEST_TURN = 1.0
"""Radians. The bounds hold up to pi, but are of no use beyond this."""
ROUNDING = 1e-12
"""Lengths of the scene. Added to each bound: a thousand times the rounding of a program."""


class Certificate:
    """The polytope that holds every pose, or why there is none; a record.

    Attributes
    ----------
    outcome
        CAGED, FREE (it is unbounded), RAN_OFF (it is, without the rows of points that may run off their faces), or
        TOO_LARGE: what linearising leaves out grows with the polytope without end.
    worst
        The row that grew most; where the outcome is RAN_OFF, the one with the smallest gap of those given up.
    n_rounds
        How often the rows were moved out.
    least, greatest
        Extents of the polytope, travel in lengths of the scene, turn in radians.
    travel, turn
        The largest magnitudes of each component.
    """

    outcome: int
    worst: int
    n_rounds: int
    least: Annotated[FloatArray, 6]
    greatest: Annotated[FloatArray, 6]
    travel: Annotated[FloatArray, 3]
    turn: Annotated[FloatArray, 3]


class CertificateRoom(NamedTuple):
    """Room for one certificate.

    Attributes
    ----------
    gaps, moved_out
        Bounds of the rows at the start, and how far they are moved out, (n_points * n_boxes,), lengths of the scene.
    is_kept
        Whether a row counts.
    certificate
        The result.
    """

    gaps: FloatArray
    moved_out: FloatArray
    is_kept: IntArray
    certificate: Certificate


def empty_certificate_room(n_pairs: int) -> CertificateRoom:
    """Return room for a scene (plain Python)."""
    return CertificateRoom(np.zeros(n_pairs), np.zeros(n_pairs), np.zeros(n_pairs, np.int64), empty_record(Certificate))


@kernel
def spread(a: Vector, size: Vector) -> float:
    """Return the greatest a . w where |w_k| <= size_k."""
    return abs(a[0]) * size[0] + abs(a[1]) * size[1] + abs(a[2]) * size[2]


@kernel
def turning_left_out(a: Vector, arm: Vector, turn: Vector) -> tuple[float, float]:
    """Bound a . (exp(w) d - d - w x d) from above, and its magnitude, where |w_k| <= turn_k (7.8)."""
    along = dot(a, arm)
    across = minus(arm, scaled(a, along))
    size = norm(turn)
    mixed = 0.5 * spread(a, turn) * spread(across, turn)
    square = 0.5 * size * size * abs(along)
    cubic = size * size * size * norm(arm) / 6.0
    return mixed + cubic + (square if along < 0.0 else 0.0), mixed + cubic + square


@kernel
def gap_left_out(normal: Vector, arm: Vector, travel: Vector, turn: Vector) -> tuple[float, float]:
    """Bound what linearising leaves out of the part of d - t along a normal that turns with the object (7.8)."""
    above, size = turning_left_out(normal, arm, turn)
    n = (abs(normal[0]), abs(normal[1]), abs(normal[2]))
    coupled = (
        n[0] * (turn[1] * travel[2] + turn[2] * travel[1])
        + n[1] * (turn[2] * travel[0] + turn[0] * travel[2])
        + n[2] * (turn[0] * travel[1] + turn[1] * travel[0])
    )
    coupled += 0.5 * dot(turn, turn) * norm(travel)
    return above + coupled, size + coupled


@kernel
def reaches(room: PlayRoom, axis: Vector, moment: Vector, sign: float) -> float:
    """Return the greatest sign * (axis . t + moment . w) over the polytope; inf: none."""
    objective = room.program.objective
    for k in range(3):
        objective[k] = sign * axis[k]
        objective[3 + k] = sign * moment[k]
    room.program.basis[0] = -1
    if solve_program(room.rows, room.bounds, room.program) != OPTIMAL:
        return math.inf
    return promised(room.program)


@kernel
def stays_over_face(geometry: Geometry, pair: int, length_m: float, room: PlayRoom, certificate: Certificate) -> bool:
    """Whether the point stays over its face, and cannot come out behind the opposite one, in the whole polytope (7.9).

    Asked of the extents first, then of the polytope itself.
    """
    point, box, face = pair // geometry.n_own_boxes, pair % geometry.n_own_boxes, room.faces[pair]
    travel, turn, arm = vector_from(certificate.travel), vector_from(certificate.turn), row(room.arms, pair)
    for step in range(1, 3):
        k = (face + step) % 3
        columns = room.placement.box_rotations[box]
        axis = (columns[0, k], columns[1, k], columns[2, k])
        moment = cross(arm, axis)
        here = room.placement.points_box[box, point, k] / length_m
        _, left_out = gap_left_out(axis, arm, travel, turn)
        left = geometry.half_sizes[box, k] / length_m - left_out - ROUNDING
        if abs(here) + spread(axis, travel) + spread(moment, turn) < left:
            continue
        # The point moves by -(axis . t + moment . w) as seen from the box.
        if here + reaches(room, axis, moment, -1.0) >= left or reaches(room, axis, moment, 1.0) - here >= left:
            return False
    return True


@kernel
def move_out(geometry: Geometry, length_m: float, room: PlayRoom, work: CertificateRoom) -> bool:
    """Compare each row with what linearising leaves out; True: every row is far enough out, and its point stays."""
    certificate = work.certificate
    travel, turn = vector_from(certificate.travel), vector_from(certificate.turn)
    closed = True
    most = 0.0
    for pair in range(len(work.gaps)):
        if work.is_kept[pair] == 0:
            continue
        above, size = gap_left_out(row(room.rows, pair), row(room.arms, pair), travel, turn)
        face = room.faces[pair]
        thickness = 2.0 * geometry.half_sizes[pair % geometry.n_own_boxes, face % 3] / length_m
        if work.moved_out[pair] + size + ROUNDING >= thickness or not stays_over_face(
            geometry, pair, length_m, room, certificate
        ):
            work.is_kept[pair] = 0
            closed = False
            continue
        if above + ROUNDING >= work.moved_out[pair]:
            if above - work.moved_out[pair] > most:
                most, certificate.worst = above - work.moved_out[pair], pair
            work.moved_out[pair] = SPARE * above + 2.0 * ROUNDING
            closed = False
    return closed


@kernel
def write_bounds(room: PlayRoom, work: CertificateRoom) -> None:
    for pair in range(len(work.gaps)):
        room.bounds[pair] = work.gaps[pair] + work.moved_out[pair] if work.is_kept[pair] == 1 else math.inf


@kernel
def tightest_given_up(work: CertificateRoom) -> int:
    """Return the row with the smallest gap of those that no longer count; -1: all do."""
    tightest = -1
    for pair in range(len(work.gaps)):
        if work.is_kept[pair] == 0 and (tightest < 0 or work.gaps[pair] < work.gaps[tightest]):
            tightest = pair
    return tightest


@kernel
def close_polytope(geometry: Geometry, length_m: float, room: PlayRoom, work: CertificateRoom) -> int:
    """Move the rows out until what linearising leaves out is less (7.7)."""
    certificate = work.certificate
    n_dropped = 0
    for n_rounds in range(ROUNDS):
        certificate.n_rounds = n_rounds + 1
        write_bounds(room, work)
        if extents(room.rows, room.bounds, room.program, certificate.least, certificate.greatest) != OPTIMAL:
            return TOO_LARGE
        for k in range(3):
            certificate.travel[k] = max(-certificate.least[k], certificate.greatest[k])
            certificate.turn[k] = max(-certificate.least[3 + k], certificate.greatest[3 + k])
        size = norm(vector_from(certificate.travel)) + norm(vector_from(certificate.turn))
        if size == math.inf:
            certificate.worst = tightest_given_up(work)
            return FREE if n_dropped == 0 else RAN_OFF
        if norm(vector_from(certificate.turn)) > LARGEST_TURN:
            return TOO_LARGE
        if move_out(geometry, length_m, room, work):
            return CAGED
        n_dropped = 0
        for pair in range(len(work.is_kept)):
            n_dropped += 1 - work.is_kept[pair]
    return TOO_LARGE


@kernel
def angle_bound(goal: Goal, certificate: Certificate) -> float:
    """Bound a yaw, pitch or roll (7.10), its sign applied."""
    turn = certificate.turn
    k = 5 - goal.kind  # components of w: roll about x, pitch about y, yaw about z
    one, other = (k + 1) % 3 + 3, (k + 2) % 3 + 3
    k = k if goal.kind != SHIFT else 3
    bound = certificate.greatest[k] if goal.sign > 0.0 else -certificate.least[k]
    sine = max(bound, 0.0) + 0.5 * turn[one - 3] * turn[other - 3] + ROUNDING
    if goal.kind == PITCH:
        return math.asin(min(sine, 1.0))
    cosine = 1.0 - 0.5 * (turn[1] ** 2 + (turn[2] ** 2 if goal.kind == YAW else turn[0] ** 2))
    return math.atan2(sine, cosine)


@entry_kernel
def certify(
    geometry: Geometry,
    length_m: float,
    goals: Rows[Goal],
    bounds: FloatArray,
    room: PlayRoom,
    work: CertificateRoom,
) -> None:
    """Prove that the object is caged, and bound each goal.

    Parameters
    ----------
    geometry, length_m, goals
        As in `cagepose.kernels.play.find_play`.
    bounds
        Where caged: the greatest value that each goal could have, its sign applied, (n_goals,), radians or metres.
    room, work
        See there; ``work.certificate`` is the result.
    """
    place_object(geometry, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), room.placement)
    choose_faces(geometry, (0.0, 0.0, 0.0), length_m, room)
    write_trust_region(room, math.inf)
    for pair in range(len(work.gaps)):
        work.gaps[pair] = max(room.bounds[pair], 0.0)
        work.moved_out[pair] = 0.0
        work.is_kept[pair] = 1
    certificate = work.certificate
    certificate.worst = -1
    certificate.outcome = close_polytope(geometry, length_m, room, work)
    if certificate.outcome != CAGED:
        return
    for i in range(len(goals)):
        goal = goals[i]
        if goal.kind != SHIFT:
            bounds[i] = angle_bound(goal, certificate)
            continue
        factor = write_slope(goal, (1.0, 0.0, 0.0, 0.0), length_m, room)
        room.program.basis[0] = -1
        bounds[i] = math.inf
        if solve_program(room.rows, room.bounds, room.program) == OPTIMAL:
            arm = scaled(vector_from(goal.start), 1.0 / length_m)
            direction = scaled(vector_from(goal.direction), goal.sign)
            above, _ = turning_left_out(direction, arm, vector_from(certificate.turn))
            bounds[i] = length_m * (factor * promised(room.program) + above + ROUNDING)
