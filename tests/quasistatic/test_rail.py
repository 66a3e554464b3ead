"""The rail of the docs by the mechanics: its rest pose is unique, and its tilt has a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from audit.geometry import deepest
from cagepose import Variation, run, run_many
from quasistatic.paths import RESTS, again, path_poses
from rails import SIDE_PLAY_MM, exact_tilt_deg, rail_scene, tilt_deg

WORLD_DEG = {
    "pitch_deg": (-0.3322, -0.2131, 0.0012),
    "yaw_deg": (-0.2322, -0.3131, 0.0018),
    "roll_deg": (-0.3327, -0.3125, 0.1018),
}
RELATIVE_DEG = (-0.33220, -0.31308, 0.00182)
MISALIGNED = sorted(WORLD_DEG)
SPACING_MM = 183.0


def relative_deg(result):
    """ZYX angles of the rail in the cage's frame at the end, degrees."""
    pose = result.scene.cage.pose_world_cage.inverse() @ result.pose
    return np.degrees(pose.euler_zyx)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("misaligned", MISALIGNED)
def test_gravity_then_push_ends_at_the_published_pose(misaligned, metric):
    """Printed digits: relative ZYX to 1e-5 deg, world ZYX to 1e-4 deg; the tilt exactly.

    The pitch differs from the tilt by the yaw: sin(pitch) = sin(tilt) cos(yaw) to second order, 5e-6 deg here.
    """
    result = run(again(rail_scene(**{misaligned: 0.1}), metric=metric), method="quasistatic")
    assert [phase.verdict for phase in result.phases] == ["rests", "rests"]
    assert relative_deg(result) == pytest.approx(RELATIVE_DEG, abs=0.6e-5)
    assert np.degrees(result.pose.euler_zyx) == pytest.approx(WORLD_DEG[misaligned], abs=0.6e-4)
    exact = exact_tilt_deg(1.0, SPACING_MM)
    assert tilt_deg(result, 0) == pytest.approx(exact, rel=1e-9)
    assert tilt_deg(result, 1) == pytest.approx(-exact, rel=1e-9)


@pytest.mark.parametrize(
    ("tilt_of_rail", "tilt_of_cage"),
    [
        ((0.0, 0.0, 0.1), (0.0, 0.0, 0.0)),
        ((-0.0624523771, -0.227143487, 0.000134042398), (-0.0624523771, -0.227143487, 0.000134042398)),
    ],
)
def test_from_near_an_unstable_balance_it_slides_away_in_few_steps(tilt_of_rail, tilt_of_cage):
    """The guides nearly balance on the rollers, and turn about the vertical ever faster, first by 1e-7 rad a step.

    Curvature across the faces, a thousand times that along them, must not hold the steps back (5.10).
    """
    variation = Variation(object_euler_zyx=np.radians([tilt_of_rail]), cage_euler_zyx=np.radians([tilt_of_cage]))
    runs = run_many(rail_scene(), variation, method="quasistatic")
    assert runs.phase_verdicts.tolist() == [["rests", "rests"]]
    assert runs.n_steps.max() < 30


@pytest.mark.parametrize("misaligned", MISALIGNED)
def test_gravity_drops_it_by_half_the_play_before_it_tilts(misaligned):
    """The first motion is free: a travel along gravity by play / 2 over the cosine of the cage's tilt, 1 - 1.5e-6."""
    first = run(rail_scene(**{misaligned: 0.1}), method="quasistatic").phases[0].events[0]
    assert first.rule == "free"
    assert first.motion.kind == "travel"
    assert first.motion.distance_m == pytest.approx(0.5e-3, rel=1e-5)


@pytest.mark.parametrize("pin_y_mm", [20.0, -20.0])
def test_both_pins_yaw_it_by_the_side_play(pin_y_mm):
    """Four side rollers (+-a, +-b) hold the webs, half a width h = b + c apart from the middle plane: seen from above,
    the turned web touches two of them at psi with b cos psi + a sin psi = h, whatever way it is yawed. b is 29.52 mm,
    h the inner face of the webs at 30.05 mm, a 91.5 mm. The tilt shortens a by cos(tilt), 1.5e-5, and the roll adds
    less: the last two digits of 0.33220 are not from this line.
    """
    result = run(rail_scene(pitch_deg=0.1, pin_y_mm=pin_y_mm), method="quasistatic")
    a, b, h = SPACING_MM / 2.0, 29.52, 29.52 + SIDE_PLAY_MM / 2.0
    radius = np.hypot(a, b)
    yaw_deg = np.degrees(np.arctan2(a, b) - np.arccos(h / radius))
    expected = np.array(RELATIVE_DEG) * (1.0, 1.0, 1.0) if pin_y_mm > 0 else np.array(RELATIVE_DEG) * (-1.0, 1.0, -1.0)
    assert relative_deg(result) == pytest.approx(expected, abs=0.6e-5)
    assert abs(relative_deg(result)[0]) == pytest.approx(yaw_deg, abs=2e-5)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("pin_y_mm", [20.0, -20.0])
@pytest.mark.parametrize("misaligned", MISALIGNED)
@pytest.mark.parametrize(
    ("play_mm", "tolerance"), [(1.0, 1e-9), (0.1, 1e-9), (0.01, 1e-9), (0.001, 1e-6), (0.0001, 1e-6)]
)
def test_a_tight_rail_is_as_exact_with_no_other_setting_changed(play_mm, tolerance, misaligned, pin_y_mm, metric):
    """Tilt error as a fraction of the play's own angle. Rounding over 600 mm, 1e-16, is 1e-9 of a play of 0.0001 mm."""
    scene = again(rail_scene(**{misaligned: 0.1}, play_mm=play_mm, pin_y_mm=pin_y_mm), metric=metric)
    result = run(scene, method="quasistatic")
    assert [phase.verdict for phase in result.phases] == ["rests", "rests"]
    exact = exact_tilt_deg(play_mm, SPACING_MM)
    assert tilt_deg(result, 0) == pytest.approx(exact, rel=tolerance)
    assert tilt_deg(result, 1) == pytest.approx(-exact, rel=tolerance)


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("misaligned", MISALIGNED)
@pytest.mark.parametrize("play_mm", [1.0, 0.1])
def test_with_friction_it_slides_to_the_same_tilt(play_mm, misaligned, metric):
    """mu = 0.1 does not jam the push. Gravity alone may leave it anywhere along x and y: only the tilts are unique."""
    scene = again(rail_scene(**{misaligned: 0.1}, play_mm=play_mm), friction=0.1, metric=metric)
    result = run(scene, method="quasistatic")
    assert {phase.verdict for phase in result.phases} <= set(RESTS)
    exact = exact_tilt_deg(play_mm, SPACING_MM)
    assert tilt_deg(result, 0) == pytest.approx(exact, rel=1e-9)
    assert tilt_deg(result, 1) == pytest.approx(-exact, rel=1e-9)


@pytest.mark.parametrize("friction", [None, 0.1])
@pytest.mark.parametrize("misaligned", MISALIGNED)
def test_no_roller_is_ever_inside(misaligned, friction):
    scene = again(rail_scene(**{misaligned: 0.1}), friction=friction)
    result = run(scene, method="quasistatic")
    assert max(deepest(scene, pose) for pose in path_poses(result)) <= 1e-12
