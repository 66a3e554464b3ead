"""Rods with rounded rims, plates with rounded mouths, and rings: circles with a tube around them, beside oracles.

A rod whose rims are rounded by r is all that is no farther than r from a shorter and thinner rod, and a mouth is so
beside a wider one: what is between two of them is known from `turned_bodies`, which has no tubes.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from boundary.asked import Asked
from boundary.lathe import ring, rounded_hole, rounded_rod, turned
from boundary.motions import TOLERANCE, TOUCH, random_motion, random_offset
from boundary.prisms import Corner
from boundary.test_first_to_meet import Tally, check
from boundary.test_gaps import GAPS, RESOLUTION, told_of
from cagepose import Box, Cage, Cylinder, Facets, Load, Object, Pose, Scene, Sphere, run
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE
from cagepose.kernels.boundary.within import depth_in
from cagepose.model.boundary.features import boundary_of
from cagepose.model.checks import FloatArray
from cagepose.model.shape_moments import shape_moments
from cagepose.studies.gaps import GapFinder
from inner_kernels import as_machine_code
from shapes import turned_bodies
from shapes.convex_bodies import random_turn
from shapes.turned_bodies import Circles, circles_of, placed_at, random_turned

Rng = np.random.Generator
WEIGHT = [Load("weight", gravity=(0.0, 0.0, -9.81))]


def drawn_rod(rng: Rng) -> tuple[Facets, Circles]:
    """Return a rod or a disc with rounded rims, and what the oracle has of it."""
    radius, length = rng.uniform(0.2, 0.6), rng.uniform(0.2, 2.0)
    rim = float(rng.choice([0.05, 0.5, 0.95, 0.999])) * min(radius, 0.5 * length)
    core = circles_of(Cylinder(radius - rim, length - 2.0 * rim))
    return rounded_rod(radius, length, rim), Circles(core.centers, core.axes, core.radii, rim)


def drawn_other(rng: Rng) -> tuple[object, Circles]:
    if rng.random() < 0.5:
        return drawn_rod(rng)
    part = random_turned(rng)
    return part, circles_of(part)


def test_features_and_moments_of_a_rod_are_those_of_its_surfaces():
    """Two tubes, a side and two ends; volume by Steiner's formula for what is near a convex body."""
    radius, length, rim = 2.0, 30.0, 1.5
    rod = rounded_rod(radius, length, rim)
    found = boundary_of([rod], 1e-9).features
    assert sorted(found["kind"].tolist()) == [LINE, FACE, FACE, CIRCLE, CIRCLE]
    tubes = found[found["kind"] == CIRCLE]
    assert tubes["radius"] == pytest.approx([rim] * 2, abs=1e-14)
    assert tubes["length"] == pytest.approx([radius - rim] * 2, abs=1e-14)
    assert tubes["high"] - tubes["low"] == pytest.approx([0.5 * math.pi] * 2, abs=1e-14)
    core, height = radius - rim, length - 2.0 * rim
    area, bent = 2.0 * math.pi * core * (core + height), math.pi * height + math.pi**2 * core
    volume = math.pi * core**2 * height + area * rim + bent * rim**2 + 4.0 / 3.0 * math.pi * rim**3
    assert shape_moments(rod).volume_m3 == pytest.approx(volume, rel=1e-9)
    assert shape_moments(ring(5.0, 1.0)).volume_m3 == pytest.approx(2.0 * math.pi**2 * 5.0, rel=1e-9)


def test_gaps_of_what_touches(cases, say):
    rng, wrong = np.random.default_rng(41), []
    n_pairs = cases(30, 400)
    for _ in range(n_pairs):
        (part, one), (cage_part, other) = drawn_rod(rng), drawn_other(rng)
        if rng.random() < 0.3:
            part, one, cage_part, other = cage_part, other, part, one
        size = max(one.size, other.size)
        away = float(rng.choice(GAPS)) * TOUCH * size
        pose = placed_at(one, other, random_turn(rng), random_offset(rng), away)
        asked = Asked([part], [cage_part], TOUCH * size)
        away = turned_bodies.gap(one.at(pose), other)[0]
        if told := told_of(asked.place(pose), TOUCH * size, away, away + RESOLUTION * size):
            wrong.append(f"{told}: {part} at {pose}, {cage_part}")
    say(f"gaps of {n_pairs} pairs with rounded rims: {len(wrong)} wrong")
    assert not wrong, "\n".join([f"{len(wrong)} of {n_pairs} wrong", *wrong[:5]])


