"""Bounds from multipliers: never below the maximum, whatever the solution's rounding."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from cagepose.kernels.algebra.linear_program import OPTIMAL, Program, solve_program
from cagepose.kernels.algebra.program_bound import dual_bound
from cagepose.kernels.algebra.record import empty_record


def solved(rows: np.ndarray, bounds: np.ndarray, objective: np.ndarray) -> Program | None:
    program = empty_record(Program)
    program.objective[:] = objective
    return program if solve_program(rows, bounds, program) == OPTIMAL else None


def random_box(rng: np.random.Generator, spread: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of about one around the origin, some of them nearly the same: ill-conditioned corners."""
    rows = rng.normal(size=(30, 6)) / 3
    rows[15:] = rows[:15] + spread * rng.normal(size=(15, 6))
    rows = np.vstack([rows, np.eye(6), -np.eye(6)])
    return rows, rng.uniform(0.001, 0.02, len(rows)), np.eye(6)[rng.integers(6)]


def test_no_point_inside_passes_the_bound_and_it_is_tight(cases):
    rng = np.random.default_rng(3)
    for _ in range(cases(100, 300)):
        rows, bounds, objective = random_box(rng, 10.0 ** rng.uniform(-9, 0))
        program = solved(rows, bounds, objective)
        assert program is not None
        bound, left_over = dual_bound(rows, bounds, program)
        assert left_over < 1e-7
        # The solution itself, pulled towards the origin until it is inside exactly, is a witness.
        corner = program.x * (1 - 1e-9)
        exact = [sum(Fraction(a) * Fraction(x) for a, x in zip(row, corner, strict=True)) for row in rows.tolist()]
        if all(value <= Fraction(limit) for value, limit in zip(exact, bounds.tolist(), strict=True)):
            value = sum(Fraction(f) * Fraction(x) for f, x in zip(objective.tolist(), corner.tolist(), strict=True))
            assert value <= Fraction(bound) + Fraction(left_over) * Fraction(0.02)
            assert float(value) >= bound * (1 - 1e-6)


def test_wrong_multipliers_still_give_a_bound(cases):
    """Multipliers that are off by a tenth miss part of the objective, and pay for it."""
    rng = np.random.default_rng(4)
    for _ in range(cases(50, 100)):
        rows, bounds, objective = random_box(rng, 0.1)
        program = solved(rows, bounds, objective)
        assert program is not None
        maximum = float(objective @ program.x)
        program.passive.x[:6] *= rng.uniform(0.9, 1.1, 6)
        bound, left_over = dual_bound(rows, bounds, program)
        assert bound + left_over * 0.02 >= maximum
