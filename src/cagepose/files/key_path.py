"""Paths to one value of a scene file, as users write them: ``cage.pose.euler_zyx_deg[1]``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from cagepose.errors import Key, key_path
from cagepose.model.wording import number_of

Path = tuple[Key, ...]

_STEP = re.compile(r"\[(?P<index>\d{1,9})\]|(?P<dot>\.?)(?P<name>[^.\[\]]+)")


def parse_key_path(text: str) -> Path:
    """Split a path into keys and indices; ``boxes.1`` and ``boxes[1]`` mean the same.

    Raises
    ------
    ValueError
        The text is not a path; the message says why.

    >>> parse_key_path("object.boxes[1].size")
    ('object', 'boxes', 1, 'size')
    """
    path: list[Key] = []
    place = 0
    while place < len(text):
        step = _STEP.match(text, place)
        if step is None or (step["name"] and bool(step["dot"]) != bool(path)) or (step["index"] and not path):
            raise ValueError(
                f"{text!r} is not a path to a value; write keys with dots and indices in brackets,"
                " such as object.boxes[0].size[2]"
            )
        path.append(int(step["index"]) if step["index"] else step["name"])
        place = step.end()
    if not path:
        raise ValueError("the path is empty; write keys with dots, such as object.mass")
    return tuple(path)


def resolved(data: object, path: Path) -> Path:
    """Return ``path`` with ``.1`` as ``[1]`` where ``data`` holds a list, and ``[1]`` as ``.1`` where a mapping."""
    keys: list[Key] = []
    here: object = data
    for key in path:
        if isinstance(here, list) and isinstance(key, str) and key.isdecimal() and len(key) < 10:
            key = int(key)
        elif isinstance(here, Mapping) and isinstance(key, int):
            key = str(key)
        keys.append(key)
        here = _child(here, key)
    return tuple(keys)


def value_at(data: object, path: Path) -> Any:
    """Return the value at ``path``, or None where there is none."""
    here: object = data
    for key in path:
        here = _child(here, key)
    return here


def set_value(data: object, path: Path, value: object) -> Path:
    """Change one value of ``data`` in place, making mappings on the way where there is nothing yet.

    Returns
    -------
    Path
        Where the value stands, see `resolved`.

    Raises
    ------
    ValueError
        An index outside its list, or a step into a number or text; the message says which.
    """
    path = resolved(data, path)
    here: Any = data
    for depth, key in enumerate(path):
        _check_step(here, key, key_path(path[:depth]) or "the scene")
        if depth == len(path) - 1:
            here[key] = value
        elif isinstance(here, dict) and here.get(key) is None and isinstance(path[depth + 1], str):
            here[key] = here = {}
        else:
            here = _child(here, key)
    return path


def _check_step(here: object, key: Key, held: str) -> None:
    if isinstance(here, list):
        allowed = f"give an index from 0 to {len(here) - 1}" if here else "set the whole list"
        if not isinstance(key, int):
            raise ValueError(f"{held} is a list, which has no key {key!r}; {allowed}")
        if key >= len(here):
            raise ValueError(f"{held} holds {number_of(len(here), 'value')}, so it has no index {key}; {allowed}")
    elif here is None:
        raise ValueError(f"{held} is missing, so it has no index {key}; write it into the scene, or set it as a whole")
    elif not isinstance(here, dict):
        raise ValueError(f"{held} is a single value, which holds no {key!r}; set {held} itself")


def _child(here: object, key: Key) -> object:
    if isinstance(here, Mapping):
        return here.get(key)
    if isinstance(here, list) and isinstance(key, int) and key < len(here):
        return here[key]
    return None
