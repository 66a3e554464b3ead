"""Linear programs with six unknowns, against HiGHS."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from cagepose.kernels.algebra.linear_program import (
    INFEASIBLE,
    OPTIMAL,
    UNBOUNDED,
    Program,
    program_rows,
    solve_program,
)
from cagepose.kernels.algebra.program_bound import extents
from cagepose.kernels.algebra.record import empty_record

HIGHS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}


def program_of(objective: np.ndarray) -> Program:
    program = empty_record(Program)
    program.objective[:] = objective
    return program


def random_program(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Often degenerate: small whole numbers, bounds of zero, rows given twice, objectives along an axis."""
    n_rows = int(rng.integers(3, 40))
    if rng.random() < 0.5:
        rows = rng.integers(-1, 2, (n_rows, 6)).astype(float)
        bounds = rng.integers(0, 3, n_rows).astype(float)
    else:
        rows = rng.normal(size=(n_rows, 6))
        bounds = rng.uniform(0, 1, n_rows) * (rng.random(n_rows) < 0.8)
    if rng.random() < 0.3:
        rows = np.vstack([rows, rows[:2]])
        bounds = np.concatenate([bounds, bounds[:2]])
    is_axis = rng.random() < 0.5
    objective = np.eye(6)[rng.integers(6)] * rng.choice([-1.0, 1.0]) if is_axis else rng.normal(size=6)
    return rows, bounds, objective / np.abs(objective).max()


def test_maxima_agree_with_highs(cases):
    rng = np.random.default_rng(1)
    unbounded = 0
    for _ in range(cases(300, 1500)):
        rows, bounds, objective = random_program(rng)
        program = program_of(objective)
        outcome = solve_program(rows, bounds, program)
        known = linprog(-objective, A_ub=rows, b_ub=bounds, bounds=(None, None), method="highs-ds", options=HIGHS)
        if known.status == 0:
            assert outcome == OPTIMAL
            assert float(objective @ program.x) == pytest.approx(-known.fun, abs=1e-9)
            assert program.passive.x[: program.passive.used].min() >= -1e-11
        else:
            assert known.status in (2, 3)  # HiGHS says "infeasible or unbounded"; zero is feasible
            assert outcome == UNBOUNDED
            assert (rows @ program.ray).max() <= 1e-10
            assert objective @ program.ray > 0
            unbounded += 1
    assert unbounded > 10


def test_a_program_that_nothing_satisfies_is_named():
    rows = np.array([[1.0, 0, 0, 0, 0, 0], [-1.0, 0, 0, 0, 0, 0]])
    assert solve_program(rows, np.array([1.0, -2.0]), program_of(np.eye(6)[1])) == INFEASIBLE


def test_a_basis_of_an_earlier_program_gives_the_same_maximum(cases):
    rng = np.random.default_rng(2)
    cold, warm = 0, 0
    for _ in range(cases(100, 300)):
        rows, bounds, objective = rng.normal(size=(40, 6)), rng.uniform(0.1, 1, 40), rng.normal(size=6)
        program = program_of(objective)
        if solve_program(rows, bounds, program) != OPTIMAL:
            continue
        cold += program.n_pivots
        rows += 1e-3 * rng.normal(size=rows.shape)
        fresh = program_of(objective)
        assert solve_program(rows, bounds, program) == solve_program(rows, bounds, fresh) == OPTIMAL
        assert float(objective @ program.x) == pytest.approx(float(objective @ fresh.x), rel=1e-12)
        warm += program.n_pivots
    assert warm < 0.2 * cold


def test_the_extents_of_a_slanted_box_that_is_open_on_one_side():
    """|x_1 + x_2| <= 2, |x_2| <= 1, -3 <= x_3, all else within 1: x_1 reaches 3, x_3 has no greatest value."""
    rows, bounds = program_rows(12)
    rows[0, :2], rows[1, :2] = (1, 1), (-1, -1)
    bounds[:2] = 2
    for i, k in enumerate((1, 3, 4, 5)):
        rows[2 + 2 * i, k], rows[3 + 2 * i, k] = 1, -1
        bounds[2 + 2 * i : 4 + 2 * i] = 1
    rows[10, 2], bounds[10] = -1, 3
    rows[11, 2], bounds[11] = 1, np.inf  # does not count
    least, greatest = np.zeros(6), np.zeros(6)
    assert extents(rows, bounds, empty_record(Program), least, greatest)[0] == OPTIMAL
    assert greatest == pytest.approx([3, 1, np.inf, 1, 1, 1])
    assert least == pytest.approx([-3, -1, -3, -1, -1, -1])
