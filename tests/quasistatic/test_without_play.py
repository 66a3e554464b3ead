"""Contacts without play: motions that only the second order stops, (5.21) and (5.22)."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Pose, Scene, SceneError, run

LENGTH, WIDTH, THICKNESS = 0.1, 0.08, 0.01


def plate(
    pairs: np.ndarray,
    slope: float,
    center_of_gravity: tuple[float, float, float],
    stops: tuple[tuple[float, float, float], ...] = (),
) -> Scene:
    """A plate between pairs of opposite points, as far apart as it is thick; gravity leans by ``slope`` along x."""
    points = [(x, y, side * THICKNESS / 2) for x, y in pairs for side in (-1.0, 1.0)]
    body = Object([Box((LENGTH, WIDTH, THICKNESS))], center_of_gravity_m=center_of_gravity)
    return Scene(body, Cage(np.array([*points, *stops])), [Load("weight", gravity=(slope, 0.0, -1.0))])


def random_plates(n: int) -> list[Scene]:
    """Half of them with round numbers, as people draw them."""
    random = np.random.default_rng(11)
    scenes = list[Scene]()
    while len(scenes) < n:
        pairs = random.uniform(-0.4, 0.4, (int(random.integers(1, 5)), 2)) * (LENGTH, WIDTH)
        x, y = random.uniform(-0.3, 0.3, 2) * (LENGTH, WIDTH)
        if random.random() < 0.5:
            pairs, x, y = np.round(pairs, 2), round(x, 2), round(y, 2)
        try:
            scenes.append(plate(pairs, 10.0 ** random.uniform(-3.0, 0.0), (x, y, 0.0)))
        except SceneError:  # two points at one place
            continue
    return scenes


def test_plates_without_a_stop_slide_out(cases):
    """Nothing but the slope acts along the plate, and no point is in the way."""
    n = cases(200, 4000)
    verdicts = [run(scene).verdict for scene in random_plates(n)]
    assert verdicts == ["escapes"] * n


@pytest.mark.parametrize("beside", [0.0, 0.01])
def test_a_plate_between_two_points_rests_at_its_stops(beside):
    """The weight beside the points is carried to second order, and the proof says how much of the load that is."""
    stops = ((LENGTH / 2 + 0.003, -0.02, 0.0), (LENGTH / 2 + 0.003, 0.02, 0.0))
    found = run(plate(np.array([(0.0, 0.0)]), 0.1, (0.0, beside, 0.0), stops)).phases[0]
    assert found.verdict == "rests"
    assert found.pose.position_m == pytest.approx((0.003, 0.0, 0.0), abs=1e-12)
    at_stops = sum(contact.force_normal_n for contact in found.contacts if contact.point in ("C3", "C4"))
    assert at_stops == pytest.approx(0.1 / np.hypot(0.1, 1.0), rel=1e-9)
    assert "to second order" in found.proof.reason
    assert found.proof.residual > 1e-3


def test_pairs_that_hold_to_first_order_leave_nothing():
    """Four pairs around the centre of gravity: forces balance the weight, and nothing else is needed."""
    stops = ((LENGTH / 2 + 0.003, -0.02, 0.0), (LENGTH / 2 + 0.003, 0.02, 0.0))
    pairs = np.array([(-0.03, -0.02), (-0.03, 0.02), (0.03, -0.02), (0.03, 0.02)])
    found = run(plate(pairs, 0.1, (0.0, 0.0, 0.0), stops)).phases[0]
    assert found.verdict == "rests"
    assert found.proof.residual < 1e-11
    assert "second order" not in found.proof.reason


def test_a_fork_around_opposite_points_may_turn():
    """The other way round the second order opens: a fork as wide as a pair of points turns until a face stops it."""
    arms = [Box((0.1, 0.01, 0.02), Pose((0.0, side * 0.01, 0.0))) for side in (-1.0, 1.0)]
    bridge = Box((0.01, 0.01, 0.02), Pose((0.045, 0.0, 0.0)))
    fork = Object([*arms, bridge], center_of_gravity_m=(0.03, 0.0, 0.0))
    points = np.array([(0.0, -0.005, 0.0), (0.0, 0.005, 0.0)])
    found = run(Scene(fork, Cage(points), [Load("push", gravity=(0.0, -1.0, 0.0))])).phases[0]
    assert found.verdict in ("escapes", "rests")
    assert np.abs(found.pose.quaternion_wxyz[1:]).max() > 1e-3
