"""A scene with some keys of its file changed: what `Scene.changed` asks for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.key_path import Path, parse_key_path, resolved, set_value, value_at
from cagepose.files.scene_data import scene_of
from cagepose.files.scene_document import scene_document
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

ANGLES, QUATERNION = "euler_zyx_deg", "quat_wxyz"
NO_PARAMETERS = (
    "is of a scene file, and a scene holds what its expressions came to; change these numbers, or read the file with"
    " another value: cagepose.load_scene(file, ['parameters.play=0.3'])"
)


def changed_scene(scene: Scene, changes: Mapping[str, object]) -> Scene:
    """Return a scene with values of some keys changed, all at once; lengths in metres.

    Raises
    ------
    SceneError
        A key that is none, a value that it cannot have, or a scene that cannot be right.
    """
    data = scene_document(scene, "m")
    problems = []
    for key, value in changes.items():
        try:
            if not isinstance(key, str):
                raise ValueError(f"{key!r} is no key; write one as in a scene file, such as 'object.mass'")
            path = resolved(data, _by_index(scene, data, parse_key_path(key)))
            if path[0] == "parameters":
                problems.append(Problem(path, NO_PARAMETERS))
                continue
            _choose_orientation(data, path)
            set_value(data, path, _plain(value))
        except ValueError as error:
            problems.append(Problem((), str(error)))
    if problems:
        raise SceneError(problems)
    return scene_of(data)


def _by_index(scene: Scene, data: dict[str, Any], path: Path) -> Path:
    """Return a path with the name of a point as its index, where points stand in a list without names."""
    names_at: dict[Path, tuple[str, ...]] = {("cage", "points"): scene.cage.standing.names}
    names_at |= {("cage", "bodies", body.name, "points"): body.names for body in scene.cage.bodies}
    for at, names in names_at.items():
        if path[: len(at)] == at and path[len(at) :] and path[len(at)] in names:
            is_list = isinstance(value_at(data, at), list)
            return (*at, names.index(str(path[len(at)])), *path[len(at) + 1 :]) if is_list else path
    return path


def _choose_orientation(data: dict[str, Any], path: Path) -> None:
    """Write an orientation as that of its two forms which a path leads to, and no more as the other."""
    for depth, key in enumerate(path):
        pose = value_at(data, path[:depth])
        if key == ANGLES and isinstance(pose, dict):
            quaternion = pose.pop(QUATERNION, None)
            angles = np.degrees(Pose(quaternion_wxyz=quaternion).euler_zyx).tolist()
            pose.setdefault(ANGLES, angles)
        elif key == QUATERNION and isinstance(pose, dict):
            angles_deg = pose.pop(ANGLES, (0.0, 0.0, 0.0))
            pose.setdefault(QUATERNION, Pose(euler_zyx=np.radians(angles_deg)).quaternion_wxyz.tolist())


def _plain(value: object) -> object:
    """Return arrays and tuples as lists, and NumPy's numbers as Python's."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return value
