"""Numbers of a scene file written anew where they stand: all other characters of its text stay as they were."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from cagepose.files.key_path import Path, resolved, value_at
from cagepose.files.yaml_source import YamlSource, scalar_value
from cagepose.model.checks import is_number

_END_OF_LINE = re.compile("\r\n|[\r\n]")
"""Where the YAML parser counts a new line."""
_WORD = re.compile(r"[^\s,\[\]{}#]+")


class _Written(NamedTuple):
    first: int
    last: int
    word: str


class _NotInPlace(Exception):
    """What is to be written is no number in the place of a number."""


def with_numbers(text: str, yaml: YamlSource, changes: Mapping[Path, object]) -> str | None:
    """Return ``text``, which was read as ``yaml``, with other numbers at some paths; None: a change is of another kind,
    such as of a key that is not there. Lists and mappings of numbers may stand for their numbers.
    """
    starts = [0, *(end.end() for end in _END_OF_LINE.finditer(text))]
    written = dict[int, _Written]()
    try:
        for path, value in changes.items():
            for one in _words(text, starts, yaml, resolved(yaml.data, path), value):
                written[one.first] = one  # of two changes of one number the later one counts
    except _NotInPlace:
        return None
    for first in sorted(written, reverse=True):
        text = f"{text[:first]}{written[first].word}{text[written[first].last :]}"
    return text


def _words(text: str, starts: list[int], yaml: YamlSource, path: Path, value: object) -> Iterator[_Written]:
    there = value_at(yaml.data, path)
    if isinstance(value, (list, dict)):
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        held = list(there) if isinstance(there, dict) else list(range(len(there))) if isinstance(there, list) else None
        if type(value) is not type(there) or set(keys) != set(held or ()):
            raise _NotInPlace
        for key in keys:
            yield from _words(text, starts, yaml, (*path, key), value_at(value, (key,)))
        return
    if not (is_number(value) and is_number(there)) or path not in yaml.values:
        raise _NotInPlace
    line, column = yaml.values[path]
    found = _WORD.match(text, starts[line - 1] + column - 1)
    if found is None or scalar_value(found[0]) != there:
        raise _NotInPlace
    yield _Written(found.start(), found.end(), found[0] if value == there else repr(value).removesuffix(".0"))
