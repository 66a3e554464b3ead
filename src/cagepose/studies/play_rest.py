"""Where the loads leave the object inside its play: a linear program for each phase, no motion followed (7.13).

Friction does not count, and neither does the way: each phase is answered from the start pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.kernels.algebra.linear_program import OPTIMAL, ProgramRoom, solve_program
from cagepose.kernels.algebra.record import Rows, empty_record, empty_rows
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.rows import N_TRUST, empty_play_room, write_start
from cagepose.kernels.play.search import REACHED, Extreme, find_play
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.load_scaling import scaled_load
from cagepose.studies.play_frame import FREEDOMS, PlayFrame

CARRIES = 1e-9
"""Of the load: a smaller force is rounding."""
LEFT_OPEN = 1e-7
"""Lengths of the scene, or radians. A freedom with a smaller range at rest is determined."""
TOUCHES = 1e-9
"""Lengths of the scene: a row whose gap is smaller touches."""
FLAT = 1e-12
"""Lengths of the scene: how exactly the touching points stay at their faces while ranges are asked."""


@dataclass(frozen=True, eq=False)
class PressedPoint:
    """A point that carries load: its name, the box's, and the force along the face's normal.

    ``force_n`` is in newtons if the load is (see `PlayRest`), else per unit load.
    """

    point: str
    box: str
    force_n: float


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
        By the linear program; of what the load leaves open, near to the start. None: the load meets no end.
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


def play_rests(scene: Scene) -> tuple[PlayRest, ...]:
    """Say where each phase's load leaves the object, if its play is small and nothing rubs.

    The answer is where the load has done all the work that the cage allows. `cagepose.run` follows the way there, with
    friction, and proves the rest.
    """
    frame = PlayFrame(scene)
    room = empty_play_room(frame.geometry)
    goals, sizes = _load_goals(scene, frame)
    extremes = empty_rows(Extreme, len(goals))
    find_play(frame.geometry, frame.length_m, goals, extremes, room)
    write_start(frame.geometry, frame.length_m, room)
    polytope = _Polytope(frame, room.rows, room.bounds)
    return tuple(
        _rest(scene, frame, polytope, index, goals[index], float(size), extremes[index])
        for index, size in enumerate(sizes)
    )


def _load_goals(scene: Scene, frame: PlayFrame) -> tuple[Rows[Goal], FloatArray]:
    """Return the loads' work as goals, per unit of the larger force of each phase, and these forces."""
    goals = empty_rows(Goal, len(scene.loads))
    sizes = np.zeros(len(scene.loads))
    for index, load in enumerate(scene.loads):
        weight, force, _ = scaled_load(scene, load)
        sizes[index] = max(np.linalg.norm(weight), np.linalg.norm(force))
        goal = goals[index]
        goal.kind, goal.sign = SHIFT, 1.0
        goal.directions[:] = frame.from_world(np.stack([weight, force]) / sizes[index])
        points = [scene.object.center_of_gravity_m, np.zeros(3) if load.force is None else load.force.at_object_m]
        goal.starts[:] = frame.pose_frame_object.transform(np.array(points))
    return goals, sizes


