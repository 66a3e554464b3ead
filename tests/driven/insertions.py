"""Pegs that are lowered on a compliance (Whitney 1982), and exact statics of them in the plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, root

from cagepose import Box, Cage, CageBody, Chamfer, Cylinder, Drive, Hole, Load, Object, Pose, Scene, Spring
from cagepose.model.checks import FloatArray

MM = 1e-3
RADIUS, LENGTH, LG = 5.0, 60.0, 40.0
"""Of the peg, and how far above its tip the centre of the compliance is, mm."""
STIFFNESS, TURNING = 5.0, 2e4
"""Of the compliance: N/mm to the side and along, N mm/rad."""
HALF = math.sqrt(TURNING / STIFFNESS)
"""Its two springs are so far from its centre along the peg, mm."""


@dataclass(frozen=True)
class Statics:
    """A peg in balance as it slides down: its tip, its lean, and forces at the mouth and, of two points, at the tip."""

    tip_mm: FloatArray
    lean: float
    forces_n: FloatArray
    friction: float

    @property
    def axial_n(self) -> float:
        """What pushes the peg along the hole's axis."""
        normal, lean = self.forces_n, self.lean
        at_mouth = normal[0] * (self.friction * math.cos(lean) + math.sin(lean))
        return float(at_mouth + (self.friction * normal[1] if len(normal) == 2 else 0.0))


@dataclass(frozen=True)
class Insertion:
    """A peg above or in a hole; its support is ``aside`` of it, mm, and turned by ``lean``."""

    hole_radius: float
    aside: float
    lean: float
    friction: float

    def anchors(self, high: float) -> list[FloatArray]:
        """Where the springs are held, x and z, with the centre of the support ``high`` above the mouth."""
        along = np.array([math.sin(self.lean), math.cos(self.lean)])
        return [np.array([self.aside, high]) + sign * HALF * along for sign in (-1.0, 1.0)]

    def exact(self, n_points: int, high: float) -> Statics:
        """One point is the mouth on the peg's side, the other one the tip's edge on the wall across."""

        def missing(unknowns: FloatArray) -> list[float]:
            x, z, lean, *normal = unknowns
            tip, axis = np.array([x, z]), np.array([math.sin(lean), math.cos(lean)])
            side = np.array([math.cos(lean), -math.sin(lean)])
            force, moment = np.zeros(2), 0.0
            for sign, anchor in zip((-1.0, 1.0), self.anchors(high), strict=True):
                at = tip + (LG + sign * HALF) * axis
                pull = 0.5 * STIFFNESS * (anchor - at)
                force, moment = force + pull, moment + at[0] * pull[1] - at[1] * pull[0]
            mouth = np.array([self.hole_radius, 0.0])
            gaps, pushes = [(mouth - tip) @ side - RADIUS], [(mouth, normal[0] * (self.friction * axis - side))]
            if n_points == 2:
                edge = tip - RADIUS * side
                gaps.append(edge[0] + self.hole_radius)
                pushes.append((edge, normal[1] * np.array([1.0, self.friction])))
            for place, push in pushes:
                force, moment = force + push, moment + place[0] * push[1] - place[1] * push[0]
            return [*force, moment, *gaps]

        guess = np.array([self.hole_radius - RADIUS, high - LG, 0.001, *[1.0] * n_points])
        for _ in range(3):
            guess = root(missing, guess, tol=1e-14).x
        return Statics(guess[:2], float(guess[2]), guess[3:], self.friction)

    def high_at(self, n_points: int, depth: float) -> float:
        """How high the support's centre is where the middle of the tip is ``depth`` below the mouth, mm."""
        return float(
            brentq(lambda high: self.exact(n_points, high).tip_mm[1] + depth, LG - depth - 5.0, LG, xtol=1e-13)
        )

    def scene(self, begins: float, ends: Sequence[float], shape: str = "round") -> Scene:
        """The peg starts upright in the middle of the hole, its tip ``begins`` deep and its support ``LG`` above that.
        It is lowered until the support is as high as each of ``ends``.
        """
        start, high = 0.5 * LENGTH - begins, LG - begins
        springs = []
        for sign, anchor in zip((-1.0, 1.0), self.anchors(high), strict=True):
            at = np.array([0.0, LG - 0.5 * LENGTH + sign * HALF])
            pull = 0.5 * STIFFNESS * float(np.linalg.norm(anchor - at - (0.0, start)))
            rides = anchor - (self.aside, high)
            ends_m = [np.array([x, 0.0, z]) * MM for x, z in (at, rides)]
            springs.append(Spring(*ends_m, 0.5 * STIFFNESS / MM, pull, of="gripper"))
        gripper = CageBody("gripper", pose=Pose(np.array([self.aside, 0.0, high]) * MM))
        loads, before = [], high
        for number, end in enumerate(ends):
            lowered = Drive(travel=(0.0, 0.0, (end - before) * MM))
            loads.append(Load(f"insert {number}", springs=springs, drive={"gripper": lowered}))
            before = end
        pose = Pose((0.0, 0.0, start * MM))
        if shape == "round":
            peg = Object(shapes=[Cylinder(RADIUS * MM, LENGTH * MM, name="peg")], pose=pose)
            block = Box(np.array([60.0, 60.0, 50.0]) * MM, Pose((0.0, 0.0, -25.0 * MM)), "block")
            cage = Cage(
                shapes=[block, Hole(self.hole_radius * MM, 45.0 * MM, in_=["block"], name="hole")], bodies=[gripper]
            )
        else:
            peg = Object([Box(np.array([2.0 * RADIUS, 2.0 * RADIUS, LENGTH]) * MM, name="peg")], pose=pose)
            off = self.hole_radius + 10.0
            walls = [
                Box(np.array([20.0, 60.0, 50.0]) * MM, Pose(np.array([x, 0.0, -25.0]) * MM), name)
                for x, name in ((-off, "left"), (off, "right"))
            ]
            cage = Cage(shapes=walls, bodies=[gripper])
        return Scene(peg, cage, loads, friction_coefficient=self.friction)


def on_chamfer(angle: float, friction: float, way_mm: float, aside: float = 0.4) -> Scene:
    """A round peg that is let down by ``way_mm`` beside a hole with a chamfer 2 mm wide, from 1 mm above the block."""
    springs = [
        Spring((0.0, 0.0, at * MM), (0.0, 0.0, to * MM), 0.5 * STIFFNESS / MM, 150.0, of="gripper")
        for at, to in ((LG + 40.0, 100.0), (LG - 40.0, -100.0))
    ]
    peg = Object(
        shapes=[Cylinder(RADIUS * MM, LENGTH * MM, Pose((0.0, 0.0, 0.5 * LENGTH * MM)), "peg")],
        pose=Pose(np.array([aside, 0.0, 1.0]) * MM),
    )
    block = Box(np.array([60.0, 60.0, 50.0]) * MM, Pose((0.0, 0.0, -25.0 * MM)), "block")
    hole = Hole(5.05 * MM, 45.0 * MM, Chamfer(2.0 * MM, angle), ["block"], name="hole")
    gripper = CageBody("gripper", pose=Pose(np.array([aside, 0.0, LG + 1.0]) * MM))
    drive = {"gripper": Drive(travel=(0.0, 0.0, -way_mm * MM))}
    load = Load("insert", springs=springs, drive=drive)
    return Scene(peg, Cage(shapes=[block, hole], bodies=[gripper]), [load], friction_coefficient=friction)
