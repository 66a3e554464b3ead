"""Shapes as they are drawn: outlines, normals and borders of meshes."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Chamfer, Hole, Pose
from cagepose.model.shapes import AnyShape, Capsule, Cone, Convex, Cylinder, Disc, Sphere
from cagepose.model.volume import BOX_SIGNS
from cagepose.views.solids import CHORDS_OF_CIRCLE, cut_off, solid_of

BLOCK = Box((0.04, 0.03, 0.02))
ROUNDED = Convex(BOX_SIGNS * 0.01, 0.003)
ALL = [BLOCK, Sphere(0.01), Capsule(0.01, 0.05), Cylinder(0.01, 0.03), Cone(0.02, 0.0, 0.03), Disc(0.01), ROUNDED]


def fronts(shape: Box | AnyShape, eye: tuple[float, float, float]) -> np.ndarray:
    return solid_of(shape).normals @ np.array(eye) > 0.0


@pytest.mark.parametrize(
    ("shape", "eye", "n_lines"),
    [
        (BLOCK, (1.0, 2.0, 3.0), 9),  # of twelve edges three are behind
        (BLOCK, (0.0, 0.0, 1.0), 4),
        (Sphere(0.01), (0.3, -0.2, 0.9), None),
        (Cylinder(0.01, 0.03), (0.0, 0.0, 1.0), CHORDS_OF_CIRCLE),
        (
            Cylinder(0.01, 0.03),
            (1.0, 0.0, 1.0),
            3 * CHORDS_OF_CIRCLE // 2 + 2,
        ),  # a rim, half of the other, and two sides
    ],
)
def test_what_an_eye_sees_as_lines_is_edges_and_where_the_shape_ends(shape, eye, n_lines) -> None:
    outline = solid_of(shape).outline(fronts(shape, eye))
    assert n_lines is None or abs(len(outline) - n_lines) <= 2  # an edge of the mesh may stand right across the view
    times_met = np.bincount(outline.ravel())
    assert (times_met[times_met > 0] >= 2).all()  # no loose ends


@pytest.mark.parametrize("eye", [(0.3, -0.2, 0.9), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_balls_outline_is_a_circle_across_the_view(eye) -> None:
    solid, view = solid_of(Sphere(0.01)), np.array(eye) / np.linalg.norm(eye)
    places = solid.mesh.vertices_m[np.unique(solid.outline(fronts(Sphere(0.01), eye)))]
    across = np.linalg.norm(places - np.outer(places @ view, view), axis=1)
    assert across == pytest.approx(0.01, rel=0.03)


def test_what_is_round_is_shaded_smoothly_and_what_is_flat_is_not() -> None:
    ball, block = solid_of(Sphere(0.01)), solid_of(BLOCK)
    outwards = ball.mesh.vertices_m[ball.mesh.triangles] / 0.01
    assert np.abs(ball.corner_normals - outwards).max() < 0.04  # a triangle at a pole is turned by 0.1
    assert np.array_equal(block.corner_normals, np.repeat(block.normals[:, None], 3, axis=1))


def test_shapes_of_one_kind_and_size_share_a_mesh_wherever_they_are() -> None:
    here, there = Capsule(0.01, 0.05), Capsule(0.01, 0.05, Pose((1, 2, 3)), "there")
    assert solid_of(here) is solid_of(there)
    assert solid_of(here) is not solid_of(Capsule(0.01, 0.06))
    assert solid_of(Cylinder(0.01, 0.05)) is not solid_of(here)


def test_a_chamfer_makes_another_hole() -> None:
    plain, wide = Hole(0.004, 0.01), Hole(0.004, 0.01, Chamfer(0.001, 0.5))
    assert solid_of(plain) is not solid_of(wide)
    assert solid_of(wide) is solid_of(Hole(0.004, 0.01, Chamfer(0.001, 0.5), pose_body_shape=Pose((1, 0, 0))))


def test_of_a_large_body_only_what_is_near_counts() -> None:
    needed = np.array([[0.0, 0, 0], [1, 1, 1]])
    body = np.array([[-50.0, 0.5, 0.5], [50.0, 0.5, 40.0], [0.2, 0.3, 0.4]])
    assert cut_off(body, needed, 2.0).tolist() == [[-2, 0.5, 0.5], [3, 0.5, 3], [0.2, 0.3, 0.4]]
