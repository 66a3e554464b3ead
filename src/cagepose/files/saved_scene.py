"""Scenes back into files: `save_scene`."""

from __future__ import annotations

import io
import os
import re
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq

from cagepose.files.key_path import parse_key_path, resolved, value_at
from cagepose.files.scene_document import scene_document
from cagepose.files.units import LENGTH_UNITS, LengthUnit
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, write_whole
from cagepose.model.checks import expect, expect_choice
from cagepose.model.scene import Scene

LINE_WIDTH = 110
"""Characters; a mapping that is shorter stands in one line."""
LONG_NUMBERS = re.compile(r"[-+.eE\d, ]{1000,}")
"""Texts that ruamel.yaml does not get to see, as it looks at each character several times."""
STANDS_FOR = re.compile("\ue000(\\d+)\ue000")
"""What stands for such a text: its number between characters that nobody uses."""


def save_scene(scene: Scene, path: str | os.PathLike[str], length_unit: LengthUnit = "mm") -> None:
    """Write a scene file from which `load_scene` reads the same scene, whole or not at all.

    Numbers are as short as that allows; a scene holds no parameters, but what its expressions came to. Not each number
    of metres is one of millimetres or inches: lengths that were given in another unit may differ in their last digit.
    The ranges of adjustable numbers are written as they are: give the unit of the file that they come from. Those whose
    key leads to no number of the file, such as a parameter, are left out.

    Raises
    ------
    SceneError
        It is no scene, or an unknown unit.
    OSError
        The file cannot be written, or holds something else than a scene that was saved.
    """
    expect(scene, Scene, "scene")
    expect_choice(length_unit, LENGTH_UNITS, "length_unit")
    check_can_save_scene(path)
    yaml = YAML()
    yaml.width = 4096  # no line is broken
    yaml.indent(mapping=2, sequence=4, offset=2)
    stream = io.StringIO(f"# A scene, {MADE_BY}.\n")
    stream.seek(0, io.SEEK_END)
    long = list[str]()
    yaml.dump(_styled(_readable(scene_document(scene, length_unit)), long), stream)
    content = STANDS_FOR.sub(lambda found: long[int(found[1])], stream.getvalue())
    write_whole(path, content.encode())


def check_can_save_scene(path: str | os.PathLike[str]) -> None:
    """Find out before long work whether `save_scene` can write to ``path``.

    Raises
    ------
    OSError
        It cannot, see `check_can_write`.
    """
    check_can_write(path, is_made_by_us, "a scene that cagepose saved")


def _readable(data: dict[str, Any]) -> dict[str, Any]:
    """Return data without the adjustable numbers that stand nowhere in them: no file may have such."""
    found = {name: entry for name, entry in data.get("adjustable", {}).items() if _has_number(data, entry["key"])}
    others = {key: value for key, value in data.items() if key != "adjustable"}
    return {**others, "adjustable": found} if found else others


def _has_number(data: dict[str, Any], key: str) -> bool:
    try:
        value = value_at(data, resolved(data, parse_key_path(key)))
    except ValueError:
        return False
    return isinstance(value, int | float) and not isinstance(value, bool)


def _styled(value: object, long: list[str]) -> object:
    """Return data in the form that people write: numbers in brackets, short mappings in one line. Long texts of numbers
    are added to ``long``, and what stands for them is returned.
    """
    if isinstance(value, dict):
        found = CommentedMap((key, _styled(item, long)) for key, item in value.items())
        is_flat = not any(isinstance(item, dict) for item in value.values()) and _is_short(value)
        if is_flat or (len(value) > 1 and _is_short(value)):
            found.fa.set_flow_style()
        return found
    if isinstance(value, list):
        rows = CommentedSeq(_styled(item, long) for item in value)
        if not any(isinstance(item, dict | list) for item in value):
            rows.fa.set_flow_style()
        return rows
    if isinstance(value, str) and LONG_NUMBERS.fullmatch(value):
        long.append(value)
        return f"\ue000{len(long) - 1}\ue000"
    return value


def _is_short(value: object) -> bool:
    return len(repr(value)) <= LINE_WIDTH
