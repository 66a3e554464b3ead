"""The planar theory of docs/theory/planar: each formula against a computation by hand."""

from __future__ import annotations

import math

import pytest

from cagepose.paper.planar import (
    first_pin_y_m,
    gravity_moment_nm,
    pitch_limit_rad,
    play_angle_rad,
    push_opposes_weight,
    push_pitch_moment_nm,
    push_reduces_yaw,
    push_yaw_moment_nm,
    small_play_angle_rad,
    yaw_limit_rad,
    zero_is_within_reach,
)

DEG = math.pi / 180.0


def test_a_plate_between_rollers_turns_until_it_touches_both():
    """Gap 2, thickness 1, spacing 183, all mm: cos t - 91.5 sin t = 0.5.

    With sin t = t and cos t = 1 - t^2/2: t = 0.5/91.5 = 0.0054645 rad, and t^2/2 = 1.493e-5 takes 1.493e-5/91.5 =
    1.63e-7 rad away: 0.0054643 rad = 0.313084 deg.
    """
    angle = play_angle_rad(0.002, 0.001, 0.183)
    assert angle / DEG == pytest.approx(0.313084, abs=1e-6)
    assert math.cos(angle) - 91.5 * math.sin(angle) == pytest.approx(0.5, abs=1e-14)


def test_a_channel_around_rollers_turns_until_it_touches_both():
    """Points 59.04 apart in a channel of 60.1 mm, spacing 183: 29.52 cos w + 91.5 sin w = 30.05.

    0.53/91.5 = 0.0057923 rad; cos w lacks w^2/2 = 1.678e-5 of 29.52, which needs 5.41e-6 rad more: 0.0057978 rad =
    0.33219 deg.
    """
    angle = play_angle_rad(0.05904, 0.0601, 0.183)
    assert angle / DEG == pytest.approx(0.33219, abs=1e-5)
    assert 29.52 * math.cos(angle) + 91.5 * math.sin(angle) == pytest.approx(30.05, abs=1e-12)


def test_for_small_angles_it_is_play_over_spacing():
    """1 mm over 183 mm is 0.0054645 rad = 0.31310 deg; 1.06 mm over 183 mm is 0.0057923 rad = 0.33188 deg."""
    assert small_play_angle_rad(0.002, 0.001, 0.183) / DEG == pytest.approx(0.31310, abs=1e-5)
    assert small_play_angle_rad(0.05904, 0.0601, 0.183) / DEG == pytest.approx(0.33188, abs=1e-5)


@pytest.mark.parametrize("play", [1e-3, 1e-6, 1e-9, 1e-12])
def test_exact_and_small_angle_meet_when_the_play_vanishes(play):
    """Their difference is of the order of half the angle squared times thickness over spacing."""
    exact, small = play_angle_rad(1.0 + play, 1.0, 183.0), small_play_angle_rad(1.0 + play, 1.0, 183.0)
    assert exact == pytest.approx(small, rel=1e-4, abs=1e-17)


def test_the_weight_behind_the_centre_lifts_the_pins():
    """20 N at 0.1 m behind O: 2 N m about +y, which lowers what lies at +x and lifts the pins at -x."""
    assert gravity_moment_nm(20.0, 0.1) == pytest.approx(2.0)
    assert gravity_moment_nm(20.0, -0.1) == pytest.approx(-2.0)


def test_the_moment_of_the_push_in_pitch():
    """10 N at a level pin 60.747 mm below O: -0.60747 N m. At 5 deg: -10 (60.515747 - 52.293445) N mm = -82.22 N mm."""
    assert push_pitch_moment_nm(10.0, 0.0, 0.060747, 0.6) == pytest.approx(-0.60747)
    assert push_pitch_moment_nm(10.0, 5.0 * DEG, 0.060747, 0.6) == pytest.approx(-0.0822230, abs=1e-6)


