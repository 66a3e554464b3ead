"""The cases built in Python are the scenes in ``scenes/``, which an installed package lacks."""

from __future__ import annotations

from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from cagepose import Pose, Scene, load_scene
from cagepose.paper.cases import case_scenes

SCENES = Path(__file__).resolve().parents[2] / "scenes"
FILES = ["sample.yaml", "rail-yaw.yaml", "rail-pitch.yaml", "rail-roll.yaml"]


def same_pose(one: Pose, other: Pose) -> None:
    assert_allclose(one.position_m, other.position_m, atol=1e-15)
    assert_allclose(one.quaternion_wxyz, other.quaternion_wxyz, atol=1e-15)


def same_scene(one: Scene, other: Scene) -> None:
    assert one.name == other.name
    assert [box.name for box in one.object.boxes] == [box.name for box in other.object.boxes]
    for box, twin in zip(one.object.boxes, other.object.boxes, strict=True):
        assert_allclose(box.size_m, twin.size_m, atol=1e-15)
        same_pose(box.pose_object_box, twin.pose_object_box)
    assert_allclose(one.object.center_of_gravity_m, other.object.center_of_gravity_m, atol=1e-15)
    same_pose(one.object.pose_world_object, other.object.pose_world_object)
    assert one.cage.names == other.cage.names
    assert_allclose(one.cage.points_cage, other.cage.points_cage, atol=1e-15)
    same_pose(one.cage.pose_world_cage, other.cage.pose_world_cage)
    assert one.tolerances == other.tolerances
    assert (one.friction_coefficient, one.metric) == (other.friction_coefficient, other.metric)
    assert [load.name for load in one.loads] == [load.name for load in other.loads]
    for load, twin in zip(one.loads, other.loads, strict=True):
        assert (load.gravity_world is None, load.force is None) == (twin.gravity_world is None, twin.force is None)
        if load.gravity_world is not None:
            assert_allclose(load.gravity_world, twin.gravity_world, atol=1e-15)
        if load.force is not None:
            assert_allclose(load.force.direction, twin.force.direction, atol=1e-15)
            assert_allclose(load.force.at_object_m, twin.force.at_object_m, atol=1e-15)


@pytest.mark.parametrize("place", range(4), ids=FILES)
def test_each_case_is_its_scene_file(place):
    same_scene(case_scenes()[place], load_scene(SCENES / FILES[place]))
