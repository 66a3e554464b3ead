"""The JSON Schema says what the strict models say."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pydantic import ValidationError

from cagepose.files.schema import SceneModel, scene_json_schema
from cagepose.files.schema_shapes import KINDS
from cagepose.files.yaml_source import parse_yaml
from cagepose.model.methods import METHODS


def test_the_schema_names_its_dialect_and_title_and_is_plain_json() -> None:
    schema = scene_json_schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["title"] == "cagepose scene"
    assert "$id" not in schema
    assert json.loads(json.dumps(schema)) == schema


def test_every_key_has_a_description_and_unknown_keys_are_refused() -> None:
    schema = scene_json_schema()
    for name, part in (("scene", schema), *schema["$defs"].items()):
        assert part["additionalProperties"] is False, name
        for key, value in part["properties"].items():
            assert value.get("description"), f"{name}.{key}"


def test_the_methods_are_those_that_run() -> None:
    assert json.dumps(list(METHODS)) in json.dumps(scene_json_schema()["properties"]["method"])


def test_every_example_is_valid(sample_text: str) -> None:
    """Each example of the schema, put where it belongs in a good scene, is accepted."""
    schema = scene_json_schema()
    n_tried = 0
    for path, examples in _examples(schema, schema, ()):
        for example in examples:
            data: Any = parse_yaml(sample_text, "x").data
            shape = path[: path.index("shapes") + 2] if "shapes" in path else path
            if len(path) > len(shape) and path[len(shape)] not in KINDS:
                _put(data, (*shape, "sphere"), {"radius": 1})
            _put(data, path, example)
            if path[-1] in ("direction", "magnitude") and "force" in str(path[2]):
                _put(data, (*path[:-1], "at"), [0, 0, 0])
            # Neighbours of an example may be missing; the example itself must be right.
            assert {details["type"] for details in _errors(data)} <= {"missing"}, path
            n_tried += 1
    assert n_tried > 20


def _errors(data: object) -> list[Any]:
    try:
        SceneModel.model_validate(data)
    except ValidationError as error:
        return error.errors()
    return []


def _examples(node: dict[str, Any], schema: dict[str, Any], path: tuple[Any, ...]) -> Any:
    if "$ref" in node:
        node = {**schema["$defs"][node["$ref"].rpartition("/")[2]], **{k: v for k, v in node.items() if k != "$ref"}}
    if "examples" in node:
        yield path, node["examples"]
    for key, child in node.get("properties", {}).items():
        yield from _examples(child, schema, (*path, key))
    for choice in (*node.get("anyOf", ()), *node.get("oneOf", ())):
        yield from _examples(choice, schema, path)
    if isinstance(node.get("items"), dict):
        yield from _examples(node["items"], schema, (*path, 0))
    if isinstance(node.get("additionalProperties"), dict):
        yield from _examples(node["additionalProperties"], schema, (*path, "any"))


def _put(data: Any, path: tuple[Any, ...], value: Any) -> None:
    for depth, key in enumerate(path[:-1]):
        if isinstance(data, dict) and not isinstance(data.get(key), (dict, list)):
            data[key] = [] if isinstance(path[depth + 1], int) else {}
        if isinstance(data, list) and key >= len(data):
            data.append({})
        elif isinstance(data, dict) and isinstance(data[key], list) and isinstance(path[depth + 1], str):
            data[key] = {}
        data = data[key]
    data[path[-1]] = value


@pytest.mark.parametrize("word", ["true", "'1'", "[1]", "{a: 1}", "1_0"])
def test_only_numbers_are_numbers(sample_text: str, word: str) -> None:
    data = parse_yaml(sample_text.replace("[0, 0, -1]", f"[0, 0, {word}]"), "x").data
    with pytest.raises(ValidationError):
        SceneModel.model_validate(data)
