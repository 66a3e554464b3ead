"""What a file of solids in the world does not hold, kept beside them: our note, with mass and poses.

In STEP it is a comment of the file, beside STL a file of its own.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from cagepose.exchange.beside import beside_text, read_beside, spoilt
from cagepose.files.scene_document import scene_document
from cagepose.files.write import MADE_BY
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene

OF_OBJECT = ("mass", "center_of_gravity", "inertia", "pose")
"""Keys of the scene file's object that stand in the note as they are."""
SHOWN = {"object": "shown_object", "cage": "shown_cage"}
"""Keys of where each body is in the file: position and quaternion."""
MOST_BYTES = 4 * 1024 * 1024
IN_STEP = re.compile(r"/\* cagepose (.*?) \*/", re.DOTALL)


def solids_note(scene: Scene, pose_world_object: Pose) -> str:
    """Return the note for solids that show the object at a pose. Holes have no names there, but mouths."""
    document = scene_document(scene, "m")
    note = json.loads(beside_text(scene, with_friction=True))
    note["what"] = f"a scene's loads, points and poses, {MADE_BY}"
    note["object"] = {key: document["object"][key] for key in OF_OBJECT if key in document["object"]}
    note["holes"] = {
        str(hole.name): hole.pose_body_shape.position_m.tolist() for hole in (*scene.object.holes, *scene.cage.holes)
    }
    for body, pose in (("object", pose_world_object), ("cage", scene.cage.pose_world_cage)):
        note[SHOWN[body]] = [pose.position_m.tolist(), pose.quaternion_wxyz.tolist()]
    return json.dumps(note)


def with_note(step: bytes, note: str) -> bytes:
    """Return a STEP file with the note as a comment."""
    start, _, rest = step.partition(b"\n")
    escaped = note.replace("*/", "*\\/")  # the same in JSON, and no end of the comment
    return b"\n".join([start, f"/* cagepose {escaped} */".encode(), rest])


def file_beside(path: Path) -> Path:
    """Return the file in which the note of an STL file stands."""
    return path.with_name(f"{path.name}.json")


def read_solids_note(path: Path, notes: list[str]) -> dict[str, Any]:
    """Return the note of a file; nothing, where there is none, or a spoilt one, which ``notes`` is told."""
    kept = path if path.suffix.lower() in (".step", ".stp") else file_beside(path)
    if not kept.is_file():
        return {}
    with kept.open("rb") as stream:
        text = stream.read(MOST_BYTES).decode(errors="replace")
    if kept == path:
        if "/* cagepose {" not in text:
            return {}
        found = IN_STEP.search(text)
        text = found.group(1) if found else ""
    note = read_beside(text) or {}
    mouths = note.get("holes")
    is_whole = (
        "friction" in note
        and isinstance(note.get("object"), dict)
        and isinstance(mouths, dict)
        and all(_lengths([mouth]) == [3] for mouth in mouths.values())
        and all(_lengths(note.get(key)) == [3, 4] for key in SHOWN.values())
    )
    if not is_whole:
        notes.append(spoilt(kept.name))
    return note if is_whole else {}


def _lengths(found: Any) -> list[int]:
    """Return how many numbers there are in each list of a list; 0: it is no list of numbers."""
    rows = found if isinstance(found, list) else []
    return [
        len(row) if isinstance(row, list) and all(isinstance(one, int | float) for one in row) else 0 for row in rows
    ]
