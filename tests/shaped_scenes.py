"""Scenes with shapes, and shapes that are drawn, which tests share."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, Load, Object, Pose, Scene
from cagepose.model.shapes import AnyShape, Capsule, Cone, Convex, Cylinder, Sphere

WEIGHT = Load("weight", gravity=(0, 0, -1))
ALONG_X = Pose(euler_zyx=(0, np.pi / 2, 0))
SIDES = ((0.013, "left"), (-0.013, "right"))
TABLE = Box((0.4, 0.4, 0.02), Pose((0, 0, -0.01)), "table")


def held(*shapes: Box | AnyShape, start: Pose) -> Object:
    """An object of one kilogram, its centre of gravity at its origin."""
    return Object(
        shapes=shapes, center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.diag((1e-5, 2e-5, 3e-5)), pose=start
    )


def ball_on_table(height_m: float = 0.05) -> Scene:
    """A ball of 10 mm over a table of 400 mm; no points, no boxes in the object."""
    return Scene(held(Sphere(0.01), start=Pose((0, 0, height_m))), Cage(shapes=[TABLE]), [WEIGHT], name="ball")


def ball_on_points() -> Scene:
    """A ball over three points: no shapes in the cage."""
    points = [(0.01, 0, 0), (-0.005, 0.009, 0), (-0.005, -0.009, 0)]
    return Scene(held(Sphere(0.02), start=Pose((0, 0.003, 0.05))), Cage(points), [WEIGHT], name="points")


def bar_between_bars() -> Scene:
    """A round bar falls on one of two that lie side by side, slides down it and comes to lie on both."""
    bars = [Capsule(0.01, 0.2, Pose((0, y, 0), euler_zyx=(0, np.pi / 2, 0)), name) for y, name in SIDES]
    bar = held(Capsule(0.01, 0.05, ALONG_X), start=Pose((0, 0.003, 0.06)))
    return Scene(bar, Cage(shapes=bars), [WEIGHT], name="bars")


def block_on_balls() -> Scene:
    """A box and three equal balls; no points."""
    places = ((0.01, 0, 0), (-0.01, 0.008, 0), (-0.01, -0.008, 0))
    balls = [Sphere(0.005, Pose(place)) for place in places]
    start = Pose((0, 0, 0.06), euler_zyx=np.radians((10.0, 25.0, 18.0)))
    return Scene(held(Box((0.04, 0.03, 0.02)), start=start), Cage(shapes=balls), [WEIGHT], name="block")


def drawn_shape(random: np.random.Generator) -> Box | AnyShape:
    size = random.uniform(0.004, 0.02, 3)
    turned = Pose(euler_zyx=random.uniform(-3, 3, 3))
    return (
        Box(size, turned),
        Sphere(size[0], turned),
        Capsule(size[0], size[1], turned),
        Cylinder(size[0], size[1], turned),
        Cone(size[0], size[1] / 3.0, size[2], turned),
        Convex(random.normal(size=(7, 3)) * size, 0.0, turned),
        Convex(random.normal(size=(5, 3)) * size, 0.003, turned),
    )[int(random.integers(7))]


def placed_apart(random: np.random.Generator, shape: Box | AnyShape, away: float) -> Box | AnyShape:
    way = random.normal(size=3)
    place = away * way / np.linalg.norm(way)
    pose = Pose(place) @ shape.pose_body_shape
    return Box(shape.size_m, pose) if isinstance(shape, Box) else shape.moved(pose)
