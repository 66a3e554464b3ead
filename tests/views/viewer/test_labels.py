"""Names in a picture: beside their places, and never over each other."""

from __future__ import annotations

import itertools
import math

import numpy as np

from cagepose.views.viewer.labels import LEAST_LEADER, MOVED_BY, PIXELS_BESIDE, PIXELS_TO_EDGE, laid_out, leader

PICTURE = (200.0, 150.0)


def test_a_name_at_the_edge_stays_in_the_picture_and_does_not_touch_its_edge():
    corners = laid_out([(195.0, 1.0), (2.0, 8.0)], [(60.0, 12.0)] * 2, PICTURE, [False] * 2)
    assert corners == [(200.0 - 60.0 - PIXELS_TO_EDGE, PIXELS_TO_EDGE), (2.0 + PIXELS_BESIDE, PIXELS_TO_EDGE)]


def test_a_name_alone_stands_to_the_right_and_above():
    [corner] = laid_out([(100.0, 50.0)], [(20.0, 12.0)], PICTURE, [False])
    assert corner == (100.0 + PIXELS_BESIDE, 50.0 - PIXELS_BESIDE / 2.0 - 12.0)


def test_of_two_names_at_one_place_the_second_goes_to_the_left():
    first, second = laid_out([(100.0, 50.0)] * 2, [(20.0, 12.0)] * 2, PICTURE, [False] * 2)
    assert first is not None
    assert second == (100.0 - PIXELS_BESIDE - 20.0, first[1])


def test_a_name_keeps_off_the_place_of_another_where_it_can():
    """The second place lies just where the first name would stand."""
    first, _ = laid_out([(100.0, 50.0), (115.0, 40.0)], [(20.0, 12.0)] * 2, PICTURE, [False] * 2)
    assert first == (100.0 - PIXELS_BESIDE - 20.0, 50.0 - PIXELS_BESIDE / 2.0 - 12.0)


def test_names_of_a_crowd_never_cover_each_other_and_those_without_room_are_left_out():
    generator = np.random.default_rng(7)
    places = [(x, y) for x, y in generator.uniform(0.0, 120.0, (60, 2))]
    corners = laid_out(places, [(24.0, 12.0)] * 60, PICTURE, [index < 30 for index in range(60)])
    kept = [corner for corner in corners if corner is not None]
    assert 10 < len(kept) < 60
    for (ax, ay), (bx, by) in itertools.combinations(kept, 2):
        assert abs(ax - bx) >= 24.0 or abs(ay - by) >= 12.0


def test_a_name_without_room_beside_its_place_is_moved_away_and_a_line_leads_there():
    """Four names fill the room beside one place."""
    places, sizes = [(100.0, 75.0)] * 6, [(20.0, 12.0)] * 6
    corners = laid_out(places, sizes, PICTURE, [True] * 5 + [False])
    assert corners[5] is None
    lines = [corner and leader(place, corner, size) for place, corner, size in zip(places, corners, sizes, strict=True)]
    assert lines[:4] == [None] * 4
    assert lines[4] is not None
    assert LEAST_LEADER < math.dist(places[4], lines[4]) <= max(MOVED_BY)


def test_no_name_covers_what_is_taken():
    taken = [((90.0, 0.0), (110.0, 150.0))]
    [corner] = laid_out([(95.0, 50.0)], [(40.0, 12.0)], PICTURE, [True], taken)
    assert corner is not None
    assert corner[0] + 40.0 <= 90.0
