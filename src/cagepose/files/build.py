"""From a checked scene file to the model: lengths to metres, angles to radians, and the problems that it finds."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numpy as np

from cagepose.errors import Key, Problem, SceneError
from cagepose.files.points_file import PointsTable
from cagepose.files.schema import BoxModel, ForceModel, LoadModel, MomentModel, PoseModel, SceneModel, SpringModel
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.load import Force, Load, Moment, Spring
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Adjustable, Scene
from cagepose.model.tolerances import GRAZING_BAND_DEFAULT_RAD, TOUCH_DEFAULT, Tolerances

Noun = TypeVar("Noun")
Given = ParamSpec("Given")


def build_scene(model: SceneModel, table: PointsTable | None) -> Scene:
    """Make the scene that ``model`` describes; ``table`` holds the points if they stand in a file of their own.

    Raises
    ------
    SceneError
        All that the model found wrong, with paths from the root of the scene file.
    """
    builder = _Builder(model.units.length if model.units else "mm")
    held = builder.make(("object",), builder.object, model)
    cage = builder.make(("cage",), builder.cage, model, table)
    loads = [builder.make(("loads", index), builder.load, load, index) for index, load in enumerate(model.loads)]
    tolerances = builder.make(("tolerances",), builder.tolerances, model)
    if builder.problems or held is None or cage is None or tolerances is None:
        raise SceneError(builder.problems)
    return Scene(
        held,
        cage,
        [load for load in loads if load is not None],
        name=model.name,
        friction_coefficient=_friction(model),
        friction_of=None if model.friction is None else model.friction.of,
        method=model.method,
        metric=model.metric,
        tolerances=tolerances,
        adjustable=[
            Adjustable(name, entry.key, entry.range[0], entry.range[1])
            for name, entry in (model.adjustable or {}).items()
        ],
    )


class _Builder:
    def __init__(self, unit: LengthUnit) -> None:
        self.unit: LengthUnit = unit
        self.problems: list[Problem] = []

    def make(
        self, prefix: tuple[Key, ...], maker: Callable[Given, Noun], *args: Given.args, **kwargs: Given.kwargs
    ) -> Noun | None:
        """Return what ``maker`` makes, or collect its problems as seen from ``prefix``."""
        try:
            return maker(*args, **kwargs)
        except SceneError as error:
            self.problems.extend(error.under(*prefix).problems)
            return None

    def object(self, model: SceneModel) -> Object:
        part = model.object
        boxes = [self.make(("object", "boxes", index), self.box, box) for index, box in enumerate(part.boxes)]
        pose = self.make(("object", "pose"), self.pose, part.pose)
        metres_per_unit = float(to_metres(1.0, self.unit))
        return Object(
            [box for box in boxes if box is not None],
            None if part.center_of_gravity is None else to_metres(part.center_of_gravity, self.unit),
            pose=pose,
            mass_kg=part.mass,
            inertia_kg_m2=None if part.inertia is None else np.array(part.inertia) * metres_per_unit**2,
        )

    def box(self, model: BoxModel) -> Box:
        pose = Pose(to_metres(model.position, self.unit), euler_zyx=_radians(model.euler_zyx_deg))
        return Box(to_metres(model.size, self.unit), pose, model.name)

    def pose(self, model: PoseModel | None) -> Pose:
        if model is None:
            return Pose()
        position = to_metres(model.position or [0.0, 0.0, 0.0], self.unit)
        return Pose(position, model.quat_wxyz, euler_zyx=_radians(model.euler_zyx_deg))

    def cage(self, model: SceneModel, table: PointsTable | None) -> Cage:
        points, names = point_rows(model, table)
        return Cage(to_metres(points, self.unit), names, self.pose(model.cage.pose))

    def load(self, model: LoadModel, index: int) -> Load | None:
        springs = [
            self.make(("loads", index, "springs", number), self.spring, spring)
            for number, spring in enumerate(model.springs or [])
        ]
        if None in springs:
            return None
        return Load(
            model.name,
            gravity=model.gravity,
            force=None if model.force is None else self.force(model.force),
            forces=[self.force(force) for force in model.forces or []],
            moments=[self.moment(moment) for moment in model.moments or []],
            springs=[spring for spring in springs if spring is not None],
        )

    def force(self, model: ForceModel) -> Force:
        return Force(model.direction, to_metres(model.at, self.unit), model.magnitude, follows=bool(model.follows))

    def moment(self, model: MomentModel) -> Moment:
        return Moment(model.direction, float(to_metres(model.magnitude, self.unit)), follows=bool(model.follows))

    def spring(self, model: SpringModel) -> Spring:
        per_metre = model.stiffness / float(to_metres(1.0, self.unit))
        return Spring(to_metres(model.at, self.unit), to_metres(model.to, self.unit), per_metre, model.preload or 0.0)

    def tolerances(self, model: SceneModel) -> Tolerances:
        given = model.tolerances
        touch = TOUCH_DEFAULT if given is None or given.touch is None else given.touch
        band_deg = None if given is None else given.grazing_band_deg
        return Tolerances(touch, GRAZING_BAND_DEFAULT_RAD if band_deg is None else math.radians(band_deg))


def point_rows(model: SceneModel, table: PointsTable | None) -> tuple[list[list[float]], tuple[str, ...] | None]:
    """Return the points in the file's unit and their names (None: the default ones)."""
    points = model.cage.points
    if table is not None:
        return table.points, table.names
    if isinstance(points, dict):
        return list(points.values()), tuple(points)
    return (points, None) if isinstance(points, list) else ([], None)


def _radians(angles_deg: list[float] | None) -> list[float] | None:
    return None if angles_deg is None else [math.radians(angle) for angle in angles_deg]


def _friction(model: SceneModel) -> float | None:
    if model.friction is None:
        return None
    if model.friction.angle_deg is not None:
        return math.tan(math.radians(model.friction.angle_deg))
    return model.friction.coefficient
