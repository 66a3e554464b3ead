"""A hull cut into pieces that lie flush is that hull."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from boundary.boundary_checks import faults_of_surface
from boundary.drawn_hulls import SIZE_M, cut, drawn_hull
from boundary.same_features import differences
from cagepose import Pose
from cagepose.model.boundary.convex_pieces import piece_of_hull
from cagepose.model.boundary.union import union_of
from cagepose.model.hull import hull_of

TOUCH_M = 1e-9 * SIZE_M
Cases = Callable[[int, int], int]


def test_the_pieces_of_a_hull_give_back_its_own_features(cases: Cases) -> None:
    for case in range(cases(40, 2000)):
        rng = np.random.default_rng((case, 1))
        hull = drawn_hull(rng)
        whole = union_of([piece_of_hull(hull, Pose(), 0)], TOUCH_M)
        pieces = [piece_of_hull(hull_of(corners), Pose(), 0) for corners in cut(hull, int(rng.integers(1, 9)), rng)]
        found = union_of(pieces, TOUCH_M)
        assert not faults_of_surface(found, TOUCH_M), case
        assert not differences(found, whole, 1e-9 * SIZE_M), case
        assert found.faces.is_convex.all(), case


def test_pieces_shifted_within_the_touch_tolerance_give_back_the_hull(cases: Cases) -> None:
    for case in range(cases(40, 2000)):
        rng = np.random.default_rng((case, 2))
        hull = drawn_hull(rng)
        whole = union_of([piece_of_hull(hull, Pose(), 0)], TOUCH_M)
        shift_m = 10.0 ** rng.uniform(-14.0, -12.0)
        pieces = cut(hull, int(rng.integers(1, 9)), rng)
        shifts = [Pose(shift_m * rng.standard_normal(3)) for _ in pieces]
        shifted = [piece_of_hull(hull_of(corners), by, 0) for corners, by in zip(pieces, shifts, strict=True)]
        found = union_of(shifted, TOUCH_M)
        assert not faults_of_surface(found, TOUCH_M), case
        assert not differences(found, whole, 1e-9 * SIZE_M), case
