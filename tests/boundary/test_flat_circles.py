"""Circles that lie on part of a face: their arcs, against places that are asked one by one whether they are over it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.kernels.boundary.circle import circle_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, OUTSIDE, SEGMENT
from cagepose.kernels.boundary.reach import beyond_face
from cagepose.kernels.circles.places import on_circle
from cagepose.model.boundary import features
from cagepose.model.boundary.convex_pieces import piece_of_box
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Cylinder

TOUCH_M, FAR = 1e-9, math.pi / 4.0
TILT = Pose((0.3, -0.2, 0.7), (0.9, 0.3, -0.4, 0.2))
ROD = Cylinder(0.5, 2.0)
STANDING = TILT @ Pose((0, 0, 1.0))
PRISM = [(x, y, z) for x, y in ((-0.6, -0.5), (0.7, -0.4), (0.1, 0.55)) for z in (-1.0, 0.0)]


def under(x: float, y: float, wide: float, deep: float) -> Box:
    """A box with its upper face at a height of zero, before all is tilted."""
    return Box((wide, deep, 1.0), TILT @ Pose((x, y, -0.5)), name=f"under {x} {y}")


L_SHAPE = [under(0.0, -0.6, 2.0, 0.8), under(-0.6, 0.4, 0.8, 1.2)]
COMB = [under(0.0, -1.0, 3.0, 1.2), *(under(x, 0.3, 0.12, 1.4) for x in (-0.4, -0.1, 0.2, 0.47))]
PLATE = under(0.0, 0.0, 2.0, 2.0)
PIERCED = [PLATE, Hole(0.3, 1.0, None, [PLATE.name], TILT @ Pose((0.35, 0.1, 0)))]
SCENES = {  # what it stands on, and how many arcs
    "a smaller box": ([under(0.0, 0.0, 0.8, 0.8)], 4),
    "half over an edge": ([under(1.0, 0.0, 2.0, 2.0)], 1),
    "a narrow bar": ([under(0.05, 0.0, 0.2, 3.0)], 2),
    "a bar that ends": ([under(0.05, 1.0, 0.2, 2.0)], 1),
    "a corner": ([under(1.1, 1.2, 2.0, 2.0)], 1),
    "a prism": ([Convex(PRISM, 0.0, TILT)], 3),
    "an L": (L_SHAPE, 1),
    "a comb": (COMB, 6),
    "a hole in a plate": (PIERCED, 2),
    "a larger box": ([under(0.0, 0.0, 3.0, 3.0)], 1),
}


class Arc(NamedTuple):
    first: float
    last: float


def arcs_by_sampling(circle, body, face: int, n: int = 1440) -> list[Arc]:
    """Return the arcs of a whole circle over a face, the ends by bisection; one that passes zero ends beyond a turn."""

    def is_over(angle: float) -> bool:
        return bool(beyond_face(body, face, on_circle(circle_of(circle), angle).point) <= 0.0)

    def end_between(one: float, other: float) -> float:
        inside = is_over(one)
        for _ in range(60):
            middle = 0.5 * (one + other)
            one, other = (middle, other) if is_over(middle) == inside else (one, middle)
        return 0.5 * (one + other)

    angles = (np.arange(n + 1) + 0.123) * (2.0 * math.pi / n)
    inside = [is_over(angle) for angle in angles]
    inside[-1] = inside[0]
    if all(inside):
        return [Arc(0.0, 2.0 * math.pi)]
    ends = [end_between(angles[k], angles[k + 1]) for k in range(n) if inside[k] != inside[k + 1]]
    if inside[0]:
        ends = [*ends[1:], ends[0] + 2.0 * math.pi]
    return [Arc(*pair) for pair in zip(ends[::2], ends[1::2], strict=True)]


def all_along(asked: Asked):
    rows = asked.found.rows[: asked.found.used[0]]
    return rows[rows["before"] + rows["after"] > 0.0]


def flat_rows(asked: Asked, pose: Pose):
    """Yield a circle, the body and the index of a face that it touches along arcs, and the rows of these."""
    asked.place(pose)
    rows = all_along(asked)
    for i, j in sorted(set(zip(rows["feature"].tolist(), rows["cage_feature"].tolist(), strict=True))):
        mine = rows[(rows["feature"] == i) & (rows["cage_feature"] == j)]
        one, other = asked.held.features[i], asked.cage.features[j]
        if {int(one.kind), int(other.kind)} == {CIRCLE, FACE}:
            yield (one, asked.cage, j, mine) if one.kind == CIRCLE else (other, asked.held, i, mine)


def faults_of(rows, arcs: list[Arc], is_told) -> list[str]:
    """Say where rows are not those of some arcs: both ends, and places between no farther apart than an eighth turn.

    ``is_told``: whether the place at an angle is told of an edge or another circle that crosses this one there.
    """
    faults, n_rows = [], 0
    for first, last in arcs:
        is_whole = last - first >= 2.0 * math.pi
        seen = [(row["angle"] - first + 1e-9) % (2.0 * math.pi) - 1e-9 for row in rows]
        mine = sorted((at, row) for at, row in zip(seen, range(len(rows)), strict=True) if at <= last - first + 1e-9)
        n_rows += len(mine)
        elsewhere = [end - first for end in (first, last) if not is_whole and is_told(end)]
        at = np.array(sorted({*(angle for angle, _ in mine), *elsewhere}))
        at = at[np.diff(at, prepend=-1.0) > 1e-7]
        if is_whole:
            if len(mine) != 8 or not np.allclose(np.diff(at), FAR):
                faults.append(f"{len(mine)} places of a whole circle")
        elif abs(at[0]) > 1e-7 or abs(at[-1] - (last - first)) > 1e-7 or (np.diff(at) > FAR + 1e-9).any():
            faults.append(f"places at {at} of an arc {last - first:.9f} long")
        for angle, row in mine:
            before, after = (FAR, FAR) if is_whole else (min(angle, FAR), min(last - first - angle, FAR))
            if abs(rows[row]["before"] - before) > 1e-7 or abs(rows[row]["after"] - after) > 1e-7:
                faults.append(f"{rows[row]['before']} before and {rows[row]['after']} after {angle} of {last - first}")
    if n_rows != len(rows):
        faults.append(f"{len(rows)} rows, {n_rows} of them on arcs")
    return faults


@pytest.mark.parametrize("of_cage", [False, True])
@pytest.mark.parametrize("name", SCENES)
def test_arcs_of_a_rod_on_part_of_a_face(monkeypatch, name, of_cage):
    """Boxes are of one part here, so that their faces are one, and need not be convex."""
    stand, n_arcs = SCENES[name]
    rng = np.random.default_rng(3)
    monkeypatch.setattr(features, "piece_of_box", lambda box, _: piece_of_box(box, 0))
    asked = Asked(stand, [ROD], TOUCH_M) if of_cage else Asked([ROD], stand, TOUCH_M)
    for _ in range(3):
        pose = STANDING @ Pose((0, 0, 0), euler_zyx=(rng.uniform(-3.0, 3.0), 0, 0))
        pose, n_found = (pose.inverse() if of_cage else pose), 0
        for circle, body, face, rows in flat_rows(asked, pose):
            arcs = arcs_by_sampling(circle, body, face)
            n_found += len(arcs)
            others = asked.found.rows[: asked.found.used[0]]

            def is_told(angle: float, circle=circle, rows=rows, others=others) -> bool:
                at = np.array(on_circle(circle_of(circle), angle).point)
                return len(others[np.linalg.norm(others["place"] - at, axis=1) < 1e-7]) > len(
                    rows[np.linalg.norm(rows["place"] - at, axis=1) < 1e-7]
                )

            assert not (faults := faults_of(rows, arcs, is_told)), faults
        assert n_found == n_arcs


def test_what_the_faces_of_these_scenes_end_at(monkeypatch):
    """An L and a comb have borders that are segments, a pierced plate a circle that its face is outside of."""
    monkeypatch.setattr(features, "piece_of_box", lambda box, _: piece_of_box(box, 0))
    for stand, kind in ((L_SHAPE, SEGMENT), (COMB, SEGMENT), (PIERCED, OUTSIDE)):
        assert (features.boundary_of(stand, TOUCH_M).bounds["kind"] == kind).any()


def test_a_circle_goes_on_from_one_part_to_the_next():
    """The faces of two parts are two, and their seam is where an arc of each ends."""
    asked = Asked([ROD], L_SHAPE, TOUCH_M)
    asked.place(STANDING)
    rows = all_along(asked)
    heights = TILT.inverse_transform(rows["place"])[:, 1]
    at_seam = rows[np.abs(heights + 0.2) < 1e-9]
    assert len(set(rows["cage_feature"].tolist())) == 2
    ends = sorted(zip(at_seam["before"].tolist(), at_seam["after"].tolist(), strict=True))
    np.testing.assert_allclose(ends, [(FAR, FAR)], atol=1e-9)  # at the other end of the seam an edge crosses it


def test_where_an_arc_ends_the_edge_that_crosses_it_is_told():
    """Its place goes along both, and the arc is told by the places between."""
    asked = Asked([ROD], [under(1.0, 0.0, 2.0, 2.0)], TOUCH_M)
    found = asked.place(STANDING)
    rows = found.rows[: found.used[0]]
    down = rows[rows["normal"] @ TILT.rotation[:, 2] < -0.9]
    kinds = asked.cage.features[down["cage_feature"]]["kind"]
    assert len(down) == 5
    assert len(all_along(asked)) == (kinds == FACE).sum() == 3
    assert (kinds == LINE).sum() == 2


@pytest.mark.parametrize("beyond", [-1.5e-9, 0.0, 1e-13, 1e-10, 1e-8])
def test_a_place_where_a_circle_reaches_an_edge_is_one_by_itself(beyond):
    """The edge has the circle's tangent, so that the two do not cross: the place is on the face."""
    asked = Asked([ROD], [under(1.5 - beyond, 0.0, 2.0, 2.0)], TOUCH_M)
    found = asked.place(STANDING)
    rows = found.rows[: found.used[0]]
    down = rows[rows["normal"] @ TILT.rotation[:, 2] < -0.9]
    places = TILT.inverse_transform(down["place"])
    long = down["before"] + down["after"]
    assert len(down) == (3 if beyond >= 1e-10 else 1)  # where it crosses the edge counts by itself
    np.testing.assert_allclose(max(long), 2.0 * math.acos(1.0 - max(beyond, 0.0) / 0.5), rtol=1e-5, atol=1e-6)
    at_ends = math.sqrt(beyond) if beyond == 1e-8 else 0.0  # so far beside the middle of the arc, which is 2e-4 m long
    np.testing.assert_allclose(places[:, [0, 2]], [(0.5, 0.0)] * len(down), atol=3e-5)
    np.testing.assert_allclose(
        sorted(places[:, 1]), [-at_ends, 0.0, at_ends][: len(down)] if at_ends else 0.0, atol=3e-5
    )


def test_a_place_where_a_circle_reaches_a_corner_is_one_by_itself():
    """The corner of the box is on the circle, which passes it outside of the box."""
    asked = Asked([ROD], [under(0.5 / math.sqrt(2.0) + 1.0, 0.5 / math.sqrt(2.0) + 1.0, 2.0, 2.0)], TOUCH_M)
    found = asked.place(STANDING)
    rows = found.rows[: found.used[0]]
    down = rows[rows["normal"] @ TILT.rotation[:, 2] < -0.9]
    assert len(down) == 1
    assert (down["before"] + down["after"]).tolist() == [0.0]
