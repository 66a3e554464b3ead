"""Many runs of one scene as the kernels take them: one class for each method."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np

from cagepose.kernels.algebra.pose import write_quaternions
from cagepose.kernels.algebra.record import Rows, dtype_of
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.batch.quasistatic import quasistatic_runs
from cagepose.kernels.batch.rows import Endings, Starts, empty_endings
from cagepose.kernels.batch.stepwise import stepwise_runs
from cagepose.kernels.contact.metric import PhaseLoad
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.quasistatic.run import QuasistaticRules, empty_quasistatic_workspace
from cagepose.kernels.stability.proof import empty_proof_room
from cagepose.kernels.stepwise.run import PhaseLoads, empty_workspace
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.geometry import cage_sizes, object_size
from cagepose.model.load import Force, Load
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene
from cagepose.runs.frames import Frames, middle_of_boxes
from cagepose.runs.judge import body_of
from cagepose.runs.quasistatic import STEP_LIMIT, TURN_STEP_RAD
from cagepose.runs.stepwise import no_slip_angle_rad, phase_loads, rules_of_size
from cagepose.runs.variation import Variation
from cagepose.runs.weights import dead_loads, weigh


class Batch(ABC):
    """Runs of one scene. A method says which kernel runs them, and with what (`room`).

    Attributes
    ----------
    n_runs
        How many.
    endings
        Filled by `run_piece`.
    """

    n_runs: int
    endings: Endings

    def _begin(self, scene: Scene, variation: Variation, middle_object: FloatArray) -> dict[str, FloatArray]:
        self._scene, self._frames = scene, Frames(scene, middle_object)
        self.n_runs, columns = variation.columns(scene)
        self.endings = empty_endings(self.n_runs, len(scene.loads), len(scene.cage.names))
        self._idle_rooms = list[Callable[[int, int], None]]()
        return columns

    @abstractmethod
    def room(self) -> Callable[[int, int], None]:
        """Return a call of the kernel, with room for one thread: it runs the first up to, without, the last."""

    def run_piece(self, first: int, last: int) -> int:
        """Run ``first`` up to, without, ``last``, in any thread; return how many these are."""
        try:
            run = self._idle_rooms.pop()
        except IndexError:
            run = self.room()
        run(first, last)
        if last < self.n_runs:
            self._idle_rooms.append(run)
        return last - first


class StepwiseBatch(Batch):
    """Runs of one scene by the paper's rules."""

    def __init__(self, scene: Scene, variation: Variation) -> None:
        columns = self._begin(scene, variation, middle_of_boxes(scene))
        frictions = columns.get("friction_coefficient")
        angles = np.array([no_slip_angle_rad(scene)]) if frictions is None else np.arctan(frictions)
        self._starts = _starts(scene, columns, angles)
        self._loads = _stepwise_loads(scene, columns, self._frames.middle_object)
        self._rules = rules_of_size(scene, 1.0)
        self._tolerances = kernel_tolerances(1.0, scene.tolerances.touch)

    def room(self) -> Callable[[int, int], None]:
        geometry = self._frames.geometry(self._scene)
        return _prepared(
            stepwise_runs,
            self._starts,
            self._loads,
            geometry,
            as_vector(self._frames.middle_object),
            self._rules,
            self._tolerances,
            empty_workspace(geometry, len(self._scene.loads), self._rules),
            self.endings,
        )


class QuasistaticBatch(Batch):
    """Runs of one scene by the mechanics."""

    def __init__(self, scene: Scene, variation: Variation) -> None:
        columns = self._begin(scene, variation, scene.object.center_of_gravity_m)
        self._body = body_of(scene)
        friction = scene.friction_coefficient or 0.0
        self._starts = _starts(scene, columns, columns.get("friction_coefficient", np.array([friction])))
        self._loads = _quasistatic_loads(scene, columns)
        self._rules = QuasistaticRules(friction, TURN_STEP_RAD, STEP_LIMIT)
        self._tolerances = kernel_tolerances(1.0, scene.tolerances.touch)

    def room(self) -> Callable[[int, int], None]:
        geometry = self._frames.geometry(self._scene)
        return _prepared(
            quasistatic_runs,
            self._starts,
            self._loads,
            geometry,
            self._body,
            as_vector(self._frames.middle_object),
            self._rules,
            self._tolerances,
            empty_quasistatic_workspace(geometry, len(self._scene.loads), STEP_LIMIT),
            empty_proof_room(geometry),
            self.endings,
        )


