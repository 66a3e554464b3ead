"""Which gaps limit an end of the play, and what it is worth to close or to open each of them (7.11).

At the pose that reaches the end, the limiting rows hold the slope of the value. Where more rows touch than are needed,
several sets of them could hold it: closing a gap moves the end by the most that any set lets it carry, opening it by
the least. Both are linear programs over the rows that touch, with one bound moved by one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cagepose.kernels.algebra.linear_program import OPTIMAL, ProgramRoom, solve_program
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.play.goal import PITCH, ROLL, SHIFT, Goal
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.studies.play_frame import PlayFrame

TOUCHES = 1e-8
"""Lengths of the scene: the search leaves limiting gaps of 1e-12, and knows flat tops to their square root."""
WORTHLESS = 1e-6
"""Of the slope. A gap that is worth less does not limit the end."""
SAME_FACE = 1e-9
"""Rows that differ by less: faces of two boxes that are flush at the point, one gap."""
FARTHEST = 1e3
"""How far the programs may go for a bound of one: what the slope lacks of the rows, 1e-9, errs by this much more."""


@dataclass(frozen=True, eq=False)
class Clearance:
    """A gap that limits an end of the play.

    Attributes
    ----------
    point, box
        Names; of two boxes that are flush there, the first.
    gap_m
        At the start, to the face that limits, metres.
    closing, opening
        How much nearer the end comes for each metre that the gap is closed, and how much farther it goes for each
        metre that it is opened: radians or metres. They differ where other points limit the end as well.
    """

    point: str
    box: str
    gap_m: float
    closing: float
    opening: float


def limiting_clearances(scene: Scene, frame: PlayFrame, goal: Goal, motion: Pose) -> tuple[Clearance, ...]:
    """Return what limits a goal at the motion that reaches its end, the gap that is best to close first."""
    pairs, faces, rows = _touching(frame, motion)
    if not pairs:
        return ()
    unit = frame.length_m if goal.kind == SHIFT else 1.0
    slope = _slope(goal, motion, frame.length_m)
    size = float(np.abs(slope).max())
    program = empty_record(ProgramRoom)
    all_rows = np.vstack([rows, np.eye(6), -np.eye(6)])
    start = _gaps(frame, Pose())
    found = []
    n_boxes = frame.geometry.n_own_boxes
    for place, (pair, face) in enumerate(zip(pairs, faces, strict=True)):
        point = pair // n_boxes
        flush = [
            other
            for other in range(len(pairs))
            if pairs[other] // n_boxes == point and np.abs(rows[other] - rows[place]).max() < SAME_FACE
        ]
        if flush[0] < place:
            continue
        worth = list[float]()
        for bound in (-1.0, 1.0):
            bounds = np.append(np.zeros(len(rows)), np.full(12, FARTHEST))
            bounds[flush] = bound
            program.objective[:] = slope / size
            program.basis[0] = -1
            is_solved = solve_program(all_rows, bounds, program) == OPTIMAL
            worth.append(bound * size * float(program.objective @ program.x_near) if is_solved else math.inf)
        closing, opening = (value * unit / frame.length_m for value in worth)
        if closing > WORTHLESS * size * unit / frame.length_m:
            found.append(
                Clearance(
                    scene.cage.names[point],
                    str(scene.object.boxes[pair % n_boxes].name),
                    float(start[face, pair]),
                    closing,
                    max(opening, 0.0),
                )
            )
    return tuple(sorted(found, key=lambda clearance: (-clearance.closing, -clearance.opening)))


def _gaps(frame: PlayFrame, motion: Pose) -> FloatArray:
    """Return how far each point is beyond each face of each box, metres, (6, n_points * n_boxes)."""
    geometry = frame.geometry
    points = motion.inverse_transform(geometry.points_world)
    n_boxes = geometry.n_own_boxes
    along = np.einsum(
        "pbi,bij->pbj", points[:, None] - geometry.box_positions[:n_boxes], geometry.box_rotations[:n_boxes]
    )
    half = geometry.half_sizes[:n_boxes]
    gaps: FloatArray = np.concatenate([along - half, -along - half], axis=2).reshape(-1, 6).T
    return gaps


def _touching(frame: PlayFrame, motion: Pose) -> tuple[list[int], list[int], FloatArray]:
    """Return the pairs of point and box that touch, the faces they do so at, and their rows (7.1)."""
    gaps = _gaps(frame, motion)
    nearest = gaps.argmax(axis=0)
    pairs = np.flatnonzero(gaps.max(axis=0) < TOUCHES * frame.length_m)
    faces = nearest[pairs]
    n_boxes = frame.geometry.n_own_boxes
    columns = frame.geometry.box_rotations[pairs % n_boxes, :, faces % 3]
    normals = np.where(faces < 3, 1.0, -1.0)[:, None] * columns @ motion.rotation.T
    arms = (frame.geometry.points_world[pairs // n_boxes] - motion.position_m) / frame.length_m
    return pairs.tolist(), faces.tolist(), np.hstack([normals, np.cross(arms, normals)])


def _slope(goal: Goal, motion: Pose, length_m: float) -> FloatArray:
    """Return the rate of the value, its sign applied, in radians or lengths of the scene, (6,): (7.4)."""
    if goal.kind == SHIFT:
        arms = goal.starts @ motion.rotation.T / length_m
        shift = np.append(goal.directions.sum(axis=0), np.cross(arms, goal.directions).sum(axis=0))
        return np.asarray(goal.sign * shift, dtype=np.float64)
    yaw, pitch, _ = motion.euler_zyx
    along = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    if goal.kind == PITCH:
        rate = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    elif goal.kind == ROLL:
        rate = along / math.cos(pitch)
    else:
        rate = along * math.tan(pitch) + np.array([0.0, 0.0, 1.0])
    return np.asarray(goal.sign * np.append(np.zeros(3), rate), dtype=np.float64)
