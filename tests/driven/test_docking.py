"""A rail in its rollers meets a mate with tapered pins: within what the play allows it is turned into line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Cage, CageBody, Drive, Load, Object, Pose, Scene, load_scene, run
from cagepose.files.scene_file import read_scene_file
from our_scenes import SCENES

(DOCK,) = (path for path in SCENES if path.stem == "dock")


def docking(yaw_deg: float, pitch_deg: float, way_m: float = 0.03) -> Scene:
    """The scene of ours, out of line by other angles."""
    scene = load_scene(DOCK)
    pose = Pose((0, 0, 0), euler_zyx=np.radians([yaw_deg, pitch_deg, 0.0]))
    (mate,) = scene.cage.bodies
    straight = CageBody("mate", shapes=mate.shapes, pose=pose.inverse() @ Pose((-0.62, 0.0, 0.0)))
    cage = Cage(scene.cage.points_cage, scene.cage.names, pose, bodies=[straight])
    held = scene.object
    rail = Object(held.boxes, held.center_of_gravity_m, holes=held.holes, mass_kg=held.mass_kg, pose=pose)
    along = {"mate": Drive(travel=pose.rotation.T @ (way_m, 0.0, 0.0))}
    weight = (0.0, 0.0, -9.81)
    return Scene(rail, cage, [Load("weight", gravity=weight), Load("dock", gravity=weight, drive=along)])


@pytest.mark.parametrize(
    ("yaw_deg", "pitch_deg"),
    [
        (0.0, 0.0),
        (0.0, 0.1),
        (-0.3, 0.0),
        (-0.2, -0.2),
        (0.1, 0.0),
        (0.33, 0.0),
        (0.0, 0.3),
        (0.1, 0.1),
        (-0.1, -0.2),
        (0.25, -0.25),
        (0.0, 0.2),
        (-0.1, 0.1),
        (0.2, 0.1),
    ],
)
def test_within_its_play_the_rail_comes_into_line(yaw_deg: float, pitch_deg: float) -> None:
    """Up to the play that the pins have left in the holes: 0.34 mm, over at least 500 mm."""
    _, phase = run(docking(yaw_deg, pitch_deg)).phases
    assert phase.verdict == "rests"
    assert phase.drive is not None
    assert phase.drive.share == 1.0
    yaw, pitch, roll = np.degrees(phase.pose.euler_zyx)
    assert max(abs(yaw), abs(roll)) < math.degrees(0.34 / 500.0)
    assert abs(pitch) < math.degrees(0.34 / 500.0) + math.degrees(0.5 / 500.0)
    assert phase.drive.snaps_j < 1e-4


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.1), (0.3, -0.4), (-0.5, 0.5)])
def test_the_docking_with_parameters_stands_and_goes_straight_in_the_world(yaw: float, pitch: float) -> None:
    """Its half angles are series; where they end, the mate is out of line by less than 1e-14."""
    settings = (f"parameters.yaw={yaw}", f"parameters.pitch={pitch}")
    turned = read_scene_file(DOCK.parent / "studies" / "dock.yaml", settings).scene
    exact = docking(yaw, pitch)
    (mate,), (expected,) = turned.cage.bodies, exact.cage.bodies
    np.testing.assert_allclose(mate.pose_cage_body.position_m, expected.pose_cage_body.position_m, atol=1e-14)
    np.testing.assert_allclose(mate.pose_cage_body.quaternion_wxyz, expected.pose_cage_body.quaternion_wxyz, atol=1e-14)
    np.testing.assert_allclose(turned.object.pose_world_object.rotation, exact.object.pose_world_object.rotation)
    ((leg,),) = turned.loads[1].drive.values()
    ((way,),) = exact.loads[1].drive.values()
    np.testing.assert_allclose(leg.travel_m, way.travel_m, atol=1e-14)
