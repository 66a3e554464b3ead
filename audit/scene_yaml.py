"""A scene as a scene file in metres, to the last digit."""

from __future__ import annotations

import json
from typing import Any

from cagepose import Scene
from cagepose.files.scene_document import scene_document


def scene_yaml(scene: Scene, name: str, remarks: list[str]) -> str:
    """Return the text of a scene file, with remarks above it."""
    lines = [f"# {remark}" for remark in remarks]
    return "\n".join([*lines, *_block({**scene_document(scene, "m"), "name": name}, 0)]) + "\n"


def _block(value: dict[str, Any], depth: int) -> list[str]:
    """A mapping line by line: what fits stands on one line, in JSON, which YAML contains."""
    lines = []
    for key, item in value.items():
        head = f"{'  ' * depth}{json.dumps(key) if depth > 1 else key}:"
        if isinstance(item, dict) and len(json.dumps(item)) > 100:
            lines += [head, *_block(item, depth + 1)]
        elif isinstance(item, list) and item and isinstance(item[0], dict):
            lines += [head, *(f"{'  ' * (depth + 1)}- {json.dumps(entry)}" for entry in item)]
        else:
            lines.append(f"{head} {json.dumps(item)}")
    return lines
