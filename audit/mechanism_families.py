"""Families of simple mechanisms as people draw them: cams on pins, rails on V rollers, dovetails, pucks in bores.

Sizes are round numbers of millimetres; clearances and pushes are those of a workshop.
"""

from __future__ import annotations

import numpy as np

from audit.case import FloatArray
from audit.draws import MM, Rng, weight
from cagepose import Box, Cage, Chamfer, Cone, Convex, Cylinder, Force, Hole, Load, Moment, Object, Pose, Scene
from cagepose.model.shapes import Shape

FRICTIONS = (0.0, 0.1, 0.3)
ACROSS = Pose(euler_zyx=(0.0, 0.0, np.pi / 2))
"""Turns an axis that points up to one along y."""


def cam(rng: Rng) -> Scene:
    """An eccentric disc on a pin is turned against a wall that it cannot pass, by a moment about its pin."""
    radius, off = float(rng.choice([20.0, 30.0, 40.0])), float(rng.choice([2.0, 4.0, 8.0]))
    clearance = float(rng.choice([0.001, 0.01, 0.05]))
    angle = np.radians(rng.choice([30.0, 45.0, 60.0, rng.uniform(30, 80)])) * rng.choice([-1.0, 1.0])
    aside = off * np.array([np.cos(angle), 0.0, np.sin(angle)])
    disc = Cylinder(radius * MM, 20 * MM, ACROSS, "cam")
    bore = Hole(
        (5.0 + clearance) * MM, 20 * MM, None, ("cam",), Pose((-aside + (0, -10, 0)) * MM, ACROSS.quaternion_wxyz)
    )
    gap = rng.choice([0.0, 0.01, 0.5]) * (off * (1.0 - np.cos(angle)) - 3.0 * clearance)
    walls: list[Shape] = [
        Cylinder(5 * MM, 60 * MM, ACROSS, "pin"),
        _box((50, 200, 300), (aside[0] + radius + 25 + gap, 0, 0), "wall"),
        _box((200, 10, 200), (0, 16, 0), "front"),
        _box((200, 10, 200), (0, -16, 0), "back"),
    ]
    held = Object(shapes=[disc], holes=[bore], center_of_gravity_m=-aside * MM, pose=Pose(aside * MM))
    turn = Load("turn", moments=[Moment((0, np.sign(angle), 0), 0.01)])
    smooth = {"pin": 0.0, "front": 0.0, "back": 0.0} if rng.random() < 0.7 else {}
    return Scene(held, Cage(shapes=walls), [turn], friction_coefficient=_mu(rng), friction_of=smooth)


def v_rollers(rng: Rng) -> Scene:
    """A square rail on its edge in two V rollers, pushed against a stop by one or two forces."""
    side, length = float(rng.choice([8.0, 10.0, 12.0])), float(rng.choice([60.0, 80.0, 120.0]))
    half = float(rng.choice([20.0, 30.0])) if length > 60 else float(rng.choice([20.0, 30.0, 15.0]))
    rollers: list[Shape] = []
    for x in (-half, half):
        for y, low, high, name in ((2.5, 10.0, 5.0, "a"), (-2.5, 5.0, 10.0, "b")):
            at = Pose((x * MM, y * MM, -12 * MM), ACROSS.quaternion_wxyz)
            rollers.append(Cone(low * MM, high * MM, 5 * MM, at, f"roller {name} {x:+g}"))
    stop = _box((10, 40, 40), (length / 2 + 5 + rng.choice([0.0, 0.0, 1.0]), 0, 0), "stop")
    rail = Box(np.array([length, side, side]) * MM, Pose(euler_zyx=(0, 0, np.pi / 4)), "rail")
    held = Object([rail], pose=Pose((0, 0, float(rng.choice([5.0, 6.0])) * MM)), mass_kg=1.0)
    loads = [weight(), _pushes(rng, np.array([length / 2, side / 2, side / 2]))]
    return Scene(held, Cage(shapes=[*rollers, stop]), loads, friction_coefficient=_mu(rng))


