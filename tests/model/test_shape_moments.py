"""Moments of single shapes: against formulas by hand, against fine meshes, and against each other."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Capsule, Cone, Convex, Cylinder, Disc, Pose, Sphere
from cagepose.model.shape_moments import mesh_sums, shape_moments, sums_of
from cagepose.model.surface import shape_mesh

POSE = Pose((1.0, -2.0, 0.5), (0.3, -0.4, 0.5, 0.1))
RNG = np.random.default_rng(3)
CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
HEXAGON = np.array([(np.cos(k * np.pi / 3), np.sin(k * np.pi / 3), 0.3) for k in range(6)])


def assert_same(found, expected, rtol):
    size = np.sqrt(np.trace(expected.second_moment_m2))
    assert_allclose(found.volume_m3, expected.volume_m3, rtol=rtol)
    assert_allclose(found.centroid_m, expected.centroid_m, rtol=0.0, atol=rtol * size)
    assert_allclose(found.second_moment_m2, expected.second_moment_m2, rtol=0.0, atol=rtol * size**2)


@pytest.mark.parametrize(
    ("shape", "volume", "height", "squares"),
    [
        (Sphere(2.0), 32.0 / 3.0 * np.pi, 0.0, (0.8, 0.8, 0.8)),
        (Cylinder(2.0, 3.0), 12.0 * np.pi, 0.0, (1.0, 1.0, 0.75)),
        (Cone(2.0, 0.0, 4.0), 16.0 / 3.0 * np.pi, -1.0, (0.6, 0.6, 0.6)),  # 3/20 R^2 and 3/80 h^2
        (Cone(0.0, 2.0, 4.0), 16.0 / 3.0 * np.pi, 1.0, (0.6, 0.6, 0.6)),
        (Cone(2.0, 2.0, 3.0), 12.0 * np.pi, 0.0, (1.0, 1.0, 0.75)),
        (Disc(2.0), 0.0, 0.0, (0.0, 0.0, 0.0)),
    ],
)
def test_formulas_of_the_books(shape, volume, height, squares):
    found = shape_moments(shape)
    assert_allclose(found.volume_m3, volume, rtol=1e-15)
    assert_allclose(found.centroid_m, (0.0, 0.0, height), atol=1e-15)
    assert_allclose(found.second_moment_m2, np.diag(squares), rtol=1e-14)


@pytest.mark.parametrize(
    "shape",
    [
        Sphere(2.0, POSE),
        Capsule(1.0, 2.0, POSE),
        Cylinder(2.0, 3.0, POSE),
        Cone(2.0, 0.5, 3.0, POSE),
        Convex(CUBE, 0.5, POSE),
        Convex(HEXAGON, 0.5, POSE),
        Convex([(0, 0, 0), (1, 0, 0), (0.2, 0.7, 0)], 0.3, POSE),
        Convex(RNG.normal(size=(30, 3)), 0.2, POSE),
        Convex(RNG.normal(size=(4, 3)), 2.0, POSE),
        Convex([(1, 2, 3), (2, 0, 5)], 1.0, POSE),
    ],
)
def test_meshes_tend_to_it(shape):
    """Their error falls with the square of the chord's angle, so that two of them tell where they go."""
    origin = POSE.position_m
    coarse, fine = (mesh_sums(shape_mesh(shape, 128, halved=halved), origin) for halved in (False, True))
    limit = (fine.times(4.0 / 3.0) + coarse.times(-1.0 / 3.0)).moments(origin)
    assert_same(shape_moments(shape), limit, 1e-6)


def test_a_hull_without_a_radius_is_exact_and_a_box_as_one_is_the_box():
    assert_same(shape_moments(Convex(CUBE * (0.5, 1.0, 1.5), 0.0, POSE)), shape_moments(Box((1, 2, 3), POSE)), 1e-15)


@pytest.mark.parametrize("radius", [1e-6, 0.1, 10.0])
def test_a_thin_rounded_hull_is_a_capsule_and_a_small_one_a_sphere(radius):
    length = 2.0
    needle = np.array([(x, y, z) for x, y, _ in CUBE[::2] * 1e-7 * radius for z in (-length / 2, length / 2)])
    assert_same(shape_moments(Convex(needle, radius, POSE)), shape_moments(Capsule(radius, length, POSE)), 1e-6)
    speck = CUBE * 1e-7 * radius
    assert_same(shape_moments(Convex(speck, radius, POSE)), shape_moments(Sphere(radius, POSE)), 1e-6)


def test_a_cut_through_a_rounded_box_changes_nothing_but_what_is_counted_twice():
    """A bar with round ends is its two halves, each blown up, less the middle where they overlap: a plate, blown up."""
    whole = Convex(CUBE * (3.0, 1.0, 0.5), 0.4, POSE)
    left = Convex(CUBE * (1.5, 1.0, 0.5) - (1.5, 0.0, 0.0), 0.4, POSE)
    right = Convex(CUBE * (1.5, 1.0, 0.5) + (1.5, 0.0, 0.0), 0.4, POSE)
    plate = Convex(CUBE[4:] * (0.0, 1.0, 0.5), 0.4, POSE)
    left_, right_, plate_, whole_ = (
        sums_of(shape_moments(part), POSE.position_m) for part in (left, right, plate, whole)
    )
    together = (left_ + right_ + plate_.times(-1.0)).moments(POSE.position_m)
    assert_same(together, whole_.moments(POSE.position_m), 1e-14)
