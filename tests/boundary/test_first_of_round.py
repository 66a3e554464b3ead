"""First contact of parts with round rims and sides that is known in closed form, and in holes of `pierced_plate`."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from boundary.asked import Asked
from boundary.drawn_plates import WIDE
from boundary.motions import motion_of
from boundary.test_first_to_meet import check
from cagepose import Box, Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Cylinder, Disc, Shape, Sphere
from shapes import pierced_plate
from shapes.pierced_plate import plate_of

FLOOR = [Box((8.0, 8.0, 1.0), Pose((0, 0, -0.5)))]


def first_amount(part: Shape, cage: list[Shape], pose: Pose, motion: Motion, end: float) -> float:
    asked = Asked([part], cage, 3e-9)
    asked.place(pose)
    return asked.first(motion, end).amount


def travel(*velocity: float) -> Motion:
    return motion_of(np.zeros(3), np.array(velocity, float), 0.0, np.zeros(3))


def test_a_can_that_turns_about_its_axis_meets_a_ball_beside_its_rim():
    """Its rim turns about a place beside its middle, in whose plane the ball is a
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
        assert first_amount(can, [there], Pose(), motion, 1.0) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-3, 0.3, np.pi / 4, np.pi / 2 - 1e-3, np.pi / 2])
def test_a_cylinder_and_a_disc_fall_on_a_floor(tilt):
    pose, radius, half = Pose((0.1, 0.2, 3.0), euler_zyx=(0.4, tilt, 0.0)), 0.5, 1.0
    lowest = radius * math.sin(tilt)
    lands = first_amount(Cylinder(radius, 2.0 * half), FLOOR, pose, travel(0, 0, -1), 10.0)
    assert lands == pytest.approx(3.0 - lowest - half * math.cos(tilt), abs=1e-8)
    assert first_amount(Disc(radius), FLOOR, pose, travel(0, 0, -1), 10.0) == pytest.approx(3.0 - lowest, abs=1e-8)


@pytest.mark.parametrize("radius", [0.4, 0.49, 0.499999])
@pytest.mark.parametrize("cage", [[Hole(0.5, 1.0)], [FLOOR[0].renamed("plate"), Hole(0.5, 0.5, in_=("plate",))]])
def test_a_peg_goes_into_a_hole_and_turns_until_it_touches(cage, radius):
    """Straight, beside its middle, and turning about the mouth's middle and beside it."""
    peg, plate, depth = Cylinder(radius, 2.0), plate_of(cage[-1], len(cage) == 1, WIDE), 0.25
    assert first_amount(peg, cage, Pose((0, 0, 1.5)), travel(0, 0, -1), 0.8) == math.inf
    pose = Pose((0, 0, 1.0 - depth))
    aside = first_amount(peg, cage, pose, travel(0.6, 0.8, 0), 1.0)
    assert aside == pytest.approx(0.5 - radius, abs=1e-9)
    for x in (0.0, 0.1):
        motion = motion_of(np.array((x, 0.0, 0.0)), np.zeros(3), 1.0, np.array((0.0, 1.0, 0.0)))
        hit, told = check(Asked([peg], cage, 3e-9), pose, motion, 1.0, lambda at: pierced_plate.gap(peg, at, plate)[0])
        assert not told
        assert hit.amount < 1.0


def test_a_rim_that_grazes_a_wall():
    """The rim's farthest point is as far from the middle of the turn as the wall: it touches there or passes."""
    cage, peg, pose = [Hole(0.5, 1.0)], Cylinder(0.4, 2.0), Pose((0, 0, 0.7))
    motion = motion_of(np.zeros(3), np.zeros(3), 1.0, np.array((0.0, 1.0, 0.0)))
    plate = plate_of(cage[0], True, WIDE)
    _, told = check(Asked([peg], cage, 3e-9), pose, motion, 1.0, lambda at: pierced_plate.gap(peg, at, plate)[0])
    assert not told


def test_a_ball_falls_on_the_rim_of_a_hole_and_a_bar_into_its_chamfer():
    cage = [Hole(0.5, 2.0, Chamfer(0.1, math.pi / 4))]
    lands = first_amount(Sphere(0.9), cage, Pose((0, 0, 3.0)), travel(0, 0, -1), 5.0)
    on_cone = 0.9 * math.sqrt(2.0) - 0.6  # centre over the rim, if it touched the cone
    touches_at = 0.9 / math.sqrt(2.0)
    on_rim = math.sqrt(0.9**2 - 0.6**2)
    height = on_cone if 0.5 <= touches_at <= 0.6 else on_rim
    assert lands == pytest.approx(3.0 - height, abs=1e-8)
    in_cone = first_amount(Capsule(0.55 * math.sqrt(2.0), 1.0), cage, Pose((0, 0, 4.0)), travel(0, 0, -1), 5.0)
    assert in_cone == pytest.approx(3.5 - (2.0 * 0.55 - 0.6), abs=1e-8)


def test_a_tapered_pin_enters_a_hole_aside():
    """At depth (R - e - r) / tan b its side touches the sharp rim: the flat tip of radius r, so far aside e."""
    tip, beside, taper = 0.3, 0.1, 0.25
    pin = Cone(tip, tip + 2.0 * taper, 2.0)
    lands = first_amount(pin, [Hole(0.5, 1.0)], Pose((beside, 0, 2.0)), travel(0, 0, -1), 3.0)
    assert 1.0 - lands == pytest.approx(-(0.5 - beside - tip) / taper, abs=1e-8)
