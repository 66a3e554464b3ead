"""Shapes in scene files and in saved runs: units, places, names and friction."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Capsule, Cone, Convex, Cylinder, Disc, Scene, Sphere
from cagepose.files.record import from_record, record_of
from cagepose.files.scene_file import parse_scene

SCENE = """\
name: shapes
units: {length: in}
object:
  shapes:
    - {cylinder: {radius: 5, length: 20}, position: [1, 2, 3], euler_zyx_deg: [0, 90, 0], name: pin, friction: 0.2}
    - box: {size: [1, 2, 3]}
      position: [40, 0, 0]
      friction: {angle_deg: 45}
    - {cone: {radius_bottom: 5, radius_top: 0, length: 10}, position: [0, 60, 0]}
    - {convex: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], radius: 0.5}, position: [0, 0, 80]}
  pose: {position: [0, 0, 500]}
cage:
  shapes:
    - {sphere: {radius: 3}, position: [0, 0, -50], friction: {coefficient: 0}}
    - {capsule: {radius: 3, length: 8}}
    - {disc: {radius: 9}, position: [0, 0, -90]}
    - {box: {size: [9, 9, 9]}, position: [100, 0, 0], name: block}
  pose: {position: [0, 1, 0]}
loads:
  - name: gravity
    gravity: [0, 0, -1]
friction: {coefficient: 0.1, of: {disc1: 0.4}}
"""
INCH = 0.0254


def assert_is_the_scene(scene: Scene) -> None:
    held, cage = scene.object, scene.cage
    (box,), (pin, cone, plate) = held.boxes, held.shapes
    assert isinstance(pin, Cylinder)
    assert isinstance(cone, Cone)
    assert isinstance(plate, Convex)
    assert [part.name for part in held.parts] == ["box1", "pin", "cone1", "convex1"]
    assert_allclose((pin.radius_m, pin.length_m), (5 * INCH, 20 * INCH))
    assert_allclose(pin.pose_body_shape.position_m, np.array((1, 2, 3)) * INCH)
    assert_allclose(pin.pose_body_shape.rotation[:, 2], (1, 0, 0), atol=1e-15)
    assert_allclose(box.size_m, np.array((1, 2, 3)) * INCH)
    assert_allclose((cone.radius_bottom_m, cone.radius_top_m, cone.length_m), (5 * INCH, 0, 10 * INCH))
    assert_allclose(plate.vertices_m, np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)]) * INCH)
    assert plate.radius_m == 0.5 * INCH
    ball, bar, disc, block = cage.shapes
    assert isinstance(ball, Sphere)
    assert isinstance(bar, Capsule)
    assert isinstance(disc, Disc)
    assert isinstance(block, Box)
    assert_allclose((ball.radius_m, bar.radius_m, bar.length_m, disc.radius_m), np.array((3, 3, 8, 9)) * INCH)
    assert cage.element_names == ("sphere1", "capsule1", "disc1", "block")
    assert_allclose(cage.pose_world_cage.position_m, (0, INCH, 0))


def test_shapes_are_read_with_their_units_places_and_names() -> None:
    scene = parse_scene(SCENE)
    assert_is_the_scene(scene)
    expected = {"disc1": 0.4, "pin": 0.2, "box1": math.tan(math.pi / 4), "sphere1": 0.0}
    assert scene.friction_of == pytest.approx(expected)
    assert scene.friction_coefficient == 0.1
    plate = 0.5 + (2 + math.sqrt(2)) * math.pi / 8 + math.pi / 6
    volumes = np.array((6, 500 * math.pi, 250 / 3 * math.pi, plate))
    height = volumes @ (0, 3, -2.5, 80) / volumes.sum()
    assert scene.object.center_of_gravity_m[2] == pytest.approx(height * INCH, rel=1e-12)


def test_one_name_in_the_cage_and_in_the_object_does_no_harm_where_neither_has_friction() -> None:
    text = SCENE.replace(", name: block", "").replace("      friction: {angle_deg: 45}\n", "")
    assert parse_scene(text).cage.shapes[3].name == parse_scene(text).object.boxes[0].name == "box1"


@pytest.mark.parametrize(
    ("change", "found"),
    [
        ("object.shapes[0].cylinder.radius=6", lambda scene: scene.object.shapes[0].radius_m / INCH - 6),
        ("cage.shapes.1.capsule={radius: 1, length: 2}", lambda scene: scene.cage.shapes[1].length_m / INCH - 2),
        (
            "cage.shapes[0].position=[1, 2, 3]",
            lambda scene: scene.cage.shapes[0].pose_body_shape.position_m[2] / INCH - 3,
        ),
        ("object.shapes[3].convex.vertices[1][0]=7", lambda scene: scene.object.shapes[2].vertices_m[1, 0] / INCH - 7),
        ("object.shapes[0].friction=0.7", lambda scene: scene.friction_of["pin"] - 0.7),
    ],
)
def test_values_of_shapes_can_be_set(change: str, found: Callable[[Scene], float]) -> None:
    assert found(parse_scene(SCENE, set_values=[change])) == pytest.approx(0.0, abs=1e-12)


def test_a_scene_with_shapes_is_saved_without_loss() -> None:
    scene = parse_scene(SCENE)
    record = json.loads(json.dumps(record_of(scene)))
    assert [list(shape) for shape in record["shapes"]] == [["cylinder"], ["cone"], ["convex"]]
    assert [list(shape) for shape in record["cage_shapes"]] == [["sphere"], ["capsule"], ["disc"], ["box"]]
    again = from_record(Scene, record)
    assert record_of(again) == record
    assert_is_the_scene(again)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda record: record["shapes"].append({}),
        lambda record: record["shapes"].append({"torus": {}}),
        lambda record: record["shapes"][0].update(record["shapes"][1]),
        lambda record: record["shapes"][0]["cylinder"].pop("radius_m"),
        lambda record: record["shapes"][0]["cylinder"].update(radius_m=-1.0),
        lambda record: record["cage_shapes"].append(None),
    ],
)
def test_a_damaged_record_of_shapes_is_refused(spoil: Callable[[dict[str, Any]], None]) -> None:
    record = record_of(parse_scene(SCENE))
    spoil(record)
    with pytest.raises(ValueError, match="validation error"):
        from_record(Scene, record)


def test_holes_are_read_set_and_saved() -> None:
    hole = "hole: {radius: 2, depth: 5, in: [block], chamfer: {width: 0.5, angle_deg: 30}}"
    text = SCENE.replace("  pose: {position: [0, 1, 0]}", f"    - {{{hole}, position: [100, 0, 4.5], friction: 0.3}}")
    scene = parse_scene(text, set_values=["cage.shapes[4].hole.depth=6"])
    (found,) = scene.cage.holes
    assert (found.name, found.in_, scene.friction_of["hole1"]) == ("hole1", ("block",), 0.3)
    chamfer_m = 0.5 * INCH * math.sqrt(3.0)
    expected = [(-6 * INCH, 2 * INCH), (-chamfer_m, 2 * INCH), (0, 2.5 * INCH)]
    assert_allclose(found.rims, expected, atol=1e-15)
    record = json.loads(json.dumps(record_of(scene)))
    assert record["cage_holes"][0]["in_"] == ["block"]
    assert record_of(from_record(Scene, record)) == record
