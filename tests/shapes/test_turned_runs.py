"""Whole runs of turned parts, over others and into holes, asked by the oracles what they did on the way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cagepose import Box, Cage, Load, Object, Pose, Run, Scene, SceneError, run
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Cylinder, Shape, Sphere, Turned
from quasistatic.paths import RESTS, VERDICTS, path_of, potential
from shapes import pierced_plate
from shapes.convex_bodies import random_turn
from shapes.pierced_plate import plate_of
from shapes.test_runs import DEEP, POSES, imbalance
from shapes.turned_bodies import circles_of, gap, random_turned

WEIGHT = Load("weight", gravity=(0, 0, -1))
WIDE = 6.0
DEEP_ON_THE_WAY = 150.0
"""Touch tolerances. Known: sharp rims that cross at a small angle go in each other by so much for some steps."""
UNDECIDED = 0.05
"""Of runs, at most so many may end without an answer, by name."""


def object_of(part: Shape, pose: Pose) -> Object:
    return Object(
        shapes=[part], center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.diag((0.3, 0.4, 0.5)), pose=pose
    )


class Asked:
    """What was seen of many runs."""

    def __init__(self) -> None:
        self.verdicts = dict.fromkeys(sorted(VERDICTS), 0)
        self.wrong: list[str] = []
        self.deepest = self.highest = self.least_balanced = 0.0

    def ask(self, number: int, scene: Scene, result: Run, depth_at: Callable[[Pose], float]) -> None:
        """Ask one run for how deep it went, whether its potential rose, and whether a rest is balanced."""
        phase = result.phases[-1]
        self.verdicts[phase.verdict] += 1
        path = path_of(phase)
        every = max(1, len(path) // POSES)
        depth, last = (max(map(depth_at, poses)) / scene.touch_m for poses in (path[::every], path[-1:]))
        heights = [potential(scene, scene.loads[0], pose) for pose in path]
        rise = float(np.max(np.diff(heights), initial=0.0))
        left = imbalance(scene, result) if phase.verdict in RESTS else 0.0
        if last >= DEEP or depth >= DEEP_ON_THE_WAY or rise >= 1e-12 or left >= 1e-8:
            self.wrong.append(
                f"run {number} {phase.verdict}: {depth:g} touch tolerances deep, {last:g} at last, {rise:g} up,"
                f" {left:g} of the load not balanced"
            )
        self.deepest, self.highest = max(self.deepest, depth), max(self.highest, rise)
        self.least_balanced = max(self.least_balanced, left)

    def __str__(self) -> str:
        return (
            f"{self.verdicts}; at most {self.deepest:.1e} touch tolerances deep, {self.highest:.1e} up,"
            f" {self.least_balanced:.1e} of the load not balanced"
        )

    def check(self) -> None:
        n_runs = sum(self.verdicts.values())
        assert not self.wrong, "\n".join(self.wrong)
        assert self.verdicts["stalled"] + self.verdicts["limit"] <= UNDECIDED * n_runs, self.verdicts


def random_peg(rng: np.random.Generator, radius: float) -> Shape:
    share = rng.choice([0.5, 0.9, 0.98, 1.2])
    kind = rng.choice(["peg", "pin", "tapered", "ball"])
    if kind == "ball":
        return Sphere(share * radius)
    if kind == "pin":
        return Capsule(share * radius, 2.0)
    return Cylinder(share * radius, 2.0) if kind == "peg" else Cone(0.8 * share * radius, share * radius, 2.0)


def test_pegs_dropped_over_holes(cases, say):
    rng, asked = np.random.default_rng(40), Asked()
    for number in range(cases(20, 60)):
        chamfer = Chamfer(0.1, float(rng.choice([0.5, np.pi / 4, 1.0]))) if rng.random() < 0.5 else None
        depth, is_open = float(rng.choice([0.5, 1.0, 1.5])), bool(rng.random() < 0.5)
        plate = Box(
            (WIDE, WIDE, depth if is_open else depth + 1.0), Pose((0, 0, -0.5 * depth - (0 if is_open else 0.5)))
        )
        plate, hole = plate.renamed("plate"), Hole(0.5, depth, chamfer, in_=("plate",))
        peg, tilt = random_peg(rng, 0.5), float(rng.choice([0.0, 0.01, 0.05, 0.2]))
        way = rng.normal(size=3)
        turn = (1.0, *(0.5 * tilt / np.linalg.norm(way) * way))
        start = Pose((*(rng.choice([0.0, 0.02, 0.2]) * rng.uniform(-1.0, 1.0, 2)), 2.0), turn)
        friction = float(rng.choice([0.0, 0.3]))
        scene = Scene(object_of(peg, start), Cage(shapes=[plate, hole]), [WEIGHT], friction_coefficient=friction)
        oracle = plate_of(hole, is_open, 0.5 * WIDE)

        def depth_at(pose: Pose, peg=peg, oracle=oracle) -> float:
            return -pierced_plate.gap(peg, pose, oracle)[0]

        asked.ask(number, scene, run(scene, method="quasistatic"), depth_at)
    say(f"{sum(asked.verdicts.values())} pegs dropped over holes: {asked}")
    asked.check()


def test_turned_parts_dropped_on_others(cases, say):
    rng, asked, number = np.random.default_rng(41), Asked(), 0
    while number < cases(20, 60):
        part = random_turned(rng)
        beside = [random_turned(rng, Pose(rng.uniform(-0.8, 0.8, 3), random_turn(rng))) for _ in range(3)]
        floor = Box((20.0, 20.0, 1.0), Pose((0, 0, -2.5)))
        if not any(isinstance(each, Turned) for each in (part, *beside)):
            continue
        turn = random_turn(rng) if rng.random() < 0.7 else (1.0, 0.0, 0.0, 0.0)
        start = Pose((*rng.uniform(-0.3, 0.3, 2), 4.0), turn)
        friction = float(rng.choice([0.0, 0.3]))
        try:
            scene = Scene(
                object_of(part, start), Cage(shapes=[floor, *beside]), [WEIGHT], friction_coefficient=friction
            )
        except SceneError:
            continue
        body, around = circles_of(part), [circles_of(other) for other in (floor, *beside)]

        def depth_at(pose: Pose, body=body, around=around) -> float:
            return max(-gap(body.at(pose), other)[0] for other in around)

        asked.ask(number, scene, run(scene, method="quasistatic"), depth_at)
        number += 1
    say(f"{number} turned parts dropped on others: {asked}")
    asked.check()
