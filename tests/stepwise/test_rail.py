"""The rail of docs/theory: its tilt has a closed form, (g/2) cos t - (l/2) sin t = 1/2 (`rails.exact_tilt_deg`)."""

from __future__ import annotations

import numpy as np
import pytest

from rails import exact_tilt_deg, rail_scene, tilt_deg
from stepwise_run import run

MISALIGNED = [{"pitch_deg": 0.1}, {"yaw_deg": 0.1}, {"roll_deg": 0.1}]
TILT_DEG = 0.313084


def test_the_closed_form_is_the_published_tilt():
    assert exact_tilt_deg(1.0, 183.0) == pytest.approx(TILT_DEG, abs=5e-7)


@pytest.mark.parametrize("misaligned", MISALIGNED)
@pytest.mark.parametrize("cog_y_mm", [0.0, 0.5])
@pytest.mark.parametrize("pin_y_mm", [20.0, -20.0])
def test_gravity_tilts_it_up_and_the_push_tilts_it_down(misaligned, cog_y_mm, pin_y_mm):
    result = run(rail_scene(**misaligned, cog_y_mm=cog_y_mm, pin_y_mm=pin_y_mm))
    gravity, push = result.phases
    assert (gravity.verdict, push.verdict) == ("stable", "stable")
    assert gravity.events[0].motion.distance_m == pytest.approx(0.5e-3, rel=1e-5)
    assert tilt_deg(result, 0) == pytest.approx(exact_tilt_deg(1.0, 183.0), abs=1e-8)
    assert tilt_deg(result, 1) == pytest.approx(-exact_tilt_deg(1.0, 183.0), abs=1e-8)
    rules = [event.rule for event in push.events]
    assert rules[:3] == ["Slp-1", "Slp-2", "B-3"]
    assert rules[-1] == "B-4"


def test_the_first_slides_are_half_the_side_play_and_the_way_to_the_stop():
    """Slp-1 turns about the far roller until the side play of 0.53 mm at 183 mm is used up; Slp-2 ends at the stop."""
    first, second = run(rail_scene(yaw_deg=0.1)).phases[1].events[:2]
    assert np.degrees(first.motion.angle_rad) == pytest.approx(0.1659, abs=5e-5)
    assert second.motion.distance_m == pytest.approx(0.904e-3, abs=1e-6)
    assert second.hit == ("C13",)


def gravity_drives_the_tilt(scene) -> bool:
    """Whether gravity's moment about the front rollers exceeds the least one that counts (R3: 1e-3 of force times
    distance).

    At a spacing of 200 mm the front rollers stand below the centre of gravity, 100 mm ahead: then the rail stays level.
    """
    cog = scene.object.pose_world_object.transform(scene.object.center_of_gravity_m)
    front = scene.cage.points_world()[[4, 6]]
    lever_m = (cog - front.mean(axis=0))[0]
    return lever_m > 1e-3 * np.linalg.norm(front - cog, axis=1).max()


def test_random_rails_all_end_at_the_exact_tilt(cases):
    rng = np.random.default_rng(42)
    worst_deg, n_level = 0.0, 0
    for _ in range(cases(30, 200)):
        yaw, pitch, roll = rng.uniform(-0.3, 0.3, 3)
        play_mm, spacing_mm = rng.uniform(0.3, 1.5), rng.uniform(150.0, 200.0)
        scene = rail_scene(
            yaw_deg=yaw,
            pitch_deg=pitch,
            roll_deg=roll,
            play_mm=play_mm,
            spacing_mm=spacing_mm,
            cog_y_mm=rng.choice([0.0, 0.5]),
            pin_y_mm=rng.choice([-20.0, 20.0]),
        )
        result = run(scene)
        assert [phase.verdict for phase in result.phases] == ["stable", "stable"]
        exact = exact_tilt_deg(play_mm, spacing_mm)
        worst_deg = max(worst_deg, abs(tilt_deg(result, 1) + exact))
        if gravity_drives_the_tilt(scene):
            worst_deg = max(worst_deg, abs(tilt_deg(result, 0) - exact))
        else:
            n_level += 1
            assert tilt_deg(result, 0) == pytest.approx(0.0, abs=1e-8)
    assert worst_deg < 1e-8
    assert n_level <= 2


@pytest.mark.parametrize("misaligned", MISALIGNED)
@pytest.mark.parametrize("touch", [1e-9, 1e-8, 1e-7, 1e-6])
def test_the_touch_tolerance_does_not_show_in_the_tilt(misaligned, touch):
    result = run(rail_scene(**misaligned, touch=touch))
    assert result.verdict == "stable"
    assert tilt_deg(result, 0) == pytest.approx(exact_tilt_deg(1.0, 183.0), abs=1e-5)
    assert tilt_deg(result, 1) == pytest.approx(-exact_tilt_deg(1.0, 183.0), abs=1e-5)


def test_play_below_the_resolution_of_r3_is_told():
    """At 0.05 mm the way from level to tilted is less than 0.018 deg, so the method holds the rail where it is."""
    result = run(rail_scene(pitch_deg=0.1, play_mm=0.05))
    assert exact_tilt_deg(0.05, 183.0) < 0.018
    assert any("less than 0.018 deg" in warning for warning in result.warnings)


def test_a_tighter_rail_is_as_exact():
    """Play 0.1 mm: the event logs of a fuzzy method would depend on its tolerance here."""
    result = run(rail_scene(pitch_deg=0.1, play_mm=0.1))
    assert tilt_deg(result, 1) == pytest.approx(-exact_tilt_deg(0.1, 183.0), abs=1e-8)
