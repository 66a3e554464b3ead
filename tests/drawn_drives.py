"""Scenes with driven bodies, to be drawn: jaws that close on a block and turn it, and a spring with a driven end."""

from __future__ import annotations

import math

import numpy as np

from cagepose import Box, Cage, Load, Object, Pose, Scene, Spring
from cagepose.model.cage_body import CageBody
from cagepose.model.drive import Drive

SHORT, LONG, TURN_DEG = 0.02, 0.04, 50.0
"""The block, and by how much it is turned from the jaws."""
APART, WAY = 0.07, 0.03
"""How far the jaws are apart at the start, and how far each would go."""
OPENED = 0.01
"""How far each opens again."""
BLOCKED_AT = (APART - SHORT) / (2.0 * WAY)


def jaws(cage_pose: Pose | None = None, *, turns_after: bool = False) -> Scene:
    """A block on four points between two jaws that close, without friction; then they open and turn, and stand."""
    pose = Pose() if cage_pose is None else cage_pose
    block = Object(
        [Box((SHORT, LONG, 0.02))],
        mass_kg=1.0,
        pose=pose @ Pose((0, 0, 0.01), euler_zyx=(math.radians(TURN_DEG), 0, 0)),
    )
    below = [(x, y, 0.0) for x in (-0.005, 0.005) for y in (-0.005, 0.005)]
    bodies = [
        CageBody(
            name,
            points=[(0, 0, 0.05)],
            shapes=[Box((0.01, 0.1, 0.04), Pose((0, 0, 0)), f"{name} pad")],
            pose=Pose((sign * (APART / 2 + 0.005), 0, 0.025)),
        )
        for name, sign in (("left", -1), ("right", 1))
    ]
    close = {name: Drive((sign * WAY, 0, 0)) for name, sign in (("left", 1), ("right", -1))}
    down = pose.rotation @ np.array((0, 0, -9.81))
    loads = [Load("close", gravity=down, drive=close)]
    if turns_after:
        both = {
            name: [Drive((-sign * OPENED, 0, 0)), Drive(about=(0, 0, 1), angle=math.radians(5))]
            for name, sign in (("left", 1), ("right", -1))
        }
        loads += [Load("turn", gravity=down, drive=both), Load("weigh", gravity=down)]
    return Scene(block, Cage(below, pose=pose, bodies=bodies), loads, friction_coefficient=0.0, name="jaws")


def open_between_jaws(angle_rad: float) -> float:
    """How far jaws are apart that a block touches on both sides, turned from them by an angle."""
    return SHORT * math.cos(angle_rad) + LONG * math.sin(angle_rad)


def pulled() -> Scene:
    """A block on a smooth table, pulled along by a spring whose far end is driven."""
    block = Object([Box((0.02, 0.02, 0.02))], mass_kg=1.0, pose=Pose((0, 0, 0.01)))
    table = Box((0.4, 0.1, 0.01), Pose((0.05, 0, -0.005)), "table")
    hand = CageBody("hand", points=[(0, 0, 0)], pose=Pose((0.06, 0, 0.01)))
    pull = Spring((0.01, 0, 0), (0, 0, 0), 500.0, 0.0, of="hand")
    load = Load("pull", gravity=(0, 0, -9.81), springs=[pull], drive={"hand": Drive((0.05, 0, 0))})
    return Scene(block, Cage(shapes=[table], bodies=[hand]), [load], friction_coefficient=0.0, name="pulled")
