"""A scene as a scene file in metres, to the last digit."""

from __future__ import annotations

import json
from typing import Any

from audit.case import FloatArray
from cagepose import Load, Pose, Scene


def scene_yaml(scene: Scene, name: str, remarks: list[str]) -> str:
    """Return the text of a scene file, with remarks above it."""
    held, cage = scene.object, scene.cage
    boxes = [
        {"name": box.name, "size": _plain(box.size_m), **_pose(box.pose_object_box, "euler_zyx_deg")}
        for box in held.boxes
    ]
    part: dict[str, Any] = {"boxes": boxes, "center_of_gravity": _plain(held.center_of_gravity_m)}
    if held.mass_kg is not None:
        part["mass"] = held.mass_kg
    if held.inertia_kg_m2 is not None:
        part["inertia"] = _plain(held.inertia_kg_m2)
    part["pose"] = _pose(held.pose_world_object, "quat_wxyz")
    points = dict(zip(cage.names, _plain(cage.points_cage), strict=True))
    document: dict[str, Any] = {
        "name": name,
        "units": {"length": "m"},
        "object": part,
        "cage": {"points": points, "pose": _pose(cage.pose_world_cage, "quat_wxyz")},
        "loads": [_load(load) for load in scene.loads],
        "friction": {"coefficient": scene.friction_coefficient or 0.0, "of": scene.friction_of},
        "tolerances": {"touch": scene.tolerances.touch},
    }
    if scene.metric is not None:
        document["metric"] = scene.metric
    lines = [f"# {remark}" for remark in remarks]
    return "\n".join([*lines, *_block(document, 0)]) + "\n"


def _load(load: Load) -> dict[str, Any]:
    entry: dict[str, Any] = {"name": load.name}
    if load.gravity_world is not None:
        entry["gravity"] = _plain(load.gravity_world)
    if load.force is not None:
        entry["force"] = {"direction": _plain(load.force.direction), "at": _plain(load.force.at_object_m)}
        if load.force.magnitude_n is not None:
            entry["force"]["magnitude"] = load.force.magnitude_n
    return entry


def _pose(pose: Pose, form: str) -> dict[str, Any]:
    """Where a part is: boxes have angles alone, which are not written where they are zero."""
    entry: dict[str, Any] = {"position": _plain(pose.position_m)}
    if form == "quat_wxyz":
        entry[form] = _plain(pose.quaternion_wxyz)
    elif pose.quaternion_wxyz[0] != 1.0:
        entry[form] = [angle * 57.29577951308232 for angle in pose.euler_zyx]
    return entry


def _plain(array: FloatArray) -> Any:
    return array.tolist()


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
