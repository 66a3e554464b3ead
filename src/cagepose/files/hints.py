"""What people write in a scene file in the place of what it knows, and what they mean by it."""

from __future__ import annotations

import json
import math
import re

from cagepose.files.key_path import Path
from cagepose.files.schema_shapes import KINDS
from cagepose.files.units import LENGTH_UNITS
from cagepose.model.checks import is_number

DOWN = {"-z": [0, 0, -1], "z": [0, 0, 1], "+z": [0, 0, 1], "down": [0, 0, -1], "-y": [0, -1, 0], "-x": [-1, 0, 0]}
"""Words for a direction of gravity."""
SPELLED = {"mm": ("millimet", "millimeter"), "m": ("meter", "metre"), "in": ("inch",)}
"""Beginnings of the names of units."""
SMALLER = {"cm": "10 and use mm", "um": "0.001 and use mm", "µm": "0.001 and use mm", "ft": "12 and use in"}
"""Units that there are not, and what to multiply lengths by."""
OTHER_WORDS = {
    "roller": "capsule",
    "rod": "capsule",
    "pin": "capsule",
    "ball": "sphere",
    "block": "box",
    "wall": "box",
    "cuboid": "box",
    "hull": "convex",
    "mesh": "convex",
    "polyhedron": "convex",
    "frustum": "cone",
    "bore": "hole",
    "rotation": "euler_zyx_deg",
    "euler": "euler_zyx_deg",
    "euler_deg": "euler_zyx_deg",
    "euler_zyx": "euler_zyx_deg",
    "quaternion": "quat_wxyz",
    "quat": "quat_wxyz",
    "height": "length",
    "mu": "coefficient",
    "angle": "angle_deg",
    "vector": "direction",
    "point": "at",
    "newtons": "magnitude",
    "com": "center_of_gravity",
    "cog": "center_of_gravity",
    "center_of_mass": "center_of_gravity",
    "centre_of_mass": "center_of_gravity",
    "centre_of_gravity": "center_of_gravity",
    "acceleration": "gravity",
    "translation": "travel",
    "axis": "about",
    "body": "of",
}
"""What people call keys, and what they are called here."""
_EULER = re.compile(r"euler_?([xyz]{3})(_?deg|_?rad)?")


def meant_by_value(path: Path, value: object) -> str | None:
    """Return what to write in the place of a value of another form, or None."""
    key = path[-1] if path else ""
    if path == ("units",) and isinstance(value, str):
        return _unit(value, "units: {{length: {}}}")
    if path == ("units", "length") and isinstance(value, str):
        return _unit(value, "{}")
    if path == ("friction",) and is_number(value):
        return f"write friction: {{coefficient: {value}}}"
    if key == "gravity" and not isinstance(value, list):
        return _gravity(value)
    if key == "stop_at" and is_number(value):
        return f"write stop_at: {{force: {value}}}, or {{moment: {value}}} of turns"
    if key in ("force", "moment") and path[-2:-1] != ("stop_at",) and _is_vector(value):
        at = ", at: [0, 0, 0]" if key == "force" else ""
        length = math.hypot(*value) if isinstance(value, list) else 0.0
        return f"write {key}: {{direction: {json.dumps(value)}{at}, magnitude: {length:.6g}}}"
    if path[-2:] == ("hole", "in") and isinstance(value, str):
        return f"write in: [{value}]"
    if key == "pose" and _is_vector(value):
        return f"write pose: {{position: {json.dumps(value)}}}"
    if key == "size" and is_number(value):
        return f"write the three edge lengths: size: [{value}, {value}, {value}]"
    if path[:1] == ("cage",) and path[-2:-1] == ("points",) and isinstance(key, int) and is_number(value):
        return "put each point into brackets of its own: points: [[4, 4, 0], [-4, 4, 0]]"
    return None


def meant_by_key(key: str, known: list[str]) -> str | None:
    """Return what to write in the place of a key that there is not, or None."""
    lower = key.lower()
    kind = lower.removesuffix("s")
    if kind in KINDS and "shapes" in known:
        return f"shapes are listed: shapes: [{{{kind}: ...}}]"
    if (match := _EULER.fullmatch(lower)) and match[1] != "zyx" and "euler_zyx_deg" in known:
        give = "quat_wxyz, or the angles" if "quat_wxyz" in known else "those"
        return (
            f"angles about axes in another order are other angles: give {give} about z, then y, then x as euler_zyx_deg"
        )
    if lower in ("rpy", "rpy_deg") and "euler_zyx_deg" in known:
        return "give the same angles in the other order, in degrees: euler_zyx_deg: [yaw, pitch, roll]"
    if lower in ("type", "kind", "shape") and "sphere" in known:
        return "the kind is a key that holds the numbers: {sphere: {radius: 3}}"
    if lower == "diameter" and "radius" in known:
        return "give half of it as radius"
    other = f"{lower}s" if f"{lower}s" in known else OTHER_WORDS.get(lower)
    if other == "euler_zyx_deg" and other in known:
        return f"did you mean {other}, the angles in degrees about z, then y, then x?"
    return f"did you mean {other}?" if other in known else None


def _unit(word: str, form: str) -> str | None:
    lower = word.lower()
    for unit in LENGTH_UNITS:
        if lower == unit or lower.startswith(SPELLED[unit]):
            return f"write {form.format(unit)}"
    if lower in SMALLER:
        return f"multiply the lengths by {SMALLER[lower]}"
    return None


def _gravity(value: object) -> str:
    if isinstance(value, str) and value.lower() in DOWN:
        found: list[float] = [*DOWN[value.lower()]]
    else:
        found = [0, 0, -abs(value)] if is_number(value) and value else [0, 0, -1]
    return f"write it as a vector: gravity: {json.dumps(found)}"


def _is_vector(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(map(is_number, value)) and any(value)