class _Polytope:
    """The polytope of the start (7.1), in lengths of the scene, and programs over it."""

    def __init__(self, frame: PlayFrame, rows: FloatArray, bounds: FloatArray) -> None:
        self.frame = frame
        self.rows = rows
        self.bounds = bounds
        self.program: ProgramRoom = empty_record(ProgramRoom)

    def solve(self, objective: FloatArray) -> bool:
        """Whether there is a greatest value; its solution and multipliers are in ``program``."""
        self.program.objective[:] = objective / np.abs(objective).max()
        self.program.basis[0] = -1
        return bool(solve_program(self.rows, self.bounds, self.program) == OPTIMAL)

    def carried(self, objective: FloatArray) -> dict[int, float]:
        """Return the multiplier of each row that the last solution leans on."""
        scale, n_pairs = float(np.abs(objective).max()), len(self.bounds) - N_TRUST
        priced = zip(self.program.basis.tolist(), self.program.multipliers.tolist(), strict=True)
        return {row: scale * price for row, price in priced if row < n_pairs and price > CARRIES}

    def face(self, kept: list[int]) -> _Polytope:
        """Return the part in which the points of some rows stay at their faces."""
        rows, bounds = self.rows.copy(), self.bounds.copy()
        first = len(bounds) - N_TRUST
        rows[first : first + len(kept)] = -rows[kept]
        bounds[first : first + len(kept)] = FLAT - bounds[kept]
        return _Polytope(self.frame, rows, bounds)

    def freedoms(self) -> tuple[list[OpenFreedom], list[FloatArray]]:
        """Return all ranges, and the twists that reach their ends."""
        ranges, corners = list[OpenFreedom](), list[FloatArray]()
        for name, slope, unit in self._slopes():
            ends = list[float | None]()
            for sign in (-1.0, 1.0):
                found = self.solve(sign * slope)
                twist = self.program.x_near.copy()
                ends.append(unit * float(slope @ twist) if found else None)
                if found and np.abs(self.program.x_far).max() < FLAT:
                    corners.append(twist)
            ranges.append(OpenFreedom(name, ends[0], ends[1]))
        return ranges, corners

    def towards_start(self, middle: FloatArray) -> FloatArray:
        """Go from a twist inside straight to the smallest one that touches the same rows, if the others allow."""
        left = self.bounds - self.rows @ middle
        touching = left < TOUCHES
        smallest = np.linalg.lstsq(self.rows[touching], self.bounds[touching])[0].astype(np.float64)
        speed = self.rows @ (smallest - middle)
        blocks = ~touching & (speed > 0.0) & np.isfinite(left)
        share = min(1.0, float((left[blocks] / speed[blocks]).min(initial=1.0)))
        return middle + share * (smallest - middle)

    def _slopes(self) -> list[tuple[str, FloatArray, float]]:
        """Rates of the freedoms with a twist (t / L, w), and their units in metres or radians."""
        origin = self.frame.pose_frame_object.position_m / self.frame.length_m
        shifts = [np.append(axis, np.cross(origin, axis)) for axis in np.eye(3)]
        turns = [np.append(np.zeros(3), axis) for axis in np.eye(3)]
        units = [self.frame.length_m] * 3 + [1.0] * 3
        return list(zip(FREEDOMS, shifts + turns, units, strict=True))


def _rest(
    scene: Scene, frame: PlayFrame, polytope: _Polytope, index: int, goal: Goal, size_n: float, extreme: Extreme
) -> PlayRest:
    load = scene.loads[index]
    in_newtons = scaled_load(scene, load).in_newtons
    arms = goal.starts / frame.length_m
    objective = np.append(goal.directions.sum(axis=0), np.cross(arms, goal.directions).sum(axis=0))
    exact = None
    if extreme.outcome == REACHED:
        w, x, y, z = extreme.quaternion.tolist()
        exact = frame.outward(tuple(extreme.position.tolist()), (w, x, y, z))
    limits = dict(zip(extreme.limits.tolist(), extreme.prices.tolist(), strict=True)) if exact else {}
    exact_forces = _forces(scene, {pair: size_n * price for pair, price in limits.items() if price > CARRIES})
    if not polytope.solve(objective):
        return PlayRest(load.name, in_newtons, None, exact, (), exact_forces, ())
    carried = polytope.carried(objective)
    kept, twist = list(carried), polytope.program.x_near.copy()
    ranges, corners = polytope.face(kept).freedoms()
    if corners:
        twist = polytope.towards_start(np.array(corners).mean(axis=0))
    return PlayRest(
        load.name,
        in_newtons,
        frame.outward(*frame.motion(twist).as_tuples()),
        exact,
        _forces(scene, {pair: size_n * price for pair, price in carried.items()}),
        exact_forces,
        tuple(freedom for freedom in ranges if _is_open(freedom, frame.length_m)),
    )


def _is_open(freedom: OpenFreedom, length_m: float) -> bool:
    unit = length_m if freedom.name in FREEDOMS[:3] else 1.0
    return freedom.low is None or freedom.high is None or freedom.high - freedom.low > LEFT_OPEN * unit


def _forces(scene: Scene, carried: dict[int, float]) -> tuple[PressedPoint, ...]:
    n_boxes = len(scene.object.boxes)
    found = [
        PressedPoint(scene.cage.names[pair // n_boxes], str(scene.object.boxes[pair % n_boxes].name), force)
        for pair, force in carried.items()
    ]
    return tuple(sorted(found, key=lambda pressed: -pressed.force_n))
