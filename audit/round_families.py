"""Families with circles: pins, pegs, balls, screws, coins and rollers over holes, plates and grooves.

Sizes are in millimetres until a scene is built. How far a part starts beside the axis of its hole is dense from zero to
the rim.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from audit.draws import MM, Rng, friction, weight
from cagepose import Box, Cage, Capsule, Chamfer, Cone, Cylinder, Disc, Force, Hole, Load, Object, Pose, Scene, Sphere
from cagepose.model.shapes import Shape

DEEP = 200.0
"""A hole of this depth goes through."""


def tapered_pin(rng: Rng) -> Scene:
    """A tapered pin over a round hole, sharp or chamfered, a third of them with a head."""
    radius = rng.uniform(3, 8)
    low, high = radius * rng.uniform(0.0, 0.98), radius * rng.uniform(1.05, 2.0)
    length = rng.uniform(15, 60)
    parts: list[Shape] = [_cone(low, high, length, length / 2)]
    if rng.random() < 0.33:
        parts.append(Cylinder(high * rng.uniform(0.8, 1.6) * MM, 4.0 * MM, _up(length + 2.0), "head"))
    plate, hole = _plate(rng, radius, 2.5 * length)
    return _dropped(rng, parts, [plate], [hole], _beside(rng, radius), tilt=rng.choice([0.0, 0.0, 0.05]))


def square_hole(rng: Rng) -> Scene:
    """A cone or a ball over a square hole between four boxes."""
    half, thick = rng.uniform(3, 8), rng.uniform(8, 30)
    walls = [
        Box(np.array([40.0, 80.0, thick]) * MM, _at(side * (20.0 + half), 0.0, -thick / 2), name)
        for side, name in ((-1, "left"), (1, "right"))
    ]
    walls += [
        Box(np.array([2.0 * half, 40.0, thick]) * MM, _at(0.0, side * (20.0 + half), -thick / 2), name)
        for side, name in ((-1, "front"), (1, "back"))
    ]
    if rng.random() < 0.5:
        length = rng.uniform(15, 60)
        part: Shape = _cone(half * rng.uniform(0.0, 0.95), half * rng.uniform(1.1, 2.0), length, length / 2)
    else:
        radius = half * rng.uniform(1.05, 3.0)
        part = Sphere(radius * MM, _up(radius), "ball")
    return _dropped(rng, [part], walls, [], _beside(rng, half), tilt=rng.choice([0.0, 0.0, 0.05]))


def ball_on_hole(rng: Rng) -> Scene:
    """A ball, or a bar with round ends, over a round hole."""
    radius = rng.uniform(3, 8)
    ball = radius * rng.uniform(0.7, 2.5)
    length = rng.uniform(5, 30)
    part: Shape = Sphere(ball * MM, _up(ball), "ball")
    if rng.random() < 0.4:
        part = Capsule(ball * MM, length * MM, _up(ball + length / 2), "bar")
    plate, hole = _plate(rng, radius, rng.uniform(1.0, 4.0) * radius)
    return _dropped(rng, [part], [plate], [hole], _beside(rng, radius), tilt=rng.choice([0.0, 0.05]))


def peg(rng: Rng) -> Scene:
    """A peg with play stands in a hole, or over it, is let go tilted, and half of them are pushed."""
    radius, length, depth = rng.uniform(3, 8), rng.uniform(15, 60), rng.uniform(5, 30)
    plate, hole = _plate(rng, radius * (1 + 10 ** rng.uniform(-3.5, -0.7)), depth)
    play = float(hole.radius_m / MM - radius)
    part = Cylinder(radius * MM, length * MM, _up(length / 2), "peg")
    loads = [weight()]
    if rng.random() < 0.5:
        force = Force((*rng.normal(size=2), -0.2), (0.0, 0.0, length * MM))
        loads.append(Load("push", force=force))
    if rng.random() < 0.6:
        tilt, height = rng.uniform(0, 1) * play / depth, -depth * rng.uniform(0.2, 0.95)
        return _dropped(rng, [part], [plate], [hole], rng.uniform(0, 0.5) * play, tilt=tilt, height=height, loads=loads)
    return _dropped(rng, [part], [plate], [hole], _beside(rng, radius), tilt=rng.choice([0.0, 0.05]), loads=loads)


def countersunk(rng: Rng) -> Scene:
    """A screw with a conical head over a chamfered hole of the same angle or another one."""
    shank = rng.uniform(2, 5)
    radius, angle = shank * rng.uniform(1.02, 1.4), rng.choice([30.0, 41.0, 45.0, 60.0])
    head_angle = angle if rng.random() < 0.5 else rng.uniform(25, 65)
    length, head = rng.uniform(8, 30), shank * rng.uniform(1.5, 2.2)
    height = (head - shank) / np.tan(np.radians(head_angle))
    parts: list[Shape] = [
        Cylinder(shank * MM, length * MM, _up(length / 2), "shank"),
        _cone(shank, head, height, length + height / 2),
    ]
    width = rng.uniform(0.3, 1.2) * (head - radius)
    depth = max(rng.uniform(4, 30), 1.5 * width / np.tan(np.radians(angle)))
    plate, hole = _plate(rng, radius, depth, Chamfer(width * MM, np.radians(angle)))
    return _dropped(rng, parts, [plate], [hole], _beside(rng, radius), tilt=rng.choice([0.0, 0.0, 0.03]))


def coin(rng: Rng) -> Scene:
    """A disc, a coin or a short cylinder falls tilted onto a plate, or onto the rim of a hole."""
    radius, thick = rng.uniform(5, 20), rng.uniform(1, 6)
    part: Shape = Cylinder(radius * MM, thick * MM, _up(thick / 2), "coin")
    if rng.random() < 0.2:
        part = Disc(radius * MM, name="disc")
    plate, hole = _plate(rng, rng.uniform(3, 1.2 * radius), rng.uniform(3, 30))
    tilt = rng.choice([0.0, 0.02, 0.3, rng.uniform(0, 1.4)])
    lift = 2.0 * radius
    beside = rng.choice([0.0, 1.0, rng.uniform(0, 2)]) * float(hole.radius_m / MM)
    holes = [hole] if rng.random() < 0.6 else []
    return _dropped(rng, [part], [plate], holes, beside, tilt=tilt, height=lift)


def roller(rng: Rng) -> Scene:
    """A cylinder, or a bar with round ends, lies on a plate or falls into a groove of two boxes."""
    radius, length = rng.uniform(3, 10), rng.uniform(10, 60)
    along = Pose(euler_zyx=(0.0, np.pi / 2, 0.0))
    part: Shape = Cylinder(radius * MM, length * MM, along, "roller")
    if rng.random() < 0.3:
        part = Capsule(radius * MM, length * MM, along, "bar")
    size = np.array([100.0, 60.0, 10.0]) * MM
    if rng.random() < 0.3:
        ground = [Box(size, _at(0.0, 0.0, -5.0), "plate"), Box(size, _at(0.0, 50.0, 5.0), "stop")]
        beside, lift = rng.uniform(-30, 5), radius + 1.0
    else:
        ground = []
        for side, name in ((-1, "left"), (1, "right")):
            steep = np.radians(rng.choice([30.0, 45.0, rng.uniform(10, 70)]))
            turned = Pose(euler_zyx=(0.0, 0.0, side * steep))
            ground.append(Box(size, turned @ Pose((0, side * 0.030, -0.005)), name))
        beside, lift = rng.choice([0.0, rng.uniform(-5, 5)]), 4.0 * radius
    tilt = rng.choice([0.0, 0.0, 0.05])
    return _dropped(rng, [part], ground, [], beside, tilt=tilt, height=lift + 30 * tilt, heading=np.pi / 2)


def rolling(rng: Rng) -> Scene:
    """A ball, a roller or a bar with round ends rolls along rails, in a groove or over a plate with a hole, over its
    end or up to a stop, above a floor.
    """
    radius, length = rng.choice([5.0, rng.uniform(3, 10)]), rng.choice([20.0, rng.uniform(10, 60)])
    ends, across = rng.choice([10.0, rng.uniform(5, 30)]), Pose(euler_zyx=(0.0, 0.0, np.pi / 2))
    part: Shape = Sphere(radius * MM, name="ball")
    kind = rng.choice(["rails", "rods", "rails", "groove", "hole"])
    if kind == "hole" or rng.random() < 0.3:
        part = (Cylinder if rng.random() < 0.5 else Capsule)(radius * MM, length * MM, across, "roller")
    half = radius * rng.choice([0.6, 0.8, rng.uniform(0.3, 0.95)])
    beam, lift = np.array([40.0 + ends, 20.0, 10.0]) * MM, radius
    middle, holes = (ends - 40.0) / 2.0, list[Hole]()
    ground: list[Shape] = [Box(np.array([200.0, 100.0, 10.0]) * MM, _at(0, 0, -60), "floor")]
    for side in (-1.0, 1.0):
        if kind == "rails":
            ground.append(Box(beam, _at(middle, side * (half + 10.0), -5.0), f"rail {side:g}"))
        elif kind == "rods":
            along = _at(middle, side * (half + 4.0), -4.0) @ Pose(euler_zyx=(0.0, np.pi / 2, 0.0))
            ground.append(Cylinder(4.0 * MM, float(beam[0]), along, f"rod {side:g}"))
        elif kind == "groove":
            turned = Pose(euler_zyx=(0.0, 0.0, side * rng.choice([np.pi / 4, rng.uniform(0.2, 1.2)])))
            ground.append(Box(beam, turned @ _at(middle, side * 10.0, -5.0), f"side {side:g}"))
            lift = 2.5 * radius
    if kind == "hole":
        ground.append(Box(np.array([40.0 + ends, 60.0, 10.0]) * MM, _at(middle, 0.0, -5.0), "plate"))
        holes.append(
            Hole(rng.uniform(0.5, 1.0) * ends * MM, DEEP * MM, None, ("plate",), _at(0, rng.uniform(-9, 9), 0))
        )
    if rng.random() < 0.4:
        ground.append(Box(np.array([10.0, 80.0, 60.0]) * MM, _at(ends + rng.uniform(-5, 15) + 5.0, 0.0, 0.0), "stop"))
    way = np.array([1.0, rng.choice([0.0, 0.0, rng.normal() * 0.2]), 0.0])
    push = Load("push", gravity=(0, 0, -9.81), force=Force(way, (0, 0, 0), 0.1 * 9.81 * rng.choice([0.02, 0.1, 0.4])))
    pose = Pose(np.array([-ends - length / 2.0, rng.choice([0.0, 0.3]), lift + 0.5]) * MM)
    held, mu = Object(shapes=[part], pose=pose, mass_kg=0.1), float(rng.choice([0.3, 0.5, rng.uniform(0.1, 1.0)]))
    loads = [Load("weight", gravity=(0, 0, -9.81)), push]
    return Scene(held, Cage(shapes=ground, holes=holes), loads, friction_coefficient=mu)


def _plate(rng: Rng, radius: float, depth: float, chamfer: Chamfer | None = None) -> tuple[Box, Hole]:
    """A plate with its top at zero and a hole, half of those through and some chamfered."""
    thick = depth * rng.choice([1.0, 1.0, 1.5])
    if chamfer is None and rng.random() < 0.4:
        angle = np.radians(rng.choice([30.0, 45.0, 60.0]))
        width = min(rng.uniform(0.1, 0.5) * radius, 0.5 * depth * np.tan(angle))
        chamfer = Chamfer(width * MM, angle)
    plate = Box(np.array([80.0, 80.0, thick]) * MM, _at(0.0, 0.0, -thick / 2), "plate")
    return plate, Hole(radius * MM, depth * MM, chamfer, ("plate",), name="hole")


def _beside(rng: Rng, rim: float) -> float:
    """How far beside the axis: nothing, a hair to all of the rim's radius by its order of magnitude, or anything."""
    kind = rng.random()
    if kind < 0.1:
        return 0.0
    return float(rim * (10 ** rng.uniform(-5, 0) if kind < 0.5 else rng.uniform()))


