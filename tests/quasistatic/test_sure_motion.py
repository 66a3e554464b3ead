"""The short proof that contacts do not balance a load, against the full problem with round cones and by its own terms.

Contact sets are those of `test_only_onset`; half of the loads are such that some forces inside the cones balance them,
some of them only just, and the rest are any.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from cagepose.kernels.algebra.least_squares import rounding_scale
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.cone import BALANCED, HELD, ConeWorkspace, clear_cone, cone_residual
from cagepose.kernels.contact.metric import WRENCH
from cagepose.kernels.contact.separation import SURELY, WIDER, leaves_cones, separating_twist
from inner_kernels import as_machine_code
from quasistatic.test_only_onset import Held, contacts_of, random_held


class Judge:
    """Both ways to ask, of one contact set and load after the other."""

    def __init__(self) -> None:
        self.room = empty_record(ConeWorkspace)
        self._solve = as_machine_code(cone_residual)

    def left(self, case: Held, friction: float) -> float:
        """What the contacts leave of the load, in lengths of the terms."""
        contacts = contacts_of(case)
        clear_cone(self.room, case.load, WRENCH, 1.0)
        left = self._solve(contacts.rows, contacts.used[0], friction, case.load, np.bool_(False), self.room)
        return left / rounding_scale(self.room.passive)

    def moves(self, case: Held) -> bool:
        self.left(case, 0.0)
        contacts = contacts_of(case)
        return bool(separating_twist(contacts.rows, contacts.used[0], case.friction, case.load, self.room))

    def leaves(self, case: Held, twist: np.ndarray, slack: float) -> bool:
        contacts = contacts_of(case)
        return bool(leaves_cones(contacts.rows, contacts.used[0], case.friction, slack, twist))


@pytest.fixture(scope="module")
def judge() -> Judge:
    return Judge()


def random_case(random: np.random.Generator) -> Held:
    case = random_held(random)
    if random.random() < 0.5:
        return case
    away = random.normal(size=7) * 10.0 ** random.uniform(-12, 0.5)
    load = np.where(np.arange(7) < 6, case.load + away, 0.0)
    return case._replace(load=load / np.linalg.norm(load))


def test_what_it_says_moves_has_no_balance_and_its_twist_shows_it(
    judge: Judge, cases: Callable[[int, int], int], say: Callable[[str], None]
) -> None:
    random, n_moving, n_sure = np.random.default_rng(0), 0, 0
    n_cases = cases(400, 4000)
    for _ in range(n_cases):
        case = random_case(random)
        is_sure, twist = judge.moves(case), judge.room.passive.residual[:6].copy()
        if is_sure:
            assert case.load[:6] @ twist > SURELY * np.linalg.norm(twist)
            normal, tangential = case.columns[:, 0] @ twist, case.columns[:, 1:] @ twist
            resists = normal + case.friction * np.linalg.norm(tangential, axis=1)
            assert (resists <= 1e-13 * np.linalg.norm(case.columns[:, 0], axis=1)).all()
            assert judge.left(case, case.friction) > HELD
        if judge.left(case, case.friction) > 1e-3 and judge.left(case, WIDER * case.friction) > 1e-3:
            n_moving += 1
            n_sure += is_sure
    say(f"{n_moving} loads that nothing balances, not even with wider cones: {n_sure} of them shown")
    assert n_moving > n_cases // 20
    assert n_sure > 0.95 * n_moving


def test_a_twist_that_a_force_resists_is_no_proof(judge: Judge, cases: Callable[[int, int], int]) -> None:
    random = np.random.default_rng(1)
    for _ in range(cases(100, 300)):
        case = random_held(random)
        twist = random.normal(size=6)
        normal, tangential = case.columns[:, 0] @ twist, case.columns[:, 1:] @ twist
        resists = normal + case.friction * np.linalg.norm(tangential, axis=1)
        assert judge.leaves(case, twist, 0.0) == bool((resists <= 0.0).all())


def test_balanced_loads_are_never_said_to_move(judge: Judge, cases: Callable[[int, int], int]) -> None:
    random = np.random.default_rng(2)
    for _ in range(cases(200, 2000)):
        case = random_held(random)
        if judge.left(case, case.friction) <= BALANCED:
            assert not judge.moves(case)
