"""Where the loads leave the object inside its play: a linear program for each phase, no motion followed (7.13).

Friction does not count, and neither does the way: each phase is answered from the start pose.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import empty_system
from cagepose.kernels.algebra.record import IntArray, Rows, empty_rows
from cagepose.kernels.play.extreme import REACHED, Extreme, Limits, find_linear_play
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import PlayWorkspace, empty_play_workspace, write_start
from cagepose.kernels.play.search import find_play
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.scope import check_all_freedoms, check_boxes_and_points
from cagepose.runs.actions import acting_pushes, is_one_force
from cagepose.runs.load_scaling import scaled_load
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS, PlayFrame, motion_after, range_goals
from cagepose.studies.tolerances import GAP_AT_FACES, RANGE_OF_FREEDOM


@dataclass(frozen=True, eq=False)
class PressedPoint:
    """A point that carries load: its name, the box's, and the force along the face's normal.

    ``force_n`` is in newtons if the load is (see `PlayRest`), else per unit load.
    """

    point: str
    box: str
    force_n: float

    def __repr__(self) -> str:
        return f"<PressedPoint {self.point!r} on {self.box!r}: {self.force_n:.4g}>"


@dataclass(frozen=True, eq=False)
class OpenFreedom:
    """A freedom that the load leaves open, and its range: metres or radians from the start, in the cage's axes.

    None: without end.
    """

    name: str
    low: float | None
    high: float | None


@dataclass(frozen=True, eq=False)
class PlayRest:
    """The rest under one phase's load.

    Attributes
    ----------
    phase
        Name.
    in_newtons
        Whether forces are in newtons, not per unit load.
    linear_pose_world_object
        By the linear program; of what the load leaves open, nearest to the start. None: the load meets no end.
    pose_world_object
        The exact one, where the load can do no more work nearby. None: none was found.
    forces, exact_forces
        That balance the load at each of the two poses, the largest first; where they are not unique, one choice.
    undetermined
        To first order.
    """

    phase: str
    in_newtons: bool
    linear_pose_world_object: Pose | None
    pose_world_object: Pose | None
    forces: tuple[PressedPoint, ...]
    exact_forces: tuple[PressedPoint, ...]
    undetermined: tuple[OpenFreedom, ...]

    def __repr__(self) -> str:
        pose = self.pose_world_object or self.linear_pose_world_object
        return f"<PlayRest of {self.phase!r}: {'no end' if pose is None else pose}>"


def play_rests(scene: Scene) -> tuple[PlayRest, ...]:
    """Say where each phase's load leaves the object, if its play is small and nothing rubs.

    Left out are phases with more than a weight and what one dead force is equal to.

    The answer is where the load has done all the work that the cage allows. `cagepose.run` follows the way there, with
    friction, and proves the rest.
    """
    check_boxes_and_points(scene, "play")
    check_all_freedoms(scene, "where loads leave the play")
    frame = PlayFrame(scene)
    work = empty_play_workspace(frame.geometry, frame.held)
    loads = [load for load in scene.loads if is_one_force(scene, load)]
    goals, sizes = _load_goals(scene, loads, frame)
    extremes = empty_rows(Extreme, len(goals))
    find_play(frame.geometry, goals, extremes, work)
    write_start(frame.geometry, work)
    return tuple(
        _rest(scene, frame, work, load, float(sizes[index]), extremes[index]) for index, load in enumerate(loads)
    )


def _load_goals(scene: Scene, loads: list[Load], frame: PlayFrame) -> tuple[Rows[Goal], FloatArray]:
    """Return the loads' work as goals, per unit of the larger force of each phase, and these forces."""
    goals = empty_rows(Goal, len(loads))
    sizes = np.zeros(len(loads))
    for index, load in enumerate(loads):
        weight, forces, _ = scaled_load(scene, load)
        pushes = acting_pushes(load, forces)
        force, at_object = (pushes[0].vector, pushes[0].at_m) if pushes else (np.zeros(3), np.zeros(3))
        sizes[index] = max(np.linalg.norm(weight), np.linalg.norm(force))
        goal = goals[index]
        goal.kind, goal.sign = SHIFT, 1.0
        goal.directions[:] = frame.vectors_from_world(np.stack([weight, force]) / sizes[index])
        goal.starts[:] = frame.from_object(np.stack([scene.object.center_of_gravity_m, at_object]))
    return goals, sizes


def _rest(scene: Scene, frame: PlayFrame, work: PlayWorkspace, load: Load, size_n: float, extreme: Extreme) -> PlayRest:
    """Return the rest of one phase; the workspace has the polytope of the start."""
    is_reached, is_linear_reached = extreme.outcome == REACHED, extreme.linear_outcome == REACHED
    pose, linear_pose, open_freedoms = None, None, list[OpenFreedom]()
    if is_reached:
        pose = frame.pose_after(extreme.position, extreme.quaternion)
    if is_linear_reached:
        limits = extreme.linear_limits
        rows, bounds = _face(work, limits.pairs[: limits.n_pairs])
        ranges = empty_rows(Extreme, 2 * len(FREEDOMS))
        find_linear_play(range_goals(frame), rows, bounds, work.program, ranges)
        open_freedoms = _open_freedoms(np.asarray(ranges), frame.length_m)
        twist = extreme.linear_twist.copy()
        shortest_inside(rows, bounds, empty_system(len(rows)), work.program.passive, twist)
        linear_pose = frame.pose_after(*motion_after(twist))
    return PlayRest(
        load.name,
        scaled_load(scene, load).in_newtons,
        linear_pose,
        pose,
        _forces(scene, extreme.linear_limits, size_n) if is_linear_reached else (),
        _forces(scene, extreme.limits, size_n) if is_reached else (),
        tuple(open_freedoms),
    )


def _face(work: PlayWorkspace, kept: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the part of the polytope in which the points of some rows stay at their faces."""
    rows, bounds, n_pairs = work.rows.copy(), work.bounds.copy(), len(work.faces)
    rows[n_pairs : n_pairs + len(kept)] = -rows[kept]
    bounds[n_pairs : n_pairs + len(kept)] = GAP_AT_FACES - bounds[kept]
    return rows, bounds


def _open_freedoms(ends: np.ndarray, length_m: float) -> list[OpenFreedom]:
    found = []
    values = np.where(ends["linear_outcome"] == REACHED, ends["linear"], np.nan).reshape(-1, 2)
    for place, (low, high) in enumerate(values.tolist()):
        if not high - low <= RANGE_OF_FREEDOM:
            unit = length_m if place < N_LENGTHS else 1.0
            found.append(
                OpenFreedom(FREEDOMS[place], *(None if math.isnan(end) else unit * end for end in (low, high)))
            )
    return found


def _forces(scene: Scene, limits: Limits, size_n: float) -> tuple[PressedPoint, ...]:
    n_boxes = len(scene.object.boxes)
    found = [
        PressedPoint(scene.cage.names[pair // n_boxes], str(scene.object.boxes[pair % n_boxes].name), size_n * price)
        for pair, price in zip(limits.pairs[: limits.n_pairs].tolist(), limits.prices.tolist(), strict=False)
    ]
    return tuple(sorted(found, key=lambda pressed: -pressed.force_n))
