"""Small dense algebra of the kernels, against NumPy, SciPy and differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from cagepose.kernels.algebra.dense import add_across, cholesky, confine, solve_lower, solve_upper
from cagepose.kernels.algebra.least_distance import shortest_inside
from cagepose.kernels.algebra.least_squares import PassiveSet, append_column, clear, empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.algebra.second_order import add_coupling, add_turned_arm


def held_columns(columns: np.ndarray) -> PassiveSet:
    held = empty_record(PassiveSet)
    clear(held, 6, 1.0)
    for label, column in enumerate(columns):
        append_column(held, column, label, 0.0)
    return held


def test_choleskys_factor_solves_and_a_matrix_that_is_not_positive_has_none():
    rng = np.random.default_rng(1)
    root, b = rng.normal(size=(6, 6)), rng.normal(size=6)
    factor, x = root @ root.T, np.zeros(6)
    assert cholesky(factor, 0.0, 6)
    solve_lower(factor, b, x, 6)
    solve_upper(factor, x, 6)
    assert root @ root.T @ x == pytest.approx(b, rel=1e-9)
    assert not cholesky(np.diag([1.0, 1, 1, 1, 1, -1e-9]), 0.0, 6)


def test_a_confined_matrix_solves_along_what_the_columns_leave_free():
    rng = np.random.default_rng(2)
    columns, matrix = rng.normal(size=(3, 6)), rng.normal(size=(6, 6))
    matrix = matrix + matrix.T
    q, _ = np.linalg.qr(columns.T)
    projection = np.eye(6) - q @ q.T
    confined = matrix.copy()
    held = held_columns(columns)
    assert confine(confined, held) == pytest.approx(np.linalg.norm(projection @ matrix @ projection))
    assert confined == pytest.approx(projection @ matrix @ projection, abs=1e-13)
    add_across(confined, held, 2.0)
    slope = projection @ rng.normal(size=6)
    assert columns @ np.linalg.solve(confined, slope) == pytest.approx(0, abs=1e-12)


def test_the_second_derivatives_of_a_gap_are_those_of_its_differences():
    """The gap n . exp(-w) (d - t) of a point at d to a plane that turns and travels, about axes of any radii (7.3)."""
    rng = np.random.default_rng(3)
    normal, arm, radii = rng.normal(size=3), rng.normal(size=3), rng.uniform(0.5, 2, 3)
    axes = Rotation.random(random_state=4).as_matrix()
    found = np.zeros((6, 6))
    rows = tuple(tuple(row) for row in axes.tolist())
    add_turned_arm(tuple(normal), tuple(arm), 1.0, rows, tuple(radii), found)
    add_coupling(tuple(normal), 1.0, rows, tuple(radii), found)

    def gap(y: np.ndarray) -> float:
        return float(normal @ Rotation.from_rotvec(-axes.T @ (y[3:] / radii)).apply(arm - y[:3]))

    h = 1e-4
    steps = h * np.eye(6)
    for i, one in enumerate(steps):
        for k, other in enumerate(steps):
            mixed = gap(one + other) - gap(one - other) - gap(other - one) + gap(-one - other)
            assert found[i, k] == pytest.approx(mixed / (4 * h * h), abs=1e-6)


def test_the_shortest_vector_inside_agrees_with_slsqp():
    rng = np.random.default_rng(5)
    for _ in range(20):
        rows, offset = rng.normal(size=(12, 6)), rng.normal(size=6)
        bounds = rows @ offset + rng.uniform(0, 0.5, 12)
        bounds[-1] = np.inf
        x = np.zeros(6)
        assert shortest_inside(rows, bounds, empty_system(12), empty_record(PassiveSet), x)
        assert (rows @ x - bounds).max() < 1e-12
        known = minimize(
            lambda v: v @ v,
            offset,
            jac=lambda v: 2 * v,
            constraints={"type": "ineq", "fun": lambda v, r=rows[:-1], b=bounds[:-1]: b - r @ v},
            method="SLSQP",
            options={"ftol": 1e-14},
        )
        assert np.linalg.norm(x) == pytest.approx(np.linalg.norm(known.x), rel=1e-6)


def test_inequalities_that_contradict_each_other_allow_no_vector():
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [-1.0, 0, 0, 0, 0, 0]])
    assert not shortest_inside(rows, np.array([1.0, -2.0]), empty_system(2), empty_record(PassiveSet), np.zeros(6))
