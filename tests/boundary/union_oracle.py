"""Bodies of several parts, and what is material of them: asked of the shapes and holes themselves, no feature of a
boundary among it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from cagepose import Box, Pose
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Shape, Sphere

FloatArray = NDArray[np.float64]
Body = list[Shape]

STEPS = 4001
"""Along a ray, at first."""
BALL = 0.3
"""Smallest size of parts of random bodies, metres."""


def is_material(body: Sequence[Shape], places: FloatArray) -> NDArray[np.bool_]:
    """Which of some places (n, 3) are in a part, and not in a hole that is cut out of it."""
    holes = [part for part in body if isinstance(part, Hole)]
    found = np.zeros(len(places), np.bool_)
    for part in body:
        if isinstance(part, Hole):
            continue
        mine = part.holds(places)
        for hole in holes:
            if part.name in hole.in_:
                mine &= ~hole.holds(places)
        found |= mine
    return found


def first_material(body: Sequence[Shape], start: FloatArray, way: FloatArray, end: float) -> float:
    """How far a place goes along a unit vector until it is in material: by samples, each stretch of them halved."""
    steps = np.linspace(0.0, end, STEPS)
    hit = np.flatnonzero(is_material(body, start + steps[:, None] * way))
    if not len(hit):
        return math.inf
    low, high = float(steps[max(hit[0] - 1, 0)]), float(steps[hit[0]])
    while high - low > 1e-11:
        between = np.linspace(low, high, 9)[1:-1]
        inside = np.flatnonzero(is_material(body, start + between[:, None] * way))
        at = int(inside[0]) if len(inside) else len(between)
        low, high = (float(between[at - 1]) if at else low), (float(between[at]) if at < len(between) else high)
    return high


def peg() -> Body:
    """A pin that ends flush in the underside of its head."""
    pin = Cylinder(0.3, 1.0, Pose((0, 0, -0.5)), name="pin")
    return [pin, Cylinder(0.6, 0.4, Pose((0, 0, 0.2)), name="head")]


def tiles() -> Body:
    """Two flush boxes with a hole across their seam, blind or open."""
    boxes: Body = [Box((1.0, 1.4, 0.6), Pose((side * 0.5, 0, -0.3)), name=f"tile{side}") for side in (-1, 1)]
    return [*boxes, Hole(0.25, 0.6, in_=("tile-1", "tile1"), pose_body_shape=Pose((0.05, 0.1, 0)))]


def boss() -> Body:
    """A plate with a round boss, and a hole through both, widened at its mouth."""
    plate = Box((2.0, 1.4, 0.4), Pose((0, 0, -0.2)), name="plate")
    top = Cylinder(0.5, 0.3, Pose((0.1, 0, 0.15)), name="boss")
    pose = Pose((0.15, 0.05, 0.3))
    return [plate, top, Hole(0.2, 0.7, Chamfer(0.1, math.pi / 4), in_=("plate", "boss"), pose_body_shape=pose)]


def half_sunk() -> Body:
    """A roller that lies half in a box."""
    box = Box((1.2, 1.2, 0.6), Pose((0, 0, -0.3)), name="box")
    return [box, Cylinder(0.25, 1.6, Pose((0.1, 0, 0), euler_zyx=(0.3, math.pi / 2, 0)), name="roller")]


def stalk() -> Body:
    """A ball on a stalk on a disc-like foot."""
    ball = Sphere(0.35, Pose((0, 0, 0.3)), name="ball")
    return [ball, Cylinder(0.15, 0.8, Pose((0, 0, -0.3)), name="stalk"), Cone(0.6, 0.3, 0.2, Pose((0, 0, -0.7)))]


def stack() -> Body:
    """Two stacked plates with a countersunk hole, whose cone ends in the lower one."""
    upper = Box((1.6, 1.6, 0.2), Pose((0, 0, -0.1)), name="upper")
    lower = Box((1.4, 1.8, 0.4), Pose((0, 0, -0.4)), name="lower")
    return [upper, lower, Hole(0.2, 0.6, Chamfer(0.3, math.pi / 4), in_=("upper", "lower"))]


def closed() -> Body:
    """A plate with a hole that a box below closes, and with one that a pin fills but for a ring and a recess."""
    plate = Box((2.0, 1.4, 0.4), Pose((0, 0, -0.2)), name="plate")
    cover = Box((0.7, 0.9, 0.3), Pose((-0.4, 0, -0.55)), name="cover")
    holes: Body = [Hole(0.25, 0.4, in_=("plate",), pose_body_shape=Pose((x, 0, 0)), name=f"h{x}") for x in (-0.5, 0.5)]
    return [plate, cover, *holes, Cylinder(0.2, 0.5, Pose((0.52, 0, -0.35)), name="pin")]


def plugged() -> Body:
    """A blind hole in a block that a square peg sticks out of, and a plug that fits another hole."""
    block = Box((2.0, 1.4, 0.8), Pose((0, 0, -0.4)), name="block")
    holes: Body = [Hole(0.3, 0.5, in_=("block",), pose_body_shape=Pose((x, 0, 0)), name=f"h{x}") for x in (-0.5, 0.5)]
    square = Box((0.4, 0.3, 0.9), Pose((-0.5, 0, -0.05), euler_zyx=(0.4, 0, 0)), name="square")
    return [block, *holes, square, Cylinder(0.3, 0.6, Pose((0.5, 0, -0.3)), name="plug")]


def steps() -> Body:
    """A hole through an upper plate that ends in a lower one, beside which a third one has an opening of its own."""
    upper = Box((1.6, 1.6, 0.3), Pose((0, 0, -0.15)), name="upper")
    lower = Box((1.4, 1.8, 0.4), Pose((0, 0, -0.5)), name="lower")
    through = Hole(0.25, 0.5, in_=("upper", "lower"), pose_body_shape=Pose((-0.3, 0, 0)), name="blind")
    wide = Hole(0.3, 0.3, in_=("upper",), pose_body_shape=Pose((0.35, 0, 0)), name="wide")
    narrow = Hole(0.2, 0.4, in_=("lower",), pose_body_shape=Pose((0.35, 0, -0.3)), name="narrow")
    return [upper, lower, through, wide, narrow]


BODIES: dict[str, Callable[[], Body]] = {
    made.__name__: made for made in (peg, tiles, boss, half_sunk, stalk, stack, closed, plugged, steps)
}


def random_part(rng: np.random.Generator, name: str, kinds: Sequence[str]) -> Shape:
    """A part of an ordinary size near the origin; half of them along the axes, on a grid."""
    size, other = rng.uniform(BALL, 2.0 * BALL, 2)
    grid = rng.random() < 0.5
    at = np.round(rng.uniform(-0.4, 0.4, 3) / 0.2) * 0.2 if grid else rng.uniform(-0.4, 0.4, 3)
    quarter = [(0, 0, 0), (0, math.pi / 2, 0), (0, 0, math.pi / 2)][rng.integers(3)]
    pose = Pose(at, euler_zyx=quarter) if grid else Pose(at, rng.normal(size=4))
    if grid:
        size, other = 0.4, 0.6
    match rng.choice(kinds):
        case "box":
            return Box((size, other, size + 0.1), pose, name=name)
        case "cylinder":
            return Cylinder(size, other, pose, name=name)
        case "cone":
            return Cone(size, float(rng.choice([0.0, 0.5])) * size, other, pose, name=name)
        case "sphere":
            return Sphere(size, pose, name=name)
        case "capsule":
            return Capsule(0.6 * size, other, pose, name=name)
        case _:
            corners = rng.uniform(-size, size, (6, 3))
            return Convex(corners, 0.2 * size, pose, name=name)
