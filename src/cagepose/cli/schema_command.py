"""``cagepose schema``: the scene file's shape for editors."""

from __future__ import annotations

import sys


def schema_command() -> int:
    """Print the JSON Schema of scene files, for editors: cagepose schema > scene.schema.json"""
    from json import dumps

    from cagepose.files.schema import scene_json_schema

    sys.stdout.write(dumps(scene_json_schema(), indent=1) + "\n")
    return 0
