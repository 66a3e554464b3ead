"""The nearest places of two bodies: each pair proves itself, by two planes that keep the bodies apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cagepose import Box, Pose
from cagepose.model.nearest import core_of, nearest_points
from cagepose.model.shapes import AnyShape, Capsule, Cone, Convex, Cylinder, Disc, Sphere
from cagepose.model.surface import shape_mesh

SEGMENTS = 96


def shapes(generator: np.random.Generator) -> list[Box | AnyShape]:
    """One of each kind, about 10 mm large."""
    a, b, c = generator.uniform(0.002, 0.01, 3)
    vertices = generator.normal(0.0, 0.005, (generator.integers(4, 12), 3))
    return [
        Box((a, b, c)), Sphere(a), Capsule(a, b), Cylinder(a, b), Cone(a, b, c), Cone(0.0, b, c), Disc(a),
        Convex(vertices), Convex(vertices, a), Convex(vertices[:3], b),
    ]  # fmt: skip


def turned(generator: np.random.Generator, away_m: float) -> Pose:
    way, quaternion = generator.normal(size=3), generator.normal(size=4)
    return Pose(away_m * way / np.linalg.norm(way), quaternion / np.linalg.norm(quaternion))


def test_no_two_places_of_the_bodies_are_nearer(cases: Callable[[int, int], int]) -> None:
    generator = np.random.default_rng(71)
    n_apart, n_pairs = 0, cases(100, 1500)
    for _ in range(n_pairs):
        kinds = shapes(generator), shapes(generator)
        one, other = (of[generator.integers(len(of))] for of in kinds)
        here, there = turned(generator, 0.0), turned(generator, generator.uniform(0.02, 0.06))
        cores = core_of(one, here), core_of(other, there)
        bare = nearest_points(*(core._replace(radius_m=0.0) for core in cores))
        if np.linalg.norm(bare[1] - bare[0]) < cores[0].radius_m + cores[1].radius_m + 1e-6:
            continue  # in each other
        foot, place = nearest_points(*cores)
        between = place - foot
        distance = float(np.linalg.norm(between))
        n_apart += 1
        normal = between / distance
        for shape, pose, end, way in ((one, here, foot, normal), (other, there, place, -normal)):
            heights = pose.transform(shape_mesh(shape, SEGMENTS).vertices_m) @ way - end @ way
            assert -5e-5 < heights.max() < 1e-9  # all of it is behind, and reaches there but for the mesh's chords
    assert n_apart > 0.8 * n_pairs