def test_first_contacts_of_rounded_rims(cases, say):
    rng, tally = np.random.default_rng(42), Tally()
    for _ in range(cases(20, 400)):
        (part, body), (cage_part, other) = drawn_rod(rng), drawn_other(rng)
        size = max(body.size, other.size)
        away = float(rng.choice([0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7])) * size
        pose = placed_at(body, other, random_turn(rng), random_offset(rng), away)
        towards = other.middle - body.at(pose).middle
        motion, end = random_motion(rng, pose, towards, size), float(rng.choice([0.1, 1.0, 3.0]))
        normal = towards / max(float(np.linalg.norm(towards)), 1e-300)

        def apart_at(
            there: Pose, is_rough: bool = False, body=body, other=other, least=-TOLERANCE * TOUCH * size
        ) -> float:
            nonlocal normal
            apart, normal = turned_bodies.gap(body.at(there), other, normal, is_rough=is_rough)
            return max(apart, least) if math.isinf(apart) else apart

        found = check(
            Asked([part], [cage_part], TOUCH * size), pose, motion, end, apart_at, partial(apart_at, is_rough=True)
        )
        tally.note(found[0], end, found[1], (part, pose, cage_part, motion, end))
    tally.conclude("rounded rims", say)


def narrowest(finder: GapFinder, pose: Pose) -> float:
    found = finder._rows(pose, 4.0 * finder._scene.size_m, narrowest=True)
    return math.nan if found is None or not len(found.gaps_m) else float(found.gaps_m[0])


def least_along(of_angles, n: int = 4001) -> float:
    """Return the least value of a function around a circle, by finer and finer samples about the best."""
    angles = np.linspace(0.0, 2.0 * math.pi, n)
    at, width = float(angles[of_angles(angles).argmin()]), float(angles[1])
    for _ in range(25):
        angles = np.linspace(at - width, at + width, 41)
        at, width = float(angles[of_angles(angles).argmin()]), width / 5.0
    return float(of_angles(np.array([at]))[0])


def height_over_rod(places: FloatArray, radius: float, length: float, rim: float) -> FloatArray:
    off = np.stack([np.hypot(places[:, 0], places[:, 1]) - radius + rim, np.abs(places[:, 2]) - 0.5 * length + rim])
    found: FloatArray = np.linalg.norm(np.maximum(off, 0.0), axis=0) + np.minimum(off.max(axis=0), 0.0) - rim
    return found


def height_of_circle(angles: FloatArray, pose: Pose, level: float, sizes: tuple[float, ...]) -> FloatArray:
    """Return how far places of the circle in a tube are above a rod at a pose, less the radius of the tube."""
    radius, length, rim, core, tube = sizes
    places = np.stack([core * np.cos(angles), core * np.sin(angles), 0.0 * angles + level], axis=1)
    return height_over_rod(pose.inverse_transform(places), radius, length, rim) - tube


def test_a_rod_and_the_mouth_of_a_hole_or_a_ring_have_the_gap_that_samples_have(cases):
    """The circle in a tube is as far from the shorter rod as both rounding radii and the gap together."""
    rng, n_seen = np.random.default_rng(43), {"plate": 0, "ring": 0}
    for _ in range(cases(8, 60)):
        radius = rng.uniform(1.0, 3.0)
        length, hole = rng.uniform(2.0, 10.0) * radius, rng.uniform(1.1, 3.0) * radius
        rim, tube = rng.uniform(0.05, 0.95) * radius, rng.uniform(0.1, 1.0) * radius
        rod, core = rounded_rod(radius, length, rim), hole + tube
        for other in (ring(core, tube, "ring"), rounded_hole(hole, tube, 20.0 * hole, 20.0 * hole, "plate")):
            start = Object(shapes=[rod], pose=Pose((0.0, 0.0, 20.0 * length)))
            finder = GapFinder(Scene(start, Cage(shapes=[other]), WEIGHT))
            for _ in range(6):
                turn = (rng.uniform(-3.0, 3.0), rng.uniform(-0.5, 0.5), rng.uniform(-3.0, 3.0))
                pose = Pose(
                    (*(0.5 * hole * rng.uniform(-1.0, 1.0, 2)), rng.uniform(-0.2, 0.6) * length), euler_zyx=turn
                )
                level = -tube if other.name == "plate" else 0.0

                sizes = (radius, length, rim, core, tube)
                expected = least_along(partial(height_of_circle, pose=pose, level=level, sizes=sizes))
                if other.name == "plate":  # or its top is, where the rod is lowest beside the mouth; below is its wall
                    axis, turned = pose.rotation[:, 2], pose.rotation[2, 2]
                    across = math.copysign(1.0, turned) * np.array((axis[0], axis[1], 0.0)) / math.hypot(*axis[:2])
                    down = -math.copysign(1.0, turned) * (0.5 * length - rim) * axis
                    down += (radius - rim) * (abs(turned) * across - np.array((0.0, 0.0, math.hypot(*axis[:2]))))
                    lowest = pose.position_m + down
                    expected = 0.0 if lowest[2] - rim < 0.0 else expected
                    if math.hypot(*lowest[:2]) > core:
                        expected = min(expected, float(lowest[2]) - rim)
                if expected > 1e-6 * length:
                    assert narrowest(finder, pose) == pytest.approx(expected, abs=1e-12 * length)
                    n_seen[other.name] += 1
    assert min(n_seen.values()) > 5


