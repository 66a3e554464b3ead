"""Pushes without friction from any pose, and where they lead: they find the ends of the play (7.15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from cagepose.kernels.algebra.pose import quaternion_product, write_euler_zyx
from cagepose.kernels.algebra.record import Rows, dtype_of
from cagepose.kernels.contact.loads import CARDAN_MOMENT, DEAD_FORCE, Action, PhaseLoad, acting
from cagepose.kernels.driven.workspace import empty_drive_workspace
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.kernels.outcome.trace import VERDICT_NAMES
from cagepose.kernels.quasistatic.run import QuasistaticRules
from cagepose.kernels.stability.second_order import STABILITY_NAMES
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.drives import no_drives
from cagepose.runs.methods import REGISTRY
from cagepose.runs.quasistatic import TURN_STEP_RAD

STEP_LIMIT = 60
"""One push takes so many steps at most. Forty are many for one that comes to rest, and what still turns then goes on.
"""
TURNS_ON = 0.5
"""Radians, in so many steps."""
STEEPEST, TURN = 1.55, 2.0 * np.pi
"""Radians. Pitch beyond is next to the pole of the angles; what is pushed there, or all around, has no end."""
YAW, PITCH, ROLL = range(3)
UNITS = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Freedom:
    """What is asked: how far a point of the object goes along a direction of the cage, or how far an angle turns.

    Attributes
    ----------
    at_object_m, direction_cage
        Of a way, (3,) each; metres, and a unit vector.
    angle
        YAW, PITCH or ROLL in the cage's axes, from the start; None: a way.
    """

    at_object_m: FloatArray
    direction_cage: FloatArray
    angle: int | None = None


@dataclass(frozen=True, eq=False)
class Pushed:
    """Where a push led.

    Attributes
    ----------
    start, poses
        Where it began, and where the object was after each step.
    verdict
        "rests", or as of a run that does not.
    is_saddle
        Whether it rests where a motion to the side would let the push go on.
    passes_pole
        Whether an angle came to where it has no end, or all around.
    contacts
        At the end, rows of `ContactRecord`.
    """

    start: Pose
    poses: FloatArray
    verdict: str
    is_saddle: bool
    passes_pole: bool
    contacts: np.ndarray

    @property
    def pose(self) -> Pose:
        """At the end."""
        return self.pose_after(len(self.poses))

    def pose_after(self, n_steps: int) -> Pose:
        if n_steps == 0:
            return self.start
        return _pose(self.poses[n_steps - 1])

    @property
    def rests(self) -> bool:
        return self.verdict == "rests"

    @property
    def goes_on(self) -> bool:
        """Whether nothing is ahead, or the object turns around."""
        return self.verdict == "escapes" or (not self.rests and self.passes_pole)


class Pushes:
    """The object of a scene, to be pushed.

    Attributes
    ----------
    start
        From where ways and angles count.
    is_seated
        Whether more than the push acts.
    held
        1 for each freedom that is held, else 0, (6,).
    n_steps
        That all pushes so far took together.
    """

    def __init__(
        self,
        scene: Scene,
        start: Pose,
        seat: np.ndarray,
        unit_n: float = 1.0,
        unit_nm: float = 1.0,
        displaced: FloatArray | None = None,
        held: FloatArray | None = None,
    ) -> None:
        """
        Parameters
        ----------
        scene
            Its start pose, loads and friction do not matter.
        start
            See above.
        seat
            What acts beside each push, rows of `Action`.
        unit_n, unit_nm
            How much force and moment a push has.
        displaced
            Where the bodies of the cage stand, as for `cases_of`.
        held
            1 for each freedom that is held, else 0, (6,); None: those of the scene.
        """
        self.start, self._cage = start, scene.cage.pose_world_cage
        self._center, self._units = scene.object.center_of_gravity_m, (unit_n, unit_nm)
        self.is_seated = len(seat) > 0
        self._actions = np.concatenate([np.zeros(1, dtype_of(Action)), seat])
        self._to_cage = _between(self._cage.inverse(), start.inverse() @ self._cage)
        cases = cases_of(scene, 0.0, None, displaced)
        self._run = REGISTRY["quasistatic"].run
        cases = cases._replace(
            object_positions=cases.object_positions.copy(),
            object_quaternions=cases.object_quaternions.copy(),
            point_frictions=np.full_like(cases.point_frictions, np.nan),
            box_frictions=np.full_like(cases.box_frictions, np.nan),
            drives=no_drives(scene),
            actions=cast(Rows[Rows[PhaseLoad]], self._actions[None, None]),
        )
        self._outcome = empty_outcome(scene.geometry, 1, STEP_LIMIT, 0)
        rules = QuasistaticRules(TURN_STEP_RAD, STEP_LIMIT)
        work = empty_drive_workspace(scene.geometry, STEP_LIMIT, 1, 1, len(self._actions))
        part = part_of(scene)
        if held is not None:
            part.body.held[:] = held
        self.held = part.body.held.copy()
        self._begins = cases.object_positions[0], cases.object_quaternions[0]
        self._arguments = [Slots(argument) for argument in (part, cases, rules, work, self._outcome)]
        self.n_steps = 0

    def push(self, freedom: Freedom, sign: float, start: Pose) -> Pushed:
        """Push from a pose, towards the greatest value (sign 1) or the least (-1), until the push is at rest.

        The work of a force is how far its point goes along it; the work of a Cardan moment is how far its angle turns.
        """
        self._aim(freedom, sign)
        angle, pushed = freedom.angle, self._let_go(start, freedom.angle)
        last = pushed
        while angle is not None and last.verdict == "limit" and not pushed.passes_pole:
            if abs(self._turned(angle, last.start, last.poses)) < TURNS_ON:
                break
            last = self._let_go(last.pose, angle)
            poses = np.concatenate([pushed.poses, last.poses])
            pushed = replace(last, start=start, poses=poses, passes_pole=self._pass_pole(angle, start, poses))
        return pushed

    def settle(self) -> Pushed:
        """Let what acts beside pushes bring the object to rest, from the start."""
        self._actions[0]["kind"], self._actions[0]["vector"] = DEAD_FORCE, 0.0
        return self._let_go(self.start, None)

    def _let_go(self, start: Pose, angle: int | None) -> Pushed:
        self._begins[0][:], self._begins[1][:] = start.position_m, start.quaternion_wxyz
        self._run(*self._arguments)
        _, _, n_steps, n_contacts = self._outcome.counts.tolist()
        self.n_steps += n_steps
        contacts, poses = cast(Any, self._outcome.contacts), self._outcome.path[:n_steps].copy()
        ended = self._outcome.phases[0]
        return Pushed(
            start,
            poses,
            VERDICT_NAMES[ended.verdict],
            STABILITY_NAMES[ended.stability] == "unstable",
            angle is not None and self._pass_pole(angle, start, poses),
            contacts[:n_contacts].copy(),
        )

    def _pass_pole(self, angle: int, start: Pose, poses: FloatArray) -> bool:
        """Whether an angle turns all around along poses, (n, 7), or the pitch comes to the pole at one of them."""
        is_steep = (np.abs(self._angles(poses)[:, PITCH]) > STEEPEST).any()
        return bool(is_steep) or abs(self._turned(angle, start, poses)) > TURN

    def _turned(self, angle: int, start: Pose, poses: FloatArray) -> float:
        """Return how far an angle turns from a start along poses, (n, 7)."""
        return _unwound(self._angles(np.concatenate([_row(start), poses]))[:, angle])

    def _angles(self, poses: FloatArray) -> FloatArray:
        """Return yaw, pitch and roll of poses (n, 7) in the cage's axes, from the start, (n, 3), radians."""
        found = np.zeros((len(poses), 3))
        write_euler_zyx(poses[:, 3:] @ self._to_cage, found)
        return found

    def value(self, freedom: Freedom, chain: Sequence[Pushed]) -> float:
        """Return how far pushes, one after the other, led from the start: metres, or radians with all turns around."""
        if freedom.angle is not None:
            poses = np.concatenate([_row(self.start), *(pushed.poses for pushed in chain)])
            return _unwound(self._angles(poses)[:, freedom.angle])
        pose = chain[-1].pose
        way = pose.transform(freedom.at_object_m) - self.start.transform(freedom.at_object_m)
        return float(self._cage.rotation @ freedom.direction_cage @ way)

    def wrench(self, freedom: Freedom, sign: float, pose: Pose) -> FloatArray:
        """Return a push at a pose: force, and moment about the centre of gravity, (6,), whose work is its value."""
        self._aim(freedom, sign)
        one = acting(self._actions[0], as_vector(np.zeros(3)), pose.as_tuples()[1])
        return np.append(one.force, one.moment) / self._units[0 if freedom.angle is None else 1]

    def _aim(self, freedom: Freedom, sign: float) -> None:
        action = self._actions[0]
        if freedom.angle is None:
            action["kind"] = DEAD_FORCE
            action["vector"] = sign * self._units[0] * (self._cage.rotation @ freedom.direction_cage)
            action["arm_object"] = freedom.at_object_m - self._center
        else:
            action["kind"], action["vector"] = CARDAN_MOMENT, 0.0
            action["vector"][freedom.angle] = sign * self._units[1]
            action["anchor"] = self._cage.rotation[:, 2]
            action["arm_object"] = self.start.rotation.T @ self._cage.rotation[:, 0]


def unseated(scene: Scene, held: FloatArray | None = None) -> Pushes:
    """Return pushes from the scene's start, with nothing beside them; ``held`` as for `Pushes`."""
    return Pushes(scene, scene.object.pose_world_object, np.zeros(0, dtype_of(Action)), held=held)


def _pose(row: FloatArray) -> Pose:
    return Pose.from_unit(row[:3], row[3:])


def _row(pose: Pose) -> FloatArray:
    return np.concatenate([pose.position_m, pose.quaternion_wxyz])[None]


def _between(left: Pose, right: Pose) -> FloatArray:
    """Return the matrix (4, 4) that makes quaternions of poses, as rows, those of the poses between two others."""
    before, after = left.as_tuples()[1], right.as_tuples()[1]
    return np.array([quaternion_product(quaternion_product(before, as_unit), after) for as_unit in UNITS])


def _unwound(angles: FloatArray) -> float:
    """Return how far angles turn from the first to the last, each less than half a turn from the one before."""
    steps = np.diff(angles)
    return float((steps - TURN * np.round(steps / TURN)).sum())