def _dropped(
    rng: Rng,
    parts: Sequence[Shape],
    cage: Sequence[Shape],
    holes: Sequence[Hole],
    beside: float,
    *,
    tilt: float,
    height: float = 2.0,
    heading: float | None = None,
    loads: Sequence[Load] | None = None,
) -> Scene:
    """The part above the origin, so far beside it and so much tilted, a third of the time along an axis."""
    if heading is None:
        heading = 0.0 if rng.random() < 0.33 else rng.uniform(0, 2 * np.pi)
    turn = (0.0 if tilt == 0.0 else rng.uniform(0, 2 * np.pi), tilt, 0.0)
    lift = height + (30.0 * tilt if height > 0.0 else 0.0)
    pose = Pose((beside * np.cos(heading) * MM, beside * np.sin(heading) * MM, lift * MM), euler_zyx=turn)
    if any(isinstance(part, Disc) for part in parts):  # it has no volume
        inertia = np.diag((1e-5, 1e-5, 2e-5))
        held = Object(shapes=parts, center_of_gravity_m=(0, 0, 0), pose=pose, mass_kg=1.0, inertia_kg_m2=inertia)
    else:
        held = Object(shapes=parts, pose=pose)
    mu = friction(rng)
    return Scene(held, Cage(shapes=cage, holes=holes), loads or [weight()], friction_coefficient=mu)


def _cone(low: float, high: float, length: float, height: float) -> Cone:
    return Cone(low * MM, high * MM, length * MM, _up(height), "cone")


def _up(height: float) -> Pose:
    return Pose((0.0, 0.0, height * MM))


def _at(x: float, y: float, z: float) -> Pose:
    return Pose(np.array([x, y, z]) * MM)
