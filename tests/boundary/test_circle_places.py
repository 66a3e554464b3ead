"""All places where a circle has a common normal with something else: against dense sampling, none missed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary import circle_pairs
from boundary.circle_sampling import Asked, Sampled, changes, size_of, stationary
from cagepose.kernels.algebra.record import empty_rows
from cagepose.kernels.circles.beside_circle import common_with_circle, places_by_circle
from cagepose.kernels.circles.beside_flat import (
    common_with_plane,
    common_with_point,
    places_by_plane,
    places_by_point,
)
from cagepose.kernels.circles.beside_round import (
    Round,
    common_with_line,
    common_with_round,
    place_by_round_near,
    places_by_round,
)
from cagepose.kernels.circles.places import (
    FLAT,
    GREATEST,
    LEAST,
    SADDLE,
    WHOLE,
    Circle,
    Place,
)
from inner_kernels import as_machine_code

EXACT = 1e-12
"""Of the size."""
ROUNDING, FLAT_STRETCH_RAD = 2e-15, 1e-2
"""Of the size, by how much distances differ that are equal to rounding; and the longest stretch of such."""
AT_ONCE = 500
"""Pairs whose sampled places are halved down together."""
PAIRS = {"line": circle_pairs.with_line, "round": circle_pairs.with_round, "circle": circle_pairs.with_circle}
UNIT = Circle((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 1.0)


def apart(one: float, other: float) -> float:
    return abs(math.remainder(float(one) - float(other), 2.0 * math.pi))


def kind_of(rises: bool, side: float, is_circle: bool) -> int:
    if is_circle and rises != (side > 0.0):
        return SADDLE
    return LEAST if rises else GREATEST


def found_by(circle, other, flat_m: float):
    """The kernels' places along the first circle, or the smaller of two, and that circle and the other one."""
    is_circle, places = isinstance(other, Circle), empty_rows(Place, 16)
    find = as_machine_code(places_by_circle if is_circle else places_by_round)
    n_places = find(circle, other, flat_m, places)
    is_first = not is_circle or circle.radius <= other.radius
    rows = [row.copy() for row in places[: max(n_places, 0)]]
    angles = [(float(row["angle" if is_first else "other_angle"]), row) for row in rows]
    return n_places, angles, (circle, other) if is_first else (other, circle)


def near_to(told, side: float, is_circle: bool, found) -> list[float]:
    """Which of the places found are of the kind of a sampled one, and near it."""
    middle, reach = 0.5 * (told.low + told.high), 0.5 * (told.high - told.low) + 1e-6
    return [
        angle
        for angle, place in found
        if place["is_near"] == (side > 0.0)
        and place["kind"] in (FLAT, kind_of(told.rises, side, is_circle))
        and apart(angle, middle) <= reach
    ]


def beside_on_a_flat_stretch(told, exactly, size: float, pair: Asked, is_circle: bool, found) -> list[float]:
    """Which of the places found are of the kind of a sampled one, and as far from the other part, to rounding, as all
    between the two: circles of one size that nearly lie on a ball have stretches of 1e-3 radians like that.
    """
    distance = Sampled([pair], np.longdouble).distance
    beside = []
    for angle, place in found:
        way = math.remainder(angle - float(exactly), 2.0 * math.pi)
        is_kind = place["kind"] in (FLAT, kind_of(told.rises, pair.side, is_circle))
        if is_kind and place["is_near"] == (pair.side > 0.0) and abs(way) <= FLAT_STRETCH_RAD:
            between = distance(float(exactly) + way * np.linspace(0.0, 1.0, 9))
            beside += [angle] * bool(np.ptp(between) <= ROUNDING * size)
    return beside


@pytest.mark.parametrize("name", PAIRS)
def test_no_place_is_missed_and_each_is_exact(name, cases, say):
    rng = np.random.default_rng(3)
    n_pairs, n_places, n_whole, missed, worst = cases(150, 20_000), 0, 0, [], 0.0
    for first in range(0, n_pairs, AT_ONCE):
        asked, answers, sampled = [], [], []
        for pair in range(first, min(first + AT_ONCE, n_pairs)):
            circle, other = PAIRS[name](rng)
            size = size_of(circle, other)
            flat_m = size * float(rng.choice([1e-13, 1e-11, 1e-9]))
            n_found, found, (along, around) = found_by(circle, other, flat_m)
            if n_found == WHOLE:
                around_it = Sampled([Asked(along, around)]).distance(np.linspace(-np.pi, np.pi, 4096))
                assert np.ptp(around_it) <= 2.0 * flat_m + 1e-14 * size, (pair, circle, other)
                n_whole += 1
                continue
            for side in (1.0, -1.0) if name == "circle" else (1.0,):
                sampled += changes(len(asked), Asked(along, around, side))
                asked.append(Asked(along, around, side))
                answers.append((pair, size, found))
        n_places += len(sampled)
        nearest, least, sizes = [], [], []
        for told, exactly in zip(sampled, stationary(asked, sampled), strict=True):
            pair, size, found = answers[told.index]
            one, is_circle = asked[told.index], name == "circle"
            near = near_to(told, one.side, is_circle, found)
            near = near or beside_on_a_flat_stretch(told, exactly, size, one, is_circle, found)
            if not near:
                missed.append((pair, told))
            elif told.rises:
                nearest.append(min(near, key=lambda angle, exactly=exactly: apart(angle, exactly)))
                least.append((told.index, exactly))
                sizes.append(size)
        exact = Sampled([asked[index] for index, _ in least], np.longdouble)
        theirs, ours = (exact.distance(np.array(at)) for at in (nearest, [at for _, at in least]))
        worst = max(worst, float((np.abs(theirs - ours) / sizes).max()))
    say(f"{name}: {n_places} sampled places of {n_pairs} pairs, {len(missed)} missed, least distances to {worst:.1e}")
    assert not missed
    assert worst < EXACT


