"""Drives that may jam, to be drawn: pegs on a compliance, drawers between pins, wedges, jaws."""

from __future__ import annotations

import math

import numpy as np

from cagepose import Box, Cage, CageBody, Cylinder, Drive, Force, Load, Object, Pose, Scene, Sphere
from driven.driven_scenes import jaws, wedge
from driven.insertions import LG, Insertion

KINDS = ("peg", "drawer", "wedge", "jaws")


def drawn(random: np.random.Generator, kind: str) -> Scene:
    if kind == "peg":
        return peg(random)
    if kind == "drawer":
        return drawer(random)
    if kind == "wedge":
        return wedge(friction=float(random.uniform(0.0, 1.2)), wall_friction=float(random.uniform(0.0, 3.0)))
    return jaws(angle_deg=float(random.uniform(5.0, 40.0)), friction=float(random.uniform(0.0, 1.0)))


def peg(random: np.random.Generator) -> Scene:
    """Round or square, beside the hole and aslant, with friction up to 0.6."""
    radius = 5.0 * (1.0 + 10.0 ** float(random.uniform(-3.0, -1.0)))
    aside, lean = float(random.uniform(0.0, 0.6)), math.radians(float(random.uniform(-0.6, 0.6)))
    insertion = Insertion(radius, aside, lean, float(random.uniform(0.0, 0.6)))
    return insertion.scene(2.0, [LG - float(random.uniform(5.0, 35.0))], str(random.choice(["round", "square"])))


def drawer(random: np.random.Generator) -> Scene:
    """A drawer on a smooth table between two pins, pushed beside its middle against a force, or none."""
    apart, beside = float(random.uniform(0.02, 0.09)), float(random.uniform(0.0, 0.018))
    limit = apart / (2.0 * max(beside, 1e-3))
    friction = min(limit * 10.0 ** float(random.uniform(-0.5, 0.3)), 4.0)
    side, resistance = float(random.choice([-1.0, 1.0])), float(random.choice([0.0, 1.0, 1.0]))
    pins = [
        Cylinder(0.005, 0.1, Pose((sign * 0.5 * apart, -sign * side * 0.025, 0.01)), name)
        for sign, name in ((-1.0, "rear pin"), (1.0, "front pin"))
    ]
    table = Box((1.0, 1.0, 0.02), Pose((0.0, 0.0, -0.01)), "table")
    finger = CageBody("finger", shapes=[Sphere(0.005, Pose((-0.055, side * beside, 0.01)), "tip")])
    force = Force((-1.0, 0.0, 0.0), (0.05, 0.0, 0.0), resistance) if resistance else None
    load = Load("push", gravity=(0.0, 0.0, -9.81), force=force, drive={"finger": Drive(travel=(0.005, 0.0, 0.0))})
    part = Object([Box((0.1, 0.04, 0.02), name="drawer")], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    cage = Cage(shapes=[*pins, table], bodies=[finger])
    smooth = {"tip": 0.0, "table": 0.0}
    return Scene(part, cage, [load], friction_coefficient=friction, friction_of=smooth, name="drawer")
