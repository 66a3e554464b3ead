"""Convex hulls: of bodies that are known, of random points against Qhull, and of points at the edge of rounding."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from cagepose import Convex, Pose, SceneError
from cagepose.model.hull import FLAT, hull_of

CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))


def assert_closed(hull, points):
    """Euler's formula; each edge in two faces, once in either sense; all points within all faces, loops in them."""
    size = np.ptp(points, axis=0).max()
    sides = [side for loop in hull.faces for side in zip(loop, (*loop[1:], loop[0]), strict=True)]
    assert len(set(sides)) == len(sides)
    assert {(b, a) for a, b in sides} == set(sides)
    assert sorted({(min(side), max(side)) for side in sides}) == [tuple(edge) for edge in hull.edges.tolist()]
    assert len(hull.vertices_m) - len(hull.edges) + len(hull.faces) == 2
    assert {corner for loop in hull.faces for corner in loop} == set(range(len(hull.vertices_m)))
    assert_allclose(np.linalg.norm(hull.normals, axis=1), 1.0, rtol=1e-14)
    for loop, normal in zip(hull.faces, hull.normals, strict=True):
        corners = hull.vertices_m[list(loop)]
        assert np.abs((corners - corners[0]) @ normal).max() <= 3.0 * FLAT * size
        assert ((points - corners[0]) @ normal).max() <= 3.0 * FLAT * size
        area = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
        assert area @ normal > 0.0


def volume_of(hull):
    middle = hull.vertices_m.mean(axis=0)
    return sum(
        np.linalg.det(hull.vertices_m[[loop[0], one, other]] - middle) / 6.0
        for loop in hull.faces
        for one, other in pairwise(loop[1:])
    )


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e6])
@pytest.mark.parametrize("seed", range(5))
def test_a_box_has_six_faces_of_four_corners(scale, seed):
    rng = np.random.default_rng(seed)
    pose = Pose(rng.normal(size=3) * 10.0 * scale, rng.normal(size=4))
    points = pose.transform(CUBE * (1.0, 2.0, 3.0) * scale)
    hull = hull_of(points)
    assert_closed(hull, points)
    assert [len(hull.vertices_m), len(hull.edges), len(hull.faces)] == [8, 12, 6]
    assert (hull.vertices_m == points).all()
    expected = np.concatenate([pose.rotation.T, -pose.rotation.T])
    assert np.abs(hull.normals @ expected.T - 1.0).min(axis=0).max() < 1e-14


def test_of_a_straight_box_normals_are_exact_and_points_within_faces_and_edges_are_no_corners():
    grid = np.array(list(product((-1.0, -0.3, 0.1, 1.0), repeat=3))) * (0.3, 0.1, 0.7)
    hull = hull_of(grid)
    assert_closed(hull, grid)
    assert hull.vertices_m.tolist() == (CUBE * (0.3, 0.1, 0.7)).tolist()
    assert sorted(hull.normals.tolist()) == sorted([*np.eye(3).tolist(), *(-np.eye(3)).tolist()])


@pytest.mark.parametrize("n", [3, 5, 6, 64])
def test_a_prism_has_two_ends_and_a_side_for_each_corner(n):
    angles = 2.0 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(n)], axis=1)
    points = Pose((3, 1, 2), (0.3, 0.2, -0.5, 0.7)).transform(np.concatenate([ring, ring + np.array((0.2, 0.1, 1.5))]))
    hull = hull_of(points)
    assert_closed(hull, points)
    assert sorted(len(face) for face in hull.faces) == sorted([4] * n + [n, n])


@pytest.mark.parametrize("seed", range(20))
def test_of_random_points_it_is_that_of_qhull(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 120)), 3))
    if seed % 2:
        points /= np.linalg.norm(points, axis=1, keepdims=True)  # all of them corners
    hull, peer = hull_of(points), ConvexHull(points)
    assert_closed(hull, points)
    assert hull.vertices_m.tolist() == points[np.sort(peer.vertices)].tolist()
    assert_allclose(volume_of(hull), peer.volume, rtol=1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_points_off_their_planes_by_rounding_and_around_the_tolerance_still_close_up(seed):
    """Boxes that share faces, every corner several times, each moved by 1e-17 to 1e-8 of the size."""
    rng = np.random.default_rng(seed)
    grid = rng.integers(0, 4, (60, 3)) / 3.0
    points = Pose((5, 6, 7), rng.normal(size=4)).transform(grid)
    points += rng.uniform(-1.0, 1.0, points.shape) * 10.0 ** rng.uniform(-17.0, -8.0)
    hull = hull_of(points)
    assert_closed(hull, points)
    assert_allclose(volume_of(hull), ConvexHull(points).volume, rtol=1e-7)


def test_flat_points_make_a_polygon_with_two_sides():
    pose = Pose((1, 2, 3), (0.1, 0.9, 0.3, 0.2))
    flat = np.array([(0, 0, 0), (2, 0, 0), (1, 0, 0), (2, 1, 0), (0, 1, 0), (0.5, 0.5, 0), (1, 1, 0)], dtype=float)
    hull = hull_of(pose.transform(flat))
    assert hull.dimension == 2
    assert_closed(hull, pose.transform(flat))
    assert (hull.vertices_m == pose.transform(flat)[[0, 1, 3, 4]]).all()
    assert len(hull.edges) == 4
    assert hull.faces[0] == hull.faces[1][::-1]
    assert_allclose(np.abs(hull.normals @ pose.rotation[:, 2]), 1.0)


def test_points_on_a_line_make_a_segment_and_points_at_one_place_a_point():
    line = np.outer([0.3, -1.0, 2.0, 2.0, 0.1], (1.0, 2.0, 3.0)) + 5.0
    hull = hull_of(line)
    assert (hull.dimension, hull.edges.tolist(), hull.faces) == (1, [[0, 1]], ())
    assert hull.vertices_m.tolist() == line[[1, 2]].tolist()
    point = hull_of(np.array([(1.0, 2.0, 3.0)] * 3))
    assert (point.dimension, point.vertices_m.tolist(), len(point.edges)) == (0, [[1.0, 2.0, 3.0]], 0)


def test_a_needle_as_thin_as_what_is_flat_is_refused_and_none_takes_for_ever():
    """Turned, the outlines of its faces may cross themselves, as rounding decides which triangles lie in one plane."""
    angles, told = 2.0 * np.pi * np.arange(24) / 24.0, list[str]()
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(24)])
    for number in range(40):
        turn = Rotation.random(random_state=number).as_matrix()
        needle = np.concatenate([1.0e-8 * ring, 1.0e-8 * ring + (0.0, 0.0, 1.0)]) @ turn
        try:
            Convex(needle)
        except SceneError as error:
            told.append(str(error))
    assert told
    assert all(text.startswith("vertices") for text in told)
