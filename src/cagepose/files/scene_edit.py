"""A scene file with some values changed, as text: comments and lines stay as they were."""

from __future__ import annotations

import io
from collections.abc import Sequence

from ruamel.yaml import YAML

from cagepose.files.key_path import parse_key_path, set_value
from cagepose.files.scene_file import SceneText
from cagepose.files.yaml_source import parse_yaml


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
    yaml = YAML()
    yaml.preserve_quotes = True
    yaml.width = 4096  # no line is broken anew
    data = yaml.load(scene_text.text)
    plain = YAML(typ="safe", pure=True)
    for argument in set_values:
        key, _, text = argument.partition("=")
        set_value(data, parse_key_path(key.strip()), plain.load(text))
    stream = io.StringIO()
    yaml.dump(data, stream)
    return stream.getvalue()
