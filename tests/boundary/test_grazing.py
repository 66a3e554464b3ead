"""Motions along which discs, pins and other round parts pass something at some ten to thousand touch tolerances, or
dip into it by as much: nothing is passed over, and no pair of features takes many steps.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from boundary.asked import Asked
from boundary.drawn_plates import random_peg, random_plate
from boundary.motions import TOLERANCE, TOUCH, after, motion_of, random_direction, random_offset
from boundary.test_first_to_meet import STARTS, Tally, check, greatest_separation
from cagepose import Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.circle_first import Reached, first_touch_of_curved
from cagepose.kernels.boundary.first_meeting import is_curved
from cagepose.kernels.boundary.meetings import can_touch
from cagepose.model.shapes import Shape
from inner_kernels import as_machine_code
from shapes import convex_bodies, pierced_plate, turned_bodies

MOST_STEPS = 1000
"""For one pair of features."""
BEFORE = 0.5
"""Amount after which they are nearest."""


class Steps:
    """How many steps each pair of curved features took."""

    def __init__(self) -> None:
        self.taken, self.first = list[int](), as_machine_code(first_touch_of_curved)

    def count(self, asked: Asked, motion: Motion, end: float) -> None:
        held, cage, found, touch_m = asked.held, asked.cage, asked.found, asked.touch_m
        for i in range(len(held.own.features)):
            for j in range(len(cage.own.features)):
                one, other = held.own.features[i], cage.own.features[j]
                if is_curved(one, other) and can_touch(one, other):
                    memory = (asked.moved, found.places, found.waiting, found.kept, 0)
                    reached = Reached(*self.first(held, i, cage, j, motion, end, 1e-9, touch_m, touch_m, *memory))
                    self.taken.append(reached.n_steps)

    def conclude(self, say: Callable[[str], None]) -> None:
        taken = np.array(self.taken)
        say(f"{len(taken)} pairs: {taken.mean():.1f} steps, at most {taken.max()}")
        assert taken.max() <= MOST_STEPS


def grazing(
    rng: np.random.Generator,
    pose: Pose,
    size: float,
    wanted: float,
    apart_at: Callable[[Pose], tuple[float, np.ndarray]],
) -> tuple[Pose, Motion] | None:
    """A pose and a motion from it: bodies are so far apart half-way, and come no nearer there."""
    for _ in range(4):
        apart, normal = apart_at(pose)
        pose = Pose(pose.position_m + normal * (apart - wanted), pose.quaternion_wxyz)
    kind = rng.choice(["travel", "turn", "screw"])
    velocity = random_direction(rng) * size * (kind != "turn")
    axis, rate = random_direction(rng), float(rng.uniform(0.1, 2.0)) * (kind != "travel")
    center = np.array(pose.position_m) + rng.normal(size=3) * size * rng.choice([0.0, 0.0, 1.0])
    for _ in range(3):
        motion, span = motion_of(center, velocity, rate, axis if rate else np.zeros(3)), 1e-5
        rises = (apart_at(after(motion, pose, span))[0] - apart_at(after(motion, pose, -span))[0]) / (2.0 * span)
        velocity = velocity + normal * rises
    motion = motion_of(center, velocity, rate, axis if rate else np.zeros(3))
    start = after(motion, pose, -BEFORE)
    return (start, motion) if abs(apart_at(pose)[0] - wanted) < 0.5 * abs(wanted) else None


def tolerances(rng: np.random.Generator) -> float:
    """How far apart or, one in three, how deep, in touch tolerances."""
    return float(10.0 ** rng.uniform(1.0, 3.0) * rng.choice([1.0, 1.0, -1.0]))


def test_round_and_sharp_parts_that_graze(cases, say):
    rng, tally, steps = np.random.default_rng(17), Tally(), Steps()
    for _ in range(cases(2, 10)):
        part, cage_part = turned_bodies.random_turned(rng), turned_bodies.random_turned(rng)
        body, other = turned_bodies.circles_of(part), turned_bodies.circles_of(cage_part)
        size = max(body.size, other.size)
        pose = turned_bodies.placed_at(body, other, convex_bodies.random_turn(rng), random_offset(rng), 1e-3 * size)
        normal = other.middle - body.at(pose).middle

        def gap_at(there: Pose, body=body, other=other) -> tuple[float, np.ndarray]:
            nonlocal normal
            apart, normal = turned_bodies.gap(body.at(there), other, normal)
            return apart, normal / np.linalg.norm(normal)

        def apart_at(there: Pose, body=body, other=other, least=-TOLERANCE * TOUCH * size, gap_at=gap_at) -> float:
            apart, along = gap_at(there)
            return apart if apart >= least else greatest_separation(body.at(there), other, [along, *STARTS])

        found = grazing(rng, pose, size, tolerances(rng) * TOUCH * size, gap_at)
        if found is None or apart_at(found[0]) < 0.0:
            continue
        start, motion = found
        asked = Asked([part], [cage_part], TOUCH * size)
        hit, told = check(asked, start, motion, 1.0, apart_at)
        tally.note(hit, 1.0, told, (part, start, cage_part, motion))
        assert hit is None or not hit.is_open
        steps.count(asked, motion, 1.0)
    tally.conclude("round and sharp parts that graze", say)
    steps.conclude(say)


def test_parts_that_graze_in_and_over_holes(cases, say):
    rng, tally, steps = np.random.default_rng(18), Tally(), Steps()
    for _ in range(cases(5, 25)):
        cage, plate, radius = random_plate(rng)
        part: Shape = random_peg(rng, radius)
        turn = np.array([1.0, *(rng.normal(size=3) * rng.choice([0.0, 0.02, 0.1]))])
        beside = rng.uniform(-0.2, 0.2, 2) * radius * rng.choice([0.0, 1e-3, 1.0])
        pose = Pose((*beside, rng.uniform(-0.5, 2.5)), turn)

        def gap_at(there: Pose, part=part, plate=plate) -> tuple[float, np.ndarray]:
            apart, normal = pierced_plate.gap(part, there, plate)[:2]
            return apart, np.array(normal)

        found = grazing(rng, pose, 1.0, tolerances(rng) * 3e-9, gap_at)
        if found is None or gap_at(found[0])[0] < 0.0:
            continue
        start, motion = found
        asked = Asked([part], cage, 3e-9)
        hit, told = check(asked, start, motion, 1.0, lambda at, gap_at=gap_at: gap_at(at)[0])
        tally.note(hit, 1.0, told, (part, start, cage, motion))
        assert hit is None or not hit.is_open
        steps.count(asked, motion, 1.0)
    tally.conclude("parts that graze in and over holes", say)
    steps.conclude(say)
