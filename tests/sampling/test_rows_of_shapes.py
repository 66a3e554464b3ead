"""A scene of which only what a number belongs to is built anew is that of the whole file, to the last bit."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cagepose.files.key_path import parse_key_path
from cagepose.files.scene_file import SceneText, scene_text_of
from cagepose.model import geometry
from cagepose.model.boundary import features
from cagepose.model.scene import Scene
from cagepose.runs.cases import taken_apart
from our_studies import RunStudy
from sampling.test_rows import compare_with_runs

SCENES = Path(__file__).resolve().parents[2] / "scenes"
CLUTCH = """\
name: roller clutch
units: {length: mm}
parameters: {hub: 55.29, roller: 22.86, ring: 101.6}
object:
  shapes: [{name: roller, cylinder: {radius: "=roller / 2", length: 16}}]
  pose: {position: [0, "=hub / 2 + roller / 2 + 0.1", 0]}
cage:
  shapes:
    - {name: hub, box: {size: [60, "=hub", 20]}}
    - {name: plate, box: {size: [130, 130, 20]}}
    - {name: ring, hole: {radius: "=ring / 2", depth: 20, in: [plate]}, position: [0, 0, 10]}
friction: {coefficient: 0}
loads: [{name: wedge, force: {direction: [1, 0, 0], at: [0, 0, 0]}}]
"""
CORNER = """\
name: part in a corner
units: {length: mm}
object:
  boxes:
    - {name: base, size: [100, 60, 20], position: [0, 0, 0]}
    - {name: rib, size: [20, 60, 30], position: [0, 0, 25]}
    - {name: ear, size: [20, 20, 20], position: [60, 0, 0], euler_zyx_deg: [30, 0, 0]}
  shapes:
    - {name: knob, sphere: {radius: 6}, position: [-30, 0, 20]}
    - name: nose
      cone: {radius_bottom: 8, length: 10, radius_top: 2}
      position: [-53, 0, 0]
      euler_zyx_deg: [0, -90, 0]
  center_of_gravity: [0, 0, 5]
  mass: 1
  inertia: [[500, 0, 0], [0, 1100, 0], [0, 0, 1200]]
  pose: {position: [0.5, 0.5, 10.5], euler_zyx_deg: [0.2, 0, 0]}
cage:
  pose: {euler_zyx_deg: [0, 0.01, 0]}
  shapes:
    - {name: floor, box: {size: [300, 300, 20]}, position: [0, 0, -10]}
    - {name: wall, box: {size: [300, 20, 60]}, position: [0, -41, 30]}
    - {name: stop, capsule: {radius: 10, length: 60}, position: [-70, 20, 20], euler_zyx_deg: [10, 0, 0]}
    - name: block
      convex: {vertices: [[0, 0, 0], [30, 0, 0], [0, 30, 0], [0, 0, 30], [30, 30, 30]], radius: 1}
      position: [90, 60, 20]
friction: {coefficient: 0.05}
loads:
  - {name: weight, gravity: [0, 0, -9.81]}
  - {name: seat, gravity: [0, 0, -9.81], force: {direction: [-1, -3, 0], at: [10, 30, -5], magnitude: 20}}
