"""The rows of play: each cage point stays beyond one face of each box, linearised at a motion of the object (7.1)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.linear_program import OPTIMAL, ProgramRoom, extents, program_rows
from cagepose.kernels.algebra.record import FloatArray, IntArray, empty_record
from cagepose.kernels.algebra.vector import Vector, cross, row
from cagepose.kernels.collision.geometry import Geometry, Placement, empty_placement, place_object
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.newton import NewtonRoom

START = (0.0, 0.0, 0.0)
"""The motion begins here."""
N_TRUST = 12
"""Rows |xi_k| <= radius of the trust region."""
COUNTS = 1e-12
"""Coefficients of a row below this are rounding: they do not reach for an end that is not there."""
HARDLY = 1e-9
"""A gap whose multiplier is smaller does not limit the motion."""
NOT_BEYOND = 1e-8
"""Lengths of the scene. A point that is beyond another face of the box by less stays with its face."""
ROUNDING = 1e-13
"""Lengths of the scene: gaps of points that touch are known so well."""


class PlayRoom(NamedTuple):
    """Room for one search.

    Attributes
    ----------
    placement
        Of the boxes at the pose that is asked.
    faces
        For each point and box, the face that the point is to stay beyond: axis, or 3 + axis for the negative side,
        (n_points * n_boxes,).
    arms
        From the position to the point, lengths of the scene, (n_points * n_boxes, 3).
    rows, bounds
        Those of (7.1), lengths divided by the scene's length, then those of the trust region.
    least, greatest
        Extents of the polytope, (6,).
    start_faces, spare
        The faces at the start, and what is added to each gap so that none is below zero there: a start that touches
        may be inside by rounding. (n_points * n_boxes,), the latter in lengths of the scene.
    program, newton
        See there.
    """

    placement: Placement
    faces: IntArray
    arms: FloatArray
    rows: FloatArray
    bounds: FloatArray
    least: FloatArray
    greatest: FloatArray
    start_faces: IntArray
    spare: FloatArray
    program: ProgramRoom
    newton: NewtonRoom


def empty_play_room(geometry: Geometry) -> PlayRoom:
    """Return room for a scene (plain Python)."""
    n_pairs = len(geometry.points_world) * geometry.n_own_boxes
    return PlayRoom(
        empty_placement(geometry),
        np.zeros(n_pairs, np.int64),
        np.zeros((n_pairs, 3)),
        *program_rows(n_pairs + N_TRUST),
        np.zeros(6),
        np.zeros(6),
        np.zeros(n_pairs, np.int64),
        np.zeros(n_pairs),
        empty_record(ProgramRoom),
        empty_record(NewtonRoom),
    )


@kernel
def gap_beyond(geometry: Geometry, placement: Placement, point: int, box: int, face: int) -> float:
    """Return how far the point is beyond the plane of a face, metres."""
    axis = face if face < 3 else face - 3
    along = placement.points_box[box, axis, point]
    gap: float = (along if face < 3 else -along) - geometry.half_sizes[box, axis]
    return gap


@kernel
def gap_at(geometry: Geometry, length_m: float, point: int, box: int, room: PlayRoom) -> float:
    """Return the gap of a point to the face that it stays beyond, with its spare, lengths of the scene."""
    pair = point * geometry.n_own_boxes + box
    gap: float = gap_beyond(geometry, room.placement, point, box, room.faces[pair]) / length_m + room.spare[pair]
    return gap


@kernel
def farthest_face(geometry: Geometry, placement: Placement, point: int, box: int) -> int:
    """Return the face of the box that the point is farthest beyond."""
    best = 0
    for face in range(1, 6):
        if gap_beyond(geometry, placement, point, box, face) > gap_beyond(geometry, placement, point, box, best):
            best = face
    return best


@kernel
def choose_farthest_faces(geometry: Geometry, room: PlayRoom) -> None:
    n_boxes = geometry.n_own_boxes
    for pair in range(len(room.faces)):
        room.faces[pair] = farthest_face(geometry, room.placement, pair // n_boxes, pair % n_boxes)


@kernel
def is_beyond(geometry: Geometry, length_m: float, pair: int, face: int, room: PlayRoom) -> bool:
    """Whether the point is beyond that face by more than one that is flush with it can be by rounding."""
    point, box = pair // geometry.n_own_boxes, pair % geometry.n_own_boxes
    return gap_beyond(geometry, room.placement, point, box, face) > NOT_BEYOND * length_m


@kernel
def has_choice(geometry: Geometry, length_m: float, pair: int, room: PlayRoom) -> bool:
    """Whether the point is beyond more than one face of the box."""
    n_beyond = 0
    for face in range(6):
        if is_beyond(geometry, length_m, pair, face, room):
            n_beyond += 1
    return n_beyond > 1


@kernel
def room_left(pair: int, room: PlayRoom) -> float:
    """Return what is left of a row's gap at the worst corner of the extents; -inf: they have no end there."""
    left: float = room.bounds[pair]
    for k in range(6):
        a = room.rows[pair, k]
        if abs(a) > COUNTS:
            left -= a * (room.greatest[k] if a > 0.0 else room.least[k])
    return left