@pytest.mark.parametrize("pitch_deg", [-4.0, 0.3, 7.0])
@pytest.mark.parametrize("yaw_deg", [0.0, 2.0])
def test_both_moments_are_those_of_the_cross_product(pitch_deg, yaw_deg):
    """(R p) x f with p = (-L, y, -H) and f along x: the y component for a pitch, the z component for a yaw."""
    height, reach, side, force = 0.060747, 0.6, 0.02, 3.0
    pitch, yaw = pitch_deg * DEG, yaw_deg * DEG
    z_world = reach * math.sin(pitch) - height * math.cos(pitch)
    y_world = -reach * math.sin(yaw) + side * math.cos(yaw)
    assert push_pitch_moment_nm(force, pitch, height, reach) == pytest.approx(z_world * force, abs=1e-15)
    assert push_yaw_moment_nm(force, yaw, side, reach) == pytest.approx(-y_world * force, abs=1e-15)


def test_the_moment_of_the_push_in_yaw():
    """10 N at y = 20 mm: -0.2 N m at no yaw; at 1 deg -10 (19.996954 - 10.471444) N mm = -95.255 N mm."""
    assert push_yaw_moment_nm(10.0, 0.0, 0.02, 0.6) == pytest.approx(-0.2)
    assert push_yaw_moment_nm(10.0, 1.0 * DEG, 0.02, 0.6) == pytest.approx(-0.0952551, abs=1e-6)


def test_the_angles_at_which_the_moments_change_their_sign():
    """atan(60.747/600) = atan(0.101245) = 5.7812 deg; atan(20/600) = 1.9092 deg, which the paper prints as 1.91."""
    pitch, yaw = pitch_limit_rad(0.060747, 0.6), yaw_limit_rad(0.04, 0.6)
    assert pitch / DEG == pytest.approx(5.7812, abs=5e-5)
    assert yaw / DEG == pytest.approx(1.9092, abs=5e-5)
    for step, sign in ((-1e-6, -1.0), (1e-6, 1.0)):
        assert math.copysign(1.0, push_pitch_moment_nm(1.0, pitch + step, 0.060747, 0.6)) == sign
        assert math.copysign(1.0, push_yaw_moment_nm(1.0, yaw + step, 0.02, 0.6)) == sign


def test_the_pin_that_touches_first_lies_farther_ahead():
    """At a yaw w the tips (-L, +-y) stand at x = -L cos w -+ y sin w: the left one is ahead (lower x) for w > 0."""
    assert first_pin_y_m(0.1, 0.04) == 0.02
    assert first_pin_y_m(-0.1, 0.04) == -0.02


@pytest.mark.parametrize(
    ("weight", "push", "holds", "margin"),
    [(2.0, -0.5, True, 0.5), (0.3, -0.5, True, 0.3), (-2.0, -0.5, False, -0.5), (0.0, -0.5, False, 0.0)],
)
def test_requirement_1_in_pitch_asks_for_opposite_moments(weight, push, holds, margin):
    """Margin: the smaller moment, which may vanish before the answer changes."""
    answer = push_opposes_weight(weight, push)
    assert (answer.holds, answer.margin) == (holds, margin)


@pytest.mark.parametrize(
    ("yaw_deg", "pin_y_m", "holds", "margin_deg"),
    [
        (0.1, 0.02, True, 1.8092),
        (-0.1, -0.02, True, 1.8092),
        (2.0, 0.02, False, -0.0908),
        (0.1, -0.02, False, -2.0092),
        (-0.1, 0.02, False, -2.0092),
    ],
)
def test_requirement_1_in_yaw_asks_for_the_pin_that_touches_first(yaw_deg, pin_y_m, holds, margin_deg):
    """Margin: 1.9092 deg less |yaw| at the first pin; at the second, 1.9092 deg and |yaw| from the change of sign."""
    answer = push_reduces_yaw(yaw_deg * DEG, pin_y_m, 0.6)
    assert answer.holds is holds
    assert answer.holds is (yaw_deg * push_yaw_moment_nm(1.0, yaw_deg * DEG, pin_y_m, 0.6) < 0.0)
    assert answer.margin / DEG == pytest.approx(margin_deg, abs=5e-5)


@pytest.mark.parametrize(("misalignment_deg", "holds", "margin_deg"), [(0.1, True, 0.213), (-0.4, False, -0.087)])
def test_requirement_2_asks_for_enough_play(misalignment_deg, holds, margin_deg):
    """0.313 - 0.1 = 0.213 and 0.313 - 0.4 = -0.087 deg."""
    answer = zero_is_within_reach(misalignment_deg * DEG, 0.313 * DEG)
    assert answer.holds is holds
    assert answer.margin / DEG == pytest.approx(margin_deg, abs=1e-12)
