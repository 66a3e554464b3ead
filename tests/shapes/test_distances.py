"""How far apart parts are, and where they touch, against `convex_bodies`; and that oracle against SciPy."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog, nnls

from cagepose import Pose
from cagepose.kernels.collision.geometry import Geometry, Placement, empty_placement, place_object
from cagepose.kernels.shapes.features import Shapes
from cagepose.model.features import shapes_of
from shapes.convex_bodies import Body, body_of, gap, nearest, placed_at, random_part, random_turn, separation

TOUCH, RESOLUTION = 1e-9, 1e-12
"""Fractions of the size of the greater body, as in runs."""
WITHIN = 8.0
"""Touch tolerances: what touches may be told to be nearer by so much, at corners of slender parts."""
GAPS = np.array([0, 0, 0.5, -0.5, 0.9, -0.9, 1, -1, 3, -3, 100, -100, 1e4, -1e4, 1e6, -1e6, 1e8, 3e8])
N_PARTS = 80


def geometry_of(held: Shapes, cage: Shapes, touch_m: float) -> Geometry:
    none = np.zeros((0, 3))
    return Geometry(none, none, np.zeros((0, 3, 3)), 0, none, held, cage, touch_m)


def placed(geometry: Geometry, pose: Pose) -> Placement:
    placement = empty_placement(geometry)
    place_object(geometry, *pose.as_tuples(), placement)
    return placement


def random_offset(rng: np.random.Generator) -> np.ndarray:
    """Any direction, or along an axis, a diagonal, ..."""
    if rng.random() < 0.6:
        return rng.normal(size=3)
    return rng.choice([-1.0, 0.0, 1.0], 3) + np.array((0.0, 1e-9, 0.0))


def overlap(one: Body, other: Body) -> bool:
    """Whether cores have a point in common: a linear program in the weights of their corners."""
    n, m = len(one.corners), len(other.corners)
    rows = np.zeros((5, n + m))
    rows[:3, :n], rows[:3, n:] = one.corners.T, -other.corners.T
    rows[3, :n] = rows[4, n:] = 1.0
    return linprog(np.zeros(n + m), A_eq=rows, b_eq=[0, 0, 0, 1, 1], method="highs").status == 0


def least_distance(one: Body, other: Body) -> float:
    """Distance of cores: least squares in the weights of their corners, which are held to sums of one."""
    weight = 1e4 * (one.size + other.size + float(np.linalg.norm(one.corners[0] - other.corners[0])))
    n, m = len(one.corners), len(other.corners)
    rows = np.zeros((5, n + m))
    rows[:3, :n], rows[:3, n:] = one.corners.T, -other.corners.T
    rows[3, :n] = rows[4, n:] = weight
    shares, _ = nnls(rows, np.array([0, 0, 0, weight, weight]))
    return float(np.linalg.norm(rows[:3] @ shares))


def test_the_oracle_agrees_with_least_squares_and_a_linear_program(cases):
    rng = np.random.default_rng(1)
    for _ in range(cases(100, 2000)):
        one, other = body_of(random_part(rng)), body_of(random_part(rng))
        one = one.at(Pose(rng.uniform(-0.8, 0.8, 3), random_turn(rng)))
        apart = separation(one, other)
        size = max(one.size, other.size)
        if apart > 1e-6 * size:
            assert abs(nearest(one, other)[0] - least_distance(one, other)) < 1e-6 * max(size, apart)
            assert apart <= nearest(one, other)[0] + 1e-14 * size
        if abs(apart) > 1e-6 * size:
            assert overlap(one, other) == (apart < 0.0)


def test_gaps_are_distances_and_tell_what_touches(cases, say):
    rng = np.random.default_rng(2)
    parts = [
        random_part(rng, Pose(rng.uniform(-0.3, 0.3, 3), random_turn(rng)) if rng.random() < 0.5 else None)
        for _ in range(N_PARTS)
    ]
    bodies, features = [body_of(part) for part in parts], [shapes_of([part]) for part in parts]
    seen = {"apart": 0, "touching": 0, "overlapping": 0}
    worst = {"too far": 0.0, "too near": 0.0}
    n_pairs = cases(400, 40_000)
    for _ in range(n_pairs):
        i, j = rng.integers(N_PARTS, size=2)
        size = max(bodies[i].size, bodies[j].size)
        touch_m = TOUCH * size
        if rng.random() < 0.1:
            pose = Pose(rng.uniform(-0.5, 0.5, 3), random_turn(rng))
        else:
            away = float(rng.choice(GAPS)) * touch_m
            pose = placed_at(bodies[i], bodies[j], random_turn(rng), random_offset(rng), away)
        meetings = placed(geometry_of(features[i], features[j], touch_m), pose).meetings
        found, true = float(meetings.gaps[0, 0]), gap(bodies[i].at(pose), bodies[j])
        told = f"parts {i} and {j} at {pose}: {found}, not {true}"
        assert np.isfinite(found), told
        if true > touch_m:
            seen["apart"] += 1
            assert found <= true + RESOLUTION * size, told
            assert found > 0.0 or true < WITHIN * touch_m, told
        elif true >= -touch_m:
            seen["touching"] += 1
            worst["too far"] = max(worst["too far"], (found - true) / size)
            worst["too near"] = max(worst["too near"], (true - found) / touch_m)
            assert meetings.used[0] > 0 or abs(true) > 0.9 * touch_m, told
        else:
            seen["overlapping"] += 1
            assert found < -0.5 * touch_m, told
    assert worst["too far"] < RESOLUTION
    assert worst["too near"] < WITHIN
    say(
        f"distances of {n_pairs} pairs: {seen}; where they touch, at most {worst['too far']:.1e} sizes too far and"
        f" {worst['too near']:.1f} touch tolerances too near"
    )
