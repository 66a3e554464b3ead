"""Plates with a hole, and parts to go into or over it."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Pose
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Cylinder, Shape, Sphere
from shapes.pierced_plate import PiercedPlate, plate_of

WIDE = 5.0
"""Size of the plate of the oracle, metres."""


def random_plate(rng: np.random.Generator) -> tuple[list[Shape], PiercedPlate, float]:
    """A plate with a hole that is open or blind, its mouth sharp or chamfered; and the hole's radius."""
    radius = float(rng.choice([0.5, 1.0, rng.uniform(0.3, 1.0)]))
    depth = float(rng.choice([0.5, 1.0, rng.uniform(0.4, 1.5)]))
    chamfer = None
    if rng.random() < 0.4:
        chamfer = Chamfer(
            float(rng.choice([0.1, 0.05])), float(rng.choice([np.pi / 4, np.pi / 6, rng.uniform(0.4, 1.2)]))
        )
    if rng.random() < 0.5:
        hole = Hole(radius, depth, chamfer)
        return [hole], plate_of(hole, True, WIDE), radius
    hole = Hole(radius, depth, chamfer, in_=("plate",))
    plate = Box((40.0, 40.0, depth + 1.0), Pose((0, 0, -(depth + 1.0) / 2.0)), name="plate")
    return [plate, hole], plate_of(hole, False, WIDE), radius


def random_peg(rng: np.random.Generator, radius: float) -> Shape:
    """A part to go into or over a hole of a radius."""
    wide = radius * float(rng.choice([0.9, 0.98, 0.5, 1.05, 1.3, rng.uniform(0.2, 1.5)]))
    kind, length = rng.choice(["cylinder", "cylinder", "cone", "ball", "bar", "box"]), float(rng.uniform(0.3, 2.0))
    if kind == "cylinder":
        return Cylinder(wide, length)
    if kind == "cone":
        return Cone(wide, wide * float(rng.choice([0.0, 0.8, 1.2])), length)
    if kind == "ball":
        return Sphere(wide)
    return Capsule(wide, length) if kind == "bar" else Box((1.2 * wide, 1.2 * wide, length))
