"""A scene file with some values changed, as text: comments and lines stay as they were."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence

import numpy as np
from ruamel.yaml import YAML

from cagepose.files.key_path import Path, parse_key_path, set_value, value_at
from cagepose.files.numbers_in_text import with_numbers
from cagepose.files.scene_file import SceneText
from cagepose.files.yaml_source import parse_yaml

ANGLE_DECIMALS = 10
"""Degrees are written with so many decimals. An orientation that was a quaternion changes by far less than the touch
tolerance, and reads well."""


def setting(key: str, value: object) -> str:
    """Return the change of one value as ``--set`` takes it; ``value`` is plain data.

    >>> setting("cage.pose.position", [0, 0, 2.5])
    'cage.pose.position=[0, 0, 2.5]'
    """
    return f"{key}={json.dumps(value)}"


def with_cage_angles(scene_text: SceneText) -> SceneText:
    """Return the file with the cage's orientation as angles, if it is a quaternion there: angles can have sliders.

    Raises
    ------
    SceneFileError
        The scene cannot be used, see `load_scene`.
    """
    pose = value_at(scene_text.yaml.data, ("cage", "pose"))
    if value_at(pose, ("quat_wxyz",)) is None:
        return scene_text
    angles = np.degrees(scene_text.scene_file().scene.cage.pose_world_cage.euler_zyx)
    kept = {key: value for key, value in pose.items() if key != "quat_wxyz"}
    anew = {**kept, "euler_zyx_deg": np.round(angles, ANGLE_DECIMALS).tolist()}
    return edited(scene_text, [setting("cage.pose", anew)])


def edited(scene_text: SceneText, set_values: Sequence[str]) -> SceneText:
    """Return the file as if ``set_values`` stood in it.

    Raises
    ------
    SceneFileError
        As `edited_text`.
    """
    if not set_values:
        return scene_text
    text = edited_text(scene_text, set_values)
    return SceneText(text, parse_yaml(text, scene_text.yaml.source), scene_text.folder)


def edited_text(scene_text: SceneText, set_values: Sequence[str]) -> str:
    """Return the file's text with ``set_values`` in it, such as ``"object.boxes[0].size[2]=12"``.

    Raises
    ------
    SceneFileError
        The scene that would result cannot be used, see `load_scene`.
    """
    scene_text.scene_file(set_values)
    changes: dict[Path, object] = {}
    for argument in set_values:
        key, _, text = argument.partition("=")
        changes[parse_key_path(key.strip())] = parse_yaml(text, argument).data if text.strip() else None
    return changed_text(scene_text, changes)


def changed_text(scene_text: SceneText, changes: Mapping[Path, object]) -> str:
    """Return the file's text with other values at some paths, unchecked. Numbers in the place of numbers change nothing
    else; with other values, blanks within lines may change.
    """
    in_place = with_numbers(scene_text.text, scene_text.yaml, changes)
    return with_values(scene_text.text, changes) if in_place is None else in_place


def with_values(text: str, changes: Mapping[Path, object]) -> str:
    """Return the text of a scene or study file with other values at some paths, unchecked."""
    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 4096  # no line is broken anew
    data = yaml.load(text)
    for path, value in changes.items():
        set_value(data, path, value)
    stream = io.StringIO()
    yaml.dump(data, stream)
    return stream.getvalue()
