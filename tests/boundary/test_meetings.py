"""Where boundaries touch at poses that are known by hand, and which meetings there are alternatives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary.asked import Asked
from cagepose import Box, Pose
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Sphere

TOUCH_M = 1e-9
FLOOR = Box((4.0, 4.0, 1.0), Pose((0, 0, -0.5)), name="floor")
CUBE = Box((1.0, 1.0, 1.0))
DOWN, TO_RIGHT = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)


def rows_of(held, cage, pose):
    """Return (places, normals, groups) of what touches."""
    found = Asked([held], cage, TOUCH_M).place(pose)
    rows = found.rows[: found.used[0]]
    order = np.lexsort(np.round(rows["place"], 9).T)
    first = {int(group): number for number, group in enumerate(dict.fromkeys(rows["group"][order].tolist()))}
    return rows["place"][order], rows["normal"][order], [first[int(group)] for group in rows["group"][order]]


def test_a_cube_on_a_floor_touches_with_four_corners_each_by_itself():
    places, normals, groups = rows_of(CUBE, [FLOOR], Pose((0, 0, 0.5)))
    corners = [(x, y, 0.0) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]
    np.testing.assert_allclose(places, corners, atol=1e-15)
    np.testing.assert_allclose(normals, [DOWN] * 4, atol=1e-15)
    assert groups == [0, 1, 2, 3]


def test_a_cube_in_line_with_the_edge_of_a_floor():
    """Its corners are on the edge, and over the floor's face: along either normal they are out."""
    _, normals, groups = rows_of(CUBE, [FLOOR], Pose((2.5, 0, 0.5)))
    assert groups == [0, 0, 1, 1]
    assert {tuple(np.round(normal, 12) + 0.0) for normal in normals} == {DOWN, (-1.0, 0.0, 0.0)}


def test_a_corner_on_a_corner_is_out_along_three_normals():
    _, normals, groups = rows_of(CUBE, [FLOOR], Pose((2.5, 2.5, 0.5)))
    assert groups == [0, 0, 0]
    assert {tuple(np.round(normal, 12) + 0.0) for normal in normals} == {DOWN, (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)}


def test_a_peg_at_the_bottom_of_its_hole_is_held_by_wall_and_floor_alike():
    plate, hole = Box((4.0, 4.0, 1.0), Pose((0, 0, -0.5)), name="plate"), Hole(0.5, 0.5, in_=("plate",))
    peg, beside = Cylinder(0.4, 2.0), Pose((0.1, 0, 0.5))
    places, normals, groups = rows_of(peg, [plate, hole], beside)
    at_wall = np.flatnonzero(np.abs(normals @ TO_RIGHT) > 0.5)
    assert len(at_wall) == 2  # where the wall begins, and at the peg's rim
    at_corner = at_wall[places[at_wall, 2].argmin()]
    np.testing.assert_allclose(places[at_corner], (0.5, 0.0, -0.5), atol=1e-12)
    on_floor = np.flatnonzero(normals @ DOWN > 0.5)
    assert len(on_floor) == 8
    assert all(groups[at_corner] != groups[at] for at in on_floor)


@pytest.mark.parametrize("tilt", [0.1, 0.5, 1.2])
def test_a_tilted_cylinder_stands_on_the_lowest_place_of_its_rim(tilt):
    height = math.cos(tilt) + 0.5 * math.sin(tilt)
    places, normals, _ = rows_of(Cylinder(0.5, 2.0), [FLOOR], Pose((0, 0, height), euler_zyx=(0, tilt, 0)))
    np.testing.assert_allclose(places, [(-math.sin(tilt) + 0.5 * math.cos(tilt), 0.0, 0.0)], atol=1e-12)
    np.testing.assert_allclose(normals, [DOWN], atol=1e-12)


def test_a_ball_lies_around_in_a_chamfer_and_on_a_sharp_rim():
    """In a chamfer of half a right angle its centre is a radius times the root of two above the tip of the cone; on a
    sharp rim of radius R it is sqrt(r^2 - R^2) above it.
    """
    seat = Hole(0.5, 2.0, Chamfer(0.3, math.pi / 4))
    radius = 0.9
    height = radius * math.sqrt(2.0) - 0.8
    places, normals, groups = rows_of(Sphere(radius), [seat], Pose((0, 0, height)))
    assert len(places) == len(set(groups)) == 8
    np.testing.assert_allclose(np.hypot(places[:, 0], places[:, 1]), radius / math.sqrt(2.0), atol=1e-12)
    np.testing.assert_allclose(normals[:, 2], -math.sqrt(0.5), atol=1e-12)
    places, _, _ = rows_of(Sphere(radius), [Hole(0.5, 2.0)], Pose((0, 0, math.sqrt(radius**2 - 0.25))))
    np.testing.assert_allclose(np.hypot(places[:, 0], places[:, 1]), 0.5, atol=1e-12)
    assert len(places) == 8


def test_a_cone_beside_the_middle_of_a_hole_touches_its_rim_at_one_place():
    tip, taper, beside = 0.3, 0.25, 0.1
    pin = Cone(tip, tip + 2.0 * taper, 2.0)
    depth = (0.5 - beside - tip) / taper
    places, normals, _ = rows_of(pin, [Hole(0.5, 1.0)], Pose((beside, 0, 1.0 - depth)))
    np.testing.assert_allclose(places, [(0.5, 0.0, 0.0)], atol=1e-12)
    slant = math.hypot(1.0, taper)
    np.testing.assert_allclose(normals, [(1.0 / slant, 0.0, -taper / slant)], atol=1e-12)


def test_crossed_edges_and_a_lying_roller():
    wedge = Convex([(-1, 0, 0), (1, 0, 0), (-1, 0.5, -1), (1, 0.5, -1), (-1, -0.5, -1), (1, -0.5, -1)])
    over = Pose((0, 0, 0), euler_zyx=(math.pi / 2, 0, 0)) @ Pose((0, 0, 0), euler_zyx=(0, 0, math.pi))
    places, normals, _ = rows_of(wedge, [wedge.renamed("other")], over)
    np.testing.assert_allclose(places, [(0, 0, 0)], atol=1e-12)
    np.testing.assert_allclose(normals, [DOWN], atol=1e-12)
    lying = Pose((0, 0, 0.2), euler_zyx=(0, math.pi / 2, 0))
    places, normals, _ = rows_of(Capsule(0.2, 1.0), [FLOOR], lying)
    np.testing.assert_allclose(np.sort(places[:, 0]), [-0.5, 0.5], atol=1e-12)
    np.testing.assert_allclose(normals, [DOWN] * 2, atol=1e-12)
