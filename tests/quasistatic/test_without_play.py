"""Contacts without play: motions that only the second order stops, (5.21) and (5.22)."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, SceneError, run

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


def test_contacts_that_hold_each_other_in_turn_are_marginal():
    """One pair keeps a bar from rolling, so that two points at different places along it are opposite: without play it
    cannot tip over them; with a play of p it rolls by the root of p, and tips by the root of that.
    """
    bars = [Box((0.06, 0.013, 0.01), Pose((0.0, side * 0.0085, 0.0))) for side in (-1.0, 1.0)]
    held = Object(bars, center_of_gravity_m=(0.005, 0.003, 0.0))
    pair, apart = [(0.0, -15.0, 2.5), (0.0, -2.0, 2.5)], [(-10.0, 8.5, -5.0), (-10.0, -12.5, 5.0)]
    stops = [(33.0, -11.75, 0.0), (33.0, -5.25, 0.0)]
    load = Load("weight", gravity=(0.1, 0.0, -1.0))
    found = run(Scene(held, Cage(np.array([*pair, *apart, *stops]) / 1e3), [load])).phases[0]
    assert (found.verdict, found.proof.stability) == ("rests", "marginal")
    assert "in turn" in found.proof.reason
    play = np.array([(0.0, -1e-4, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, -1e-4), (0.0, 0.0, 1e-4)])
    loose = np.array([*(np.array([*pair, *apart]) + play), *stops]) / 1e3
    turned = run(Scene(held, Cage(loose), [load])).phases[0]
    assert turned.verdict == "escapes" or np.abs(turned.pose.quaternion_wxyz[1:]).max() > 1e-2


def test_a_contact_that_carries_next_to_nothing_is_in_no_self_stress():
    """C2 makes up for a millionth that C1 and C4 leave, since the plate has rolled by rounding. Its second derivative
    would stop the roll on, at 16 deg.
    """
    points = np.array([(-30, 10, -1), (-23, 10.5, -5), (30, 0, 8), (30, 10, -1)]) / 1e3
    load = Load("push", force=Force((0.0, 1.0, 0.0), (0.003, -0.006, 0.004)))
    assert run(Scene(Object([Box((0.06, 0.02, 0.01))]), Cage(points), [load])).verdict == "escapes"


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (0, 2, 1, 3, 4), (4, 3, 2, 1, 0)])
def test_a_force_that_is_rounding_holds_nothing(order):
    """A cross slides along y, whatever the order of its points; one of them carried 5e-17 of the load."""
    held = Object([Box((0.04, 0.012, 0.02)), Box((0.012, 0.04, 0.02))], (-0.003, 0.009, -0.001))
    points = np.array([(-6, -12, 7), (-2, 8, -10), (-2, 8, 10), (6, -7, 7), (8, -6, -9)])[list(order)] / 1e3
    found = run(Scene(held, Cage(points), [Load("weight", gravity=(1.0, 0.0, -1.0))])).phases[0]
    assert (found.verdict, found.proof.stability, found.proof.undetermined) == ("rests", "marginal", ("y",))


def test_forces_come_before_moments_in_what_no_force_balances():
    """Between one pair along y nothing else carries the push along y; the moments are left."""
    held = Object([Box((0.04, 0.02, 0.01))], (0.005, 0.0, 0.002))
    points = np.array([(0, 10, 0), (0, -10, 0), (20, 5, 0), (20, -5, 0), (0, 0, -5)]) / 1e3
    found = run(Scene(held, Cage(points), [Load("push", gravity=(1.0, 1.0, -1.0))])).phases[0]
    assert found.verdict == "rests"
    net = sum(contact.force_normal_n * contact.normal_world for contact in found.contacts)
    assert net == pytest.approx(np.ones(3) / np.sqrt(3.0) * (1.0, 1.0, -1.0), abs=1e-5)


def test_a_fork_pushed_onto_two_pins_swings():
    """Its slot opens by the square of its turn, and within 1e-12 m of play forces of 1e5 loads could balance it."""
    sides = [Box((0.04, 0.004, 0.01), Pose((0.0, side * 0.008, 0.0))) for side in (-1.0, 1.0)]
    fork = Object([*sides, Box((0.004, 0.02, 0.01), Pose((-0.018, 0.0, 0.0)))])
    points = np.array([(0, -6, 0), (0, 6, 0), (0, 8, -5), (0, 8, 5)]) / 1e3
    found = run(Scene(fork, Cage(points), [Load("push", gravity=(1.0, 1.0, 0.0))])).phases[0]
    assert max(contact.force_normal_n for contact in found.contacts) < 2.0
    assert np.abs(found.pose.quaternion_wxyz[1:]).max() > 0.1


def test_no_force_stands_on_a_tilt():
    """An angle between three pairs, of which only one is on one line: a run turns it by rounding, and forces of a
    hundred million loads would balance its weight on that.
    """
    legs = [Box((0.1, 0.02, 0.006), Pose((0.0, 0.0, -0.007))), Box((0.1, 0.006, 0.014), Pose((0.0, -0.007, 0.003)))]
    pairs = [(-10, 10, -7), (-10, -10, -7), (-20, -4, 5.15), (-20, -10, -6.9), (-20, 0, -10), (-20, -6.38, 10)]
    stops = [(53, -5, -7), (53, 5, -7)]
    held = Object(legs, center_of_gravity_m=(0.02, 0.0, 0.0))
    found = run(Scene(held, Cage(np.array([*pairs, *stops]) / 1e3), [Load("slope", gravity=(1.0, 0.0, 0.0))])).phases[0]
    assert found.verdict == "rests"
    assert max(contact.force_normal_n or 0.0 for contact in found.contacts) < 10.0


def test_a_fork_around_opposite_points_may_turn():
    """The other way round the second order opens: a fork as wide as a pair of points turns until a face stops it."""
    arms = [Box((0.1, 0.01, 0.02), Pose((0.0, side * 0.01, 0.0))) for side in (-1.0, 1.0)]
    bridge = Box((0.01, 0.01, 0.02), Pose((0.045, 0.0, 0.0)))
    fork = Object([*arms, bridge], center_of_gravity_m=(0.03, 0.0, 0.0))
    points = np.array([(0.0, -0.005, 0.0), (0.0, 0.005, 0.0)])
    found = run(Scene(fork, Cage(points), [Load("push", gravity=(0.0, -1.0, 0.0))])).phases[0]
    assert found.verdict in ("escapes", "rests")
    assert np.abs(found.pose.quaternion_wxyz[1:]).max() > 1e-3


I_SECTION = [Box((0.06, 0.03, 0.005), Pose((0, 0, z))) for z in (-0.0175, 0.0175)] + [Box((0.06, 0.005, 0.03))]


@pytest.mark.parametrize("order", [1, -1])
def test_opposite_points_on_edges_let_a_beam_slide_out(order):
    """One in the corner of web and flange, one on the edge of the flange: which face of each counts is open (2.4)."""
    points = np.array([(0.0087, -0.0025, 0.015), (0.0087, 0.015, 0.015)])[::order]
    body = Object(I_SECTION, center_of_gravity_m=(0.005, 0.0, 0.0))
    assert run(Scene(body, Cage(points), [Load("weight", gravity=(0.1, 0.0, -1.0))])).verdict == "escapes"
