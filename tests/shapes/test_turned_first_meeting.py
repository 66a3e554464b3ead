"""First contact of parts with round rims and sides along travels, turns and screws, against safe steps by the distances
of `turned_bodies`, and in holes of `pierced_plate`; and some that are known in closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from cagepose.kernels.collision.first_meeting import Hit, first_meeting
from scipy.optimize import brentq

from cagepose import Box, Pose
from cagepose.kernels.shapes.advancement import root_of_gap
from cagepose.kernels.shapes.along_motion import place_moved
from cagepose.kernels.shapes.features import EDGE, RIM, copied
from cagepose.kernels.shapes.meeting import meeting
from cagepose.kernels.shapes.motion import Motion
from cagepose.model.features import placed_shapes, shapes_of
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Cylinder, Disc, Shape, Sphere, Turned
from inner_kernels import as_machine_code
from shapes import pierced_plate
from shapes.convex_bodies import random_turn
from shapes.pierced_plate import plate_of
from shapes.test_distances import TOUCH, geometry_of, placed, random_offset
from shapes.test_first_meeting import TOLERANCE, after, leaves, motion_of, random_direction, random_motion
from shapes.test_turned_distances import WIDE, random_peg, random_plate
from shapes.turned_bodies import circles_of, gap, placed_at, random_turned

SHORTEST = 2e-3
"""Fraction of a motion. Sampling goes on by this where parts are near."""


@pytest.fixture(scope="module")
def first():
    return as_machine_code(first_meeting)


FEW = 80
"""None of these is wrong."""
KNOWN_WRONG = 0.01
"""Share of more: three of 300 random motions are early or late, or told so by an oracle that is loose where parts touch
at the start."""


def fastest(motion: Motion, middle: np.ndarray, reach: float) -> float:
    """A speed that no point of a ball exceeds."""
    spin = motion.rate * np.array(motion.axis)
    drift = np.array(motion.velocity) + np.cross(spin, middle - np.array(motion.center))
    return float(np.linalg.norm(drift) + motion.rate * reach)


def check(
    first,
    parts: list[Shape],
    cage: list[Shape],
    pose: Pose,
    motion: Motion,
    end: float,
    apart_at: Callable[[Pose], float],
    touch_m: float,
) -> tuple[Hit | None, str]:
    """Ask the first contact, and whether it is one, and none comes before; None: parts that touch do not all leave."""
    geometry = geometry_of(shapes_of(parts), shapes_of(cage), touch_m)
    placement = placed(geometry, pose)
    if placement.meetings.used[0] > 0 and not leaves(motion, placement.meetings):
        return None, ""
    hit = Hit(*first(geometry, placement, motion, end, 0.0, 0.0))
    body, until, amount = circles_of(parts[0]).at(pose), min(hit.amount, end), 0.0
    speed = fastest(motion, body.middle, body.reach)
    while True:
        apart = apart_at(after(motion, pose, amount))
        if apart < -TOLERANCE * touch_m:
            return hit, f"{-apart / touch_m:g} touch tolerances deep at {amount}, before {hit.amount}"
        if amount == until:
            break
        amount = min(until, amount + max(apart / speed, SHORTEST * end))
    if hit.amount <= end and apart > TOLERANCE * touch_m:
        return hit, f"{apart / touch_m:g} touch tolerances too early, at {hit.amount}"
    return hit, ""


def test_random_motions(first, cases, say):
    rng, wrong, seen = np.random.default_rng(7), [], {"met": 0, "not met": 0, "pressed": 0}
    n_cases = cases(30, 400)
    for number in range(n_cases):
        part, cage_part = random_turned(rng), random_turned(rng)
        if not (isinstance(part, Turned) or isinstance(cage_part, Turned)):
            continue
        body, other = circles_of(part), circles_of(cage_part)
        size = max(body.size, other.size)
        away = float(rng.choice([0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7, 0.0])) * size
        pose = placed_at(body, other, random_turn(rng), random_offset(rng), away)
        towards = other.middle - body.at(pose).middle
        motion, end = random_motion(rng, pose, towards, size), float(rng.choice([0.1, 1.0, 3.0]))
        normal = towards / max(float(np.linalg.norm(towards)), 1e-300)

        def apart_at(there: Pose, body=body, other=other) -> float:
            nonlocal normal
            apart, normal = gap(body.at(there), other, normal)
            return apart

        hit, told = check(first, [part], [cage_part], pose, motion, end, apart_at, TOUCH * size)
        seen["pressed" if hit is None else "met" if hit.amount <= end else "not met"] += 1
        if told:
            wrong.append(f"{told}: {part} at {pose}, {cage_part}, {motion} to {end}")
        assert number >= FEW or not wrong, wrong
    say(f"first contact of {n_cases} motions of turned parts: {seen}, {len(wrong)} wrong")
    assert len(wrong) <= n_cases * KNOWN_WRONG, "\n".join([f"{len(wrong)} of {n_cases} wrong", *wrong[:5]])


def test_random_motions_in_and_over_holes(first, cases, say):
    rng, wrong, seen = np.random.default_rng(8), [], {"met": 0, "not met": 0, "pressed": 0}
    n_cases = cases(16, 60)
    for _ in range(n_cases):
        cage, plate, radius = random_plate(rng)
        part = random_peg(rng, radius)
        turn = np.array([1.0, *(rng.normal(size=3) * rng.choice([0.0, 0.02, 0.1]))])
        beside = rng.uniform(-0.2, 0.2, 2) * radius * rng.choice([0.0, 1.0])
        pose = Pose((*beside, rng.uniform(-0.5, 2.5)), turn)
        if pierced_plate.gap(part, pose, plate)[0] < 1e-6:
            continue
        motion = random_motion(rng, pose, np.array((0.0, 0.0, -1.0)), 1.0)
        end = float(rng.choice([0.5, 2.0]))
        hit, told = check(
            first, [part], cage, pose, motion, end, lambda at, p=part, q=plate: pierced_plate.gap(p, at, q)[0], 3e-9
        )
        seen["pressed" if hit is None else "met" if hit.amount <= end else "not met"] += 1
        if told:
            wrong.append(f"{told}: {part} at {pose}, {cage}, {motion} to {end}")
    say(f"first contact of {sum(seen.values())} motions in and over holes: {seen}, {len(wrong)} wrong")
    assert not wrong, "\n".join([f"{len(wrong)} of {n_cases} wrong", *wrong[:5]])


def first_amount(first, part: Shape, cage: list[Shape], pose: Pose, motion: Motion, end: float) -> float:
    geometry = geometry_of(shapes_of([part]), shapes_of(cage), 3e-9)
    return Hit(*first(geometry, placed(geometry, pose), motion, end, 0.0, 0.0)).amount


def travel(*velocity: float) -> Motion:
    return motion_of(np.zeros(3), np.array(velocity, float), 0.0, np.zeros(3))


FLOOR = [Box((8.0, 8.0, 1.0), Pose((0, 0, -0.5)))]


def test_a_can_that_turns_about_its_axis_meets_a_ball_beside_its_rim(first):
    """Its rim turns about a place beside its middle, through the arcs of which it is made: in their plane the ball is a
    circle. Only the whole of the rim comes no nearer by turning.
    """
    rng, radius, ball, above = np.random.default_rng(73), 0.5, 0.25, 0.15
    can, meets = Cylinder(radius, 1.0), radius + math.sqrt(ball**2 - above**2)
    for _ in range(30):
        angle, away, beside = rng.uniform(0.0, 2.0 * np.pi), 10 ** rng.uniform(-3.0, -1.5), 10 ** rng.uniform(-2, -0.5)
        toward = np.array([math.cos(angle), math.sin(angle), 0.0])
        pivot, place = beside * np.array([-toward[1], toward[0], 0.0]), (meets + away) * toward

        def apart(turn: float, pivot=pivot, place=place) -> float:
            cosine, sine = math.cos(turn), math.sin(turn)
            middle = pivot - (cosine * pivot[0] - sine * pivot[1], sine * pivot[0] + cosine * pivot[1], 0.0)
            return float(np.linalg.norm(place - middle)) - meets

        motion = motion_of(pivot, np.zeros(3), 1.0, np.array((0.0, 0.0, 1.0)))
        turns = np.linspace(0.0, 1.0, 400)
        inside = [turn for turn in turns if apart(turn) < 0.0]
        expected = brentq(apart, inside[0] - turns[1], inside[0], xtol=1e-14) if inside else math.inf
        there = Sphere(ball, Pose((*place[:2], 0.5 + above)))
        assert first_amount(first, can, [there], Pose(), motion, 1.0) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-3, 0.3, np.pi / 4, np.pi / 2 - 1e-3, np.pi / 2])
def test_a_cylinder_and_a_disc_fall_on_a_floor(first, tilt):
    pose, radius, half = Pose((0.1, 0.2, 3.0), euler_zyx=(0.4, tilt, 0.0)), 0.5, 1.0
    lowest = radius * math.sin(tilt)
    lands = first_amount(first, Cylinder(radius, 2.0 * half), FLOOR, pose, travel(0, 0, -1), 10.0)
    assert lands == pytest.approx(3.0 - lowest - half * math.cos(tilt), abs=1e-8)
    assert first_amount(first, Disc(radius), FLOOR, pose, travel(0, 0, -1), 10.0) == pytest.approx(
        3.0 - lowest, abs=1e-8
    )


@pytest.mark.parametrize("radius", [0.4, 0.49, 0.499999])
@pytest.mark.parametrize("cage", [[Hole(0.5, 1.0)], [FLOOR[0].renamed("plate"), Hole(0.5, 0.5, in_=("plate",))]])
def test_a_peg_goes_into_a_hole_and_turns_until_it_touches(first, cage, radius):
    """Straight, beside its middle, and turning about the mouth's middle and beside it."""
    peg, plate, depth = Cylinder(radius, 2.0), plate_of(cage[-1], len(cage) == 1, WIDE), 0.25
    assert first_amount(first, peg, cage, Pose((0, 0, 1.5)), travel(0, 0, -1), 0.8) == math.inf
    pose = Pose((0, 0, 1.0 - depth))
    aside = first_amount(first, peg, cage, pose, travel(0.6, 0.8, 0), 1.0)
    assert aside == pytest.approx(0.5 - radius, abs=1e-9)
    for x in (0.0, 0.1):
        motion = motion_of(np.array((x, 0.0, 0.0)), np.zeros(3), 1.0, np.array((0.0, 1.0, 0.0)))
        hit, told = check(first, [peg], cage, pose, motion, 1.0, lambda at: pierced_plate.gap(peg, at, plate)[0], 3e-9)
        assert not told
        assert hit.amount < 1.0


