"""Ordinary parts as they are drawn: pegs in bores, rings on pegs, plates on pins, cans, jaws; in round millimetres.

Symmetric parts, pushed along axes, at 45 deg and askew, with and without friction. What a user draws first must have an
answer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cagepose import Box, Cage, Capsule, Chamfer, Cone, Cylinder, Force, Hole, Load, Object, Pose, Scene, Sphere

MM = 1e-3
Rng = np.random.Generator
FRICTIONS = (0.0, 0.0, 0.1, 0.2, 0.3, 0.5)
WAYS_DEG = (0.0, 0.0, 90.0, 180.0, 45.0, 30.0, 10.0, 73.0)
PLAYS_MM = (0.02, 0.05, 0.1, 0.5)
PUSHES = (0.2, 0.5, 1.0, 3.0)
"""Newton, beside a weight of 1 N."""
OVER = math.pi
"""Turned about x: a hole from below."""
DOWN = (0.0, 0.0, -9.81)
FLOOR = Box((0.4, 0.4, 0.02), Pose((0.0, 0.0, -0.01)), "floor")


def peg_in_hole(rng: Rng) -> Scene:
    """A peg over a bore, or in it; set down and pushed at its top."""
    radius, length, play, depth = (float(rng.choice(x)) for x in ((4, 5, 6, 10), (20, 30, 40), PLAYS_MM, (6, 10, 15)))
    block = Box((80 * MM, 80 * MM, 40 * MM), Pose((0, 0, -20 * MM)), "block")
    chamfer = Chamfer(1.0 * MM, math.pi / 4) if rng.random() < 0.4 else None
    bore = Hole((radius + play) * MM, depth * MM, chamfer, in_=["block"], name="bore")
    aside = float(rng.choice((0.0, 0.3, 0.9))) * play
    start = Pose((aside * MM, 0, (length / 2 - depth + float(rng.choice((0.0, 1.0)))) * MM))
    peg = Cylinder(radius * MM, length * MM, name="peg")
    return _scene(rng, [peg], Cage(shapes=[block], holes=[bore]), (0, 0, length / 2), start)


def bolt_in_hole(rng: Rng) -> Scene:
    """A bolt whose head lies on a plate, its shank in a hole with play."""
    radius, length, play = (float(rng.choice(x)) for x in ((4, 5, 6), (15, 25, 40), (0.1, 0.5, 1.0)))
    plate = Box((80 * MM, 80 * MM, 12 * MM), Pose((0, 0, -6 * MM)), "plate")
    bore = Hole((radius + play) * MM, 12 * MM, in_=["plate"], name="bore")
    shank = Cylinder(radius * MM, length * MM, Pose((0, 0, -length / 2 * MM)), "shank")
    if rng.random() < 0.5:
        head: Cylinder | Box = Cylinder(2 * radius * MM, 6 * MM, Pose((0, 0, 3 * MM)), "head")
    else:
        head = Box((4 * radius * MM, 3 * radius * MM, 6 * MM), Pose((0, 0, 3 * MM)), "head")
    start = Pose((0, float(rng.choice((0.0, 0.5))) * play * MM, float(rng.choice((0.0, 0.5, 2.0))) * MM))
    at = (float(rng.choice((0, radius))), 0, 6)
    return _scene(rng, [shank, head], Cage(shapes=[plate], holes=[bore]), at, start)


def countersunk(rng: Rng) -> Scene:
    """A countersunk screw in a seat of its own or of another angle, with play; pushed at either end of its head."""
    radius, wide, play, length = (float(rng.choice(x)) for x in ((2.5, 3, 4), (2, 3), (0.1, 0.2, 0.5), (10, 20)))
    head_deg, seat_deg = (float(rng.choice((40, 45, 45, 50))) for _ in range(2))
    parts, cage = screw_and_seat(radius, wide, play, length, head_deg, seat_deg)
    start = Pose((float(rng.choice((0.0, 0.5, 0.9))) * play * MM, 0, float(rng.choice((0.5, 2.0))) * MM))
    high = wide / math.tan(math.radians(head_deg))
    return _scene(rng, parts, cage, (0, 0, float(rng.choice((0.0, -high)))), start)


def screw_and_seat(
    radius: float, wide: float, play: float, length: float, head_deg: float, seat_deg: float
) -> tuple[list[Cone | Cylinder], Cage]:
    """A screw with the top of its head at its origin, and a plate with a seat for it, mm: radius of the shank, how much
    wider the head is, play of the shank, its length; half angles.
    """
    high = wide / math.tan(math.radians(head_deg))
    head = Cone(radius * MM, (radius + wide) * MM, high * MM, Pose((0, 0, -high / 2 * MM)), "head")
    shank = Cylinder(radius * MM, length * MM, Pose((0, 0, -(high + length / 2) * MM)), "shank")
    plate = Box((80 * MM, 80 * MM, 12 * MM), Pose((0, 0, -6 * MM)), "plate")
    seat = Hole((radius + play) * MM, 12 * MM, Chamfer(wide * MM, math.radians(seat_deg)), ["plate"], name="seat")
    return [head, shank], Cage(shapes=[plate], holes=[seat])


def ring_on_peg(rng: Rng) -> Scene:
    """A ring over a peg on a floor."""
    radius, play, outer, height = (float(rng.choice(x)) for x in ((5, 8, 10), PLAYS_MM, (20, 30), (6, 10, 20)))
    peg = Cylinder(radius * MM, 30 * MM, Pose((0, 0, 15 * MM)), "peg")
    ring = Cylinder(outer * MM, height * MM, Pose((0, 0, height / 2 * MM)), "ring")
    bore = Hole((radius + play) * MM, height * MM, None, ["ring"], Pose(euler_zyx=(0, 0, OVER)), "bore")
    start = Pose((float(rng.choice((0.0, 0.5))) * play * MM, 0, float(rng.choice((0.0, 1.0, 10.0))) * MM))
    at = (float(rng.choice((0, outer))), 0, float(rng.choice((0, height))))
    return _scene(rng, [ring], Cage(shapes=[FLOOR, peg]), at, start, [bore])


def plate_on_pins(rng: Rng) -> Scene:
    """A plate with two holes over two pins on a floor."""
    radius, play, half, high = (float(rng.choice(x)) for x in ((4, 5), PLAYS_MM, (20, 30), (5, 10)))
    pins = [Cylinder(radius * MM, 14 * MM, Pose((x * MM, 0, 7 * MM)), f"pin {x:g}") for x in (-half, half)]
    plate = Box((2 * (half + 15) * MM, 40 * MM, high * MM), Pose((0, 0, high / 2 * MM)), "plate")
    holes = [
        Hole(
            (radius + play) * MM,
            high * MM,
            None,
            ["plate"],
            Pose((x * MM, 0, 0), euler_zyx=(0, 0, OVER)),
            f"hole {x:g}",
        )
        for x in (-half, half)
    ]
    start = Pose((0, 0, float(rng.choice((0.0, 0.5, 6.0))) * MM))
    at = (float(rng.choice((0, half, half + 15))), float(rng.choice((0, 20))), high)
    return _scene(rng, [plate], Cage(shapes=[FLOOR, *pins]), at, start, holes)


def can_on_step(rng: Rng) -> Scene:
    """A can or a box at the edge of a table over a floor, before a wall or a rail."""
    size, length, high, over = (float(rng.choice(x)) for x in ((10, 15), (20, 40), (10, 30), (-5, 0, 5)))
    table = Box((60 * MM, 100 * MM, high * MM), Pose((-30 * MM, 0, high / 2 * MM)), "table")
    wall = Box((10 * MM, 100 * MM, 80 * MM), Pose((float(rng.choice((30, 45))) * MM, 0, 40 * MM)), "wall")
    if rng.random() < 0.3:
        part: Cylinder | Box = Box((2 * size * MM, 2 * size * MM, length * MM), name="can")
    else:
        part = Cylinder(size * MM, length * MM, name="can")
    start = Pose((over * MM, 0, (high + length / 2 + float(rng.choice((0.0, 1.0)))) * MM))
    return _scene(rng, [part], Cage(shapes=[FLOOR, table, wall]), (0, 0, float(rng.choice((0, length / 2)))), start)


def v_block(rng: Rng) -> Scene:
    """A bar in a V-block of two leaning boxes, maybe against a stop at its end."""
    radius, length, lean = float(rng.choice((5, 10))), float(rng.choice((30, 60))), float(rng.choice((30, 45, 60)))
    turn = math.radians(lean)
    sides = []
    for sign in (-1.0, 1.0):
        normal = (sign * -math.sin(turn), 0.0, math.cos(turn))
        pose = Pose((-5 * MM * normal[0], 0, -5 * MM * normal[2]), euler_zyx=(0, -sign * turn, 0))
        along = (sign * 20 * MM * math.cos(turn), 0, 20 * MM * math.sin(turn))
        pose = Pose(pose.position_m + along, pose.quaternion_wxyz)
        sides.append(Box((40 * MM, 40 * MM, 10 * MM), pose, "left" if sign < 0 else "right"))
    stop = Box((60 * MM, 5 * MM, 60 * MM), Pose((0, (length / 2 + 3.5) * MM, 20 * MM)), "stop")
    lying = (0, 0, math.pi / 2)
    if rng.random() < 0.7:
        bar: Cylinder | Capsule | Box = Cylinder(radius * MM, length * MM, Pose(euler_zyx=lying), "bar")
    elif rng.random() < 0.5:
        bar = Capsule(radius * MM, length * MM, Pose(euler_zyx=lying), "bar")
    else:
        bar = Box((radius * MM, length * MM, radius * MM), Pose(euler_zyx=(0, math.pi / 4, 0)), "bar")
    start = Pose(
        (float(rng.choice((0.0, 0.5, 2.0))) * MM, 0, (radius / math.cos(turn) + float(rng.choice((1, 5)))) * MM)
    )
    cage = Cage(shapes=[*sides, stop] if rng.random() < 0.5 else sides)
    return _scene(rng, [bar], cage, (0, float(rng.choice((0, length / 2))), 0), start)


def on_rollers(rng: Rng) -> Scene:
    """A box or a capped bar on two or three rollers, with a stop."""
    radius, apart, high = float(rng.choice((5, 8))), float(rng.choice((40, 60))), float(rng.choice((10, 20)))
    lying = (0, 0, math.pi / 2)
    kind = Cylinder if rng.random() < 0.5 else Capsule
    places = (-apart, apart) if rng.random() < 0.6 else (-apart, 0.0, apart)
    rollers = [
        kind(radius * MM, 80 * MM, Pose((x * MM, 0, -radius * MM), euler_zyx=lying), f"roller {x:g}") for x in places
    ]
    stop = Box((10 * MM, 80 * MM, 60 * MM), Pose((110 * MM, 0, 0)), "stop")
    bar = Box((160 * MM, 40 * MM, high * MM), Pose((0, 0, high / 2 * MM)), "bar")
    start = Pose((float(rng.choice((0, 20, 25))) * MM, 0, float(rng.choice((0.0, 1.0))) * MM))
    at = (float(rng.choice((0, 80))), float(rng.choice((0, 20))), float(rng.choice((0, high))))
    return _scene(rng, [bar], Cage(shapes=[*rollers, stop]), at, start)


def ball_seat(rng: Rng) -> Scene:
    """A ball, or a bar with a ball end, over a bore or its chamfer."""
    radius, bore = float(rng.choice((6, 8, 10))), float(rng.choice((3, 4, 5)))
    block = Box((80 * MM, 80 * MM, 40 * MM), Pose((0, 0, -20 * MM)), "block")
    angle = math.radians(float(rng.choice((30, 45, 60))))
    chamfer = Chamfer(float(rng.choice((1.0, 2.0, 4.0))) * MM, angle) if rng.random() < 0.6 else None
    hole = Hole(bore * MM, 20 * MM, chamfer, in_=["block"], name="bore")
    parts: list[Box | Cylinder | Capsule | Sphere] = [Sphere(radius * MM, name="ball")]
    if rng.random() < 0.4:
        parts.append(Cylinder(2 * MM, 30 * MM, Pose((0, 0, 15 * MM)), "stem"))
    start = Pose((float(rng.choice((0.0, 1.0, 2.5))) * MM, float(rng.choice((0.0, 0.5))) * MM, 2 * radius * MM))
    return _scene(rng, parts, Cage(shapes=[block], holes=[hole]), (0, 0, float(rng.choice((0, 4)))), start)


def pocket(rng: Rng) -> Scene:
    """A box, a can or a ball in a corner of two walls, pushed into it, along it or away from it."""
    half, high = float(rng.choice((10, 15))), float(rng.choice((10, 30)))
    tall = float(rng.choice((5, 40)))
    walls = [
        Box((10 * MM, 80 * MM, tall * MM), Pose((-(half + 5) * MM, 0, tall / 2 * MM)), "left"),
        Box((80 * MM, 10 * MM, tall * MM), Pose((0, -(half + 5) * MM, tall / 2 * MM)), "front"),
        Box((10 * MM, 80 * MM, tall * MM), Pose(((half + 6) * MM, 0, tall / 2 * MM)), "right"),
    ]
    kind = rng.random()
    if kind < 0.4:
        part: Box | Cylinder | Sphere = Box(
            (2 * half * MM, 2 * half * MM, high * MM), Pose((0, 0, high / 2 * MM)), "part"
        )
    elif kind < 0.8:
        part = Cylinder(half * MM, high * MM, Pose((0, 0, high / 2 * MM)), "part")
    else:
        part = Sphere(half * MM, Pose((0, 0, half * MM)), "part")
    start = Pose(
        (float(rng.choice((0.0, 0.5))) * MM, float(rng.choice((0.0, 0.5))) * MM, float(rng.choice((0, 1))) * MM)
    )
    chosen = walls if rng.random() < 0.6 else walls[:2]
    return _scene(rng, [part], Cage(shapes=[FLOOR, *chosen]), (0, 0, float(rng.choice((0, high)))), start)


def gripper(rng: Rng) -> Scene:
    """A part between two bars, above a third or a floor."""
    radius, play, size = float(rng.choice((5, 8))), float(rng.choice((0.0, 0.1, 1.0))), float(rng.choice((10, 15)))
    lying = (0, 0, math.pi / 2)
    kind = Capsule if rng.random() < 0.5 else Cylinder
    bars = [
        kind(radius * MM, 60 * MM, Pose((x * (size + radius + play) * MM, 0, 0), euler_zyx=lying), f"bar {x}")
        for x in (-1, 1)
    ]
    below = Box((60 * MM, 60 * MM, 10 * MM), Pose((0, 0, -(size + 10) * MM)), "below")
    what = rng.random()
    if what < 0.35:
        part: Box | Capsule | Cylinder = Box((2 * size * MM, 30 * MM, 2 * size * MM), name="part")
    elif what < 0.7:
        part = Cylinder(size * MM, 30 * MM, Pose(euler_zyx=lying if rng.random() < 0.5 else (0, 0, 0)), "part")
    else:
        part = Capsule(size * MM, 30 * MM, Pose(euler_zyx=lying), "part")
    at = (0, float(rng.choice((0, 15))), float(rng.choice((0, size))))
    return _scene(rng, [part], Cage(shapes=[*bars, below]), at, Pose((0, 0, float(rng.choice((0, 2))) * MM)))


def _scene(
    rng: Rng,
    parts: Sequence[Box | Cone | Cylinder | Capsule | Sphere],
    cage: Cage,
    at_mm: Sequence[float],
    start: Pose,
    holes: Sequence[Hole] = (),
) -> Scene:
    """Set down by its weight, then pushed level at a place of the object."""
    way = math.radians(float(rng.choice(WAYS_DEG)))
    push = Force((math.cos(way), math.sin(way), 0), [x * MM for x in at_mm], float(rng.choice(PUSHES)))
    loads = [Load("weight", gravity=DOWN), Load("push", gravity=DOWN, force=push)]
    boxes = [part for part in parts if isinstance(part, Box)]
    others = [part for part in parts if not isinstance(part, Box)]
    held = Object(boxes, shapes=others, holes=holes, pose=start, mass_kg=1.0 / 9.81)
    return Scene(held, cage, loads, friction_coefficient=float(rng.choice(FRICTIONS)))


DRAWN = (
    peg_in_hole,
    bolt_in_hole,
    ring_on_peg,
    plate_on_pins,
    can_on_step,
    v_block,
    on_rollers,
    ball_seat,
    pocket,
    gripper,
)
