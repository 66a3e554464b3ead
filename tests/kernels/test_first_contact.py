"""First contact of one point with one box: closed forms, seams (touching, parallel, grazing, corner), symmetry.

The box is 2 x 2 x 2 (half size 1) unless said otherwise; all lengths in metres.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose.kernels.collision.travel import travel_entry
from cagepose.kernels.collision.turn import angle_of_key, turn_entry

RESOLUTION = 1e-12
CUBE = (1.0, 1.0, 1.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def travel(point, direction, half=CUBE, depth=RESOLUTION):
    return travel_entry(point, direction, half, depth, RESOLUTION)


def turn(point, through, axis, half=CUBE, depth=RESOLUTION):
    key = turn_entry(point, through, axis, half, depth, RESOLUTION, math.inf)
    return math.inf if key == math.inf else angle_of_key(key)


def negated(vector):
    return tuple(-value for value in vector)


class TestTravel:
    def test_the_distance_is_that_to_the_face_ahead(self):
        assert travel((3.0, 0.5, 0.0), X) == 2.0

    def test_a_point_behind_is_never_met(self):
        assert travel((-3.0, 0.5, 0.0), X) == math.inf

    def test_oblique_travel_meets_the_last_slab_entered(self):
        """From (3, 2.5) along the diagonal: x enters after 2 sqrt 2, y after 1.5 sqrt 2, so x is the face."""
        diagonal = (math.sqrt(0.5), math.sqrt(0.5), 0.0)
        assert travel((3.0, 2.5, 0.0), diagonal) == pytest.approx(2.0 * math.sqrt(2.0), rel=1e-15)

    @pytest.mark.parametrize("offset", [0.0, 1e-13, -1e-13])
    def test_sliding_in_the_plane_of_a_face_is_no_contact(self, offset):
        assert travel((3.0, 1.0 + offset, 0.0), X) == math.inf

    def test_a_touching_point_blocks_at_once_when_the_face_comes_nearer(self):
        assert travel((1.0, 0.0, 0.0), X) == 0.0
        assert travel((1.0 + 0.5 * RESOLUTION, 0.0, 0.0), X) == 0.0

    def test_a_touching_point_that_leaves_is_not_met_again(self):
        assert travel((1.0, 0.0, 0.0), negated(X)) == math.inf

    def test_a_point_that_starts_a_little_inside_may_leave_and_slide_but_not_go_deeper(self):
        inside = (1.0 - 1e-9, 0.0, 0.0)
        assert travel(inside, negated(X), depth=1e-9 + 1e-14) == math.inf
        assert travel(inside, Y, depth=1e-9 + 1e-14) == math.inf
        assert travel(inside, X, depth=1e-9 + 1e-14) == 0.0

    def test_a_small_gap_is_closed_exactly_not_skipped(self):
        assert travel((1.0 + 3e-10, 0.0, 0.0), X) == pytest.approx(3e-10, rel=1e-6)

    def test_a_corner_met_exactly_counts_only_if_every_slab_goes_in(self):
        diagonal = (math.sqrt(0.5), math.sqrt(0.5), 0.0)
        assert travel((2.0, 2.0, 0.0), diagonal) == pytest.approx(math.sqrt(2.0), rel=1e-15)
        assert travel((2.0, 0.0, 0.0), (math.sqrt(0.5), -math.sqrt(0.5), 0.0)) == math.inf


class TestTurn:
    def test_the_sample_turns_by_acos_seven_eighths(self):
        """Face at distance a = 7 from the pivot, point at distance s = 8 along the face's normal: cos t = a / s."""
        box = (5.0, 5.0, 5.0)
        assert turn((-6.0, 0.0, -5.0), (2.0, 0.0, -5.0), (0.0, -1.0, 0.0), box) == pytest.approx(
            math.acos(7 / 8), rel=1e-15
        )

    @pytest.mark.parametrize("angle_deg", [1e-6, 1.0, 90.0, 179.0, 180.0, 181.0, 270.0, 299.0])
    def test_any_angle_up_to_a_full_turn_is_found(self, angle_deg):
        """A circle of radius 2 about (0, 2.5) enters the box through its right face, x = 1, where cos(phi) = 1/2: phi
        = -60 deg.

        Seen from the box the point runs clockwise, so it starts at phi = -60 deg + the angle.
        """
        phi = math.radians(angle_deg - 60.0)
        start = (2.0 * math.cos(phi), 2.5 + 2.0 * math.sin(phi), 0.0)
        assert turn(start, (0.0, 2.5, 0.0), Z) == pytest.approx(math.radians(angle_deg), rel=1e-12, abs=1e-15)

    def test_a_full_turn_without_contact_is_none(self):
        assert turn((5.0, 0.0, 0.0), (0.0, 0.0, 0.0), Z) == math.inf

    def test_a_point_on_the_axis_never_moves(self):
        assert turn((1.0, 0.0, 0.0), (1.0, 0.0, 0.3), Z) == math.inf

    def test_the_sign_of_the_gap_rate_decides_a_touching_point(self):
        """On the right face, pivot below: one sense goes in at once, the other leaves and comes round to the left."""
        point, pivot = (1.0, 0.5, 0.0), (0.0, -3.0, 0.0)
        assert turn(point, pivot, negated(Z)) == 0.0
        round_trip = 2.0 * math.pi - (math.atan2(3.5, -1.0) - math.atan2(3.5, 1.0))
        assert turn(point, pivot, Z) == pytest.approx(round_trip, rel=1e-14)

    def test_a_touching_point_with_no_gap_rate_is_decided_by_the_gap_acceleration(self):
        """Pivot on the face's normal through the point: from inside, the circle curves in; from outside, away."""
        assert turn((1.0, 0.0, 0.0), (-3.0, 0.0, 0.0), Z) == 0.0
        assert turn((1.0, 0.0, 0.0), (3.0, 0.0, 0.0), Z, half=(1.0, 9.0, 1.0)) == math.inf

    @pytest.mark.parametrize("depth", [0.0, 1e-13, 1e-11, 1e-9])
    def test_grazing_is_decided_by_depth_not_by_angle(self, depth):
        """A circle of radius 2 about (0, 3) dips ``depth`` below the face y = 1."""
        found = turn((2.0, 3.0 - depth, 0.0), (0.0, 3.0 - depth, 0.0), Z)
        if depth <= RESOLUTION:
            assert found == math.inf
        else:
            assert found == pytest.approx(math.pi / 2 - math.acos(1.0 - depth / 2.0), abs=2e-15 / math.sqrt(depth))

    def test_sliding_on_a_face_about_its_normal_is_no_contact(self):
        assert turn((0.5, 0.2, 1.0), (-0.7, 0.1, 1.0), Z) == math.inf

    def test_a_tiny_gap_near_zero_keeps_its_digits(self):
        """Gap g over lever r: sin t = g / r. With 1 - cos t nothing of it would be left."""
        gap, lever = 1e-11, 2.0
        found = turn((0.0, 1.0 + gap, 0.0), (-lever, 1.0 + gap, 0.0), Z)
        assert found == pytest.approx(gap / lever, rel=1e-4)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_angles_do_not_depend_on_scale(scale):
    point, through = (1.7, 0.4, -0.2), (-0.5, 1.5, 0.3)
    axis = (0.48, -0.6, 0.64)
    small = turn(point, through, axis)
    large = turn_entry(
        tuple(scale * v for v in point),
        tuple(scale * v for v in through),
        axis,
        (scale, scale, scale),
        scale * RESOLUTION,
        scale * RESOLUTION,
        math.inf,
    )
    assert small < math.inf
    assert angle_of_key(large) == pytest.approx(small, rel=1e-13)


@pytest.mark.parametrize("mirror", [0, 1, 2])
def test_a_mirrored_turn_meets_at_the_same_angle(mirror):
    """A mirror turns the sense of rotation round: the axis is a pseudovector."""
    flip = np.ones(3)
    flip[mirror] = -1.0
    point, through, axis = (1.7, 0.4, -0.2), (-0.5, 1.5, 0.3), np.array((0.48, -0.6, 0.64))
    mirrored_axis = tuple((-flip * axis).tolist())
    found = turn(tuple(flip * point), tuple(flip * through), mirrored_axis)
    assert found == pytest.approx(turn(point, through, tuple(axis.tolist())), rel=1e-13)