def dovetail(rng: Rng) -> Scene:
    """A dovetail slide in its ways, with or without a stop, pushed along, down, aside or at a corner."""
    half, depth = float(rng.choice([10.0, 15.0, 20.0])), 10.0
    flare = depth * np.tan(np.radians(rng.choice([30.0, 45.0, 15.0])))
    play, length = float(rng.choice([0.0, 0.01, 0.025, 0.1])), float(rng.choice([40.0, 60.0]))
    slide = _prism([(-half - flare, 0), (half + flare, 0), (half, depth), (-half, depth)], length, "slide")
    table = _box((50, 50, 10), (0, 0, 17), "table")
    ways: list[Shape] = [_box((120, 100, 10), (0, 0, -5 - play), "base")]
    for sign, name in ((1, "right way"), (-1, "left way")):
        outline = [(half + flare, 0), (half, depth), (half + flare + 15, depth), (half + flare + 15, 0)]
        way = _prism([(sign * y, z) for y, z in outline], 120.0, name)
        ways.append(Convex(way.vertices_m, 0.0, Pose((0, sign * play * MM, -play * MM)), name))
    if rng.random() < 0.5:
        ways.append(_box((10, 80, 9), (length / 2 + 5 + rng.choice([0.0, 5.0]), 0, 4.5), "stop"))
    loads = [weight(), _pushes(rng, np.array([25.0, 25.0, 17.0]), at_corner=True)]
    held = Object(shapes=[slide, table], mass_kg=1.0)
    return Scene(held, Cage(shapes=ways), loads, friction_coefficient=_mu(rng))


def puck(rng: Rng) -> Scene:
    """A puck in a counterbore with a chamfer, or a plug in a bore, pushed at its rim."""
    radius, thick = float(rng.choice([5.0, 10.0, 20.0])), float(rng.choice([4.0, 8.0, 20.0]))
    clearance = float(rng.choice([0.01, 0.05, 0.1, 0.5]))
    depth = float(rng.choice([8.0, 10.0, 16.0]))
    block = _box((100, 100, 40), (0, 0, -20), "block")
    chamfer = Chamfer(0.5 * MM, np.radians(rng.choice([30.0, 45.0]))) if rng.random() < 0.7 else None
    bore = Hole((radius + clearance) * MM, depth * MM, chamfer, ("block",), name="bore")
    part = Cylinder(radius * MM, thick * MM, Pose((0, 0, thick / 2 * MM)), "puck")
    lift = float(rng.choice([0.0, 0.0, 1.0]))
    held = Object(shapes=[part], pose=Pose((0, 0, (lift - depth) * MM)), mass_kg=0.3)
    angle = np.radians(rng.choice([0.0, 30.0, 45.0, 90.0, rng.uniform(0, 360)]))
    along = np.array([np.cos(angle), np.sin(angle), float(rng.choice([0.0, -1.0, 0.5]))])
    at = np.array([*(radius * along[:2] * rng.choice([-1.0, 0.0, 1.0])), thick])
    force = Force(along, at * MM, float(rng.choice([1.0, 5.0])))
    loads = [Load(name, gravity=(0, 0, -9.81), forces=pushes) for name, pushes in (("weight", []), ("push", [force]))]
    return Scene(held, Cage(shapes=[block], holes=[bore]), loads, friction_coefficient=_mu(rng))


def _mu(rng: Rng) -> float:
    return float(rng.choice(FRICTIONS))


def _pushes(rng: Rng, reach_mm: FloatArray, *, at_corner: bool = False) -> Load:
    """One or two forces of 5 or 50 N along axes or diagonals, at corners or round places, beside the weight."""
    forces = []
    for _ in range(int(rng.integers(1, 3))):
        along = rng.choice([-1.0, 0.0, 1.0], 3)
        if not along.any():
            along[0] = 1.0
        share = (
            rng.choice([-1.0, 1.0], 3)
            if at_corner and rng.random() < 0.5
            else rng.choice([-1.0, -0.5, 0.0, 0.5, 1.0], 3)
        )
        forces.append(Force(along, share * reach_mm * MM, float(rng.choice([5.0, 50.0]))))
    return Load("push", gravity=(0, 0, -9.81), forces=forces)


def _box(size: tuple[float, float, float], at: tuple[float, float, float], name: str) -> Box:
    return Box(np.array(size) * MM, Pose(np.array(at) * MM), name)


def _prism(outline: list[tuple[float, float]], length: float, name: str) -> Convex:
    """A prism along x with an outline in y and z."""
    corners = [(x, y, z) for x in (-length / 2, length / 2) for y, z in outline]
    return Convex(np.array(corners) * MM, name=name)
