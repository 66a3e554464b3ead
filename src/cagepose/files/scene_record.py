"""A `Scene` as plain data without loss: SI units, every float to its last digit.

One strict pydantic model for each noun, so that a damaged file is told apart from a good one field by field.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.load import Force, Load
from cagepose.model.methods import Metric
from cagepose.model.parts import Box, Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Adjustable, Scene
from cagepose.model.tolerances import Tolerances

Three = Annotated[list[float], Field(min_length=3, max_length=3)]
Four = Annotated[list[float], Field(min_length=4, max_length=4)]


class Record(BaseModel):
    """Strict: nothing missing, nothing more, no number that is not finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class PoseRecord(Record):
    """A `Pose`."""

    position_m: Three
    quaternion_wxyz: Four

    @classmethod
    def of(cls, pose: Pose) -> PoseRecord:
        return cls(position_m=pose.position_m.tolist(), quaternion_wxyz=pose.quaternion_wxyz.tolist())

    def pose(self) -> Pose:
        return Pose(self.position_m, self.quaternion_wxyz)


class BoxRecord(Record):
    """A `Box`."""

    name: str
    size_m: Three
    pose: PoseRecord


class ForceRecord(Record):
    """A `Force`."""

    direction: Three
    at_m: Three
    magnitude_n: float | None


class LoadRecord(Record):
    """A `Load`."""

    name: str
    gravity: Three | None
    force: ForceRecord | None

    @classmethod
    def of(cls, load: Load) -> LoadRecord:
        force = load.force
        return cls(
            name=load.name,
            gravity=list_or_none(load.gravity_world),
            force=None
            if force is None
            else ForceRecord(
                direction=force.direction_world.tolist(), at_m=force.at_object_m.tolist(), magnitude_n=force.magnitude_n
            ),
        )

    def load(self) -> Load:
        force = self.force
        push = None if force is None else Force(force.direction, force.at_m, force.magnitude_n)
        return Load(self.name, gravity=self.gravity, force=push)


class AdjustableRecord(Record):
    """An `Adjustable`."""

    name: str
    key: str
    low: float
    high: float


class SceneRecord(Record):
    """A `Scene`."""

    name: str
    boxes: list[BoxRecord]
    center_of_gravity_m: Three
    mass_kg: float | None
    inertia_kg_m2: Annotated[list[Three], Field(min_length=3, max_length=3)] | None
    pose: PoseRecord
    point_names: list[str]
    points_m: list[Three]
    cage_pose: PoseRecord
    loads: list[LoadRecord]
    friction_coefficient: float | None
    method: str | None
    metric: Metric | None
    touch: float
    grazing_band_rad: float
    adjustable: list[AdjustableRecord]


def scene_record(scene: Scene) -> dict[str, Any]:
    """Return ``scene`` as plain data."""
    return record_of_scene(scene).model_dump()


def scene_from_record(record: object) -> Scene:
    """Return the scene that `scene_record` wrote.

    Raises
    ------
    pydantic.ValidationError
        Not such a record.
    SceneError
        A record of a scene that cannot be right.
    """
    return scene_of_record(SceneRecord.model_validate(record))


def record_of_scene(scene: Scene) -> SceneRecord:
    held, cage = scene.object, scene.cage
    return SceneRecord(
        name=scene.name,
        boxes=[
            BoxRecord(name=str(box.name), size_m=box.size_m.tolist(), pose=PoseRecord.of(box.pose_object_box))
            for box in held.boxes
        ],
        center_of_gravity_m=held.center_of_gravity_m.tolist(),
        mass_kg=held.mass_kg,
        inertia_kg_m2=list_or_none(held.inertia_kg_m2),
        pose=PoseRecord.of(held.pose_world_object),
        point_names=list(cage.names),
        points_m=cage.points_cage.tolist(),
        cage_pose=PoseRecord.of(cage.pose_world_cage),
        loads=[LoadRecord.of(load) for load in scene.loads],
        friction_coefficient=scene.friction_coefficient,
        method=scene.method,
        metric=scene.metric,
        touch=scene.tolerances.touch,
        grazing_band_rad=scene.tolerances.grazing_band_rad,
        adjustable=[
            AdjustableRecord(name=entry.name, key=entry.key, low=entry.low, high=entry.high)
            for entry in scene.adjustable
        ],
    )


def scene_of_record(record: SceneRecord) -> Scene:
    held = Object(
        [Box(box.size_m, box.pose.pose(), box.name) for box in record.boxes],
        record.center_of_gravity_m,
        pose=record.pose.pose(),
        mass_kg=record.mass_kg,
        inertia_kg_m2=record.inertia_kg_m2,
    )
    return Scene(
        held,
        Cage(record.points_m, record.point_names, record.cage_pose.pose()),
        [load.load() for load in record.loads],
        name=record.name,
        friction_coefficient=record.friction_coefficient,
        method=record.method,
        metric=record.metric,
        tolerances=Tolerances(record.touch, record.grazing_band_rad),
        adjustable=[Adjustable(entry.name, entry.key, entry.low, entry.high) for entry in record.adjustable],
    )


def list_or_none(values: FloatArray | None) -> Any:
    return None if values is None else values.tolist()
