"""Whitney's curve: a peg on a compliance is lowered into its hole, against exact statics in the plane."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import PhaseRun, run
from driven.insertions import LENGTH, LG, MM, RADIUS, STIFFNESS, TURNING, Insertion, Statics

ONE = Insertion(5.05, 0.4, 0.0, 0.1)
TWO = Insertion(5.01, 0.3, math.radians(0.5), 0.1)
NUMBERS = {  # normal forces, force along the axis, lean in degrees: as computed by hand, to the digits given
    (ONE, 1, 2.0): ([1.2907], 0.13219, 0.13862),
    (ONE, 1, 10.0): ([1.4333], 0.14636, 0.12109),
    (ONE, 1, 30.0): ([1.7096], 0.17234, 0.04651),
    (TWO, 2, 4.0): ([24.3087, 23.7459], 4.92698, 0.28648),
    (TWO, 2, 10.0): ([18.0227, 16.8690], 3.52522, 0.11459),
    (TWO, 2, 39.0): ([5.6786, 4.2309], 0.99386, 0.02938),
}
PLACES = pytest.mark.parametrize(("insertion", "n_points", "depth"), NUMBERS, ids=lambda value: f"{value}"[:12])


def lean_of(phase: PhaseRun) -> float:
    w, _, y, _ = phase.pose.quaternion_wxyz
    return 2.0 * math.atan2(float(y), float(w))


def forces_of(phase: PhaseRun, n_points: int) -> list[float]:
    """Normal forces of the places that carry, at the mouth and below it: a square peg touches with two corners each."""
    found = [0.0] * n_points
    for contact in phase.contacts:
        assert contact.force_normal_n is not None
        found[int(n_points == 2 and contact.place_world[2] < -1.0 * MM)] += contact.force_normal_n
    return found


def assert_is(phase: PhaseRun, exact: Statics) -> None:
    assert phase.drive is not None
    assert phase.drive.share == 1.0
    assert phase.drive.along == pytest.approx(exact.axial_n, rel=1e-8)
    assert forces_of(phase, len(exact.forces_n)) == pytest.approx(list(exact.forces_n), rel=1e-8)
    assert lean_of(phase) == pytest.approx(exact.lean, abs=1e-9)
    tip = phase.pose.transform((0.0, 0.0, -0.5 * LENGTH * MM))
    assert tip[[0, 2]] == pytest.approx(exact.tip_mm * MM, abs=1e-10)
    assert abs(tip[1]) < 1e-10


@PLACES
def test_the_statics_are_whitneys(insertion: Insertion, n_points: int, depth: float) -> None:
    """The oracle of the tests below has the numbers that were computed by hand, and for one point Whitney's force."""
    exact = insertion.exact(n_points, insertion.high_at(n_points, depth))
    forces, axial, lean_deg = NUMBERS[insertion, n_points, depth]
    assert list(exact.forces_n) == pytest.approx(forces, abs=6e-5)
    assert exact.axial_n == pytest.approx(axial, abs=6e-6)
    assert math.degrees(exact.lean) == pytest.approx(lean_deg, abs=6e-6)
    if n_points == 1:
        arm, play = LG - depth, insertion.hole_radius - RADIUS
        levers = STIFFNESS * arm * (arm - insertion.friction * RADIUS) + TURNING
        small = STIFFNESS * TURNING * (insertion.aside - arm * insertion.lean - play) / levers
        assert exact.forces_n[0] == pytest.approx(small, rel=2e-3)


@pytest.mark.parametrize(("insertion", "n_points", "depth"), list(NUMBERS))
def test_forces_and_lean_of_a_round_peg_are_whitneys(insertion: Insertion, n_points: int, depth: float) -> None:
    high = insertion.high_at(n_points, depth)
    found = run(insertion.scene(1.0 if n_points == 1 else 3.0, [high]))
    assert_is(found.phases[0], insertion.exact(n_points, high))


@pytest.mark.parametrize(("insertion", "n_points", "depth"), list(NUMBERS))
def test_a_square_peg_between_walls_has_the_same_numbers(insertion: Insertion, n_points: int, depth: float) -> None:
    high = insertion.high_at(n_points, depth)
    found = run(insertion.scene(1.0, [high], "square"))
    assert_is(found.phases[0], insertion.exact(n_points, high))


@pytest.mark.parametrize("insertion", [ONE, TWO], ids=["one point", "two points"])
def test_all_along_the_curve(insertion: Insertion) -> None:
    """One point down to where the second one comes; two from there on. The force peaks where it comes, and falls."""
    (phase,) = run(insertion.scene(1.0, [LG - 39.0])).phases
    assert phase.drive is not None
    curve = phase.drive.curve
    n_asked = [0, 0]
    for share, along in zip(curve.share[1:], curve.along[1:], strict=True):
        high = LG - 1.0 - 38.0 * float(share)
        one, two = insertion.exact(1, high), insertion.exact(2, high)
        is_two = bool((two.forces_n > 0.0).all()) and insertion is TWO
        exact = two if is_two else one
        n_asked[is_two] += 1
        if share > 0.05 and abs(two.forces_n.min()) > 0.05:  # it slides down by then, and one mode holds
            assert along == pytest.approx(exact.axial_n, rel=1e-8), share
    assert (n_asked[1] > 30) == (insertion is TWO)
    if insertion is TWO:
        peak = int(np.argmax(curve.along))
        assert (np.diff(curve.along[peak:]) < 0.0).all()
        assert phase.drive.greatest_along == pytest.approx(float(curve.along[peak]))


def test_a_peg_that_meets_nothing_ends_where_its_springs_pull_on_nothing() -> None:
    """It is let go 2 mm deep in a wide hole, and lowered: at the end what acts on it is exactly zero."""
    wide = Insertion(5.356798247868486, 0.4946953135514683, 0.010276591631677191, 0.028982384485584187)
    (phase,) = run(wide.scene(2.0, [21.855535003446633], "square")).phases
    assert (phase.verdict, phase.contacts) == ("rests", ())
    assert (phase.proof.largest_force, phase.proof.gap_work) == (0.0, 0.0)
