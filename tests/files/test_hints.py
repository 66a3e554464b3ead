"""Slips that people make in scene files, and what they are told to write instead."""

from __future__ import annotations

import pytest

from cagepose.errors import SceneFileError
from cagepose.files.scene_file import parse_scene

SCENE = """\
name: x
units: {length: mm}
object:
  boxes: [{name: b, size: [10, 10, 10], position: [0, 0, 0]}]
  pose: {position: [0, 0, 8]}
cage:
  points: [[4, 4, 0], [-4, 4, 0], [-4, -4, 0], [4, -4, 0]]
loads:
  - {name: g, gravity: [0, 0, -1]}
"""
UNIT, BOXES, POSE, LOAD = "units: {length: mm}", "  boxes:", "pose: {position: [0, 0, 8]}", "gravity: [0, 0, -1]"
ORDER = "angles about axes in another order are other angles: give quat_wxyz, or the angles about z, then y, then x as"
ZYX = "did you mean euler_zyx_deg, the angles in degrees about z, then y, then x? known keys"

SLIPS: list[tuple[str, str, str]] = [
    (
        "position: [0, 0, 0]}]",
        "position: [0, 0, 0], euler_xyz_deg: [0, 0, 9]}]",
        "other angles: give those about z, then y, then x as euler_zyx_deg;",
    ),
    (
        BOXES,
        "  shapes: [{sphere: {radius: 1}, euler_xyz: [0, 0, 9]}]\n  boxes:",
        "object.shapes[0].euler_xyz: is no known shape; angles about axes in another order are other angles",
    ),
    (
        BOXES,
        "  shapes: [{hole: {radius: 1, depth: 3, in: b}, position: [0, 0, 5]}]\n  boxes:",
        "object.shapes[0].hole.in: is text 'b'; write in: [b]",
    ),
    (UNIT, "units: mm", "units: is text 'mm'; write units: {length: mm}"),
    (UNIT, "units: {length: millimetres}", "units.length: is text 'millimetres'; write mm"),
    (UNIT, "units: inches", "units: is text 'inches'; write units: {length: in}"),
    (UNIT, "units: {length: cm}", "units.length: is text 'cm'; multiply the lengths by 10 and use mm"),
    (UNIT, "units: {length: parsec}", "units.length: is text 'parsec'; use one of: mm, m, in"),
    ("loads:", "friction: 0.2\nloads:", "friction: is 0.2; write friction: {coefficient: 0.2}"),
    ("loads:", "friction: {mu: 0.2}\nloads:", "friction.mu: is no known key; did you mean coefficient? known keys"),
    (
        LOAD,
        "force: [3, 0, 4]",
        "loads[0].force: is a list; write force: {direction: [3, 0, 4], at: [0, 0, 0], magnitude: 5}",
    ),
    (LOAD, "gravity: -z", "loads[0].gravity: is text '-z'; write it as a vector: gravity: [0, 0, -1]"),
    (LOAD, "gravity: 9.81", "loads[0].gravity: is 9.81; write it as a vector: gravity: [0, 0, -9.81]"),
    (LOAD, "gravity: true", "loads[0].gravity: is true; write it as a vector: gravity: [0, 0, -1]"),
    (LOAD, "gravity: [0, -1]", "loads[0].gravity: has 2 values; give 3"),
    (
        LOAD,
        "moment: {direction: [0, 0, 1], magnitude: 5}",
        "loads[0].moment: is no known key; did you mean moments? for example moments: [{direction: [0, 0, 1]",
    ),
    (
        LOAD,
        "spring: {at: [0, 0, 0]}",
        "loads[0].spring: is no known key; did you mean springs? for example springs: [{at: [0, 0, 0], to: [0, 0, 50],",
    ),
    (
        LOAD,
        "springs: {at: [0, 0, 0], to: [0, 0, 50], stiffness: 1}",
        "loads[0].springs: is keys with values; make it a list, with - before the first of them",
    ),
    ("loads:", "springs: []\nloads:", "springs: is no known key; it belongs to loads[i]; known keys"),
    (
        BOXES,
        "  cylinder: {radius: 3, length: 10}\n  boxes:",
        "object.cylinder: is no known key; shapes are listed: shapes: [{cylinder: ...}]; known keys",
    ),
    (
        BOXES,
        "  cylinders: []\n  boxes:",
        "object.cylinders: is no known key; shapes are listed: shapes: [{cylinder: ...}]",
    ),
    (
        BOXES,
        "  shapes: [{sphere: {radius: 3}, type: sphere}]\n  boxes:",
        "object.shapes[0].type: is no known shape; the kind is a key that holds the numbers: {sphere: {radius: 3}};",
    ),
    (
        BOXES,
        "  shapes: [{cylinder: {radius: 3, length: 5, height: 5}}]\n  boxes:",
        "object.shapes[0].cylinder.height: is no known key; did you mean length? known keys: radius, length",
    ),
    (POSE, "pose: {euler_xyz_deg: [0, 0, 0]}", f"object.pose.euler_xyz_deg: is no known key; {ORDER} euler_zyx_deg;"),
    (POSE, "pose: {euler_zxz: [0, 0, 0]}", f"object.pose.euler_zxz: is no known key; {ORDER} euler_zyx_deg;"),
    (POSE, "pose: {euler_zyx: [0, 0, 0]}", f"object.pose.euler_zyx: is no known key; {ZYX}"),
    (POSE, "pose: {rotation: [0, 0, 0]}", f"object.pose.rotation: is no known key; {ZYX}"),
    (
        POSE,
        "pose: {rpy: [0, 0, 0]}",
        "object.pose.rpy: is no known key; give the same angles in the other order, in degrees: euler_zyx_deg: [yaw,",
    ),
    (POSE, "pose: {quaternion: [1, 0, 0, 0]}", "object.pose.quaternion: is no known key; did you mean quat_wxyz?"),
    (POSE, "pose: [0, 0, 8]", "object.pose: is a list; write pose: {position: [0, 0, 8]}"),
    (BOXES, "  center_of_mass: [0, 0, 0]\n  boxes:", "is no known key; did you mean center_of_gravity? known keys"),
    ("size: [10, 10, 10]", "size: 10", "size: is 10; write the three edge lengths: size: [10, 10, 10]"),
    (
        "points: [[4, 4, 0], [-4, 4, 0], [-4, -4, 0], [4, -4, 0]]",
        "points: [4, 4, 0]",
        "cage.points[0]: is 4; put each point into brackets of its own: points: [[4, 4, 0], [-4, 4, 0]]",
    ),
    (
        "  - {name: g, gravity: [0, 0, -1]}",
        "  name: g",
        "loads: is keys with values; make it a list, with - before the",
    ),
]


@pytest.mark.parametrize(("old", "new", "told"), SLIPS, ids=[new.strip().splitlines()[0] for _, new, _ in SLIPS])
def test_a_slip_is_told_with_what_to_write(old: str, new: str, told: str) -> None:
    assert SCENE.count(old) == 1
    with pytest.raises(SceneFileError) as caught:
        parse_scene(SCENE.replace(old, new))
    assert told in str(caught.value)


def test_another_order_of_angles_never_leads_to_ours() -> None:
    for order in ("xyz", "xzy", "yxz", "yzx", "zxy", "zxz"):
        for ending in ("", "_deg", "_rad"):
            with pytest.raises(SceneFileError) as caught:
                parse_scene(SCENE.replace(POSE, f"pose: {{euler_{order}{ending}: [0, 0, 0]}}"))
            assert "did you mean" not in str(caught.value)
            assert "other angles" in str(caught.value)
