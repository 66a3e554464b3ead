"""Contact sets: faces, normals, gaps, edges, and faces hidden where boxes meet."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Object, Pose
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.algebra.vector import vector_from
from cagepose.kernels.boundary.geometry import empty_placement, held_at, place_object
from cagepose.kernels.boundary.surface_end import ends_near
from cagepose.kernels.collision.contacts import deepest_boxes
from cagepose.kernels.contact.contact_set import contact_set_for
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.friction import Friction
from cagepose.kernels.contact.metric import Body, frame_at
from cagepose.model.geometry import boxes_and_points, object_seams, scene_geometry

TOUCH = 1e-9


class Rows(NamedTuple):
    points: np.ndarray
    boxes: np.ndarray
    normals_world: np.ndarray
    gaps: np.ndarray
    near_edge: np.ndarray


STILL = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def rows_of(boxes, points, pose=STILL, touch=TOUCH):
    held = Object(boxes)
    geometry = scene_geometry(held, Cage(points), touch)
    placement, contacts, body = empty_placement(geometry), contact_set_for(geometry), empty_record(Body)
    body.axes_object[:], body.radii[:] = np.eye(3), 1.0
    place_object(geometry, *pose, placement)
    smooth = Friction(0.0, 0.0, np.full(len(points), np.nan), np.full(len(boxes), np.nan))
    assert find_contacts(geometry, placement, smooth, pose[0], frame_at(body, pose[1]), contacts)
    rows = contacts.rows[: contacts.used[0]]
    placed = held_at(geometry, placement)
    waiting = placement.memory.waiting
    near_edge = [ends_near(placed, row.feature, vector_from(row.arm + pose[0]), touch, waiting) for row in rows]
    return Rows(rows["cage_part"], rows["part"], rows["directions"][:, 0], rows["gap"], np.array(near_edge, dtype=bool))


def normals(rows):
    return {tuple(normal.round(9).tolist()) for normal in rows.normals_world}


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_each_face_has_its_outward_normal_and_gap(axis, side):
    point = np.array([0.1, -0.2, 0.3])
    point[axis] = side * (1.0 + 4e-10)
    rows = rows_of([Box((2, 2, 2))], [point])
    expected = np.zeros(3)
    expected[axis] = side
    assert_allclose(rows.normals_world, [expected])
    assert_allclose(rows.gaps, [4e-10], atol=1e-15)


def test_the_normal_turns_with_the_object():
    """A quarter turn about z takes the right face's normal from x to y."""
    quarter = Pose(euler_zyx=(math.pi / 2, 0, 0)).as_tuples()
    assert normals(rows_of([Box((2, 2, 2))], [(0.0, 1.0, 0.2)], quarter)) == {(0.0, 1.0, 0.0)}


def test_a_gap_beyond_the_tolerance_is_no_contact():
    assert len(rows_of([Box((2, 2, 2))], [(1.0 + 2e-9, 0, 0)]).points) == 0


def test_a_point_on_an_edge_touches_two_faces_and_on_a_corner_three():
    assert normals(rows_of([Box((2, 2, 2))], [(1.0, 1.0, 0.0)])) == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)}
    rows = rows_of([Box((2, 2, 2))], [(1.0, -1.0, 1.0)])
    assert len(normals(rows)) == 3
    assert rows.near_edge.all()


def test_a_point_in_the_middle_of_a_face_is_not_near_an_edge():
    assert not rows_of([Box((2, 2, 2))], [(1.0, 0.0, 0.0)]).near_edge.any()


class TestUnions:
    pair = (Box((2, 2, 2), Pose((-1, 0, 0))), Box((2, 2, 2), Pose((1, 0, 0))))

    def test_on_a_seam_only_the_common_outside_counts(self):
        """Two cubes side by side: on top of their seam each has an inner side face within reach, which is hidden."""
        rows = rows_of(self.pair, [(0.0, 0.3, 1.0)])
        assert normals(rows) == {(0.0, 0.0, 1.0)}
        assert len(rows.boxes) == 1
        assert not rows.near_edge.any()

    def test_where_the_seam_reaches_an_outer_edge_that_edge_is_real(self):
        rows = rows_of(self.pair, [(0.0, 1.0, 1.0)])
        assert normals(rows) == {(0.0, 0.0, 1.0), (0.0, 1.0, 0.0)}
        assert rows.near_edge.all()

    def test_in_an_inner_corner_both_walls_count(self):
        """A block on a plate: the foot's bottom is hidden, the plate's top and the block's side are not."""
        boxes = [Box((4, 4, 1), Pose((0, 0, -0.5))), Box((1, 4, 2), Pose((-1.5, 0, 1)))]
        assert normals(rows_of(boxes, [(-1.0, 0.0, 0.0)])) == {(0.0, 0.0, 1.0), (1.0, 0.0, 0.0)}

    def test_in_an_acute_groove_both_walls_count(self):
        """A plate and a bar leaning over it at 30 deg: the point touches both, though the bar is close above it."""
        tilt = math.radians(30)
        axis, normal = np.array([math.cos(tilt), 0, math.sin(tilt)]), np.array([math.sin(tilt), 0, -math.cos(tilt)])
        point = np.array([0.5, 0.0, 0.0])
        # The bar's lower face passes through the point; its centre lies half its height above and further up.
        bar = Box((1.0, 1.0, 0.2), Pose(point - normal * 0.1 + axis * 0.3, euler_zyx=(0, -tilt, 0)))
        rows = rows_of([Box((4, 4, 1), Pose((0, 0, -0.5))), bar], [point])
        assert normals(rows) == {(0.0, 0.0, 1.0), tuple(normal.round(9).tolist())}

    def test_overlapping_boxes_hide_what_lies_inside(self):
        boxes = [Box((2, 2, 2)), Box((2, 2, 2), Pose((1, 0, 0.0)))]
        assert normals(rows_of(boxes, [(0.0, 0.0, 1.0)])) == {(0.0, 0.0, 1.0)}

    def test_a_point_in_the_seam_lies_inside_the_object(self):
        held = Object(self.pair)
        points = Cage([(0.0, 0.0, 0.0), (5.0, 0.0, 0.0)])
        geometry = boxes_and_points(held, points, object_seams(held, TOUCH).bridges)
        depths, boxes = deepest_boxes(geometry, *STILL)
        assert depths[0] == pytest.approx(1.0)
        assert boxes[0] == geometry.n_own_boxes
        assert depths[1] == pytest.approx(-3.0)
