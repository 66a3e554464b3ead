"""Many cases of one scene as kernels take them: `Batch`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.contact.loads import FIXED_FORCE, SPRING, PhaseLoad
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.endings import INVALID, NOT_RUN, Endings, empty_endings
from cagepose.kernels.outcome.trace import BLOCKED, JAMS, STOPS
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.geometry import sizes_with_points
from cagepose.model.planar import LEAST_TILT, tilt
from cagepose.model.pose import Pose, quaternions_of
from cagepose.model.scene import FARTHEST_START, Scene
from cagepose.runs.actions import actions_of, cage_middles, spring_ends, tensions_at_zero
from cagepose.runs.cases import cases_of, greatest_friction, part_of
from cagepose.runs.load_scaling import scaled_pushes
from cagepose.runs.methods import Method
from cagepose.runs.variation import Variation


class DriveEnds(NamedTuple):
    """What came of the drives of many runs, (n, n_phases) each; see `cagepose.runs.many.Runs`."""

    shares: FloatArray
    greatest: FloatArray
    jam_possible: NDArray[np.bool_]


def drive_ends(scene: Scene, endings: Endings, frictions: FloatArray) -> DriveEnds:
    """Return what came of the drives of runs of scenes that differ in numbers, given the friction coefficient of each,
    (n,), or of all, (1,).
    """
    codes, drives = endings.verdicts, np.array([bool(load.drive) for load in scene.loads])
    is_driven = drives & ((endings.shares > 0.0) | np.isin(codes, (BLOCKED, JAMS, STOPS)))
    different, places = np.unique(frictions, return_inverse=True)
    friction = np.array([greatest_friction(scene, one) for one in different.tolist()])[places]
    could_jam = endings.least_jams <= friction[:, None]
    return DriveEnds(
        np.where(drives & (codes != NOT_RUN) & (codes != INVALID), endings.shares, np.nan),
        np.where(is_driven, endings.greatest, np.nan),
        is_driven & could_jam,
    )


class Batch:
    """Runs of one scene by one method.

    Attributes
    ----------
    n_runs
        How many.
    endings
        Filled by `run_piece`.
    """

    def __init__(self, scene: Scene, method: Method, variation: Variation) -> None:
        self._scene, self._method = scene, method
        self.n_runs, columns = variation.columns(scene)
        self.endings = empty_endings(self.n_runs, len(scene.loads), len(scene.cage.element_names))
        cases = varied_cases(scene, method.friction(scene), columns)
        self._part, self._cases, self._frictions = Slots(part_of(scene)), Slots(cases), cases.frictions
        self._endings = Slots(self.endings)
        self._is_stopped = np.zeros(1, np.int64)
        self._idle = list[Callable[[int, int], None]]()

    def run_piece(self, first: int, last: int) -> int:
        """Run ``first`` up to, without, ``last``, in any thread; return how many these are."""
        try:
            run = self._idle.pop()
        except IndexError:
            run = self._workspace()
        run(first, last)
        if last < self.n_runs:
            self._idle.append(run)
        return last - first

    def drives(self) -> DriveEnds:
        """Return what came of the drives of all runs, which are done."""
        return drive_ends(self._scene, self.endings, self._frictions)

    def stop(self) -> None:
        """Let all pieces that run now end, with KeyboardInterrupt."""
        self._is_stopped[0] = 1

    def _workspace(self) -> Callable[[int, int], None]:
        """Return a call of the kernel with a workspace for one thread."""
        rules = self._method.rules(self._scene)
        work = Slots(self._method.workspace(self._scene, rules.step_limit))
        return partial(
            _run,
            self._method,
            self._is_stopped,
            [self._part, self._cases, FARTHEST_START, Slots(rules), work, self._endings],
        )


def _run(method: Method, is_stopped: NDArray[np.int64], arguments: list[object], first: int, last: int) -> None:
    method.run_cases.until(is_stopped, first, last, *arguments)


def varied_cases(scene: Scene, friction: float, columns: dict[str, FloatArray]) -> Cases:
    """Return the cases of a scene in which columns stand in the place of its own values."""
    base = cases_of(scene, friction)
    _expect_in_plane(scene, columns.get("cage_euler_zyx"))
    points = _owned(columns.get("points_cage_m", base.points_cage))
    return Cases(
        _owned(columns.get("cage_position_m", base.cage_positions)),
        _quaternions(columns.get("cage_euler_zyx"), scene.cage.pose_world_cage),
        points,
        base.bodies_cage,
        base.displaced,
        base.drives,
        _owned(columns.get("object_position_m", base.object_positions)),
        _quaternions(columns.get("object_euler_zyx"), scene.object.pose_world_object),
        sizes_with_points(scene.object, scene.cage, points) if "points_cage_m" in columns else base.sizes_m,
        _owned(columns.get("friction_coefficient", base.frictions)),
        base.point_frictions,
        base.box_frictions,
        _actions(scene, columns),
        base.tolerances,
    )


def _expect_in_plane(scene: Scene, cage_euler_zyx: FloatArray | None) -> None:
    """
    Raises
    ------
    SceneError
        Cages that are tilted out of the plane of a planar scene.
    """
    if scene.planar is None or cage_euler_zyx is None:
        return
    tilts = [tilt(scene.planar, Pose(euler_zyx=angles)) for angles in cage_euler_zyx]
    if max(tilts, default=0.0) > LEAST_TILT:
        row = int(np.argmax(tilts))
        message = f"tilts the cage out of the plane {scene.planar} in row {row}; turn it in the plane alone"
        raise SceneError([Problem(("cage_euler_zyx",), message)])


def _owned(array: FloatArray) -> FloatArray:
    """A copy in C order, as kernels take arrays."""
    return np.array(array, order="C")


def _quaternions(angles: FloatArray | None, pose: Pose) -> FloatArray:
    return pose.quaternion_wxyz[None] if angles is None else quaternions_of(angles)


def _actions(scene: Scene, columns: dict[str, FloatArray]) -> Rows[Rows[PhaseLoad]]:
    varied = [name for name in columns if name.startswith("force_")]
    starts = list[str]()
    actions = actions_of(scene)
    if np.isin(actions["kind"], (SPRING, FIXED_FORCE)).any():
        starts = [name for name in columns if name.startswith(("object_", "cage_", "points_"))]
    n_rows = len(columns[(varied + starts)[0]]) if varied or starts else 1
    actions = np.repeat(actions[None], n_rows, axis=0)
    if varied:
        _vary_force(scene, columns, actions)
    if starts:
        _vary_anchors(scene, columns, actions)
    return cast(Rows[Rows[PhaseLoad]], actions)


def _vary_force(scene: Scene, columns: dict[str, FloatArray], actions: np.ndarray) -> None:
    """Write the one force of the scene, and the weight beside it, into each row."""
    ((place, load, force),) = [(k, load, force) for k, load in enumerate(scene.loads) for force in load.pushes]
    directions, magnitudes = force.direction[None], columns.get("force_magnitude_n")
    if "force_direction_world" in columns:
        directions = unit_rows(columns["force_direction_world"])
    if magnitudes is None and force.magnitude_n is not None:
        magnitudes = np.array([force.magnitude_n])
    weights, forces, _ = scaled_pushes(scene.object.mass_kg, load.gravity_world, directions, magnitudes)
    actions["vector"][:, place, 0] = weights
    actions["vector"][:, place, 1] = forces
    if "force_at_object_m" in columns:
        actions["arm_object"][:, place, 1] = columns["force_at_object_m"] - scene.object.center_of_gravity_m


def _vary_anchors(scene: Scene, columns: dict[str, FloatArray], actions: np.ndarray) -> None:
    """Write the springs' tensions, which are those of the preload where the object starts, and where they are held, and
    fixed forces act, as seen from the middle of the cage.
    """
    start, cage = scene.object.pose_world_object, scene.cage.pose_world_cage
    of_cage = columns.get("cage_position_m", cage.position_m[None]), _quaternions(columns.get("cage_euler_zyx"), cage)
    middles = cage_middles(scene, columns.get("points_cage_m", scene.cage.points_cage[None]), *of_cage)
    positions = columns.get("object_position_m", start.position_m[None])
    quaternions = _quaternions(columns.get("object_euler_zyx"), start)
    for place, load in enumerate(scene.loads):
        springs = np.flatnonzero(actions["kind"][0, place] == SPRING)
        for column, spring in zip(springs, load.springs, strict=True):
            ends = spring_ends(scene, spring, *of_cage)
            actions["anchor"][:, place, column] = ends - middles
            actions["tension_at_zero"][:, place, column] = tensions_at_zero(spring, ends, positions, quaternions)
        fixed = np.flatnonzero(actions["kind"][0, place] == FIXED_FORCE)
        points = [push.at_world_m for push in load.pushes if push.at_world_m is not None]
        for column, point in zip(fixed, points, strict=True):
            actions["anchor"][:, place, column] = point - middles
