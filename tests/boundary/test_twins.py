"""Features that meet at one place with one normal: what bends least is kept, and what bends most noted beside it."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.kernels.boundary.bend import bends_by, curvatures
from cagepose.kernels.boundary.met import Meeting
from cagepose.model.shapes import Capsule, Convex, Disc, Sphere
from shapes.convex_bodies import CUBE

TOUCH_M = 1e-9
ROUNDED = Convex(CUBE * (1.0, 1.0, 1.0), 0.25)
FLOOR = Box((6.0, 6.0, 1.0), Pose((0, 0, -0.5)))


def bends(asked: Asked, i: int, j: int, row) -> float:
    met = Meeting(True, float(row["gap"]), tuple(row["normal"].tolist()), tuple(row["place"].tolist()))
    around = bool(row["before"] + row["after"] > 0.0)
    return bends_by(curvatures(asked.held, i, asked.cage, j, met, around))


@pytest.mark.parametrize("swap", [False, True])
def test_a_ball_where_a_flat_top_ends_in_a_round_edge(swap):
    """The ball of radius r meets the face, which bends by 1/r no more, and the edge and the corner of radius R."""
    height = 1.25 + 0.4
    for x, y, most in ((0.2, 0.3, None), (1.0, 0.3, 1.0 / 0.65), (1.0, 1.0, 2.0 / 0.65)):
        at = Pose((x, y, height))
        asked = Asked([ROUNDED], [Sphere(0.4)], TOUCH_M) if swap else Asked([Sphere(0.4)], [ROUNDED], TOUCH_M)
        found = asked.place(at.inverse() if swap else at)
        (row,) = found.rows[: found.used[0]]
        assert bends(asked, row["feature"], row["cage_feature"], row) == pytest.approx(0.0, abs=1e-12)
        if most is None:
            assert row["twin"] == row["cage_twin"] == -1
        else:
            assert bends(asked, row["twin"], row["cage_twin"], row) == pytest.approx(most)


def test_a_bar_across_another_one_ends_at_its_middle():
    """A capsule's end is on the line of another one: its line crosses that, and its end bends away from it."""
    asked = Asked([Capsule(0.2, 1.0)], [Capsule(0.3, 2.0, Pose((0, 0, 0), euler_zyx=(0, np.pi / 2, 0)))], TOUCH_M)
    found = asked.place(Pose((0.0, 0.5, 0.5), euler_zyx=(0.0, 0.0, np.pi / 2)))
    (row,) = found.rows[: found.used[0]]
    assert bends(asked, row["feature"], row["cage_feature"], row) == pytest.approx(0.0, abs=1e-12)
    assert bends(asked, row["twin"], row["cage_twin"], row) == pytest.approx(2.0)


def test_sharp_features_have_no_twin():
    asked = Asked([Box((1.0, 1.0, 1.0))], [FLOOR], TOUCH_M)
    for pose in (Pose((0, 0, 0.5)), Pose((3.0, 0, 0.5)), Pose((3.0, 3.0, 0.5))):
        found = asked.place(pose)
        assert (found.rows["twin"][: found.used[0]] == -1).all()


def test_a_disc_whose_rim_is_along_the_top_of_a_roller():
    """Its rim, flat there as an edge is, has the roller's direction: only across that the roller bends."""
    roller = Capsule(0.3, 2.0, Pose((0, 0, 0), euler_zyx=(0, np.pi / 2, 0)))
    asked = Asked([Disc(0.5)], [roller], TOUCH_M)
    found = asked.place(Pose((0.1, 0.5, 0.3)))
    (row,) = found.rows[: found.used[0]]
    np.testing.assert_allclose(row["place"], (0.1, 0.0, 0.3), atol=1e-4)
    met = Meeting(True, 0.0, (0.0, 0.0, -1.0), (0.1, 0.0, 0.3))
    told = curvatures(asked.held, row["feature"], asked.cage, row["cage_feature"], met, False)
    np.testing.assert_allclose(told.relative, np.diag([0.0, 1.0 / 0.3, 0.0]), atol=1e-12)
    np.testing.assert_allclose(told.parallel, np.diag([0.3, 0.0, 0.0]), atol=1e-12)
