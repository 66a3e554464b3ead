"""What pydantic found, in the words of whoever wrote the file: what stands there, and what to do about it."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from cagepose.errors import Key, Problem
from cagepose.files.hints import meant_by_key, meant_by_value
from cagepose.files.key_path import Path, value_at
from cagepose.files.schema import SceneModel
from cagepose.files.schema_base import json_schema
from cagepose.files.schema_shapes import KINDS
from cagepose.model.wording import number_of

_WANTED = {
    "float_type": "a number",
    "string_type": "text (in quotes if it looks like a number)",
    "list_type": "a list in brackets",
    "dict_type": "keys with values",
    "model_type": "keys with values",
}
_FORMS = {
    "points": "a list of [x, y, z], a NAME: [x, y, z] for each point, or file: points.csv",
    "friction": "a coefficient, or coefficient: or angle_deg: with a number",
    "drive": "travel: [x, y, z], turn: with about: and angle_deg:, both, or a list of such",
}
"""The keys that may be given in several forms."""
_LIMITS = {
    "greater_than": ("gt", "above {}"),
    "greater_than_equal": ("ge", "from {} upwards"),
    "less_than": ("lt", "below {}"),
    "less_than_equal": ("le", "up to {}"),
}
_SHOWN_LENGTH = 40
_SHOWN_HOMES = 5


class Finding(NamedTuple):
    """A problem, and whether it is about the key itself and not about its value."""

    problem: Problem
    about_key: bool


def schema_findings(error: ValidationError, data: object, model: type[BaseModel] = SceneModel) -> list[Finding]:
    """Turn all that pydantic found in ``data``, which was to be a ``model``, into problems."""
    findings = []
    for details in error.errors(include_url=False):
        path = file_path(details["loc"])
        message = _message(details, path, data, model)
        findings.append(Finding(Problem(path, message), details["type"] == "extra_forbidden"))
    return findings


def shown(value: object) -> str:
    """Name a value the way a reader of the file would.

    >>> shown(True), shown("ten"), shown([1, 2]), shown(None), shown(object())
    ('true', "text 'ten'", 'a list', 'empty', 'of type object')
    """
    match value:
        case None:
            return "empty"
        case bool():
            return "true" if value else "false"
        case int() | float():
            return _number(value)
        case str():
            return f"text {_cut(value)!r}"
        case list():
            return "a list"
        case dict():
            return "keys with values"
        case _:  # of a change in Python
            return f"of type {type(value).__name__}"


def file_path(location: tuple[Key, ...]) -> Path:
    """Pydantic's location without what it adds: the form of points and friction, and a mark for keys."""
    at = 3 if location[:2] == ("cage", "bodies") else 1  # what a body has, a cage has
    if location[:1] == ("cage",) and location[at : at + 1] == ("points",):
        location = location[: at + 1] + location[at + 2 :]
    if _is_shape(location[: at + 2]) and location[at + 2 : at + 3] == ("friction",):
        location = location[: at + 3] + location[at + 4 :]
    if location[:1] == ("loads",) and location[2:3] == ("drive",):
        location = location[:4] + (location[5:] if location[4:5] != ("[key]",) else location[4:])
    return location[:-1] if location[-1:] == ("[key]",) else location


def _message(details: ErrorDetails, path: Path, data: object, model: type[BaseModel]) -> str:
    kind, found, context = details["type"], details["input"], details.get("ctx", {})
    if kind == "cagepose":
        return str(context["message"])
    if kind == "missing":
        return f"is missing; add it{_example(path, data, model)}"
    if kind == "extra_forbidden":
        known, homes = _known_keys(path[:-1], data, model), _homes(model).get(str(path[-1]), [])
        if _is_shape(path[:-1]):
            return _unknown_shape(str(path[-1]), known, homes)
        return _unknown_key(path, known, homes, data, model)
    if kind == "union_tag_not_found":
        form = "drive" if path[2:3] == ("drive",) else str(path[-1])
        return f"is {shown(found)}; give {_FORMS[form]}"
    if model is SceneModel and (meant := meant_by_value(path, found)) is not None:
        return f"is {shown(found)}; {meant}"
    if kind == "list_type" and isinstance(found, dict) and _holds_mappings(path, data, model):
        by_name = all(isinstance(value, dict) for value in found.values())
        form = "each with its own - and name" if by_name else "with - before the first of them"
        return f"is {shown(found)}; make it a list, {form}"
    if kind in _WANTED:
        return f"is {shown(found)}; give {_WANTED[kind]}"
    if kind in _LIMITS:
        name, text = _LIMITS[kind]
        return f"is {shown(found)}; give a number {text.format(_number(context[name]))}"
    if kind == "finite_number":
        return f"is {shown(found)}; give a finite number"
    if kind == "literal_error":
        return _choice(found, context["expected"])
    if kind in ("too_short", "too_long"):
        return _length_message(found, context)
    if kind in ("string_too_short", "string_too_long"):
        limit = context.get("min_length", context.get("max_length"))
        least_or_most = "at least" if "min_length" in context else "at most"
        return f"has {number_of(len(str(found)), 'character')}; give {least_or_most} {limit}"
    return f"is {shown(found)}: {details['msg'].lower()}"


def _length_message(found: Any, context: dict[str, Any]) -> str:
    n_found, least, most = len(found), context.get("min_length"), context.get("max_length")
    if n_found == 0:
        return "is empty; give at least one" if least == 1 else f"is empty; give {least} values"
    return f"has {number_of(n_found, 'value')}; give {most if least is None else least}"


