"""``cagepose schema``: the scene file's shape for editors."""

from __future__ import annotations

import sys


def schema_command() -> int:
    """Print the JSON Schema of scene files, for editors: cagepose schema > scene.schema.json"""
    from cagepose.files.schema import scene_json_schema
    from cagepose.files.write import json_text

    sys.stdout.write(json_text(scene_json_schema()))
    return 0
