"""Closed surfaces of triangles as boundaries, beside unions by fans, trimesh's rays and manifold3d's volumes."""

from __future__ import annotations

import numpy as np
import pytest

from boundary.asked import Asked
from boundary.boundary_checks import volume
from boundary.drawn_facets import bumpy_ball, drawn_facets, facets, of_boxes, solid, triangles_of, united
from boundary.same_features import differences
from boundary.test_overlap import Start
from cagepose import Box, Convex, Cylinder, Facets, Pose, Sphere
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.features import FACE
from cagepose.model.boundary.convex_pieces import piece_of_box
from cagepose.model.boundary.joined_surfaces import joined_surface
from cagepose.model.boundary.union import union_of

TOUCH_M = 1e-9
L_BRACKET = [Box((4, 1, 1)), Box((1, 3, 1), Pose((-1.5, 1, 0)))]
FORK = [Box((6, 1, 1)), *(Box((1, 1, 4), Pose((x, 0, -2.5))) for x in (-2.5, 0, 2.5))]
CROSS = [Box((4, 1, 1)), Box((1, 4, 1)), Box((1, 1, 4), Pose((0.2, 0.1, 0), euler_zyx=(0.3, 0.2, 0.1)))]
FRAME = [Box((4, 1, 1), Pose((0, 1.5, 0))), Box((4, 1, 1), Pose((0, -1.5, 0)))]
FRAME += [Box((1, 4, 1), Pose((1.5, 0, 0))), Box((1, 4, 1), Pose((-1.5, 0, 0)))]


@pytest.mark.parametrize("boxes", [L_BRACKET, FORK, CROSS, FRAME], ids=["L", "fork", "cross", "frame"])
def test_a_mesh_of_boxes_has_the_features_of_their_union(boxes):
    for turn in (Pose(), Pose((1, 2, 3), euler_zyx=(0.4, -0.7, 1.1))):
        placed = [box.moved(turn @ box.pose_body_shape) for box in boxes]
        found = joined_surface([of_boxes(placed)], [0], TOUCH_M)
        assert found.n_open == 0
        assert differences(found, union_of([piece_of_box(box, 0) for box in placed], TOUCH_M), 1e-12) == []


def test_corners_that_lead_into_material_are_none():
    """The tip of a pit has edges to one side alone, as that of a spike has, but is none that touches."""
    spike = Convex([(0, 0, 0), (0.3, 0, 1), (-0.2, 0.3, 1), (-0.2, -0.3, 1)])
    pit = facets(united([Box((4, 4, 1), Pose((0, 0, 0.5)))], [spike.moved(Pose((0, 0, 0.3)))]))
    places = joined_surface([pit], [0], TOUCH_M).vertices.places_m
    assert len(places) == 8  # of the block: those around the mouth lie in its face, which goes on around them
    assert np.abs(np.abs(places[:, :2]) - 2.0).max() < 1e-12


def test_triangles_within_faces_and_edges_change_nothing():
    """Refined a thousandfold, with corners along all edges and throughout all faces, slivers among them."""
    plain = united(CROSS)
    fine = plain.refine_to_length(0.11)
    mesh = fine.to_mesh64()
    vertices, triangles = mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64)
    rng = np.random.default_rng(5)
    edges = triangles[rng.permutation(len(triangles))[:50]]
    for a, b, _ in edges.tolist():  # a corner on a side, nearly at its end: both triangles there are divided
        where = np.flatnonzero((triangles == a).any(axis=1) & (triangles == b).any(axis=1))
        middle = len(vertices)
        vertices = np.vstack([vertices, (1 - 1e-7) * vertices[a] + 1e-7 * vertices[b]])
        halves = [np.where(triangles[where] == end, middle, triangles[where]) for end in (a, b)]
        triangles = np.concatenate([np.delete(triangles, where, axis=0), *halves])
    found = joined_surface([Facets(vertices, triangles)], [0], TOUCH_M)
    assert found.n_open == 0
    assert differences(found, joined_surface([facets(plain)], [0], TOUCH_M), 1e-9) == []


def test_two_bodies_that_touch_along_an_edge_are_apart_there():
    """Four triangles share a side: those that bound material together are neighbours."""
    one, other = (solid(Box((1, 1, 1), Pose((x, y, 0)))).to_mesh64() for x, y in ((0, 0), (1, 1)))
    vertices = np.concatenate([one.vert_properties[:, :3], other.vert_properties[:, :3]])
    triangles = np.concatenate([one.tri_verts, other.tri_verts + len(one.vert_properties)]).astype(np.int64)
    places, same = np.unique(vertices.round(12), axis=0, return_inverse=True)
    both = Facets(places, same.ravel()[triangles])
    found = joined_surface([both], [0], TOUCH_M)
    assert (found.n_open, len(found.faces.parts), len(found.edges.parts)) == (0, 12, 24)


