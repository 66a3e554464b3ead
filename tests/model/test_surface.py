"""Meshes of shapes: closed, outward, on the shape, and of its volume in the limit."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from cagepose import Box, Capsule, Cone, Convex, Cylinder, Disc, Pose, Sphere
from cagepose.model.surface import shape_mesh

RNG = np.random.default_rng(7)
POSE = Pose((1.0, -2.0, 0.5), (0.3, -0.4, 0.5, 0.1))
HEXAGON = [(np.cos(k * np.pi / 3), np.sin(k * np.pi / 3), 0.3) for k in range(6)]
PRISM = [*HEXAGON, *((x, y, z + 1.0) for x, y, z in HEXAGON)]
AREA = 1.5 * np.sqrt(3.0)


def plate_volume(triangle, radius):
    """Return the volume of a triangle blown up by a radius (Steiner)."""
    sides = np.roll(triangle, -1, axis=0) - triangle
    area = np.linalg.norm(np.cross(sides[0], sides[1])) / 2.0
    around = np.linalg.norm(sides, axis=1).sum() * np.pi / 2.0
    return 2.0 * area * radius + around * radius**2 + 4.0 / 3.0 * np.pi * radius**3


SHAPES = [
    (Box((1, 2, 3), POSE), 6.0),
    (Sphere(2.0, POSE), 32.0 / 3.0 * np.pi),
    (Capsule(1.0, 2.0, POSE), (4.0 / 3.0 + 2.0) * np.pi),
    (Cylinder(2.0, 3.0, POSE), 12.0 * np.pi),
    (Cone(2.0, 1.0, 3.0, POSE), 7.0 * np.pi),
    (Cone(0.0, 1.0, 3.0, POSE), np.pi),
    (Disc(2.0, POSE), 0.0),
    (Convex(PRISM, 0.0, POSE), AREA),
    # Steiner: volume + surface r + edges' length times angle r^2 / 2 + ball
    (Convex(PRISM, 0.5, POSE), AREA + (2 * AREA + 6) * 0.5 + (12 * np.pi / 2 + 6 * np.pi / 3) * 0.125 + np.pi / 6),
    (Convex(HEXAGON, 0.5, POSE), AREA + 6 * np.pi * 0.125 + np.pi / 6),
    *((Convex(triangle, 0.5), plate_volume(triangle, 0.5)) for triangle in RNG.normal(size=(5, 3, 3))),  # none upright
    (Convex([(0, 0, 0), (0, 0, -2.0)], 1.0, POSE), (4.0 / 3.0 + 2.0) * np.pi),
    (Convex([(1, 2, 3), (2, 0, 5)], 1.0, POSE), (4.0 / 3.0 + 3.0) * np.pi),
    (Convex([(1, 2, 3)], 2.0, POSE), 32.0 / 3.0 * np.pi),
    (Convex(RNG.normal(size=(30, 3)), 0.2, POSE), None),
]


def volume_of(mesh):
    corners = mesh.vertices_m[mesh.triangles] - mesh.vertices_m.mean(axis=0)
    return np.linalg.det(corners).sum() / 6.0


@pytest.mark.parametrize(("shape", "volume"), SHAPES)
@pytest.mark.parametrize("segments", [3, 4, 7, 32])
def test_each_side_of_a_triangle_is_the_other_way_round_that_of_one_other(shape, volume, segments):
    mesh = shape_mesh(shape, segments)
    sides = Counter((t[k], t[(k + 1) % 3]) for t in mesh.triangles.tolist() for k in range(3))
    assert set(sides.values()) == {1}
    assert {(b, a) for a, b in sides} == set(sides)
    assert set(mesh.triangles.ravel().tolist()) == set(range(len(mesh.vertices_m)))
    assert len(mesh.vertices_m) - len(sides) // 2 + len(mesh.triangles) == 2
    if volume != 0.0:
        assert volume_of(mesh) > 0.0


@pytest.mark.parametrize(("shape", "volume"), [case for case in SHAPES if case[1] is not None])
def test_its_volume_tends_to_that_of_the_shape_from_below(shape, volume):
    coarse, fine = (volume - volume_of(shape_mesh(shape, 64, halved=halved)) for halved in (False, True))
    assert -1e-12 <= fine <= 4e-3 * max(volume, 1e-9)
    if fine > 1e-9:
        assert 3.5 < coarse / fine < 4.5  # the square of the chord's angle


@pytest.mark.parametrize("shape", [case[0] for case in SHAPES])
def test_all_vertices_lie_on_the_shape_and_triangles_look_away_from_its_middle(shape):
    mesh = shape_mesh(shape, 24)
    local = shape.pose_body_shape.inverse_transform(mesh.vertices_m)
    if hasattr(shape, "rims"):
        heights, radii = np.array(shape.rims).T
        found = np.hypot(local[:, 0], local[:, 1])
        assert np.abs(found - np.interp(local[:, 2], heights, radii)).max() < 1e-12
    elif isinstance(shape, (Sphere, Capsule)):
        beyond = np.maximum(np.abs(local[:, 2]) - getattr(shape, "length_m", 0.0) / 2.0, 0.0)
        assert np.abs(np.sqrt(local[:, 0] ** 2 + local[:, 1] ** 2 + beyond**2) - shape.radius_m).max() < 1e-12
    elif isinstance(shape, Convex):
        distances = np.linalg.norm(local[:, None] - shape.core(), axis=2).min(axis=1)
        assert np.abs(distances - shape.radius_m).max() < 1e-12
    corners = mesh.vertices_m[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = corners.mean(axis=1) - mesh.vertices_m.mean(axis=0)
    assert (np.einsum("ij,ij->i", normals, outwards) >= -1e-12).all()


def test_fewer_than_three_segments_are_refused():
    with pytest.raises(ValueError, match="segments is 2; give at least 3"):
        shape_mesh(Sphere(1.0), 2)
