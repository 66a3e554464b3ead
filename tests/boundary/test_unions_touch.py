"""Unions of polyhedra in contact: seams are no edges, and what lies inside another piece touches nothing."""

from __future__ import annotations

import numpy as np

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.model.hull import hull_of
from cagepose.model.shapes import Convex, Sphere
from shapes.convex_bodies import random_turn

TOUCH_M = 1e-9


def slabs(rng: np.random.Generator, n_cuts: int, turn: Pose) -> list[Convex]:
    """A slab 4 x 4 x 1 with its top at z = 0, cut into flush hulls by vertical planes, turned."""
    pieces = [np.array([(x, y, z) for x in (-2.0, 2.0) for y in (-2.0, 2.0) for z in (-1.0, 0.0)])]
    for _ in range(n_cuts):
        angle, offset = rng.uniform(0.0, np.pi), rng.uniform(-1.0, 1.0)
        normal = np.array((np.cos(angle), np.sin(angle), 0.0))
        pieces = [half for piece in pieces for half in _halves(piece, normal, offset)]
    return [Convex(turn.transform(piece), name=f"p{k}") for k, piece in enumerate(pieces)]


def _halves(corners: np.ndarray, normal: np.ndarray, offset: float) -> list[np.ndarray]:
    heights = corners @ normal - offset
    if heights.min() > -0.05 or heights.max() < 0.05:
        return [corners]
    crossing = []
    for i in range(len(corners)):
        for j in range(i):
            if heights[i] * heights[j] < 0.0:
                share = heights[i] / (heights[i] - heights[j])
                crossing.append(corners[i] + share * (corners[j] - corners[i]))
    halves = [np.concatenate([corners[heights * sign > 0.0], crossing]) for sign in (1.0, -1.0)]
    return [hull_of(half).vertices_m for half in halves]


def test_points_slide_over_seams_and_cubes_stand_on_them(cases):
    """On a slab that is cut into flush hulls nothing is met on the way, and what touches is as on the whole slab."""
    rng = np.random.default_rng(31)
    for _ in range(cases(15, 200)):
        turn = Pose((0, 0, 0), random_turn(rng))
        cage = slabs(rng, int(rng.integers(1, 5)), turn)
        angle, beside = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(-1.0, 1.0, 2)
        cube = Box((0.6, 0.5, 0.4))
        pose = turn @ Pose((*beside, 0.2), euler_zyx=(angle, 0.0, 0.0))
        asked = Asked([cube], cage, TOUCH_M)
        meetings = asked.place(pose)
        assert meetings.used[0] == 4
        up = turn.rotation[:, 2]
        np.testing.assert_allclose(meetings.rows["normal"][:4], [-up] * 4, atol=1e-9)
        way = turn.rotation @ np.array((*(np.array((1.0, 0.7)) - beside), 0.0))
        slide = Motion(tuple(pose.position_m.tolist()), tuple(way.tolist()), 0.0, (0.0, 0.0, 0.0))
        assert asked.first(slide, 1.0).amount == np.inf
        point = Asked([Sphere(1e-12)], cage, TOUCH_M)
        point.place(turn @ Pose((*beside, 1e-12)))
        assert point.first(slide, 1.0).amount == np.inf


def test_a_notch_between_two_boxes_holds_a_corner_by_both_walls():
    """An L of two boxes: its inner edge is concave, so both of its faces hold by themselves."""
    cage = [Box((2, 2, 1), Pose((0, 0, -0.5)), name="floor"), Box((1, 2, 2), Pose((-1.5, 0, 0)), name="wall")]
    found = Asked([Box((1, 1, 1))], cage, TOUCH_M).place(Pose((-0.5, 0, 0.5)))
    rows = found.rows[: found.used[0]]
    normals = np.round(rows["normal"], 9) + 0.0
    down, left = (normals == (0.0, 0.0, -1.0)).all(axis=1), (normals == (-1.0, 0.0, 0.0)).all(axis=1)
    assert down.sum() == 4
    assert left.sum() == 4
    at_edge = np.abs(rows["place"][:, 0] + 1.0) < 1e-9
    assert not set(rows["group"][down & at_edge].tolist()) & set(rows["group"][left & at_edge].tolist())


def test_what_lies_inside_another_piece_touches_nothing():
    cage = [Box((4, 4, 1), Pose((0, 0, -0.5)), name="floor"), Box((1, 1, 1), Pose((0, 0, -0.6)), name="inside")]
    alone, both = (Asked([Box((1, 1, 1))], parts, TOUCH_M).place(Pose((0, 0, 0.5))) for parts in (cage[:1], cage))
    assert alone.used[0] == both.used[0] == 4
