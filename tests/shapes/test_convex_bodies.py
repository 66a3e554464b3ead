"""The oracle `convex_bodies` agrees with SciPy."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog, nnls

from cagepose import Pose
from shapes.convex_bodies import Body, body_of, nearest, random_part, random_turn, separation


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


def test_gaps_agree_with_least_squares_and_a_linear_program(cases):
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
