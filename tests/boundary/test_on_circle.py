"""Circles that touch all around: what is told of them, and how the gap bends at one place of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.boundary.bend import Bend, curvatures, write_bend
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.on_circle import OnCircle, write_on_circle
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Cylinder, Disc, Sphere

TOUCH_M = 1e-9
TURN = Pose((0.3, -0.2, 0.7), (0.9, 0.3, -0.4, 0.2))
CENTER = (0.1, 0.2, -0.3)
RADIUS = 0.7
CHAMFERED = Hole(0.5, 2.0, Chamfer(0.3, math.pi / 4), pose_body_shape=TURN)
SHARP = Hole(0.5, 2.0, pose_body_shape=TURN)


def around(held, cage, pose):
    """Return what is asked, and rows with what is told of their circles."""
    asked = Asked([held], [cage], TOUCH_M)
    found = asked.place(TURN @ pose)
    told = []
    for row in found.rows[: found.used[0]]:
        circle = empty_record(OnCircle)
        write_on_circle(asked.held, row.feature, asked.cage, row.cage_feature, row, CENTER, circle)
        told.append((row, circle))
    return asked, told


ON_FLOOR = Cylinder(RADIUS, 2.0), Box((4.0, 4.0, 1.0), TURN @ Pose((0, 0, -0.5))), Pose((0, 0, 1.0))
OVER_MOUTH = Box((3.0, 3.0, 1.0)), SHARP, Pose((0, 0, 0.5))
IN_CHAMFER = Sphere(0.9), CHAMFERED, Pose((0, 0, 0.9 * math.sqrt(2.0) - 0.8))
ON_MOUTH = Sphere(0.9), SHARP, Pose((0, 0, math.sqrt(0.81 - 0.25)))
RIM_IN_CHAMFER = Disc(RADIUS), CHAMFERED, Pose((0, 0, -0.1))
CASES = {  # radius, whether it is the cage's, height of the ball's centre; None: it lies on a face
    "on a floor": (ON_FLOOR, RADIUS, False, None),
    "over a mouth": (OVER_MOUTH, 0.5, True, None),
    "ball in a chamfer": (IN_CHAMFER, 0.9 * math.sqrt(0.5), True, 0.9 * math.sqrt(2.0) - 0.8),
    "ball on a mouth": (ON_MOUTH, 0.5, True, math.sqrt(0.81 - 0.25)),
    "rim in a chamfer": (RIM_IN_CHAMFER, RADIUS, False, -0.1 + RADIUS),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_told_of_a_circle_that_touches_all_around(name):
    scene, radius, is_of_cage, height = CASES[name]
    _, told = around(*scene)
    told = [(row, circle) for row, circle in told if circle.length > 0.0]
    assert len(told) == 8
    up, middles = TURN.rotation[:, 2], []
    for row, circle in told:
        assert circle.length == pytest.approx(radius, abs=1e-12)
        assert bool(circle.is_of_cage) == is_of_cage
        assert bool(circle.is_on_ball) == (height is not None)
        assert abs(circle.axis @ up) == pytest.approx(1.0)
        assert circle.before == circle.after == math.pi / 4
        middles.append(row.place - radius * circle.outward)
        if height is not None:
            np.testing.assert_allclose(circle.ball + CENTER, TURN.transform((0, 0, height)), atol=1e-9)
    np.testing.assert_allclose(middles, [middles[0]] * 8, atol=1e-9)
    assert np.linalg.norm(np.cross(middles[0] - TURN.transform((0, 0, 0)), up)) < 1e-9


@pytest.mark.parametrize("name", ["rim in a chamfer", "ball in a chamfer", "on a floor"])
def test_a_place_that_touches_all_around_bends_as_one_of_its_own(name):
    """A place of a rim is one of the object's, and a ball meets the wall's line through the place, as a plane."""
    asked, told = around(*CASES[name][0])
    rng = np.random.default_rng(5)
    for row, _ in told:
        travel, spin = rng.normal(size=3), rng.normal(size=3)
        normal, place = row.normal.copy(), row.place.copy()

        def gap(step, normal=normal, place=place, travel=travel, spin=spin):
            """Of a turn about the centre and a travel; the wall's tip is where its radius is none."""
            at = place - 0.9 * normal if name == "ball in a chamfer" else place
            size = step * np.linalg.norm(spin)
            turn = Pose((0, 0, 0), (math.cos(size / 2), *(math.sin(size / 2) * spin / np.linalg.norm(spin)))).rotation
            seen = CENTER + turn @ (at - CENTER) + step * travel
            if name == "on a floor":
                return normal @ (place - seen)
            if name == "ball in a chamfer":
                return normal @ (place - seen) - 0.9
            own = TURN.rotation.T @ (seen - TURN.transform((0, 0, 0)))
            return (0.8 + own[2] - math.hypot(own[0], own[1])) * math.sqrt(0.5)

        step = 1e-4
        curve = (gap(step) - 2.0 * gap(0.0) + gap(-step)) / step**2
        met = Meeting(True, row.gap, tuple(normal), tuple(place))
        found = curvatures(asked.held, row.feature, asked.cage, row.cage_feature, met, True)
        bend, arm = empty_record(Bend), place - CENTER
        axes = tuple(map(tuple, np.eye(3).tolist()))
        write_bend(found, met.normal, tuple(arm.tolist()), axes, (1.0, 1.0, 1.0), bend)
        y, velocity = np.concatenate([travel, spin]), travel + np.cross(spin, arm)
        face_over_point = -normal @ np.cross(spin, np.cross(spin, arm)) + 2.0 * velocity @ np.cross(normal, spin)
        assert curve == pytest.approx(face_over_point + y @ bend.sliding @ y, abs=1e-6)