@pytest.mark.parametrize("name", PAIRS)
def test_what_is_told_is_stationary_and_has_a_common_normal(name, cases):
    """The slope is zero, and the common normal leads from one place to the other, as far as the gap."""
    rng = np.random.default_rng(4)
    for pair in range(cases(60, 4000)):
        circle, other = PAIRS[name](rng)
        size = size_of(circle, other)
        n_found, found, (along, around) = found_by(circle, other, 1e-9 * size)
        for angle, place in found:
            if place["kind"] == FLAT:
                continue
            sampled = Sampled([Asked(along, around, 1.0 if place["is_near"] else -1.0)], np.longdouble)
            rho = float(sampled.from_axis(np.array([angle]))[0])
            if rho < 1e-6 * size:
                continue  # it crosses an axis
            turned_by = 1e-14 * size / rho if name == "circle" else 1e-14  # rounding turns the way across the axis
            assert abs(sampled.slope(np.array([angle]))[0]) < turned_by * size, (pair, n_found, place)
            if name == "circle":
                met = common_with_circle(circle, other, place["angle"], place["other_angle"])
            else:
                met = (common_with_line if name == "line" else common_with_round)(circle, other, angle)
            gap, normal = met.gap, np.array(met.normal)
            between = np.array(met.other_point) - np.array(met.point)
            assert abs(np.linalg.norm(normal) - 1.0) < 1e-14
            assert abs(normal @ between - gap) < EXACT * size
            shift = other.radius if name == "round" else 0.0
            told = sampled.distance(np.array([angle]))[0] - shift
            assert abs(abs(gap) - abs(told)) < EXACT * size, (pair, place)


@pytest.mark.parametrize("name", ["line", "round"])
def test_the_place_nearest_to_an_angle_is_the_nearest_of_all(name, cases, say):
    """Where one alone is told, it is the nearest of those where the distance is least."""
    rng, n_alone, n_asked = np.random.default_rng(5), 0, 0
    near = empty_rows(Place, 16)
    for _ in range(cases(100, 4000)):
        circle, other = PAIRS[name](rng)
        flat_m = 1e-9 * size_of(circle, other)
        n_found, found, _ = found_by(circle, other, flat_m)
        for angle, place in found:
            if place["kind"] != LEAST or any(row["kind"] == FLAT for _, row in found):
                continue
            asked = angle + float(rng.normal() * 10.0 ** rng.uniform(-6.0, 0.0))
            n_near = place_by_round_near(circle, other, asked, flat_m, near)
            least = [apart(at, asked) for at, row in found if row["kind"] == LEAST]
            told = [apart(float(near[k]["angle"]), asked) for k in range(n_near) if near[k]["kind"] == LEAST]
            assert abs(min(told) - min(least)) < 1e-7
            n_asked, n_alone = n_asked + 1, n_alone + (n_near == 1 < n_found)
    say(f"{name}: of {n_asked} places near an angle {n_alone} are told without the others")
    assert n_alone > 0


def test_a_point_and_a_plane_by_hand():
    places = empty_rows(Place, 2)
    assert places_by_point(UNIT, (0.0, 2.0, 0.0), 1e-9, places) == 2
    assert [place["angle"] for place in places] == pytest.approx([math.pi / 2.0, -math.pi / 2.0])
    assert [common_with_point(UNIT, (0.0, 2.0, 0.0), place["angle"]).gap for place in places] == pytest.approx(
        [1.0, 3.0]
    )
    assert places_by_point(UNIT, (1e-10, 0.0, 5.0), 1e-9, places) == WHOLE
    slanted = (0.6, 0.0, 0.8)
    assert places_by_plane(UNIT, slanted, 1e-9, places) == 2
    gaps = [common_with_plane(UNIT, (0.0, 0.0, -1.0), slanted, place["angle"]).gap for place in places]
    assert gaps == pytest.approx([0.2, 1.4], abs=1e-15)
    assert places_by_plane(UNIT, (0.0, 0.0, -1.0), 1e-9, places) == WHOLE


def test_a_circle_around_a_torus_is_equally_far():
    """Parallels, meridians and Villarceau's circles of a torus are equally far from its core circle."""
    places, size = empty_rows(Place, 16), 0.3
    for around in (
        Circle((0.0, 0.0, size), UNIT.axis, UNIT.toward, 1.0),
        Circle((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), UNIT.toward, size),
        Circle((size, 0.0, 0.0), (0.0, size, math.sqrt(1.0 - size * size)), UNIT.toward, 1.0),
    ):
        assert places_by_circle(UNIT, around, 1e-9, places) == WHOLE


def test_a_line_that_touches_a_circle_in_its_plane_is_met_at_one_place():
    places = empty_rows(Place, 16)
    tangent = Round((1.0, 3.0, 0.0), (0.0, 1.0, 0.0), 0.0, 0.0)
    n_places = places_by_round(UNIT, tangent, 1e-9, places)
    assert [place["kind"] for place in places[:n_places]].count(LEAST) == 1
    at = next(float(place["angle"]) for place in places[:n_places] if place["kind"] == LEAST)
    assert abs(at) < 1e-7
    met = common_with_line(UNIT, tangent, at)
    assert abs(met.gap) < 1e-14
