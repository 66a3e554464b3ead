"""The data of a scene file, which no file holds, as a scene: `scene_of`."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from cagepose.errors import SceneError
from cagepose.files.build import build_scene
from cagepose.files.messages import schema_findings
from cagepose.files.schema import SceneModel
from cagepose.model.scene import Scene


def scene_of(data: dict[str, Any]) -> Scene:
    """Return the scene that a file with such data would hold.

    Raises
    ------
    SceneError
        All that is wrong with them, with paths from the root of the file.
    """
    try:
        model = SceneModel.model_validate(data)
    except ValidationError as error:
        raise SceneError([finding.problem for finding in schema_findings(error, data)]) from None
    return build_scene(model, None).scene