"""
OF_CORNER = (
    "object.boxes[0].size[2]",
    "object.boxes[2].euler_zyx_deg[0]",
    "object.shapes[1].cone.radius_bottom",
    "cage.shapes[1].position[1]",
    "cage.shapes[3].convex.vertices[1][0]",
    "cage.pose.euler_zyx_deg[1]",
)
WRITTEN = {
    "clutch": (CLUTCH, ("parameters.hub", "parameters.roller", "parameters.ring")),
    "corner": (CORNER, OF_CORNER),
}
VARIED: dict[str, dict[str, Any]] = {
    "plate-on-pins.yaml": {
        "object.shapes[1].hole.radius": {"uniform": [4.98, 5.05]},  # below 5 the pin starts in the plate
        "object.shapes[1].position[0]": {"normal": {"sigma": 0.005}},
        "cage.shapes[1].convex.vertices[3][0]": {"uniform": [-2.6, -2.4]},
        "cage.points.rest left[2]": {"normal": {"sigma": 0.01}},
    },
    "peg-in-hole.yaml": {
        "cage.shapes[1].hole.radius": {"uniform": [5.9, 6.2]},  # below 6 the peg does not go in
        "cage.shapes[1].hole.depth": {"uniform": [8, 31]},  # at 30 it comes out of the block
        "loads[2].moments[0].magnitude": {"uniform": [-0.001, 0.02]},  # which must be above zero
        "friction.coefficient": {"uniform": [-0.05, 0.4]},
    },
    "rollers.yaml": {
        "object.boxes[0].size[2]": {"uniform": [9.9, 10.0]},
        "cage.shapes[0].capsule.radius": {"uniform": [7.9, 8.0]},
        "object.pose.position[2]": {"uniform": [0.2, 0.3]},
    },
    "insertion.yaml": {
        "parameters.beside": {"uniform": [0, 0.3]},
        "cage.bodies.gripper.pose.position[1]": {"uniform": [-0.2, 0.2]},
    },
}


def read(name: str) -> SceneText:
    return scene_text_of((SCENES / name).read_text(encoding="utf-8"), name)


def numbers(part: object) -> list[object]:
    """Return all that kernels take of a scene, as bytes: but for what fills up records, which is no number."""
    if isinstance(part, tuple):
        return [number for each in part for number in numbers(each)]
    if isinstance(part, np.ndarray | np.void) and part.dtype.names:
        return [number for name in part.dtype.names for number in numbers(np.array(part[name]))]
    return [(part.shape, part.tobytes()) if isinstance(part, np.ndarray) else part]


def taken(scene: Scene) -> list[object]:
    return [number for slots in taken_apart(scene, 0.1) for number in numbers(slots.value)]


@pytest.mark.parametrize("name", VARIED)
def test_rows_of_shapes_are_the_runs_of_their_scenes(run_study: RunStudy, name: str) -> None:
    found = compare_with_runs(run_study(VARIED[name], 16, scene=SCENES / name))
    assert ("refused" in found) == (name in ("plate-on-pins.yaml", "peg-in-hole.yaml"))


@pytest.mark.parametrize("name", ["clutch", "corner", *VARIED])
def test_a_scene_made_of_parts_is_that_of_its_file_to_the_last_bit(name: str) -> None:
    keys: Iterable[str]
    if name in WRITTEN:
        written, keys = WRITTEN[name]
        text = scene_text_of(written, f"{name}.yaml")
    else:
        text, keys = read(name), VARIED[name]
    paths = [parse_key_path(key) for key in keys]
    nominal = [float(of_path(text.yaml.data, path)) for path in paths]
    drawn = np.random.default_rng(1)
    text.scene_with(dict(zip(paths, nominal, strict=True)))
    for _ in range(8):
        changed = [value - abs(drawn.normal()) * 1e-4 for value in nominal]
        values = dict(zip(paths, changed, strict=True))
        geometry._boundary_of.cache_clear()
        features._lone_block.cache_clear()
        whole = taken(scene_text_of(text.text, name).scene_with(values).scene)
        found = text._with_numbers(values)
        assert found is not None  # else it was built as a whole
        assert taken(found.scene) == whole


def test_what_does_not_change_is_shared() -> None:
    text = scene_text_of(CLUTCH, "clutch.yaml")
    first, second = (text.scene_with({("parameters", "ring"): ring}).scene for ring in (101.6, 101.7))
    third = text.scene_with({("parameters", "ring"): 101.8}).scene
    assert third.object is first.object
    assert third.cage.shapes[0] is second.cage.shapes[0]
    assert third.loads == first.loads


def test_a_value_that_is_no_number_and_other_keys_than_before_are_taken_too() -> None:
    text = scene_text_of(CLUTCH, "clutch.yaml")
    text.scene_with({("parameters", "ring"): 101.7})
    named = text.scene_with({("cage", "shapes", 0, "name"): "core"}).scene
    assert named.cage.element_names == ("core", "plate", "ring")
    assert named.cage.holes[0].radius_m == pytest.approx(0.0508)
    fixed = text.scene_with({("cage", "shapes", 0, "box", "size", 1): 55.0}).scene  # an expression gives way
    assert fixed.cage.shapes[0].nodes_body()[:, 1].max() == pytest.approx(0.0275)


def of_path(data: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        data = data[key]
    return data