def test_a_point_dropped_on_a_mesh_lands_on_the_facet_that_a_ray_meets(cases):
    """At random places and in random directions, on bodies that are not convex, of up to 1,280 facets."""
    rng, n_met = np.random.default_rng(41), 0
    for _ in range(cases(20, 1000) // 10 + 1):
        shape = drawn_facets(rng)
        asked, mesh = Asked([Sphere(1e-12)], [shape], TOUCH_M), triangles_of(shape)
        for _ in range(10):
            way = rng.standard_normal(3)
            way /= np.linalg.norm(way)
            start = rng.uniform(-0.8, 0.8, 3) - 4.0 * way
            places, _, which = mesh.ray.intersects_location([start], [way], multiple_hits=True)
            asked.place(Pose(start))
            found = asked.first(Motion(tuple(start), tuple(way), 0.0, (0.0, 0.0, 0.0)), 8.0)
            if len(places) == 0:
                assert found.amount == np.inf
                continue
            ahead = (places - start) @ way
            first = int(ahead.argmin())
            assert found.amount == pytest.approx(ahead[first], abs=1e-8)
            normal = asked.cage.own.features[found.cage_feature].direction
            is_face = asked.cage.own.features[found.cage_feature].kind == FACE
            assert not is_face or normal @ mesh.face_normals[which[first]] == pytest.approx(1.0, abs=1e-8)
            n_met += 1
    assert n_met > 0


def test_meshes_overlap_if_their_intersection_has_a_volume(cases):
    rng, n_in = np.random.default_rng(42), 0
    for _ in range(cases(6, 60)):
        one, other = drawn_facets(rng), drawn_facets(rng)
        start, own, cage = Start([one], [other]), solid(one), solid(other)
        for _ in range(4):
            pose = Pose(rng.uniform(-1.0, 1.0, 3) * rng.choice([0.5, 1.5]), rng.standard_normal(4))
            volume = (own.transform(np.hstack([pose.rotation, pose.position_m[:, None]])) ^ cage).volume()
            if not 0.0 < volume < 1e-9:
                assert (start.asked(pose).depth_m > 0.0) == (volume > 0.0)
                n_in += volume > 0.0
    assert n_in > 0


def test_holds_and_reach_are_those_of_the_surface():
    """Points beside a surface, asked of trimesh; and how deep a drill gets before it comes out of the upper flange."""
    rng = np.random.default_rng(43)
    ball, turn = bumpy_ball(rng), Pose((0.3, 0.2, 0.1), euler_zyx=(1.0, 0.5, 0.2))
    placed = ball.moved(turn)
    points = rng.uniform(-1.3, 1.3, (400, 3))
    assert placed.holds(points).tolist() == triangles_of(placed).contains(points).tolist()
    assert ball.holds(ball.vertices_m[:50]).all()
    channel = facets(united([Box((4, 2, 2))], [Box((3, 3, 1), Pose((1, 0, 0)))]))
    assert channel.reach_m(np.array((1.0, 0.1, 1.0)), np.array((0.0, 0.0, -1.0))) == pytest.approx(0.5, abs=1e-12)
    assert channel.reach_m(np.array((-1.9, 0.1, 1.0)), np.array((0.0, 0.0, -1.0))) == pytest.approx(2.0, abs=1e-12)
    assert channel.reach_m(np.array((1.0, 0.1, 1.0)), np.array((0.0, 0.0, 1.0))) == 0.0


def test_a_prism_of_many_sides_has_as_many_corners_as_its_ends():
    """One corner with two hundred edges: the tip of a pyramid."""
    ring = facets(solid(Cylinder(1.0, 2.0), 200))
    found = joined_surface([ring], [0], TOUCH_M)
    assert (len(found.vertices.parts), len(found.edges.parts), len(found.faces.parts)) == (400, 600, 202)
    angles = 2.0 * np.pi * np.arange(200) / 200
    vertices = np.vstack([np.column_stack([np.cos(angles), np.sin(angles), np.zeros(200)]), [(0, 0, 1), (0, 0, 0)]])
    here, beside = np.arange(200), np.roll(np.arange(200), -1)
    sides = np.column_stack([here, beside, np.full(200, 200)])
    below = np.column_stack([beside, here, np.full(200, 201)])
    tip = joined_surface([Facets(vertices, np.vstack([sides, below]))], [0], TOUCH_M)
    assert (len(tip.vertices.parts), len(tip.edges.parts), len(tip.faces.parts)) == (201, 400, 201)
    assert tip.vertices.n_tangents.max() == 200


def test_facets_are_joined_with_polyhedra_that_they_meet(cases):
    """Flush, crossing or apart, turned: as the union of all by fans, to what touches."""
    rng = np.random.default_rng(44)
    for _ in range(cases(10, 200)):
        turn = Pose(rng.uniform(-1, 1, 3), rng.standard_normal(4))
        base = [box.moved(turn @ box.pose_body_shape) for box in L_BRACKET]
        where = [(2.5, 0, 0), (0, 0, 1.0), (0.3, 0.1, 0.6), (9, 0, 0)][int(rng.integers(4))]
        block = Box((1, 1, 1), turn @ Pose(where))
        found = joined_surface([of_boxes(base), block], [0, 1], TOUCH_M)
        wanted = union_of([*(piece_of_box(box, 0) for box in base), piece_of_box(block, 1)], TOUCH_M)
        assert found.n_open == 0
        others = set(differences(found, wanted, 4.0 * TOUCH_M))
        assert others <= {"other faces"}  # a border that bends by what touches makes a face not convex
        assert volume(found) == pytest.approx(volume(wanted), rel=1e-8)
