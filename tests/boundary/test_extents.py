"""What is told to be far apart is: boxes around features, circles as a whole, against places all along them."""

from __future__ import annotations

import numpy as np

from boundary.asked import Asked
from boundary.drawn_plates import random_peg, random_plate
from cagepose import Box, Convex, Pose
from cagepose.kernels.algebra.pose import quaternion_about
from cagepose.kernels.boundary import meetings
from cagepose.kernels.boundary.extents import circle_apart, extent_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, place_feature
from cagepose.kernels.boundary.touching import empty_meetings

ANGLES = np.linspace(0.0, 2.0 * np.pi, 721)


def random_parts(rng: np.random.Generator) -> tuple[Asked, Pose]:
    """A peg over, in or beside the hole of a plate, or a rounded block on a box; and a pose near what they touch at."""
    if rng.random() < 0.25:
        held, cage = Convex(rng.normal(size=(8, 3)), float(rng.choice([0.0, 0.2]))), [Box((2.0, 1.5, 1.0))]
        return Asked([held], cage, 1e-9), Pose(rng.uniform(-2.0, 2.0, size=3), random_turn(rng))
    cage, _, radius = random_plate(rng)
    tilt = random_turn(rng) if rng.random() < 0.5 else quaternion_about((1.0, 0.0, 0.0), float(rng.normal() * 0.05))
    place = (*rng.normal(size=2) * 0.1 * radius, rng.uniform(-0.5, 1.5))
    return Asked([random_peg(rng, radius)], cage, 1e-9), Pose(place, tilt)


def random_turn(rng: np.random.Generator) -> np.ndarray:
    turn = rng.normal(size=4)
    return turn / np.linalg.norm(turn)


def points_of(feature) -> np.ndarray:
    """Places along the core of a feature that is no face, (n, 3)."""
    point, direction = np.array(feature.point), np.array(feature.direction)
    if feature.kind == VERTEX:
        return point[None]
    if feature.kind == LINE:
        return point + np.linspace(0.0, feature.length, 99)[:, None] * direction
    toward = np.array(feature.toward)
    around = np.cos(ANGLES)[:, None] * toward + np.sin(ANGLES)[:, None] * np.cross(direction, toward)
    return point + feature.length * around


def least_gap(points: np.ndarray, other) -> float:
    """How far points are at least from a feature that goes on without end."""
    seen, along = points - np.array(other.point), np.array(other.direction)
    heights = seen @ along
    if other.kind == VERTEX:
        return float(np.linalg.norm(seen, axis=1).min() - other.radius)
    if other.kind == FACE:
        return float(heights.min() - other.radius)
    rho = np.linalg.norm(seen - heights[:, None] * along, axis=1)
    if other.kind == CIRCLE:
        return float(np.hypot(heights, rho - other.length).min() - other.radius)
    sense = -1.0 if other.radius < 0.0 else 1.0
    return float((sense * np.sqrt(1.0 - other.taper**2) * rho + other.taper * heights).min() - other.radius)


def test_no_place_of_a_circle_is_nearer_than_the_circle_as_a_whole_and_none_is_out_of_its_box(cases, say):
    rng, n_asked, nearest = np.random.default_rng(12), 0, np.inf
    for _ in range(cases(60, 4000)):
        asked, pose = random_parts(rng)
        asked.place(pose)
        for body in (asked.held, asked.cage):
            for i in range(len(body.features)):
                place_feature(body, i)
        for body, beside in ((asked.held, asked.cage), (asked.cage, asked.held)):
            for circle in body.features:
                if circle.kind != FACE:
                    box, points = extent_of(circle), points_of(circle)
                    inside = np.array(box.half) - abs(circle.radius) - np.abs(points - np.array(box.middle))
                    assert inside.min() > -1e-12
                if circle.kind != CIRCLE:
                    continue
                for other in beside.features:
                    gap = least_gap(points_of(circle), other) - circle.radius
                    apart = circle_apart(circle, other)
                    assert apart <= gap + 1e-12
                    n_asked, nearest = n_asked + 1, min(nearest, gap - apart)
    say(f"{n_asked} circles beside features are no nearer than told, and down to {nearest:.1e} farther")


def test_what_is_told_apart_touches_nothing(cases, monkeypatch):
    """The same meetings are found if nothing is told apart."""
    rng, n_found = np.random.default_rng(13), 0
    for _ in range(cases(40, 1000)):
        asked, pose = random_parts(rng)
        asked.place(pose)
        found = []
        for tells in (True, False):
            with monkeypatch.context() as patched:
                if not tells:
                    patched.setattr(meetings, "surely_apart", lambda *_: -np.inf)
                rows = empty_meetings(max(len(asked.held.features), len(asked.cage.features)))
                meetings.find_meetings(asked.held, asked.cage, 1e-3, rows)
                found.append([(row.feature, row.cage_feature, row.gap) for row in rows.rows[: rows.used[0]]])
        assert found[0] == found[1]
        n_found += len(found[0])
    assert n_found > 0
