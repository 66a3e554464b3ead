"""Scenes in which bodies press."""

from __future__ import annotations

import math

import numpy as np

from cagepose import Box, Cage, CageBody, Capsule, Convex, Drive, Load, Object, Pose, Press, Scene, Sphere
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


def lift(shape: Box | Sphere, *, lift_m: float = 0.02) -> Scene:
    """A jaw presses a part of 45 g on a table against another one, both lift it, and then it hangs between them."""
    table = Box((0.06, 0.06, 0.01), Pose((0.0, 0.0, -0.009)), "table")
    bodies = [
        CageBody(f"{name} jaw", shapes=[Box((0.01, 0.03, 0.03), Pose((x, 0.0, 0.011)), f"{name} face")])
        for name, x in (("left", -0.009), ("right", 0.012))
    ]
    press, weight = {"right jaw": Press((-1.0, 0.0, 0.0), 12.0)}, (0.0, 0.0, -9.81)
    up = {f"{name} jaw": Drive((0.0, 0.0, lift_m)) for name, _ in SIDES}
    loads = [
        Load("close", gravity=weight, press=press),
        Load("lift", gravity=weight, press=press, drive=up),
        Load("hold", gravity=weight, press=press),
    ]
    part = Object(shapes=[shape], mass_kg=0.045)
    return Scene(part, Cage(shapes=[table], bodies=bodies), loads, friction_coefficient=0.7)


def plunger(angle_deg: float, force_n: float, stiffness_n_per_m: float, way_m: float = 0.01) -> Scene:
    """A ramp on a smooth floor is pushed under the ball of a plunger, which presses it down and gives way."""
    rise, radius = math.tan(math.radians(angle_deg)), 0.002
    outline = [(-0.03, 0.0), (0.03, 0.0), (0.03, 0.01), (-0.03, 0.01 + 0.06 * rise)]
    ramp = Object(shapes=[Convex([(x, y, z) for x, z in outline for y in (-0.01, 0.01)], name="ramp")], mass_kg=0.1)
    floor = Box((0.4, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "floor")
    walls = [Box((0.4, 0.02, 0.1), Pose((0.0, y, 0.05)), name) for name, y in (("front", -0.02), ("back", 0.02))]
    high = 0.01 + 0.03 * rise + radius / math.cos(math.radians(angle_deg))
    bodies = [
        CageBody("plunger", shapes=[Sphere(radius, name="tip")], pose=Pose((0.0, 0.0, high))),
        CageBody("pusher", shapes=[Box((0.01, 0.02, 0.008), Pose((-0.035, 0.0, 0.005)), "pad")]),
    ]
    press, weight = {"plunger": Press((0.0, 0.0, -1.0), force_n, stiffness_n_per_m)}, (0.0, 0.0, -9.81)
    loads = [
        Load("settle", gravity=weight, press=press),
        Load("push", gravity=weight, press=press, drive={"pusher": Drive((way_m, 0.0, 0.0))}),
    ]
    return Scene(ramp, Cage(shapes=[floor, *walls], bodies=bodies), loads)


def vise(friction: float) -> Scene:
    """A block without weight lies askew before a fixed jaw, and another one presses it on that."""
    block = Box((0.02, 0.03, 0.01), name="block")
    part = Object([block], mass_kg=0.1, pose=Pose((-0.003, 0.0, 0.0), euler_zyx=(math.radians(20.0), 0.0, 0.0)))
    faces = [Box((0.01, 0.04, 0.02), Pose((side * 0.025, 0.0, 0.0)), f"{name} face") for name, side in SIDES]
    cage = Cage(shapes=[faces[0]], bodies=[CageBody("jaw", shapes=[faces[1]])])
    load = Load("close", press={"jaw": Press((-1.0, 0.0, 0.0), 12.0)})
    return Scene(part, cage, [load], friction_coefficient=friction)


def between(left: Press, right: Press) -> Scene:
    """A ball of 4 mm of radius without weight, 10 mm from the face of a jaw to each side."""
    bodies = [
        CageBody(name, shapes=[Box((0.01, 0.03, 0.03), Pose((side * 0.019, 0.0, 0.0)), f"{name} face")])
        for name, side in SIDES
    ]
    ball = Object(shapes=[Sphere(0.004, name="ball")], mass_kg=0.045)
    return Scene(ball, Cage(bodies=bodies), [Load("close", press={"left": left, "right": right})])


def chuck(friction: float) -> Scene:
    """A cube of 20 mm on a table, and four jaws that press with 10 N each."""
    table = Box((0.2, 0.2, 0.01), Pose((0.0, 0.0, -0.015)), "table")
    sides = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    bodies, press = [], {}
    for number, (x, y) in enumerate(sides):
        size = (0.01, 0.03, 0.02) if y == 0.0 else (0.03, 0.01, 0.02)
        bodies.append(CageBody(f"jaw {number}", shapes=[Box(size, Pose((0.03 * x, 0.03 * y, 0.0)), f"face {number}")]))
        press[f"jaw {number}"] = Press((-x, -y, 0.0), 10.0)
    cube = Object([Box((0.02, 0.02, 0.02), name="cube")], mass_kg=0.1)
    cage, load = Cage(shapes=[table], bodies=bodies), Load("close", gravity=(0.0, 0.0, -9.81), press=press)
    return Scene(cube, cage, [load], friction_coefficient=friction)


def let_go() -> Scene:
    """A jaw closes on a cube without weight, which then hangs 10 mm above a table, and opens."""
    block = Box((0.02, 0.02, 0.02), name="block")
    shapes = [
        Box((0.2, 0.2, 0.01), Pose((0.0, 0.0, -0.025)), "table"),
        Box((0.01, 0.04, 0.02), Pose((-0.015, 0.0, 0.0)), "left face"),
    ]
    jaw = CageBody("jaw", shapes=[Box((0.01, 0.04, 0.02), Pose((0.025, 0.0, 0.0)), "right face")])
    press, weight = {"jaw": Press((-1.0, 0.0, 0.0), 20.0)}, (0.0, 0.0, -9.81)
    loads = [
        Load("close", press=press),
        Load("carry", gravity=weight, press=press),
        Load("open", gravity=weight, drive={"jaw": Drive((0.01, 0.0, 0.0))}),
    ]
    cage = Cage(shapes=shapes, bodies=[jaw])
    return Scene(Object([block], mass_kg=0.1), cage, loads, friction_coefficient=0.3)
