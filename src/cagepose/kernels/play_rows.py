"""The rows of play: each cage point stays beyond one face of each box, linearised at a motion of the object (7.1)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.geometry import Geometry, Placement, empty_placement
from cagepose.kernels.jit import kernel
from cagepose.kernels.linear_program import ProgramRoom, program_rows
from cagepose.kernels.play_newton import NewtonRoom
from cagepose.kernels.record import FloatArray, IntArray, empty_record
from cagepose.kernels.vector import Vector, cross, row

N_TRUST = 12
"""Rows |xi_k| <= radius of the trust region."""
NOT_BEYOND = 1e-8
"""Lengths of the scene. A point that is beyond another face of the box by less stays with its face."""


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
    program, newton
        See there.
    """

    placement: Placement
    faces: IntArray
    arms: FloatArray
    rows: FloatArray
    bounds: FloatArray
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
        empty_record(ProgramRoom),
        empty_record(NewtonRoom),
    )


@kernel
def gap_beyond(geometry: Geometry, placement: Placement, point: int, box: int, face: int) -> float:
    """Return how far the point is beyond the plane of a face, metres."""
    axis = face % 3
    along = placement.points_box[box, point, axis]
    gap: float = (along if face < 3 else -along) - geometry.half_sizes[box, axis]
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
def choose_faces(geometry: Geometry, room: PlayRoom) -> None:
    n_boxes = geometry.n_own_boxes
    for pair in range(len(room.faces)):
        room.faces[pair] = farthest_face(geometry, room.placement, pair // n_boxes, pair % n_boxes)


@kernel
def write_rows(geometry: Geometry, position: Vector, length_m: float, room: PlayRoom) -> float:
    """Write one row (n, (c - t) x n / L) and one bound gap / L for each point and box (7.1); return the least bound."""
    n_boxes = geometry.n_own_boxes
    least = math.inf
    for pair in range(len(room.faces)):
        point, box, face = pair // n_boxes, pair % n_boxes, room.faces[pair]
        sign = 1.0 if face < 3 else -1.0
        columns = room.placement.box_rotations[box]
        axis = face % 3
        normal = (sign * columns[0, axis], sign * columns[1, axis], sign * columns[2, axis])
        c = row(geometry.points_world, point)
        arm = ((c[0] - position[0]) / length_m, (c[1] - position[1]) / length_m, (c[2] - position[2]) / length_m)
        moment = cross(arm, normal)
        for k in range(3):
            room.arms[pair, k] = arm[k]
            room.rows[pair, k] = normal[k]
            room.rows[pair, 3 + k] = moment[k]
        room.bounds[pair] = gap_beyond(geometry, room.placement, point, box, face) / length_m
        least = min(least, room.bounds[pair])
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
    for k in range(6):
        pair = room.program.basis[k]
        if pair < len(room.faces) and room.program.multipliers[k] > 1e-9:
            point, box = pair // n_boxes, pair % n_boxes
            best = farthest_face(geometry, room.placement, point, box)
            beyond = gap_beyond(geometry, room.placement, point, box, best)
            if best != room.faces[pair] and beyond > NOT_BEYOND * length_m:
                room.faces[pair] = best
                changed = True
    return changed


@kernel
def least_gap(geometry: Geometry, room: PlayRoom) -> float:
    """Return the least gap over all points and boxes, each beyond its face, metres."""
    n_boxes = geometry.n_own_boxes
    least = math.inf
    for pair in range(len(room.faces)):
        least = min(least, gap_beyond(geometry, room.placement, pair // n_boxes, pair % n_boxes, room.faces[pair]))
    return least