def test_a_rim_that_grazes_a_wall(first):
    """The rim's farthest point is as far from the middle of the turn as the wall: it touches there or passes."""
    cage, peg, pose = [Hole(0.5, 1.0)], Cylinder(0.4, 2.0), Pose((0, 0, 0.7))
    motion = motion_of(np.zeros(3), np.zeros(3), 1.0, np.array((0.0, 1.0, 0.0)))
    plate = plate_of(cage[0], True, WIDE)
    _, told = check(first, [peg], cage, pose, motion, 1.0, lambda at: pierced_plate.gap(peg, at, plate)[0], 3e-9)
    assert not told


def test_a_ball_falls_on_the_rim_of_a_hole_and_a_bar_into_its_chamfer(first):
    cage = [Hole(0.5, 2.0, Chamfer(0.1, math.pi / 4))]
    lands = first_amount(first, Sphere(0.9), cage, Pose((0, 0, 3.0)), travel(0, 0, -1), 5.0)
    on_cone = 0.9 * math.sqrt(2.0) - 0.6  # centre over the rim, if it touched the cone
    touches_at = 0.9 / math.sqrt(2.0)
    on_rim = math.sqrt(0.9**2 - 0.6**2)
    height = on_cone if 0.5 <= touches_at <= 0.6 else on_rim
    assert lands == pytest.approx(3.0 - height, abs=1e-8)
    in_cone = first_amount(first, Capsule(0.55 * math.sqrt(2.0), 1.0), cage, Pose((0, 0, 4.0)), travel(0, 0, -1), 5.0)
    assert in_cone == pytest.approx(3.5 - (2.0 * 0.55 - 0.6), abs=1e-8)


