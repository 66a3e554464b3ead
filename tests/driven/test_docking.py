"""A rail in its rollers meets a mate with tapered pins: within what the play allows it is turned into line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Cage, CageBody, Drive, Load, Object, Pose, Scene, load_scene, run
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


@pytest.mark.parametrize(("yaw_deg", "pitch_deg"), [(0.0, 0.0), (0.0, 0.1), (-0.3, 0.0), (-0.2, -0.2)])
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
