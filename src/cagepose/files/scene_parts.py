"""A scene with other numbers of which only what they belong to is built anew: `SceneParts`."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cagepose.errors import SceneError
from cagepose.files.build import Builder
from cagepose.files.build_loads import load_of
from cagepose.files.key_path import Path as KeyPath
from cagepose.files.key_path import set_value, value_at
from cagepose.files.schema import BoxModel, LoadModel
from cagepose.files.schema_base import LARGEST_NUMBER, PoseModel
from cagepose.files.schema_shapes import ShapeModel
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.cage import Cage
from cagepose.model.cage_body import CageBody
from cagepose.model.checks import FloatArray, is_number
from cagepose.model.parts import Object
from cagepose.model.scene import Scene
from cagepose.model.scope import unknown_shapes

LISTED = {"boxes": BoxModel, "shapes": ShapeModel}
"""What bodies hold in lists, and its schema."""
Numbers = Mapping[KeyPath, float]


class OtherScene(Exception):
    """More than some numbers of parts differ, or one of them cannot be: the whole file says what comes of it."""


class SceneParts:
    """The parts of a scene, each beside the data that it was built of.

    Parameters
    ----------
    scene
        The scene.
    data
        That of its file, every expression as its number.
    length_unit
        Of its lengths.
    """

    def __init__(self, scene: Scene, data: Any, length_unit: LengthUnit) -> None:
        self._scene, self._data, self._unit = scene, data, length_unit
        self._bodies: list[KeyPath] = [("object",), ("cage",)]
        self._bodies += [("cage", "bodies", name) for name in data["cage"].get("bodies") or ()]
        self._builder = Builder(length_unit, Path())
        self._built: dict[KeyPath, Any] = {}

    def scene_with(self, numbers: Numbers) -> Scene:
        """Return the scene with other numbers at some paths, in the file's unit.

        Raises
        ------
        OtherScene
            Build it of the whole file.
        """
        changed: dict[KeyPath, dict[KeyPath, float]] = {}
        for path, number in numbers.items():
            if is_parameter(path):
                continue  # the expressions that use it stand beside it
            given = value_at(self._data, path)
            if not (abs(number) <= LARGEST_NUMBER and is_number(given)):
                raise OtherScene
            if number != given or number == 0.0:  # of two signs
                changed.setdefault(self._part_of(path), {})[path] = number
        try:
            return self._assembled(changed)
        except (SceneError, ValidationError):
            raise OtherScene from None

    def _part_of(self, path: KeyPath) -> KeyPath:
        """Return the path of what is built anew for a number."""
        if path == ("friction", "coefficient"):
            return path
        if path[0] == "loads":
            return path[:2]
        for body in reversed(self._bodies):
            place = path[: len(body) + 1]
            if path[: len(body)] != body:
                continue
            if place[-1] in LISTED and "friction" not in path:
                return path[: len(body) + 2]
            if place[-1] in ("pose", "points"):
                return place
        raise OtherScene

    def _assembled(self, changed: Mapping[KeyPath, Numbers]) -> Scene:
        scene = self._scene
        others: dict[str, Any] = {}
        if friction := changed.get(("friction", "coefficient")):
            (others["friction_coefficient"],) = friction.values()
            if others["friction_coefficient"] < 0.0:
                raise OtherScene
        if any(path[0] == "loads" for path in changed):
            others["loads"] = [
                load_of(LoadModel.model_validate(self._data_with(path, changed[path])), self._unit)
                if (path := ("loads", index)) in changed
                else load
                for index, load in enumerate(scene.loads)
            ]
        if any(path[0] == "object" for path in changed):
            others["object"] = self._object(changed)
        if any(path[0] == "cage" for path in changed):
            others["cage"] = self._cage(changed)
        found = scene.but_for(**others)
        if ("object" in others or "cage" in others) and unknown_shapes(found):
            raise OtherScene
        return found

    def _object(self, changed: Mapping[KeyPath, Numbers]) -> Object:
        held, data = self._scene.object, self._data["object"]
        pose = held.pose_world_object
        if ("object", "pose") in changed:
            pose = self._pose(("object", "pose"), changed)
        if not any(path[1] in LISTED for path in changed if path[0] == "object"):
            return held.starting_at(pose)
        return Object(
            self._listed(("object",), "boxes", changed),
            None if data.get("center_of_gravity") is None else held.center_of_gravity_m,
            shapes=self._listed(("object",), "shapes", changed),
            pose=pose,
            mass_kg=held.mass_kg,
            inertia_kg_m2=held.inertia_kg_m2,
        )

    def _cage(self, changed: Mapping[KeyPath, Numbers]) -> Cage:
        cage = self._scene.cage
        place: KeyPath = ("cage", "pose")
        pose = self._pose(place, changed) if place in changed else cage.pose_world_cage
        if not any(path[0] == "cage" and path != place for path in changed):
            return cage.placed_at(pose)
        bodies = [self._body(body, changed) for body in cage.bodies]
        points = self._points(("cage",), cage.standing.points_m, changed)
        return Cage(points, cage.standing.names, pose, self._listed(("cage",), "shapes", changed), bodies=bodies)

    def _body(self, body: CageBody, changed: Mapping[KeyPath, Numbers]) -> CageBody:
        at: KeyPath = ("cage", "bodies", body.name)
        if not any(path[:3] == at for path in changed):
            return body
        pose = self._pose((*at, "pose"), changed) if (*at, "pose") in changed else body.pose_cage_body
        points = self._points(at, body.points_body, changed)
        return CageBody(body.name, points, body.names, pose, self._listed(at, "shapes", changed))

    def _listed(self, body: KeyPath, kind: str, changed: Mapping[KeyPath, Numbers]) -> list[Any]:
        """Return the boxes or the shapes of a body, as its file has them."""
        return [
            self._shape((*body, kind, index), changed)
            for index in range(len(value_at(self._data, (*body, kind)) or ()))
        ]

    def _shape(self, path: KeyPath, changed: Mapping[KeyPath, Numbers]) -> Any:
        if path not in changed:
            if path not in self._built:
                self._built[path] = self._made(path, value_at(self._data, path))
            return self._built[path]
        return self._made(path, self._data_with(path, changed[path]))

    def _made(self, path: KeyPath, data: Any) -> Any:
        if path[-2] == "boxes":
            return self._builder.box(BoxModel.model_validate(data))
        if data.get("mesh") is not None:
            raise OtherScene
        return self._builder.shape(ShapeModel.model_validate(data))

    def _pose(self, path: KeyPath, changed: Mapping[KeyPath, Numbers]) -> Any:
        return self._builder.pose(PoseModel.model_validate(self._data_with(path, changed[path])))

    def _points(self, body: KeyPath, points_m: FloatArray, changed: Mapping[KeyPath, Numbers]) -> FloatArray:
        place = (*body, "points")
        if place not in changed:
            return points_m
        data = self._data_with(place, changed[place])
        return to_metres(list(data.values()) if isinstance(data, dict) else data, self._unit)

    def _data_with(self, path: KeyPath, numbers: Numbers) -> Any:
        data = deepcopy(value_at(self._data, path))
        for place, number in numbers.items():
            set_value(data, place[len(path) :], number)
        return data


def is_parameter(path: KeyPath) -> bool:
    """Whether a path leads to a parameter."""
    return path[:1] == ("parameters",) and len(path) == 2
