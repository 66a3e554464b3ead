"""Places of a circle that touch now: those that carry are passed over, and the others may be as deep as is asked until
they have been well apart, as places of straight features.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary.asked import Asked
from boundary.motions import motion_of
from cagepose import Box, Disc, Pose
from cagepose.kernels.boundary.first_meeting import Hit
from cagepose.model.shapes import Shape

TOUCH = 1e-9
TILT = 0.4
RADIUS = 0.5
PARTS: list[Shape] = [Disc(RADIUS), Box((2.0 * RADIUS, 2.0 * RADIUS, 0.1))]
"""A circle over a face; and, of a straight edge, vertices."""


def over_table(part: Shape, gap: float) -> Asked:
    """A tilted part, of which one end is so high above a table."""
    drop = RADIUS * math.sin(TILT) + (0.05 * math.cos(TILT) if isinstance(part, Box) else 0.0)
    asked = Asked([part], [Box((10.0, 10.0, 1.0))], TOUCH)
    asked.place(Pose((0.1, 0.2, 0.5 + drop + gap), (math.cos(TILT / 2.0), 0.0, math.sin(TILT / 2.0), 0.0)))
    return asked


def falls(asked: Asked, near: float, depth: float, speed: float = -1e-3) -> Hit:
    motion = motion_of(np.zeros(3), np.array([0.3, 0.0, speed]), 0.0, np.zeros(3))
    return asked.first(motion, 1.0, near * TOUCH, depth * TOUCH)


@pytest.mark.parametrize("part", PARTS)
def test_what_is_near_may_go_deep(part):
    deep = falls(over_table(part, 5.0 * TOUCH), 10.0, 50.0)
    assert deep.amount == pytest.approx(55.0 * TOUCH / 1e-3, rel=0.02)


@pytest.mark.parametrize("part", PARTS)
def test_what_is_not_near_may_not(part):
    met = falls(over_table(part, 20.0 * TOUCH), 10.0, 50.0)
    assert met.amount == pytest.approx(20.0 * TOUCH / 1e-3, rel=0.02)


@pytest.mark.parametrize("part", PARTS)
def test_what_touches_and_carries_is_passed_over(part):
    assert falls(over_table(part, 0.0), 0.0, 0.0, -1e-9).amount == math.inf


def test_where_on_a_circle_is_told():
    asked = over_table(Disc(RADIUS), 1e-4)
    hit = falls(asked, 0.0, 0.0)
    circle = asked.held.features[hit.feature]
    toward, axis = np.array(circle["toward"]), np.array(circle["direction"])
    outward = math.cos(hit.angle) * toward + math.sin(hit.angle) * np.cross(axis, toward)
    lowest = np.array([math.cos(TILT), 0.0, -math.sin(TILT)])
    assert hit.amount == pytest.approx(0.1)
    assert not hit.is_open
    np.testing.assert_allclose(outward, lowest, atol=1e-9)
