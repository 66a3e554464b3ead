"""Angles and distances between named features, where coordinates tell them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, CageBody, Cylinder, Hole, Pose, Scene
from cagepose.runs.driven_cage import CageAt, cage_at_start
from cagepose.studies.between_features import AxesAngle, Instant, PlacesDistance
from cagepose.studies.named_features import cage_axis, cage_place, object_axis, object_place
from shaped_scenes import WEIGHT, held

BLOCK = Box((0.06, 0.06, 0.03), Pose((0, 0, -0.015)), "block")
BORE = Hole(0.01, 0.03, in_=["block"], name="bore")
PIN = Cylinder(0.0095, 0.05, Pose((0, 0, 0.03)), "pin")
SCENE = Scene(held(PIN, start=Pose()), Cage([(0.1, 0, 0)], shapes=[BLOCK], holes=[BORE]), [WEIGHT])


def angle_of(one: str, other: str, pose: Pose) -> float:
    measure = AxesAngle(cage_axis(SCENE, one), object_axis(SCENE, other))
    return measure.at(Instant(pose, cage_at_start(SCENE.cage), SCENE.touch_m))


def distance_of(one: str, other: str, pose: Pose) -> float:
    points = {"tip": np.array((0.0, 0.0, 0.005))}
    measure = PlacesDistance(cage_place(SCENE, one), object_place(SCENE, other, points))
    return measure.at(Instant(pose, cage_at_start(SCENE.cage), SCENE.touch_m))


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-9, 1e-4, 0.3, 1.5, math.pi / 2])
def test_an_angle_is_exact_however_small_and_which_way_the_axes_point(angle: float) -> None:
    for turned in (angle, -angle, math.pi - angle, math.pi + angle):
        pose = Pose((0.01, 0.02, 0.03), euler_zyx=(0.7, turned, 0.0))
        for one, other in (("bore", "pin"), ("block.z", "pin.z"), ("world.z", "object.z")):
            assert angle_of(one, other, pose) == pytest.approx(angle, rel=1e-9, abs=1e-15)


def test_a_face_and_an_axis_across_each_other() -> None:
    assert angle_of("block.x", "pin", Pose()) == pytest.approx(math.pi / 2)
    assert angle_of("block.x", "pin.x", Pose(euler_zyx=(0.4, 0.0, 0.0))) == pytest.approx(0.4)
    assert angle_of("block.y", "pin.x", Pose(euler_zyx=(0.4, 0.0, 0.0))) == pytest.approx(math.pi / 2 - 0.4)


def test_a_distance_is_that_of_places_or_from_an_axis() -> None:
    pose = Pose((0.003, 0.004, 0.0))
    assert distance_of("bore", "tip", pose) == pytest.approx(math.hypot(0.003, 0.004, 0.005), rel=1e-12)
    assert distance_of("bore.z", "tip", pose) == pytest.approx(0.005, rel=1e-12)
    assert distance_of("C1", "pin", pose) == pytest.approx(math.hypot(0.097, 0.004, 0.03), rel=1e-12)
    assert distance_of("C1", "pin.z", pose) == pytest.approx(math.hypot(0.097, 0.004), rel=1e-12)
    assert distance_of("block", "pin.x", pose) == pytest.approx(math.hypot(0.004, 0.045), rel=1e-12)


def test_a_part_may_be_called_as_an_axis_and_as_a_frame() -> None:
    """What is known as it stands is a name."""
    named = Scene(
        held(Cylinder(0.01, 0.05, Pose(euler_zyx=(0, math.pi / 2, 0)), "pin.z"), start=Pose()),
        Cage(shapes=[Cylinder(0.01, 0.05, Pose((0.1, 0, 0)), "world")]),
        [WEIGHT],
    )
    at = Instant(Pose(), cage_at_start(named.cage), named.touch_m)
    assert AxesAngle(cage_axis(named, "world"), object_axis(named, "pin.z")).at(at) == pytest.approx(math.pi / 2)


def test_features_of_a_body_are_where_it_is() -> None:
    jaw = CageBody("jaw", [(0.1, 0, 0)], shapes=[Box((0.02, 0.02, 0.02), Pose((0.2, 0, 0)), "pad")])
    scene = Scene(held(PIN, start=Pose()), Cage([(0, 0, 1.0)], bodies=[jaw]), [WEIGHT])
    displaced = Pose((0.01, 0, 0), euler_zyx=(0, 0.25, 0))
    at = Instant(Pose(), CageAt(scene.cage, (Pose(), displaced)), scene.touch_m)
    assert AxesAngle(cage_axis(scene, "pad.z"), object_axis(scene, "pin")).at(at) == pytest.approx(0.25)
    middle = object_place(scene, "pin", {})
    for name, place in (("jaw/C1", (0.1, 0, 0)), ("pad", (0.2, 0, 0))):
        apart = math.dist(displaced.transform(place), (0, 0, 0.03))
        assert PlacesDistance(cage_place(scene, name), middle).at(at) == pytest.approx(apart, rel=1e-12)
