"""What ends a step is searched where contacts are on their faces: drawn mechanisms come to an end, exactly there."""

from __future__ import annotations

import math

import numpy as np
import pytest

from audit.families import make_case
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, Sphere, run

MM = 1e-3


@pytest.mark.parametrize(("family", "first"), [("v-rollers", 315), ("tapered-pin", 320), ("square-hole", 0)])
def test_drawn_mechanisms_come_to_an_end(family, first, cases):
    """Where events were searched on the screw, 4, 4 and 1 of so many stalled or took all steps."""
    n_cases = cases({"v-rollers": 40, "tapered-pin": 90, "square-hole": 30}[family], 200)
    verdicts = {index: run(make_case(family, index).scene).verdict for index in range(first, first + n_cases)}
    assert {index: verdict for index, verdict in verdicts.items() if verdict in ("stalled", "limit")} == {}


@pytest.mark.parametrize("index", [193, 336, 337])
def test_a_cam_reaches_its_pin_with_both_ends_at_once(index):
    """Both ends of the pin are reached by one turn: no rounding lets one of them carry all of the load."""
    ended = run(make_case("cam", index).scene)
    assert ended.verdict in ("rests", "may rest")
    gaps = [contact.gap_m for contact in ended.contacts if contact.point.startswith("pin")]
    assert len(gaps) == 2
    assert max(abs(gap) for gap in gaps) < 1e-16


def test_a_shaft_that_friction_stops_in_its_bush_ends_in_the_balance():
    """It went to and fro about it, at the limit of friction, up to the limit of steps."""
    ended = run(make_case("ordinary", 814).scene)
    assert ended.verdict == "may rest"
    assert ended.phases[-1].proof.residual < 1e-9


@pytest.mark.parametrize(
    ("half_mm", "radius_mm", "begun_mm", "push_n"), [(3.0, 5.0, 0.0, 0.1), (3.5, 6.0, -2.0, 0.05), (3.2, 5.3, 1.0, 0.2)]
)
def test_a_ball_that_rolls_tips_over_the_ends_of_its_rails(half_mm, radius_mm, begun_mm, push_n):
    """Its place of contact goes along both bodies, but no material slips. It went on through the air."""
    height = math.sqrt(radius_mm**2 - half_mm**2)
    ball = Object(shapes=[Sphere(radius_mm * MM)], pose=Pose((begun_mm * MM, 0, height * MM)), mass_kg=0.1)
    rails = [
        Box((0.03, 0.01, 0.01), Pose((-0.005, side * (half_mm + 5.0) * MM, -0.005)), f"rail {side}") for side in (-1, 1)
    ]
    push = Load("push", gravity=(0, 0, -9.81), force=Force((1, 0, 0), (0, 0, 0), push_n))
    events = run(Scene(ball, Cage(shapes=rails), [push], friction_coefficient=0.5)).phases[0].events
    places = np.array([pose.position_m / MM for event in events[:-1] for pose in event.path])
    assert places[-1, 2] < 0.5 * height
    beyond = np.maximum(places[:, 0] - 10.0, 0.0)
    np.testing.assert_allclose(np.hypot(beyond, places[:, 2]), height, atol=1e-6)
