"""The polytope of play: each cage point stays beyond one face of each box, linearised at a motion of the object (7.1).

Lengths are in lengths of the scene, so that a travel can be compared with a turn. A pair is a point with a box.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.linear_program import OPTIMAL, Program, program_rows
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.program_bound import extents
from cagepose.kernels.algebra.record import FloatArray, IntArray, empty_record
from cagepose.kernels.algebra.vector import Vector, cross, minus, row
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes, empty_placed_boxes, place_boxes_at
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.newton import NewtonStep
from cagepose.kernels.play.tolerances import GAP_OF_TOUCH, ROUNDING_OF_GAP, ROUNDING_OF_TERMS

Motion = tuple[Vector, Quaternion]
"""A motion of the object from where it stands at the start: travel t and turn R, x -> R x + t."""
START_MOTION = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
"""No motion: the object stands where it did at the start."""
N_TRUST = 12
"""Rows |xi_k| <= radius of the trust region."""


class PlayWorkspace(NamedTuple):
    """Memory for one search.

    Attributes
    ----------
    points, boxes
        Of each pair, (n_pairs,).
    placement
        Of the boxes at the motion that is asked.
    faces, last_faces, start_faces
        For each pair the face that the point is to stay beyond, now, before the last step and at the start: axis, or
        3 + axis for the negative side, (n_pairs,).
    spare
        What is added to each gap so that none is below zero at the start: a start that touches may be inside by
        rounding, (n_pairs,).
    arms
        From the object's travel to the point, (n_pairs, 3).
    rows, bounds
        Those of (7.1), then those of the trust region.
    least, greatest
        Extents of the polytope, (6,).
    lengths, is_rejected
        For non-negative least squares over the rows, (n_pairs,).
    is_turned
        Whether a point has been let around an edge, (n_pairs,).
    held
        1 for each freedom that is held, else 0, (6,).
    program, newton
        See there.
    """

    points: IntArray
    boxes: IntArray
    placement: PlacedBoxes
    faces: IntArray
    last_faces: IntArray
    start_faces: IntArray
    spare: FloatArray
    arms: FloatArray
    rows: FloatArray
    bounds: FloatArray
    least: FloatArray
    greatest: FloatArray
    lengths: FloatArray
    is_rejected: NDArray[np.bool_]
    is_turned: NDArray[np.bool_]
    held: FloatArray
    program: Program
    newton: NewtonStep


def empty_play_workspace(geometry: BoxesAndPoints, held: FloatArray) -> PlayWorkspace:
    """Return a workspace for a scene of which some freedoms are held, (6,) (plain Python)."""
    n_points, n_boxes = len(geometry.points_world), geometry.n_own_boxes
    n_pairs = n_points * n_boxes
    rows, bounds = program_rows(n_pairs + N_TRUST)
    return PlayWorkspace(
        points=np.repeat(np.arange(n_points), n_boxes),
        boxes=np.tile(np.arange(n_boxes), n_points),
        placement=empty_placed_boxes(geometry),
        faces=np.zeros(n_pairs, np.int64),
        last_faces=np.zeros(n_pairs, np.int64),
        start_faces=np.zeros(n_pairs, np.int64),
        spare=np.zeros(n_pairs),
        arms=np.zeros((n_pairs, 3)),
        rows=rows,
        bounds=bounds,
        least=np.zeros(6),
        greatest=np.zeros(6),
        lengths=np.zeros(n_pairs),
        is_rejected=np.zeros(n_pairs, np.bool_),
        is_turned=np.zeros(n_pairs, np.bool_),
        held=held,
        program=empty_record(Program),
        newton=empty_record(NewtonStep),
    )


@kernel
def place(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> None:
    place_boxes_at(geometry, motion[0], motion[1], work.placement)


@kernel
def gap_beyond(geometry: BoxesAndPoints, pair: int, face: int, work: PlayWorkspace) -> float:
    """Return how far the point is beyond the plane of a face."""
    box, axis = work.boxes[pair], face if face < 3 else face - 3
    along = work.placement.points_box[box, axis, work.points[pair]]
    gap: float = (along if face < 3 else -along) - geometry.half_sizes[box, axis]
    return gap


@kernel
def gap_at(geometry: BoxesAndPoints, pair: int, work: PlayWorkspace) -> float:
    """Return the gap of a point to the face that it stays beyond, with its spare."""
    gap: float = gap_beyond(geometry, pair, work.faces[pair], work) + work.spare[pair]
    return gap


@kernel
def least_gap(geometry: BoxesAndPoints, work: PlayWorkspace) -> float:
    least = math.inf
    for pair in range(len(work.faces)):
        least = min(least, gap_at(geometry, pair, work))
    return least


@kernel
def farthest_face(geometry: BoxesAndPoints, pair: int, work: PlayWorkspace) -> int:
    """Return the face of the box that the point is farthest beyond."""
    best = 0
    for face in range(1, 6):
        if gap_beyond(geometry, pair, face, work) > gap_beyond(geometry, pair, best, work):
            best = face
    return best


@kernel
def write_farthest_faces(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> None:
    """Let each point stay beyond the face that it is farthest beyond at a motion."""
    place(geometry, motion, work)
    for pair in range(len(work.faces)):
        work.faces[pair] = farthest_face(geometry, pair, work)


@kernel
def is_beyond(geometry: BoxesAndPoints, pair: int, face: int, work: PlayWorkspace) -> bool:
    """Whether the point is beyond that face by more than one that touches it can be by rounding."""
    return gap_beyond(geometry, pair, face, work) > GAP_OF_TOUCH


@kernel
def write_row(geometry: BoxesAndPoints, motion: Motion, pair: int, work: PlayWorkspace) -> None:
    """Write the row (n, (c - t) x n) and the bound of one pair (7.1)."""
    face = work.faces[pair]
    sign, axis = (1.0, face) if face < 3 else (-1.0, face - 3)
    columns = work.placement.box_rotations[work.boxes[pair]]
    normal = (sign * columns[0, axis], sign * columns[1, axis], sign * columns[2, axis])
    arm = minus(row(geometry.points_world, work.points[pair]), motion[0])
    moment = cross(arm, normal)
    for k in range(3):
        work.arms[pair, k] = arm[k]
        work.rows[pair, k] = normal[k]
        work.rows[pair, 3 + k] = moment[k]
    work.bounds[pair] = gap_at(geometry, pair, work)


@kernel
def write_rows(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> float:
    """Place the object and write the rows of all pairs; return how deep the deepest point is inside, 0: none is."""
    place(geometry, motion, work)
    least = 0.0
    for pair in range(len(work.faces)):
        write_row(geometry, motion, pair, work)
        least = min(least, work.bounds[pair])
    return -least


@kernel
def write_trust_region(work: PlayWorkspace, radius: float) -> None:
    """Write |xi_k| <= radius, and of what is held |xi_k| <= 0; an infinite radius: none."""
    first = len(work.faces)
    for k in range(6):
        for side in range(2):
            for other in range(6):
                work.rows[first + 2 * k + side, other] = 0.0
            work.rows[first + 2 * k + side, k] = 1.0 - 2.0 * side
            work.bounds[first + 2 * k + side] = 0.0 if work.held[k] == 1.0 else radius


@kernel
def write_touching_rows(geometry: BoxesAndPoints, motion: Motion, radius: float, work: PlayWorkspace) -> None:
    """Write the rows of the pairs that touch, with bounds of zero, and a trust region; the others do not count."""
    write_rows(geometry, motion, work)
    for pair in range(len(work.faces)):
        work.bounds[pair] = 0.0 if work.bounds[pair] < GAP_OF_TOUCH else math.inf
    write_trust_region(work, radius)


@kernel
def has_choice(geometry: BoxesAndPoints, pair: int, work: PlayWorkspace) -> bool:
    """Whether the point is beyond more than one face of the box."""
    n_beyond = 0
    for face in range(6):
        if is_beyond(geometry, pair, face, work):
            n_beyond += 1
    return n_beyond > 1


@kernel
def gap_at_worst(pair: int, work: PlayWorkspace) -> float:
    """Return the linear gap of a pair at the worst corner of the extents; -inf: they have no end there."""
    gap: float = work.bounds[pair]
    for k in range(6):
        a = work.rows[pair, k]
        if abs(a) > ROUNDING_OF_TERMS:  # else it reaches for no end, even where there is none
            gap -= a * (work.greatest[k] if a > 0.0 else work.least[k])
    return gap


@kernel
def choose_faces(geometry: BoxesAndPoints, work: PlayWorkspace) -> None:
    """Choose the face that each point stays beyond (7.2), at the start.

    Where a point is beyond several faces of a box, it is enough that it stays beyond one. Of these the face is best
    that the point cannot reach anyhow, by the rows of the points that have no choice.
    """
    write_farthest_faces(geometry, START_MOTION, work)
    write_rows(geometry, START_MOTION, work)
    write_trust_region(work, math.inf)
    n_choices = 0
    for pair in range(len(work.faces)):
        work.bounds[pair] = max(work.bounds[pair], 0.0)
        if has_choice(geometry, pair, work):
            work.bounds[pair] = math.inf
            n_choices += 1
    if n_choices == 0 or extents(work.rows, work.bounds, work.program, work.least, work.greatest)[0] != OPTIMAL:
        return
    for pair in range(len(work.faces)):
        if work.bounds[pair] < math.inf:
            continue
        best, most = work.faces[pair], -math.inf
        for face in range(6):
            if is_beyond(geometry, pair, face, work):
                work.faces[pair] = face
                write_row(geometry, START_MOTION, pair, work)
                gap = gap_at_worst(pair, work)
                if gap > most:
                    most, best = gap, face
        work.faces[pair] = best
        work.bounds[pair] = math.inf


@entry
def write_start(geometry: BoxesAndPoints, work: PlayWorkspace) -> None:
    """Choose faces and write the rows (7.1) of the start, without a trust region.

    Parameters
    ----------
    geometry
        As in `cagepose.kernels.play.search.find_play`.
    work
        Its faces, rows, bounds and spare are written.
    """
    for pair in range(len(work.faces)):
        work.spare[pair] = 0.0
    choose_faces(geometry, work)
    write_rows(geometry, START_MOTION, work)
    for pair in range(len(work.faces)):
        work.start_faces[pair] = work.faces[pair]
        work.spare[pair] = max(0.0, ROUNDING_OF_GAP - work.bounds[pair])
        work.bounds[pair] += work.spare[pair]