def height_over_plate(places: FloatArray, hole: float, rim: float, wide: float, thick: float) -> FloatArray:
    rho, z = np.hypot(places[:, 0], places[:, 1]), places[:, 2]
    off = np.stack([hole + rim - rho, z + rim])
    mouth = np.linalg.norm(np.maximum(off, 0.0), axis=0) + np.minimum(off.max(axis=0), 0.0) - rim
    found: FloatArray = np.maximum.reduce([mouth, rho - wide, -thick - z])
    return found


def height_over_ring(places: FloatArray, core: float, tube: float) -> FloatArray:
    found: FloatArray = np.hypot(np.hypot(places[:, 0], places[:, 1]) - core, places[:, 2]) - tube
    return found


def test_places_are_within_or_not(cases):
    """A rod whose rim may be wider than its end, a plate with a rounded mouth, and a ring; depths are lower bounds."""
    rng, asked, waiting = np.random.default_rng(44), as_machine_code(depth_in), np.zeros(256, np.int64)
    seen = {False: 0, True: 0}
    for _ in range(cases(6, 60)):
        radius, rim = rng.uniform(1.0, 3.0), rng.uniform(0.1, 1.5)
        length = rng.uniform(1.0, 8.0) * radius
        edge = rng.uniform(0.02, 0.999) * min(radius, 0.5 * length)
        wide, thick = 3.0 * radius + rim, radius + rim
        bodies = [
            (rounded_rod(radius, length, edge), partial(height_over_rod, radius=radius, length=length, rim=edge)),
            (
                rounded_hole(radius, rim, wide, thick),
                partial(height_over_plate, hole=radius, rim=rim, wide=wide, thick=thick),
            ),
            (ring(radius + rim, rim), partial(height_over_ring, core=radius + rim, tube=rim)),
        ]
        for part, height in bodies:
            own = boundary_of([part], 1e-9)
            low, high = part.vertices_m.min(axis=0), part.vertices_m.max(axis=0)
            for place in rng.uniform(low - 0.1, high + 0.1, (100, 3)):
                above, depth = float(height(place[None])[0]), asked(own, tuple(place), 1e-9, waiting)[0]
                if abs(above) > 2e-9:
                    assert (depth > 0.0) == (above < 0.0), (part, place)
                    assert depth <= max(0.0, -above) + 1e-12
                    seen[depth > 0.0] += 1
    assert min(seen.values()) > 100