def _choice(found: object, expected: str) -> str:
    """``expected`` is pydantic's list of literals: 'mm', 'm' or 'in'."""
    choices = [choice.strip("' ") for choice in expected.replace(" or ", ", ").split(", ")]
    return f"is {shown(found)}; use one of: {', '.join(choices)}"


def _unknown_key(path: Path, known: list[str], homes: list[str], data: object, model: type[BaseModel]) -> str:
    found = str(path[-1])
    meant, plural = meant_by_key(found, known), f"{found.lower()}s"
    if meant is not None:
        example = _example((*path[:-1], plural), data, model).removeprefix(",") if plural in known else ""
        told = _ended(meant + example)
    else:
        told = f"it belongs to {_some_of(homes)}; " if homes else _close(found, known)
    return f"is no known key; {told}known keys: {', '.join(known)}"


def _unknown_shape(found: str, known: list[str], homes: list[str]) -> str:
    """For a key of a shape, most of which are the names of all shapes that there are."""
    others = [key for key in known if key not in KINDS]
    within = [f"object.shapes[i].{kind}" for kind in KINDS]
    holders = [home.rpartition(".")[2] for home in homes if home in within]
    meant = f"it belongs within {_some_of(holders)}; " if holders else _close(found, known)
    hint = meant_by_key(found, known)
    told = meant if hint is None else _ended(hint)
    return f"is no known shape; {told}known shapes: {', '.join(KINDS)}; known keys beside them: {', '.join(others)}"


def _ended(text: str) -> str:
    return f"{text} " if text.endswith("?") else f"{text}; "


def _some_of(places: list[str]) -> str:
    return " or ".join([*places[:_SHOWN_HOMES], *(["others"] if len(places) > _SHOWN_HOMES else [])])


def _close(found: str, known: list[str]) -> str:
    close = difflib.get_close_matches(found.lower(), known, n=1)
    return f"did you mean {close[0]}? " if close else "remove it; "


def _is_shape(path: Path) -> bool:
    """Whether a path leads to one of the shapes of the object, of the cage or of one of its bodies."""
    of = path[:1] if path[:2] != ("cage", "bodies") else path[:3]
    return path[:1] in (("object",), ("cage",)) and len(path) == len(of) + 2 and path[len(of)] == "shapes"


@cache
def _homes(model: type[BaseModel]) -> dict[str, list[str]]:
    """Return for each key the mappings that have it, as ``loads[i].force``; none for keys of the file itself. Those
    within mappings whose keys are names, as ``cage.bodies.NAME``, count where there are no others.
    """
    homes: dict[str, list[str]] = {}

    def visit(node: dict[str, Any], place: str) -> None:
        for part in _alternatives(node, model):
            for key, child in part.get("properties", {}).items():
                if place and place not in homes.setdefault(key, []):
                    homes[key].append(place)
                visit(child, f"{place}.{key}" if place else key)
            if isinstance(part.get("additionalProperties"), dict):
                visit(part["additionalProperties"], f"{place}.NAME")
            if isinstance(part.get("items"), dict):
                visit(part["items"], f"{place}[i]")

    visit(_schema(model), "")
    return {key: [place for place in places if "NAME" not in place] or places for key, places in homes.items()}


def _example(path: Path, data: object, model: type[BaseModel]) -> str:
    for node in _schema_nodes(path, data, model):
        if examples := node.get("examples"):
            return f", for example {path[-1]}: {json.dumps(examples[0]).replace(chr(34), '')}"
    return ""


def _holds_mappings(path: Path, data: object, model: type[BaseModel]) -> bool:
    """Whether what stands at ``path`` is a list of mappings."""
    items = [node["items"] for node in _schema_nodes(path, data, model) if isinstance(node.get("items"), dict)]
    return any("properties" in part for item in items for part in _alternatives(item, model))


def _known_keys(path: Path, data: object, model: type[BaseModel]) -> list[str]:
    """Return the keys that the mapping at ``path`` may have."""
    return [key for node in _schema_nodes(path, data, model) for key in node.get("properties", {})]


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    return json_schema(model)


def _schema_nodes(path: Path, data: object, model: type[BaseModel]) -> Iterator[dict[str, Any]]:
    """Yield the parts of the JSON Schema that speak about ``path``."""
    nodes = list(_alternatives(_schema(model), model))
    for depth, key in enumerate(path):
        is_index = isinstance(value_at(data, path[:depth]), list)
        children = [
            node.get("items") if is_index else node.get("properties", {}).get(key, node.get("additionalProperties"))
            for node in nodes
        ]
        nodes = [part for child in children if isinstance(child, dict) for part in _alternatives(child, model)]
    yield from nodes


def _alternatives(node: dict[str, Any], model: type[BaseModel]) -> Iterator[dict[str, Any]]:
    """Yield ``node`` with its references followed, and each of its choices."""
    if "$ref" in node:
        referred = _schema(model)["$defs"][node["$ref"].rpartition("/")[2]]
        yield from _alternatives({**referred, **_without_ref(node)}, model)
        return
    yield node
    for choice in (*node.get("anyOf", ()), *node.get("oneOf", ())):
        yield from _alternatives(choice, model)


def _without_ref(node: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in node.items() if key != "$ref"}


def _number(value: float) -> str:
    """A number as a person writes it; integers may be too long for Python to print.

    >>> _number(10.0), _number(0.25), _number(float("inf"))
    ('10', '0.25', 'infinite')
    """
    if value != value:
        return "not a number (.nan)"
    if abs(value) == float("inf"):
        return "infinite"
    return str(int(value)) if abs(value) < 1e6 and value == int(value) else f"{value:.6g}"


def _cut(text: str) -> str:
    return text if len(text) <= _SHOWN_LENGTH else text[: _SHOWN_LENGTH - 3] + "..."
