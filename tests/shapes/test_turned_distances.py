"""How far apart parts with round rims and sides are, and where they touch: against `turned_bodies`, and in and over
holes against `pierced_plate`.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from cagepose import Box, Pose
from cagepose.kernels.shapes.features import Shapes
from cagepose.kernels.shapes.touching import Meetings
from cagepose.model.features import shapes_of
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Shape, Sphere, Turned
from shapes import pierced_plate
from shapes.convex_bodies import CUBE, random_turn
from shapes.pierced_plate import PiercedPlate, brought_to, plate_of
from shapes.test_distances import GAPS, RESOLUTION, TOUCH, WITHIN, geometry_of, placed, random_offset
from shapes.turned_bodies import Circles, circles_of, overlap, placed_at, random_turned

N_PARTS = 80
FEW = 1000
"""Pairs of which none is told wrong."""
MANY_TO_ONE_WRONG = 800
"""Known: of 8,000 random pairs 7 are told wrong, where sharp rims and tips touch: six by 1.1 touch tolerances at most,
one of two rims to be deep.
"""


def separation_along(one: Circles, other: Circles, normal: np.ndarray) -> float:
    """Return how far apart two bodies are between planes across a unit normal of the first."""
    between = float(other.end_along(-normal) @ normal - one.end_along(normal) @ normal)
    return between - one.radius - other.radius


def greatest_separation(one: Circles, other: Circles) -> float:
    """Return how far apart two bodies are at most between two parallel planes, near the best of many directions."""
    random = np.random.default_rng(0)
    ways = np.concatenate([np.eye(3), -np.eye(3), random.normal(size=(4000, 3))])
    best = max((way / np.linalg.norm(way) for way in ways), key=lambda normal: separation_along(one, other, normal))
    found, spread = separation_along(one, other, best), 0.1
    while spread > 1e-14:
        spread *= 0.7
        near = best + spread * random.normal(size=(60, 3))
        near /= np.linalg.norm(near, axis=1)[:, None]
        values = [separation_along(one, other, normal) for normal in near]
        if max(values) > found:
            best, found = near[int(np.argmax(values))], max(values)
    return found


def tip_is_at_rim(one: Circles, other: Circles, touch_m: float) -> bool:
    """Whether a tip of either is at a sharp rim of the other: like two sharp corners, they do not touch, but pass."""
    for body, beside in ((one, other), (other, one)):
        for tip in body.centers[body.radii == 0.0]:
            for center, axis, radius in zip(beside.centers, beside.axes, beside.radii, strict=True):
                along = float((tip - center) @ axis)
                aside = float(np.linalg.norm(tip - center - along * axis)) - radius
                if radius > 0.0 and math.hypot(along, aside) <= 2.0 * touch_m:
                    return True
    return False


class Check:
    """Asks pairs of parts for their gap, and keeps the worst answers."""

    def __init__(self) -> None:
        self.seen = {"apart": 0, "touching": 0, "overlapping": 0}
        self.worst = {"too far": 0.0, "too near": 0.0}

    def pair(self, features: tuple[Shapes, Shapes], bodies: tuple[Circles, Circles], pose: Pose, away: float) -> str:
        """Ask two parts, the first at a pose with this gap, for all that can be told of them; return what is wrong."""
        size = max(body.size for body in bodies)
        touch_m = TOUCH * size
        meetings = placed(geometry_of(*features, touch_m), pose).meetings
        found, one, other = float(meetings.gaps[0, 0]), bodies[0].at(pose), bodies[1]
        told = f"{found / touch_m:g} touch tolerances apart, not {away / touch_m:g}"
        if away > touch_m:
            self.seen["apart"] += 1
            if not found <= away + RESOLUTION * size or not (found > 0.0 or away < WITHIN * touch_m):
                return told
        elif away >= -touch_m:
            self.seen["touching"] += 1
            rows = meetings.rows[: meetings.used[0]]
            least = max([away, *(separation_along(one, other, row["normal"]) for row in rows)])
            if found > least + RESOLUTION * size:
                least = max(least, greatest_separation(one, other))
            self.worst["too far"] = max(self.worst["too far"], (found - least) / size)
            self.worst["too near"] = max(self.worst["too near"], (away - found) / touch_m)
            if not found <= least + RESOLUTION * size or not found >= away - WITHIN * touch_m:
                return told
            if len(rows) == 0 and abs(away) <= 0.9 * touch_m and not tip_is_at_rim(one, other, touch_m):
                return f"nothing touches; {told}"
        elif overlap(one, other):
            self.seen["overlapping"] += 1
            if not found < -0.5 * touch_m:
                return told
        return ""


def test_gaps_of_turned_parts(cases, say):
    rng, check, wrong = np.random.default_rng(5), Check(), []
    parts = [
        random_turned(rng, Pose(rng.uniform(-0.3, 0.3, 3), random_turn(rng)) if rng.random() < 0.5 else None)
        for _ in range(N_PARTS)
    ]
    bodies, features = [circles_of(part) for part in parts], [shapes_of([part]) for part in parts]
    n_pairs = cases(400, 8000)
    for number in range(n_pairs):
        i, j = rng.integers(N_PARTS, size=2)
        if not (isinstance(parts[i], Turned) or isinstance(parts[j], Turned)):
            continue
        away = float(rng.choice(GAPS)) * TOUCH * max(bodies[i].size, bodies[j].size)
        pose = placed_at(bodies[i], bodies[j], random_turn(rng), random_offset(rng), away)
        told = check.pair((features[i], features[j]), (bodies[i], bodies[j]), pose, away)
        if told:
            wrong.append(f"{told}: {parts[i]} at {pose}, {parts[j]}")
        assert number >= FEW or not wrong, wrong
    say(f"distances of {n_pairs} pairs of turned parts: {check.seen}, {len(wrong)} wrong, worst {check.worst}")
    assert len(wrong) <= n_pairs // MANY_TO_ONE_WRONG, "\n".join([f"{len(wrong)} of {n_pairs} wrong", *wrong[:5]])


SYMMETRIC = (
    Cylinder(0.5, 1.0),
    Cylinder(0.25, 2.0),
    Cone(0.5, 0.25, 1.0),
    Cone(0.0, 0.5, 1.0),
    Disc(0.5),
    Sphere(0.5),
    Capsule(0.25, 1.0),
    Box((1.0, 1.0, 1.0)),
    Convex(CUBE * 0.25, 0.25),
)
TURNS = [
    (0, 0, 0),
    (np.pi, 0, 0),
    (np.pi / 2, 0, 0),
    (0, np.pi / 2, 0),
    (np.pi / 4, 0, 0),
    (0, np.arctan(0.5), np.pi / 2),
]
WAYS = [(0, 0, 1), (1, 0, 0), (0, 1, 1), (0.5, 0, 1)]


@pytest.mark.parametrize("away", [0.5, 1e5])
def test_gaps_at_symmetric_poses(away):
    """Flat on flat, side on side and across, rim on edge, tip on rim, axes in line: in round numbers."""
    check, wrong = Check(), []
    features = {part: shapes_of([part]) for part in SYMMETRIC}
    for one, other, turn, way in product(SYMMETRIC, SYMMETRIC, TURNS, WAYS):
        if not (isinstance(one, Turned) or isinstance(other, Turned)):
            continue
        bodies = circles_of(one), circles_of(other)
        gap = away * TOUCH * max(body.size for body in bodies)
        pose = placed_at(*bodies, Pose((0, 0, 0), euler_zyx=turn).quaternion_wxyz, np.array(way), gap)
        told = check.pair((features[one], features[other]), bodies, pose, gap)
        if told:
            wrong.append(f"{told}: {one} at {pose}, {other}")
    assert not wrong, "\n".join([f"{len(wrong)} of {sum(check.seen.values())} wrong", *wrong[:5]])


HOLE_TOUCH, WIDE = 3e-9, 5.0


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


def told_of_hole(meetings: Meetings, away: float, touch_m: float) -> str:
    """Return what is wrong with what is told of a part this far from a plate with a hole."""
    found, rows = float(meetings.gaps.min()), meetings.rows[: meetings.used[0]]
    told = f"{found / touch_m:g} touch tolerances apart, not {away / touch_m:g}"
    if found > away + 1e-11 or (found < away - WITHIN * touch_m and (away <= touch_m or found < -WITHIN * touch_m)):
        return told
    if abs(away) <= 0.9 * touch_m and rows["is_hidden"].all():
        return f"nothing touches in sight; {told}"
    return ""


def test_gaps_in_and_over_holes(cases, say):
    rng, wrong, n_seen = np.random.default_rng(6), [], 0
    aways = np.array([0.0, 0.5, -0.5, 0.9, 3.0, 100.0, 1e5, 1e7, 3e7]) * HOLE_TOUCH
    n_cases = cases(25, 400)
    for _ in range(n_cases):
        cage, plate, radius = random_plate(rng)
        part = random_peg(rng, radius)
        tilt = np.array([1.0, *(rng.normal(size=3) * rng.choice([0.0, 0.02, 0.1, 0.3]))])
        turn = tilt if rng.random() < 0.8 else random_turn(rng)
        beside = rng.uniform(-0.3, 0.3, 2) * radius * rng.choice([0.0, 1.0])
        away = float(rng.choice(aways))
        pose = brought_to(part, Pose((*beside, rng.uniform(-0.5, 2.5)), turn), plate, away)
        if pose is None:
            continue
        n_seen += 1
        told = told_of_hole(
            placed(geometry_of(shapes_of([part]), shapes_of(cage), HOLE_TOUCH), pose).meetings, away, HOLE_TOUCH
        )
        if told:
            wrong.append(f"{told}: {part} at {pose}, {cage}")
    say(f"distances of {n_seen} parts in and over holes: {len(wrong)} wrong")
    assert n_seen > n_cases // 4
    assert not wrong, "\n".join([f"{len(wrong)} of {n_seen} wrong", *wrong[:5]])


LONE, BLIND = [Hole(0.5, 1.0)], [Box((8.0, 8.0, 2.0), Pose((0, 0, -1)), name="plate"), Hole(0.5, 1.0, in_=("plate",))]


@pytest.mark.parametrize("cage", [LONE, BLIND], ids=["open", "blind"])
@pytest.mark.parametrize(
    ("part", "position", "away"),
    [
        (Cylinder(0.75, 1.0), (0.0, 0.0, 0.5), 0.0),  # covers the hole
        (Cylinder(0.75, 1.0), (0.0, 0.0, 0.501), 1e-3),
        (Cylinder(0.45, 1.0), (0.06, 0.0, 0.5), 0.0),  # stands on the plate, a little over the hole
        (Cylinder(0.45, 1.0), (0.05, 0.0, 0.0), 0.0),  # along the wall
        (Cylinder(0.45, 1.0), (0.03, 0.04, 0.0), 0.0),
        (Cylinder(0.45, 1.0), (0.0, 0.0, 0.0), 0.05),  # in the middle
        (Cylinder(0.45, 1.0), (2.0, 0.0, 0.5), 0.0),  # beside the hole
        (Disc(0.75), (0.0, 0.0, 0.0), 0.0),
        (Box((2.0, 2.0, 1.0)), (0.0, 0.0, 0.5), 0.0),
        (Sphere(0.65), (0.0, 0.0, math.sqrt(0.65**2 - 0.25)), 0.0),  # on the mouth's rim
        (Sphere(0.45), (0.0, 0.05, -0.5), 0.0),
        (Sphere(0.5), (1.5, 0.0, 0.5), 0.0),
        (Capsule(0.45, 0.5), (0.05, 0.0, -0.25), 0.0),
        (Cone(0.25, 0.75, 1.0), (0.0, 0.0, 0.0), 0.0),  # all its side on the mouth's rim
    ],
)
def test_gaps_of_what_is_in_line_with_a_hole(cage, part, position, away):
    meetings = placed(geometry_of(shapes_of([part]), shapes_of(cage), HOLE_TOUCH), Pose(position)).meetings
    assert told_of_hole(meetings, away, HOLE_TOUCH) == ""
    plate = plate_of(cage[-1], cage is LONE, WIDE)
    if not isinstance(part, Disc):
        assert pierced_plate.gap(part, Pose(position), plate)[0] == pytest.approx(away, abs=1e-12)


@pytest.mark.parametrize("beyond", [-3.0, -1.0, 0.0, 1.0, 1.4, 1.6, 1.9, 2.1, 2.5, 3.0, 3.5, 4.0, 4.5])
def test_the_end_of_a_bar_and_the_edge_under_it_leave_no_place_out(beyond):
    """A bar lies on a box whose edge it ends at, so many touch tolerances beyond: it lies on two places."""
    bar = Cylinder(0.5, 3.0, Pose(euler_zyx=(0, np.pi / 2, 0)))
    box = Box((4.0, 4.0, 1.0), Pose((1.5 - beyond * TOUCH - 2.0, 0, -1.0)))
    meetings = placed(geometry_of(shapes_of([bar]), shapes_of([box]), TOUCH), Pose()).meetings
    ends = sorted(float(row["place"][0]) for row in meetings.rows[: meetings.used[0]])
    assert (min(ends), max(ends)) == pytest.approx((-1.5, 1.5), abs=10 * TOUCH)
