"""Shapes as they are drawn: outlines, normals and borders of meshes."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Pose
from cagepose.model.shapes import AnyShape, Capsule, Cone, Convex, Cylinder, Disc, Sphere
from cagepose.model.volume import BOX_SIGNS
from cagepose.views.solids import SEGMENTS, cut_off, solid_of

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
        (Cylinder(0.01, 0.03), (0.0, 0.0, 1.0), SEGMENTS),
        (Cylinder(0.01, 0.03), (1.0, 0.0, 1.0), 3 * SEGMENTS // 2 + 2),  # a rim, half of the other, and two sides
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


@pytest.mark.parametrize("shape", ALL, ids=lambda shape: shape.kind)
def test_the_lines_around_what_faces_the_eye_bound_it(shape) -> None:
    """The area that the loops enclose on the screen is that of the triangles inside them."""
    solid, is_front = solid_of(shape), fronts(shape, (0.0, 0.0, 1.0))
    flat = solid.mesh.vertices_m[:, :2]

    def area(loop: list[int]) -> float:
        x, y = flat[loop].T
        return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

    inside = sum(area(list(corners)) for corners in solid.mesh.triangles[is_front].tolist())
    assert sum(area(loop) for loop in solid.loops(is_front)) == pytest.approx(inside, rel=1e-12)
    by_patch = (solid.loops(is_front & (solid.patches == patch)) for patch in range(solid.patches.max() + 1))
    assert sum(area(loop) for loops in by_patch for loop in loops) == pytest.approx(inside, rel=1e-12)


def test_smooth_surfaces_are_one_patch_and_edges_part_them() -> None:
    assert [int(solid_of(shape).patches.max()) + 1 for shape in ALL] == [6, 1, 1, 3, 2, 2, 1]


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


def test_of_a_large_body_only_what_is_near_counts() -> None:
    needed = np.array([[0.0, 0, 0], [1, 1, 1]])
    body = np.array([[-50.0, 0.5, 0.5], [50.0, 0.5, 40.0], [0.2, 0.3, 0.4]])
    assert cut_off(body, needed, 2.0).tolist() == [[-2, 0.5, 0.5], [3, 0.5, 3], [0.2, 0.3, 0.4]]
