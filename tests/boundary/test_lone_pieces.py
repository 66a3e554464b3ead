"""A piece that is apart from all others comes out as it is, and from the fans as well."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from boundary.boundary_checks import faults_of_surface
from boundary.drawn_hulls import SIZE_M, drawn_hull
from boundary.same_features import differences
from cagepose import Pose
from cagepose.model.boundary.convex_pieces import piece_of_hull
from cagepose.model.boundary.union import union_of

TOUCH_M = 1e-9 * SIZE_M
Cases = Callable[[int, int], int]


def test_a_lone_hull_keeps_each_digit_of_its_vertices_edges_and_faces(cases: Cases) -> None:
    for case in range(cases(40, 2000)):
        hull = drawn_hull(np.random.default_rng((case, 3)))
        found = union_of([piece_of_hull(hull, Pose(), 0)], TOUCH_M)
        assert not faults_of_surface(found, TOUCH_M)
        assert (found.vertices.places_m == hull.vertices_m).all()
        assert found.vertices.n_tangents.tolist() == np.bincount(hull.edges.ravel()).tolist()
        assert (found.edges.starts_m == hull.vertices_m[hull.edges[:, 0]]).all()
        assert (found.edges.ends_m == hull.vertices_m[hull.edges[:, 1]]).all()
        assert {*map(tuple, found.faces.normals.tolist())} == {*map(tuple, hull.normals.tolist())}
        assert found.faces.is_convex.all()
        assert sorted(found.faces.n_borders) == sorted(len(face) for face in hull.faces)


def test_a_hull_twice_at_one_place_is_that_hull(cases: Cases) -> None:
    for case in range(cases(40, 2000)):
        hull = drawn_hull(np.random.default_rng((case, 4)))
        piece = piece_of_hull(hull, Pose(), 0)
        lone, twice = union_of([piece], TOUCH_M), union_of([piece, piece], TOUCH_M)
        assert not faults_of_surface(twice, TOUCH_M), case
        assert not differences(lone, twice, 1e-9 * SIZE_M), case
