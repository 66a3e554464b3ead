"""Whole runs of turned parts, over others and into holes, asked by the oracles what they did on the way."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Convex, Load, Object, Pose, Scene, SceneError, run
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Cylinder, Disc, Shape, Sphere, Turned
from shapes import pierced_plate
from shapes.asked_runs import Asked
from shapes.convex_bodies import random_turn
from shapes.convex_depth import depth
from shapes.pierced_plate import plate_of
from shapes.turned_bodies import circles_of, gap, random_turned

WEIGHT = Load("weight", gravity=(0, 0, -1))
WIDE = 6.0
ENOUGH = 1e-12
"""How near the bounds of a depth come to each other, in sizes of a part: a thousandth of a touch tolerance."""
DEEP_ON_THE_WAY = 40.0
"""Touch tolerances. Known: sharp rims of two solid parts that cross at a small angle go in each other by so much for
some steps.
"""


def object_of(part: Shape, pose: Pose) -> Object:
    return Object(
        shapes=[part], center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.diag((0.3, 0.4, 0.5)), pose=pose
    )


def round_peg(rng: np.random.Generator, radius: float) -> Shape:
    share = rng.choice([0.5, 0.9, 0.98, 1.2])
    kind = rng.choice(["peg", "pin", "tapered", "ball"])
    if kind == "ball":
        return Sphere(share * radius)
    if kind == "pin":
        return Capsule(share * radius, 2.0)
    return Cylinder(share * radius, 2.0) if kind == "peg" else Cone(0.8 * share * radius, share * radius, 2.0)


def test_pegs_dropped_over_holes(cases, say):
    rng, asked = np.random.default_rng(40), Asked()
    for number in range(cases(8, 100)):
        chamfer = Chamfer(0.1, float(rng.choice([0.5, np.pi / 4, 1.0]))) if rng.random() < 0.5 else None
        depth, is_open = float(rng.choice([0.5, 1.0, 1.5])), bool(rng.random() < 0.5)
        plate = Box(
            (WIDE, WIDE, depth if is_open else depth + 1.0), Pose((0, 0, -0.5 * depth - (0 if is_open else 0.5)))
        )
        plate, hole = plate.renamed("plate"), Hole(0.5, depth, chamfer, in_=("plate",))
        peg, tilt = round_peg(rng, 0.5), float(rng.choice([0.0, 0.01, 0.05, 0.2]))
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


def test_a_round_end_that_tips_over_in_a_narrower_hole_goes_no_deeper_than_it_touches():
    """Its ball turns in the hole's mouth until its side comes to the rim, with no speed at first: there a lobe of the
    distance along the rim is narrower than what is searched at once. It went 570 touch tolerances deep."""
    asked = Asked()
    plate, hole = Box((6, 6, 1.5), Pose((0, 0, -0.75)), "plate"), Hole(0.5, 0.5, in_=("plate",))
    turn = (0.9999875002343701, -0.004425862351957992, -0.0010223931057448152, -0.0020894568180440947)
    start = Pose((-0.1219897996460495, -0.0022608028876972774, 2.0), turn)
    peg, oracle = Capsule(0.6, 2.0), plate_of(hole, False, 0.5 * WIDE)
    scene = Scene(object_of(peg, start), Cage(shapes=[plate, hole]), [WEIGHT], friction_coefficient=0.0)
    asked.ask(0, scene, run(scene), lambda pose: -pierced_plate.gap(peg, pose, oracle)[0])
    assert not asked.wrong, asked.wrong


def test_turned_parts_dropped_on_others(cases, say):
    rng, asked, number = np.random.default_rng(41), Asked(DEEP_ON_THE_WAY), 0
    while number < cases(10, 1000):
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
        body, around = circles_of(part), [(circles_of(other), other) for other in (floor, *beside)]

        def depth_at(pose: Pose, part=part, body=body, around=around, touch_m=scene.touch_m) -> float:
            deepest = 0.0
            for circles, other in around:
                # A search from many starts, which now and then finds too much.
                deep = -gap(body.at(pose), circles, enough=ENOUGH, is_rough=True)[0]
                if deep > touch_m and not isinstance(part, Convex) and not isinstance(other, Convex):
                    deep = min(deep, depth(part, pose, other))
                deepest = max(deepest, deep)
            return deepest

        asked.ask(number, scene, run(scene, method="quasistatic"), depth_at)
        number += 1
    say(f"{number} turned parts dropped on others: {asked}")
    asked.check()


@pytest.mark.parametrize(
    ("one", "other", "way", "deep"),
    [
        (Sphere(1.0), Sphere(1.0), (0, 0, 1.9), 0.1),
        (Box((1, 1, 1)), Box((1, 1, 1)), (0.99, 0, 0), 0.01),
        (Cylinder(1.0, 2.0), Disc(1.0), (0, 0, 1.001), -0.001),
        (Cylinder(1.0, 2.0), Capsule(0.5, 2.0), (1.4, 0, 0), 0.1),
        (Cone(1.0, 0.0, 1.0), Box((4, 4, 1)), (0, 0, 0.99), 0.01),
    ],
)
def test_the_convex_program_finds_how_deep_parts_are(one, other, way, deep):
    assert depth(one, Pose(way), other) == pytest.approx(deep, abs=1e-9)
