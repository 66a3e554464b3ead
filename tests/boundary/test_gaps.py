"""The gaps of what touches, against `convex_bodies` and `turned_bodies`, and in and over holes `pierced_plate`."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from boundary.asked import Asked
from boundary.drawn_plates import WIDE, random_peg, random_plate
from boundary.motions import TOUCH, random_offset
from cagepose import Box, Pose
from cagepose.kernels.boundary.touching import Meetings
from cagepose.model.hole import Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Shape, Sphere, Turned
from shapes import convex_bodies, pierced_plate, turned_bodies
from shapes.convex_bodies import CUBE, random_turn
from shapes.pierced_plate import brought_to, plate_of
from shapes.turned_bodies import Circles, circles_of, random_turned

RESOLUTION = 1e-12
"""Fraction of the size of the greater body, as in runs."""
WITHIN = 8.0
"""Touch tolerances: what touches may be told to be nearer by so much, at corners of slender parts."""
GAPS = np.array([0, 0, 0.5, -0.5, 0.9, -0.9, 1, -1, 3, 100, 1e4, 1e6, 1e8, 3e8])
"""In touch tolerances."""
HOLE_TOUCH = 3e-9


def told_of(found: Meetings, touch_m: float, away: float, farthest: float) -> str:
    """Return what is wrong with what touches of bodies this far apart; no gap is greater than ``farthest``,
    if anything touches.
    """
    gaps = found.rows[: found.used[0]]["gap"]
    if len(gaps) == 0:
        return "nothing touches" if abs(away) <= 0.9 * touch_m else ""
    told = f"{gaps.min() / touch_m:g} touch tolerances apart, not {away / touch_m:g}"
    return told if away > WITHIN * touch_m or not away - WITHIN * touch_m <= gaps.min() <= farthest else ""


def test_gaps_of_sharp_and_rounded_parts(cases, say):
    rng, wrong = np.random.default_rng(2), []
    n_pairs = cases(200, 20_000)
    for _ in range(n_pairs):
        parts = convex_bodies.random_part(rng), convex_bodies.random_part(rng)
        one, other = (convex_bodies.body_of(part) for part in parts)
        size = max(one.size, other.size)
        pose = convex_bodies.placed_at(
            one, other, random_turn(rng), random_offset(rng), float(rng.choice(GAPS)) * TOUCH * size
        )
        away = convex_bodies.gap(one.at(pose), other)
        told = told_of(
            Asked(parts[:1], parts[1:], TOUCH * size).place(pose), TOUCH * size, away, away + RESOLUTION * size
        )
        if told:
            wrong.append(f"{told}: {parts[0]} at {pose}, {parts[1]}")
    say(f"gaps of {n_pairs} pairs of sharp and rounded parts: {len(wrong)} wrong")
    assert not wrong, "\n".join([f"{len(wrong)} of {n_pairs} wrong", *wrong[:5]])


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


def asked_of(one: Shape, other: Shape) -> tuple[Asked, tuple[Circles, Circles], float]:
    """Return two parts, as both know them, and the touch tolerance."""
    bodies = circles_of(one), circles_of(other)
    touch_m = TOUCH * max(body.size for body in bodies)
    return Asked([one], [other], touch_m), bodies, touch_m


def told_of_turned(asked: Asked, bodies: tuple[Circles, Circles], pose: Pose, away: float) -> str:
    """Return what is wrong with what touches of two parts, the first at a pose with this gap."""
    one, other, size = bodies[0].at(pose), bodies[1], asked.touch_m / TOUCH
    found = asked.place(pose)
    least = max([away, *(separation_along(one, other, row["normal"]) for row in found.rows[: found.used[0]])])
    told = told_of(found, asked.touch_m, away, least + RESOLUTION * size)
    if told == "nothing touches" and tip_is_at_rim(one, other, asked.touch_m):
        return ""
    if not told:
        return ""
    return told_of(found, asked.touch_m, away, greatest_separation(one, other) + RESOLUTION * size)


def test_gaps_of_turned_parts(cases, say):
    rng, wrong = np.random.default_rng(5), []
    n_pairs = cases(200, 4000)
    for _ in range(n_pairs):
        parts = random_turned(rng), random_turned(rng)
        asked, bodies, touch_m = asked_of(*parts)
        away = float(rng.choice(GAPS)) * touch_m
        pose = turned_bodies.placed_at(*bodies, random_turn(rng), random_offset(rng), away)
        told = told_of_turned(asked, bodies, pose, away)
        if told:
            wrong.append(f"{told}: {parts[0]} at {pose}, {parts[1]}")
    say(f"gaps of {n_pairs} pairs of turned parts: {len(wrong)} wrong")
    assert not wrong, "\n".join([f"{len(wrong)} of {n_pairs} wrong", *wrong[:5]])


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
    wrong, n_poses = [], 0
    for one, other in product(SYMMETRIC, SYMMETRIC):
        if not (isinstance(one, Turned) or isinstance(other, Turned)):
            continue
        asked, bodies, touch_m = asked_of(one, other)
        for turn, way in product(TURNS, WAYS):
            turned = Pose(euler_zyx=turn).quaternion_wxyz
            pose = turned_bodies.placed_at(*bodies, turned, np.array(way), away * touch_m)
            told = told_of_turned(asked, bodies, pose, away * touch_m)
            n_poses += 1
            if told:
                wrong.append(f"{told}: {one} at {pose}, {other}")
    assert not wrong, "\n".join([f"{len(wrong)} of {n_poses} wrong", *wrong[:5]])


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
        told = told_of(Asked([part], cage, HOLE_TOUCH).place(pose), HOLE_TOUCH, away, away + 1e-11)
        if told:
            wrong.append(f"{told}: {part} at {pose}, {cage}")
    say(f"gaps of {n_seen} parts in and over holes: {len(wrong)} wrong")
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
    found = Asked([part], cage, HOLE_TOUCH).place(Pose(position))
    assert told_of(found, HOLE_TOUCH, away, away + 1e-11) == ""
    plate = plate_of(cage[-1], cage is LONE, WIDE)
    if not isinstance(part, Disc):
        assert pierced_plate.gap(part, Pose(position), plate)[0] == pytest.approx(away, abs=1e-12)


@pytest.mark.parametrize("beyond", [-3.0, -1.0, 0.0, 1.0, 1.4, 1.6, 1.9, 2.1, 2.5, 3.0, 3.5, 4.0, 4.5])
def test_the_end_of_a_bar_and_the_edge_under_it_leave_no_place_out(beyond):
    """A bar lies on a box whose edge it ends at, so many touch tolerances beyond: it lies on two places."""
    bar = Cylinder(0.5, 3.0, Pose(euler_zyx=(0, np.pi / 2, 0)))
    box = Box((4.0, 4.0, 1.0), Pose((1.5 - beyond * TOUCH - 2.0, 0, -1.0)))
    meetings = Asked([bar], [box], TOUCH).place(Pose())
    ends = sorted(float(row["place"][0]) for row in meetings.rows[: meetings.used[0]])
    assert (min(ends), max(ends)) == pytest.approx((-1.5, 1.5), abs=10 * TOUCH)
