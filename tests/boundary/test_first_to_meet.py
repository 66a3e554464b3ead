"""First contact of boundaries along travels, turns and screws, against safe steps by the distances of oracles."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.optimize import minimize

from boundary.asked import Asked, ball_around
from boundary.drawn_plates import random_peg, random_plate
from boundary.motions import TOLERANCE, TOUCH, after, leaves, random_motion, random_offset
from cagepose import Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.first_meeting import Hit
from cagepose.model.shapes import Shape
from shapes import convex_bodies, pierced_plate, turned_bodies
from shapes.turned_bodies import Circles

SHORTEST = 2e-3
"""Of a motion: sampling goes on by this where parts are near."""


def check(
    asked: Asked,
    pose: Pose,
    motion: Motion,
    end: float,
    apart_at: Callable[[Pose], float],
    roughly_apart_at: Callable[[Pose], float] | None = None,
) -> tuple[Hit | None, str]:
    """Ask the first contact, and whether it is one, and none comes before; None: parts that touch do not all leave.

    On the way a lower bound above zero of how far parts are apart will do, where one is given; at its end it will not.
    """
    meetings, touch_m = asked.place(pose), asked.touch_m
    if meetings.used[0] > 0 and not leaves(motion, meetings):
        return None, ""
    hit, amount = asked.first(motion, end), 0.0
    middle, reach = ball_around(asked.held)
    way = np.array(motion.velocity) + np.cross(
        motion.rate * np.array(motion.axis), pose.transform(middle) - np.array(motion.center)
    )
    speed, until = float(np.linalg.norm(way) + motion.rate * reach), min(hit.amount, end)
    while True:
        is_rough = roughly_apart_at is not None and amount != until
        apart = (roughly_apart_at if is_rough else apart_at)(after(motion, pose, amount))
        if apart < -TOLERANCE * touch_m:
            return hit, f"{-apart / touch_m:g} touch tolerances deep at {amount}, before {hit.amount}"
        if amount == until:
            break
        amount = min(until, amount + max(apart / speed, SHORTEST * end))
    if hit.amount <= end and apart > TOLERANCE * touch_m:
        return hit, f"{apart / touch_m:g} touch tolerances too early, at {hit.amount}"
    return hit, ""


STARTS = list(np.random.default_rng(0).normal(size=(20, 3)))


def greatest_separation(one: Circles, other: Circles, starts: list[np.ndarray]) -> float:
    """Return how far apart two bodies are along the direction that tells most: below zero, how deep they are, where
    the oracle's own way of finding it may be loose.
    """

    def depth_along(direction: np.ndarray) -> float:
        normal = direction / np.linalg.norm(direction)
        reach = one.end_along(normal) @ normal + one.radius
        return float(reach - other.end_along(-normal) @ normal + other.radius)

    options = {"xatol": 1e-12, "fatol": 1e-16, "maxiter": 4000}
    return -min(minimize(depth_along, start, method="Nelder-Mead", options=options).fun for start in starts)


class Tally:
    """What was seen, and what was wrong."""

    def __init__(self) -> None:
        self.seen, self.wrong = {"met": 0, "not met": 0, "pressed": 0}, list[str]()

    def note(self, hit: Hit | None, end: float, told: str, what: object) -> None:
        self.seen["pressed" if hit is None else "met" if hit.amount <= end else "not met"] += 1
        if told:
            self.wrong.append(f"{told}: {what}")

    def conclude(self, of: str, say: Callable[[str], None]) -> None:
        say(f"first contact of {sum(self.seen.values())} motions of {of}: {self.seen}, {len(self.wrong)} wrong")
        assert not self.wrong, "\n".join([f"{len(self.wrong)} wrong", *self.wrong[:5]])


def test_motions_of_round_and_sharp_parts(cases, say):
    rng, tally = np.random.default_rng(7), Tally()
    for _ in range(cases(20, 1000)):
        part, cage_part = turned_bodies.random_turned(rng), turned_bodies.random_turned(rng)
        body, other = turned_bodies.circles_of(part), turned_bodies.circles_of(cage_part)
        size = max(body.size, other.size)
        away = float(rng.choice([0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7])) * size
        pose = turned_bodies.placed_at(body, other, convex_bodies.random_turn(rng), random_offset(rng), away)
        towards = other.middle - body.at(pose).middle
        motion, end = random_motion(rng, pose, towards, size), float(rng.choice([0.1, 1.0, 3.0]))
        normal = towards / max(float(np.linalg.norm(towards)), 1e-300)

        def apart_at(
            there: Pose, is_rough: bool = False, body=body, other=other, least=-TOLERANCE * TOUCH * size
        ) -> float:
            nonlocal normal
            apart, normal = turned_bodies.gap(body.at(there), other, normal, is_rough=is_rough)
            return apart if apart >= least else greatest_separation(body.at(there), other, [normal, *STARTS])

        asked = Asked([part], [cage_part], TOUCH * size)
        found = check(asked, pose, motion, end, apart_at, partial(apart_at, is_rough=True))
        tally.note(*_of(found, end), (part, pose, cage_part, motion, end))
    tally.conclude("round and sharp parts", say)


def test_motions_in_and_over_holes(cases, say):
    rng, tally = np.random.default_rng(8), Tally()
    for _ in range(cases(20, 300)):
        cage, plate, radius = random_plate(rng)
        part: Shape = random_peg(rng, radius)
        turn = np.array([1.0, *(rng.normal(size=3) * rng.choice([0.0, 0.02, 0.1]))])
        beside = rng.uniform(-0.2, 0.2, 2) * radius * rng.choice([0.0, 1e-3, 1.0])
        pose = Pose((*beside, rng.uniform(-0.5, 2.5)), turn)
        if pierced_plate.gap(part, pose, plate)[0] < 1e-6:
            continue
        motion, end = random_motion(rng, pose, np.array((0.0, 0.0, -1.0)), 1.0), float(rng.choice([0.5, 2.0]))
        asked = Asked([part], cage, 3e-9)
        found = check(asked, pose, motion, end, lambda at, p=part, q=plate: pierced_plate.gap(p, at, q)[0])
        tally.note(*_of(found, end), (part, pose, cage, motion, end))
    tally.conclude("parts in and over holes", say)


def _of(found: tuple[Hit | None, str], end: float) -> tuple[Hit | None, float, str]:
    return found[0], end, found[1]