def _prepared(kernel: Callable[..., None], *arguments: object) -> Callable[[int, int], None]:
    slots = [Slots(argument) for argument in arguments]
    return lambda first, last: kernel(first, last, *slots)


def _starts(scene: Scene, columns: dict[str, FloatArray], frictions: FloatArray) -> Starts:
    cage, held = scene.cage.pose_world_cage, scene.object.pose_world_object
    points = columns.get("points_cage_m")
    sizes_m = np.array([scene.size_m])
    if points is not None:
        sizes_m = np.maximum(object_size(scene.object), cage_sizes(points))
    return Starts(
        _owned(columns.get("cage_position_m", cage.position_m[None])),
        _owned(_quaternions(columns.get("cage_euler_zyx"), cage)),
        _owned(scene.cage.points_cage[None] if points is None else points),
        _owned(columns.get("object_position_m", held.position_m[None])),
        _owned(_quaternions(columns.get("object_euler_zyx"), held)),
        sizes_m,
        _owned(frictions),
        FARTHEST_START,
    )


def _owned(array: FloatArray) -> FloatArray:
    """A copy in C order, as kernels take arrays."""
    return np.array(array, order="C")


def _quaternions(angles: FloatArray | None, pose: Pose) -> FloatArray:
    if angles is None:
        return pose.quaternion_wxyz[None]
    found = np.empty((len(angles), 4))
    write_quaternions(angles, found)
    return found


def _stepwise_loads(scene: Scene, columns: dict[str, FloatArray], middle_object: FloatArray) -> PhaseLoads:
    base = phase_loads(scene, middle_object)
    directions, points = base.directions_world[None], base.points_object[None]
    push = np.flatnonzero(base.is_push)
    if "force_direction_world" in columns:
        directions = np.repeat(directions, len(columns["force_direction_world"]), axis=0)
        directions[:, push[0]] = _unit_rows(columns["force_direction_world"])
    if "force_at_object_m" in columns:
        points = np.repeat(points, len(columns["force_at_object_m"]), axis=0)
        points[:, push[0]] = columns["force_at_object_m"] - middle_object
    return PhaseLoads(directions, points, base.is_push)


def _quasistatic_loads(scene: Scene, columns: dict[str, FloatArray]) -> Rows[Rows[PhaseLoad]]:
    varied = [name for name in columns if name.startswith("force_")]
    n_rows = len(columns[varied[0]]) if varied else 1
    loads = np.zeros((n_rows, len(scene.loads)), dtype_of(PhaseLoad)).view(np.recarray)
    loads[:] = dead_loads(scene)
    if varied:
        ((place, load, force),) = [
            (k, load, load.force) for k, load in enumerate(scene.loads) if load.force is not None
        ]
        magnitudes = np.ones(n_rows)
        if "force_magnitude_n" in columns:  # of a force of 1 N: a scene may give none, and count no newtons then
            magnitudes = columns["force_magnitude_n"]
            force = Force(force.direction_world, force.at_object_m, 1.0)
        weighed = weigh(scene, Load(load.name, gravity=load.gravity_world, force=force))
        pushes = weighed.force[None]
        if "force_direction_world" in columns:
            pushes = np.linalg.norm(weighed.force) * _unit_rows(columns["force_direction_world"])
        # Where newtons do not count, the weight is a part of the force.
        weights = np.ones(n_rows) if weighed.in_newtons else magnitudes
        loads["forces_world"][:, place, 0] = weights[:, None] * weighed.gravity
        loads["forces_world"][:, place, 1] = magnitudes[:, None] * pushes
        if "force_at_object_m" in columns:
            loads["arms_object"][:, place, 1] = columns["force_at_object_m"] - scene.object.center_of_gravity_m
    return loads


def _unit_rows(vectors: FloatArray) -> FloatArray:
    scaled = vectors / np.abs(vectors).max(axis=1, keepdims=True)  # so that squares neither vanish nor overflow
    unit: FloatArray = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
    return unit