def test_a_tapered_pin_enters_a_hole_aside(first):
    """At depth (R - e - r) / tan b its side touches the sharp rim: the flat tip of radius r, so far aside e."""
    tip, beside, taper = 0.3, 0.1, 0.25
    pin = Cone(tip, tip + 2.0 * taper, 2.0)
    lands = first_amount(first, pin, [Hole(0.5, 1.0)], Pose((beside, 0, 2.0)), travel(0, 0, -1), 3.0)
    assert 1.0 - lands == pytest.approx(-(0.5 - beside - tip) / taper, abs=1e-8)


def test_newtons_method_ends_at_a_root_but_for_rounding(cases):
    """From within the touch tolerance of where a rim crosses an edge, though the last step leaves no less than that
    before it."""
    rng, found = np.random.default_rng(5), 0
    cage = shapes_of([Box((1.2, 3.0, 0.4), Pose((-0.9, 0, -0.8)))])
    peg = shapes_of([Cylinder(0.25, 1.0)])
    arcs = [at for at, row in enumerate(peg.features) if row["kind"] == RIM and not row["is_second"]]
    edges = [at for at, row in enumerate(cage.features) if row["kind"] == EDGE]
    while found < cases(8, 150):
        pose = Pose(rng.uniform(-1.0, 1.0, 3), random_turn(rng))
        held, i, j = placed_shapes(peg, pose), rng.choice(arcs), rng.choice(edges)
        met, moved = meeting(held, i, cage, j), copied(held)
        if not met.is_one or not 0.01 < met.gap < 0.5:
            continue
        drift = np.array(met.normal) + 0.3 * rng.normal(size=3)
        motion = motion_of(np.array(met.place), drift, 0.2, random_direction(rng))

        def gap_after(amount: float, i=i, j=j, held=held, moved=moved, motion=motion) -> float:
            place_moved(held, i, motion, amount, moved)
            return meeting(moved, i, cage, j).gap

        if not gap_after(2.0 * met.gap) < 0.0:
            continue
        crosses = brentq(gap_after, 0.0, 2.0 * met.gap, xtol=1e-15)
        if not abs(gap_after(crosses)) < 1e-14:  # the foot jumps there
            continue
        root = root_of_gap(held, i, cage, j, motion, crosses - 5e-10, 0.0, 3e-9, moved)
        assert root == pytest.approx(crosses, abs=1e-12)
        found += 1
