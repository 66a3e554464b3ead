"""Unions with round shapes: exact where they only touch, and to 1e-6 of what overlaps against closed forms."""

from __future__ import annotations

import sys
from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Capsule, Cone, Convex, Cylinder, Disc, MissingExtraError, Object, Pose, SceneError, Sphere
from cagepose.model.apart import are_apart
from cagepose.model.shape_moments import shape_moments
from cagepose.model.union import body_moments

PI = np.pi
TURNED = Pose((3.0, -1.0, 2.0), (0.4, 0.3, -0.6, 0.2))
FLAT = Pose(euler_zyx=(0.0, PI / 2, 0.0))


def at(*position, euler=(0.0, 0.0, 0.0)):
    return TURNED @ Pose(position, euler_zyx=euler)


def lens(r, s, d):
    """The common volume of two balls at a distance d."""
    return PI * (r + s - d) ** 2 * (d * d + 2 * d * (r + s) - 3 * (r - s) ** 2) / (12.0 * d)


OVERLAPS = [
    ([Cylinder(1, 4, at(0, 0, 0)), Cylinder(1, 4, at(0, 0, 0, euler=(0.0, PI / 2, 0.0)))], 8 * PI, 16.0 / 3.0),
    ([Sphere(1, at(0, 0, 0)), Sphere(0.7, at(0, 0.6, 0.8))], 4 / 3 * PI * (1 + 0.7**3), lens(1, 0.7, 1.0)),
    ([Sphere(1, at(0, 0, 0)), Box((4, 4, 4), at(2.3, 0, 0))], 4 / 3 * PI + 64, PI / 3 * 0.49 * 2.3),
    ([Cylinder(0.5, 4, at(0, 0, 0)), Box((2, 2, 1), at(0.1, 0.2, 0))], PI + 4, PI / 4),
    ([Capsule(0.5, 4, at(0, 0, 0)), Box((2, 2, 1), at(0.1, 0.2, 0))], PI + PI / 6 + 4, PI / 4),
    ([Cone(0.5, 0.2, 2, at(0, 0, 0)), Cylinder(2, 1, at(0.3, 0, 0))], 0.26 * PI + 4 * PI, PI / 3 * 0.373125),
    ([Sphere(0.3, at(0.2, 0, 0)), Cylinder(2, 1, at(0.3, 0, 0))], 0.036 * PI + 4 * PI, 0.036 * PI),
    ([Cylinder(2, 1, at(0, 0, 0)), Disc(1, at(0, 0, 0)), Cylinder(1, 1, at(0, 0, 0))], 5 * PI, PI),
    (
        [
            *(Box((1, 1, 1), at(0, 0, 0)), Box((1, 1, 1), at(0.5, 0, 0))),
            *(Sphere(0.2, at(0.25, 0, 0)), Sphere(9, at(0, 0, 99))),
        ],
        2 + 4 / 3 * PI * (0.008 + 729),
        0.5 + 4 / 3 * PI * 0.008,
    ),
]


@pytest.mark.parametrize(("parts", "total", "shared"), OVERLAPS)
def test_what_overlaps_counts_once(parts, total, shared):
    found = body_moments(parts)
    assert abs(found.volume_m3 - (total - shared)) < 1e-6 * shared


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e3])
def test_a_ball_cut_by_a_box_has_the_cap_s_centroid_and_second_moment(scale):
    """The cap of a ball of radius 1 above height h, by integrals of powers of z; below it lies a box."""
    pose, h = Pose((7, 8, 9), (0.3, 0.1, -0.2, 0.9)), 0.3
    placed = lambda z: Pose(pose.transform((0, 0, z)) * scale, pose.quaternion_wxyz)  # noqa: E731
    found = body_moments([Sphere(scale, placed(0.0)), Box((4 * scale, 4 * scale, 4 * scale), placed(h - 2.0))])
    power = lambda n: (1 - h ** (n + 1)) / (n + 1) - (1 - h ** (n + 3)) / (n + 3)  # noqa: E731 (integral of z^n (1 - z^2))
    volume = PI * power(0) + 64.0
    height = (PI * power(1) + 64.0 * (h - 2.0)) / volume
    across = (PI / 4 * ((1 - h) - 2 / 3 * (1 - h**3) + (1 - h**5) / 5) + 64.0 * 4.0 / 3.0) / volume
    along = (PI * power(2) + 64.0 * (4.0 / 3.0 + (h - 2.0) ** 2)) / volume - height**2
    second = pose.rotation @ np.diag((across, across, along)) @ pose.rotation.T
    assert_allclose(found.volume_m3, volume * scale**3, rtol=1e-7)
    assert_allclose(found.centroid_m, pose.transform((0, 0, height)) * scale, rtol=1e-8)
    assert_allclose(found.second_moment_m2, second * scale**2, rtol=0.0, atol=1e-7 * scale**2)