def test_a_ball_lies_in_a_rounded_mouth():
    """Its middle is R + r from the circle in the mouth's tube, over the hole's axis."""
    hole, rim, radius = 3.0e-3, 1.0e-3, 4.0e-3
    plate = rounded_hole(hole, rim, 20e-3, 10e-3)
    for friction in (0.0, 0.3):
        start = Pose((0.3e-3, -0.2e-3, 10e-3))
        ball = Object(shapes=[Sphere(radius)], pose=start)
        found = run(Scene(ball, Cage(shapes=[plate]), WEIGHT, friction_coefficient=friction))
        assert found.verdict == "rests"
        height = math.sqrt((radius + rim) ** 2 - (hole + rim) ** 2) - rim
        assert found.pose.position_m == pytest.approx([0.0, 0.0, height], abs=1e-11)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_rod_with_its_weight_low_and_aside_leans_on_its_rounded_rim(friction):
    """Until its centre of gravity is above where it touches: over the middle of the rounding."""
    radius, length, rim = 2e-3, 8e-3, 1.5e-3
    aside, below = 0.8e-3, 0.7e-3  # from the axis, and from the plane of the rounding's circle
    center = (aside, 0.0, rim - 0.5 * length - below)
    rod = Object(shapes=[rounded_rod(radius, length, rim)], center_of_gravity_m=center, pose=Pose((0, 0, 6e-3)))
    floor = Box((0.1, 0.1, 0.01), Pose((0, 0, -0.005)), "floor")
    found = run(Scene(rod, Cage(shapes=[floor]), WEIGHT, friction_coefficient=friction))
    assert found.verdict == "rests"
    core = radius - rim
    lean = math.atan2(aside - core, below)
    height = rim + core * math.sin(lean) + (0.5 * length - rim) * math.cos(lean)
    assert found.pose.position_m[2] == pytest.approx(height, abs=1e-11)
    assert math.acos(found.pose.rotation[2, 2]) == pytest.approx(lean, abs=1e-8)


def plate_with_two_mouths(hole: float, rim: float, wide: float, thick: float) -> Facets:
    core, half = hole + rim, 0.5 * thick
    corners = [
        Corner((core, -half)),
        Corner((wide, -half)),
        Corner((wide, half)),
        Corner((core, half), (core, half - rim)),
    ]
    corners += [Corner((hole, half - rim)), Corner((hole, rim - half), (core, rim - half))]
    return turned(corners, "plate")


def test_a_rod_tilts_in_a_hole_with_rounded_mouths():
    """It is between two circles: 2 (R + r) cos t - (h - 2 r) sin t = 2 (a + r), whatever rounds its own ends."""
    hole, rim, thick, radius, length = 3.2e-3, 0.6e-3, 8e-3, 3e-3, 30e-3

    def room(tilt: float) -> float:
        return (hole + rim) * math.cos(tilt) - (0.5 * thick - rim) * math.sin(tilt) - radius - rim

    plate, rod = plate_with_two_mouths(hole, rim, 20e-3, thick), rounded_rod(radius, length, 1e-3)
    start = Object(shapes=[rod], pose=Pose((0.0, 0.0, 0.05)))
    finder = GapFinder(Scene(start, Cage(shapes=[plate]), WEIGHT))
    most = brentq(room, 0.0, 0.5, xtol=1e-15)
    for share in (0.2, 0.7, 0.99):
        turn = Pose(euler_zyx=(0.4, share * most, 0.0))
        pose = turn @ Pose((0.0, 0.0, 0.001))
        assert narrowest(finder, pose) == pytest.approx(room(share * most), abs=1e-13)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("share", [0.05, 0.25, 0.75, 0.99])
def test_a_rod_with_rounded_rims_lies_on_a_floor_and_in_a_groove(share, friction, cases):
    """With its axis at its radius above the floor, and without friction at sqrt(2) radii above the groove's bottom."""
    radius, length, rng = 2e-3, 12e-3, np.random.default_rng(45)
    rod = rounded_rod(radius, length, share * radius)
    floor = [Box((0.4, 0.4, 0.1), Pose((0, 0, -0.05)), "floor")]
    sides = [
        Box((0.4, 0.4, 0.1), Pose((0, 0, 0), euler_zyx=(0, 0, -way * math.pi / 4)) @ Pose((0, -way * 0.2, -0.05)), name)
        for way, name in ((1.0, "left"), (-1.0, "right"))
    ]
    for _ in range(cases(4, 60)):
        start = Object(shapes=[rod], pose=Pose((0, 0, 0.03), rng.standard_normal(4)))
        found = run(Scene(start, Cage(shapes=floor), WEIGHT, friction_coefficient=friction))
        assert found.verdict == "rests"
        lies = abs(found.pose.rotation[2, 2]) < 1e-9
        assert found.pose.position_m[2] == pytest.approx(radius if lies else 0.5 * length, abs=1e-11)
        found = run(Scene(start, Cage(shapes=sides), WEIGHT, friction_coefficient=friction))
        assert found.verdict in (("rests",) if friction == 0.0 else ("rests", "may rest"))
        if friction == 0.0:
            assert found.pose.position_m[1:] == pytest.approx([0.0, math.sqrt(2.0) * radius], abs=1e-11)