@kernel
def choose_faces(geometry: Geometry, length_m: float, room: PlayRoom) -> None:
    """Choose the face that each point stays beyond (7.2), at the start.

    Where a point is beyond several faces of a box, it is enough that it stays beyond one. Of these the face is best
    that the point cannot reach anyhow, by the rows of the points that have no choice.
    """
    choose_farthest_faces(geometry, room)
    write_rows(geometry, START, length_m, room)
    write_trust_region(room, math.inf)
    n_choices = 0
    for pair in range(len(room.faces)):
        room.bounds[pair] = max(room.bounds[pair], 0.0)
        if has_choice(geometry, length_m, pair, room):
            room.bounds[pair] = math.inf
            n_choices += 1
    if n_choices == 0 or extents(room.rows, room.bounds, room.program, room.least, room.greatest) != OPTIMAL:
        return
    for pair in range(len(room.faces)):
        if room.bounds[pair] < math.inf:
            continue
        point, box = pair // geometry.n_own_boxes, pair % geometry.n_own_boxes
        best, most = room.faces[pair], -math.inf
        for face in range(6):
            if is_beyond(geometry, length_m, pair, face, room):
                room.faces[pair] = face
                write_row(geometry, START, length_m, point, box, room)
                left = room_left(pair, room)
                if left > most:
                    most, best = left, face
        room.faces[pair] = best
        room.bounds[pair] = math.inf


@entry
def write_start(geometry: Geometry, length_m: float, room: PlayRoom) -> None:
    """Choose faces and write the rows (7.1) of the start, without a trust region.

    Parameters
    ----------
    geometry, length_m
        As in `cagepose.kernels.play.search.find_play`.
    room
        Its faces, rows, bounds and spare are written.
    """
    place_object(geometry, START, (1.0, 0.0, 0.0, 0.0), room.placement)
    for pair in range(len(room.faces)):
        room.spare[pair] = 0.0
    choose_faces(geometry, length_m, room)
    write_rows(geometry, START, length_m, room)
    for pair in range(len(room.faces)):
        room.start_faces[pair] = room.faces[pair]
        room.spare[pair] = max(0.0, ROUNDING - room.bounds[pair])
        room.bounds[pair] += room.spare[pair]
    write_trust_region(room, math.inf)


@kernel
def write_row(geometry: Geometry, position: Vector, length_m: float, point: int, box: int, room: PlayRoom) -> None:
    """Write the row (n, (c - t) x n / L) and the bound gap / L of one point and box (7.1)."""
    pair = point * geometry.n_own_boxes + box
    face = room.faces[pair]
    sign = 1.0 if face < 3 else -1.0
    axis = face if face < 3 else face - 3
    columns = room.placement.box_rotations[box]
    normal = (sign * columns[0, axis], sign * columns[1, axis], sign * columns[2, axis])
    c = row(geometry.points_world, point)
    arm = ((c[0] - position[0]) / length_m, (c[1] - position[1]) / length_m, (c[2] - position[2]) / length_m)
    moment = cross(arm, normal)
    for k in range(3):
        room.arms[pair, k] = arm[k]
        room.rows[pair, k] = normal[k]
        room.rows[pair, 3 + k] = moment[k]
    room.bounds[pair] = gap_at(geometry, length_m, point, box, room)


@kernel
def write_rows(geometry: Geometry, position: Vector, length_m: float, room: PlayRoom) -> float:
    """Write the rows of all points and boxes; return the least bound."""
    least = math.inf
    for point in range(len(geometry.points_world)):
        for box in range(geometry.n_own_boxes):
            write_row(geometry, position, length_m, point, box, room)
            least = min(least, room.bounds[point * geometry.n_own_boxes + box])
    return least


@kernel
def write_trust_region(room: PlayRoom, radius: float) -> None:
    """Write |xi_k| <= radius; an infinite radius: none."""
    first = len(room.faces)
    for k in range(6):
        for side in range(2):
            for other in range(6):
                room.rows[first + 2 * k + side, other] = 0.0
            room.rows[first + 2 * k + side, k] = 1.0 - 2.0 * side
            room.bounds[first + 2 * k + side] = radius


@kernel
def change_faces(geometry: Geometry, length_m: float, room: PlayRoom) -> bool:
    """Where a point that limits the motion is beyond another face too, let it stay beyond that one instead."""
    n_boxes = geometry.n_own_boxes
    changed = False
    for i in range(room.newton.n_rows):
        pair = room.newton.pairs[i]
        if room.newton.prices[i] > HARDLY:
            point, box = pair // n_boxes, pair % n_boxes
            best = farthest_face(geometry, room.placement, point, box)
            beyond = gap_beyond(geometry, room.placement, point, box, best)
            if best != room.faces[pair] and beyond > NOT_BEYOND * length_m:
                room.faces[pair] = best
                changed = True
    return changed


@kernel
def least_gap(geometry: Geometry, length_m: float, room: PlayRoom) -> float:
    """Return the least gap over all points and boxes, each beyond its face, lengths of the scene."""
    least = math.inf
    for point in range(len(geometry.points_world)):
        for box in range(geometry.n_own_boxes):
            least = min(least, gap_at(geometry, length_m, point, box, room))
    return least