FLUSH = [
    [Box((4, 4, 1), at(0, 0, 0)), Cylinder(1, 2, at(0, 0, 1.5))],
    [Box((4, 4, 1), at(0, 0, 0)), Cylinder(1, 2, at(0, 0, 1.5, euler=(0.3, PI / 2, 0)))],
    [Sphere(1, at(0, 0, 0)), Sphere(2, at(3, 0, 0))],
    [Cylinder(1, 2, at(0, 0, 0)), Cylinder(2, 2, at(3, 0, 0))],
    [Cylinder(1, 2, at(0, 0, 0)), Cylinder(2, 2, at(3, 0, 0.3))],
    [Cone(1, 0.2, 2, at(0, 0, 0)), Cone(0.2, 1, 2, at(0, 0, 2))],
    [Capsule(1, 2, at(0, 0, 0)), Capsule(1, 2, at(2, 0, 0, euler=(0, 0, 1.0)))],
    [Convex([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], 0.0, at(0, 0, 0)), Box((1, 1, 1), at(-0.5, 0, 0))],
    [Convex([(0, 0, 0), (1, 0, 0), (0, 1, 0)], 0.2, at(0, 0, 0)), Box((3, 3, 1), at(0, 0, 0.7))],
]


@pytest.mark.parametrize("parts", FLUSH)
def test_what_only_touches_is_added_up_in_closed_form_without_the_extra(parts, monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    found = body_moments(parts)
    each = [shape_moments(part) for part in parts]
    volumes = np.array([moments.volume_m3 for moments in each])
    middle = volumes @ np.array([moments.centroid_m for moments in each]) / volumes.sum()
    second = sum(
        volume * (moments.second_moment_m2 + np.outer(moments.centroid_m - middle, moments.centroid_m - middle))
        for volume, moments in zip(volumes, each, strict=True)
    )
    assert_allclose(found.volume_m3, volumes.sum(), rtol=1e-14)
    assert_allclose(found.centroid_m, middle, rtol=1e-14)
    assert_allclose(found.second_moment_m2, second / volumes.sum(), rtol=0.0, atol=1e-13)


def test_overlap_without_the_extra_names_it_and_the_other_way_out(monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    parts = [Sphere(1), Sphere(1, Pose((0.1, 0, 0)))]
    with pytest.raises(MissingExtraError, match=r"pip install 'cagepose\[shapes\]', or give the object's center_of"):
        Object(shapes=parts)
    held = Object(shapes=parts, center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.eye(3))
    assert held.gyration_m2.tolist() == np.eye(3).tolist()


def test_a_body_without_volume_needs_its_mass_properties():
    for given in ({}, {"center_of_gravity_m": (0, 0, 0)}, {"mass_kg": 1.0, "inertia_kg_m2": np.eye(3)}):
        with pytest.raises(SceneError, match=r"^has no volume, as discs and holes have none; give its center_of"):
            Object(shapes=[Disc(1.0)], **given)
    Object(shapes=[Disc(1.0)], center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.eye(3))


@pytest.mark.parametrize("seed", range(12))
def test_shapes_are_apart_if_and_only_if_a_plane_can_be_put_between_them(seed):
    rng = np.random.default_rng(seed)
    across = rng.normal(size=(20_000, 3))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    pose = lambda: Pose(rng.uniform(-1.6, 1.6, 3), rng.normal(size=4))  # noqa: E731
    shapes = [
        Sphere(0.5, pose()),
        Capsule(0.3, 2.0, pose()),
        Cylinder(0.7, 1.5, pose()),
        Cone(0.9, 0.0, 1.0, pose()),
        Convex(rng.normal(size=(9, 3)), 0.1, pose()),
        Box((1, 2, 0.5), pose()),
    ]
    for one, other in combinations(shapes, 2):
        gap_m = float(-(one.heights_m(across) + other.heights_m(-across)).min())
        if gap_m > 0.0 or gap_m < -0.05:  # planes are 0.02 rad from each other
            assert are_apart(one, other) == are_apart(other, one) == (gap_m > 0.0), gap_m
