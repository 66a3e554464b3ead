"""Scenes in which bodies press."""

from __future__ import annotations

import math

import numpy as np

from cagepose import Box, Cage, CageBody, Capsule, Convex, Load, Object, Pose, Press, Scene, Sphere
from cagepose.model.checks import FloatArray

ALONG_Y = Pose((0.0, 0.0, 0.0), euler_zyx=(math.pi / 2.0, 0.0, 0.0))
HEIGHT, APART = 0.02, 0.03
"""Of a part between jaws, and how far their faces are from the middle at the start, metres."""


def grip(shape: Capsule | Sphere, *, force_n: float = 12.0, friction: float = 0.7, gap_m: float = 0.0) -> Scene:
    """A part of 45 g and 4 mm of radius between a pad that stands and one that presses; it hangs in the air."""
    faces = [Box((0.01, 0.03, 0.03), Pose((side * 0.009, 0.0, 0.0)), f"{name} face") for name, side in SIDES]
    pad = CageBody("right pad", shapes=[faces[1]], pose=Pose((gap_m, 0.0, 0.0)))
    load = Load("hold", gravity=(0.0, 0.0, -9.81), press={"right pad": Press((-1.0, 0.0, 0.0), force_n)})
    part = Object(shapes=[shape], mass_kg=0.045)
    return Scene(part, Cage(shapes=[faces[0]], bodies=[pad]), [load], friction_coefficient=friction)


SIDES = (("left", -1.0), ("right", 1.0))


def ramp(angle_deg: float, force_n: float, stiffness_n_per_m: float = 0.0, friction: float = 0.0) -> Scene:
    """A ball of 10 N on a wedge that presses it up along a wall."""
    rise, radius = math.tan(math.radians(angle_deg)), 0.005
    outline = [(-0.02, -0.06), (0.04, -0.06), (0.04, 0.04 * rise), (-0.02, -0.02 * rise)]
    wedge = Convex([(x, y, z) for x, z in outline for y in (-0.01, 0.01)], name="ramp")
    wall = Box((0.01, 0.06, 0.4), Pose((-0.01, 0.0, 0.0)), "wall")
    ball = Object(
        shapes=[Sphere(radius, name="ball")],
        mass_kg=1.0,
        pose=Pose((0.0, 0.0, radius / math.cos(math.radians(angle_deg)))),
    )
    press = {"wedge": Press((-1.0, 0.0, 0.0), force_n, stiffness_n_per_m)}
    cage = Cage(shapes=[wall], bodies=[CageBody("wedge", shapes=[wedge])])
    return Scene(ball, cage, [Load("lift", gravity=(0.0, 0.0, -10.0), press=press)], friction_coefficient=friction)


def jaws(corners: FloatArray, angle: float, friction: float, pressing: tuple[str, ...]) -> Scene:
    """A prism on a smooth table between two jaws, of which some press with 12 N."""
    vertices = [(x, y, z) for x, y in corners for z in (-0.5 * HEIGHT, 0.5 * HEIGHT)]
    pose = Pose((0.0, 0.0, 0.5 * HEIGHT), euler_zyx=(angle, 0.0, 0.0))
    part = Object(shapes=[Convex(vertices, name="part")], mass_kg=0.1, pose=pose)
    bodies = [
        CageBody(name, shapes=[Box((0.01, 0.2, 0.06), Pose((side * (APART + 0.005), 0.0, 0.03)), f"{name} face")])
        for name, side in SIDES
    ]
    table = Box((0.4, 0.4, 0.02), Pose((0.0, 0.0, -0.01)), "table")
    press = {name: Press((-side, 0.0, 0.0), 12.0) for name, side in SIDES if name in pressing}
    load = Load("grip", gravity=(0.0, 0.0, -9.81), press=press)
    return Scene(
        part, Cage(shapes=[table], bodies=bodies), [load], friction_coefficient=friction, friction_of={"table": 0.0}
    )


def polygon(seed: int) -> FloatArray:
    """Corners on an ellipse, (n, 2), metres."""
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(4, 9)))
    return 0.008 * np.stack([np.cos(angles), rng.uniform(0.5, 1.0) * np.sin(angles)], axis=1)
