"""What no format of bodies holds, kept as JSON in a place of our own in the file: loads, names of points, method.

Lengths are metres. `cagepose import` reads it back.
"""

from __future__ import annotations

import json
from typing import Any

from cagepose.files.scene_document import SceneWriter, scene_document
from cagepose.model.cage import Cage
from cagepose.model.load import Load
from cagepose.model.scene import Scene
from cagepose.model.wording import few

NOTE_VERSION = 1
SETTINGS = ("method", "metric", "planar", "tolerances")
"""Keys of the scene file that stand in the note, and in a scene made from it, as they are."""
KEPT = ("name", *SETTINGS, "left_out")
"""Keys of the scene file that stand in the note as they are."""


def beside_text(scene: Scene, *, with_friction: bool = False) -> str:
    """Return the note; ``with_friction``: that of the scene too, where the format has none."""
    document = scene_document(scene, "m")
    note: dict[str, Any] = {"version": NOTE_VERSION, **{key: document[key] for key in KEPT if key in document}}
    if with_friction:
        note["friction"] = {"coefficient": scene.friction_coefficient, "of": scene.friction_of}
    note["loads"] = [still for load in scene.loads if (still := _without_drive(scene.cage, load))]
    note["points"] = list(scene.cage.names)
    note["has_mass"] = scene.object.mass_kg is not None
    note["has_inertia"] = scene.object.inertia_kg_m2 is not None
    return json.dumps(note)


def not_kept(scene: Scene) -> list[str]:
    """Return what stands neither in the bodies nor in the note, in sentences."""
    found, names = list[str](), few(entry.name for entry in scene.adjustable)
    if names:
        found.append(f"what is adjustable in the scene is not in the file: {names}")
    if scene.cage.bodies:
        bodies = few(body.name for body in scene.cage.bodies)
        found.append(f"bodies of the cage stand still in the file where they start, as one with it: {bodies}")
    if driven := few(load.name for load in scene.loads if load.drive or load.press):
        found.append(f"what is driven or presses in the scene is not in the file: {driven}")
    return found


def _without_drive(cage: Cage, load: Load) -> dict[str, Any] | None:
    """Return a load as a scene file in metres has it, of a cage whose bodies stand still; None: nothing acts then."""
    writer = SceneWriter("m")
    found = {key: value for key, value in writer.load(load).items() if key not in ("drive", "stop_at", "press")}
    if load.springs:
        ends = ({"to": writer.lengths(cage.spring_end_world(spring))} for spring in load.springs)
        springs = zip(found["springs"], ends, strict=True)
        found["springs"] = [{**{k: v for k, v in spring.items() if k != "of"}, **end} for spring, end in springs]
    return found if len(found) > 1 else None


def spoilt(where: object) -> str:
    """Return what is said of a note of ours that cannot be read."""
    return f"the note of cagepose in {where} is damaged or of another version: here, the bodies alone; export it again"


def read_beside(text: str) -> dict[str, Any] | None:
    """Return what `beside_text` wrote; None: it is something else, or somebody spoilt it."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or found.get("version") != NOTE_VERSION:
        return None
    friction = found.get("friction", {"of": {}, "coefficient": None})
    is_whole = isinstance(friction, dict) and "coefficient" in friction and isinstance(friction.get("of"), dict)
    is_whole = is_whole and isinstance(found.get("left_out", []), list)
    return found if is_whole and isinstance(found.get("points"), list) else None
