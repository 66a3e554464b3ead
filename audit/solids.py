"""How far a place is from a body: signed distances of shapes in closed form, below zero within, in numpy.

Distances of a union of shapes, each less its holes, are exact outside of it but beside a hole, and have the right sign
everywhere; within, they may tell less than the whole depth, never more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from scipy.spatial import ConvexHull

from audit.case import FloatArray
from cagepose import Box, Capsule, Cone, Convex, Cylinder, Disc, Hole, Pose, Sphere
from cagepose.model.shapes import Shape

Distance = Callable[[FloatArray], FloatArray]
"""Of places (n, 3) in metres, in a body's frame: (n,)."""
Profile = Sequence[tuple[float, float]]
"""Heights and radii of what turns about z, from below."""
OPEN = 1e-6
"""Of a hole's reach: how far it is taken to reach beyond an open end; one this close to a face is open there."""


def rotation_of(pose: Pose) -> FloatArray:
    """Return the rotation matrix of a pose, from its quaternion."""
    scalar, vector = pose.quaternion_wxyz[0], pose.quaternion_wxyz[1:]
    across = np.cross(np.eye(3), vector)
    matrix: FloatArray = np.eye(3) + 2.0 * scalar * across + 2.0 * across @ across
    return matrix


def profile_of(shape: Shape) -> Profile:
    """Return the line that makes a shape by turning about its z axis."""
    if isinstance(shape, Cylinder):
        return (-shape.length_m / 2, shape.radius_m), (shape.length_m / 2, shape.radius_m)
    if isinstance(shape, Cone):
        return (-shape.length_m / 2, shape.radius_bottom_m), (shape.length_m / 2, shape.radius_top_m)
    if isinstance(shape, Disc):
        return ((0.0, shape.radius_m),)
    assert isinstance(shape, Hole)
    if shape.chamfer is None:
        return (-shape.depth_m, shape.radius_m), (0.0, shape.radius_m)
    lower = -shape.chamfer.width_m / np.tan(shape.chamfer.angle_rad)
    widest = shape.radius_m + shape.chamfer.width_m
    return (-shape.depth_m, shape.radius_m), (lower, shape.radius_m), (0.0, widest)


def body_distance(solids: Sequence[Shape], holes: Sequence[Hole]) -> Distance:
    """Return the signed distance of a union of shapes less their holes, and of holes that stand alone.

    Raises
    ------
    NotImplementedError
        A flat polygon with a radius.
    """
    placed = {solid.name: _placed(solid, _distance(solid)) for solid in solids}
    parts = []
    for name, of_solid in placed.items():
        cuts = [_cut(hole, [placed[each] for each in hole.in_]) for hole in holes if name in hole.in_]
        parts.append((of_solid, cuts))
    parts += [(_placed(hole, _slab(hole)), [_cut(hole, [])]) for hole in holes if not hole.in_]

    def distance(places: FloatArray) -> FloatArray:
        nearest = np.full(len(places), np.inf)
        for solid, cuts in parts:
            found = solid(places)
            for cut in cuts:
                near = np.flatnonzero(found < nearest)
                found[near] = np.maximum(found[near], -cut(places[near]))
            np.minimum(nearest, found, out=nearest)
        return nearest

    return distance


def _placed(shape: Shape, own: Distance) -> Distance:
    rotation, position = rotation_of(shape.pose_body_shape), shape.pose_body_shape.position_m
    return lambda places: own((places - position) @ rotation)


def _cut(hole: Hole, solids: Sequence[Distance]) -> Distance:
    """Return the signed distance of what a hole takes away: a hair beyond its mouth, and its bottom if that is open."""
    profile, hair = profile_of(hole), OPEN * float(np.hypot(hole.radius_m, hole.depth_m))
    top, bottom = (hair, profile[-1][1]), (-hole.depth_m - 2.0 * hair, hole.radius_m)
    below = rotation_of(hole.pose_body_shape) @ (0.0, 0.0, bottom[0]) + hole.pose_body_shape.position_m
    is_open = all(solid(below[None])[0] > 0.0 for solid in solids)
    return _placed(hole, _turned([*([bottom] if is_open else []), *profile, top]))


def _distance(shape: Shape) -> Distance:
    """Return the signed distance of one shape in its own frame."""
    if isinstance(shape, Box):
        return _box(shape.size_m / 2.0)
    if isinstance(shape, Sphere):
        return _bar(shape.radius_m, 0.0)
    if isinstance(shape, Capsule):
        return _bar(shape.radius_m, shape.length_m / 2.0)
    return _hull(shape) if isinstance(shape, Convex) else _turned(profile_of(shape))


def _box(half: FloatArray) -> Distance:
    def distance(places: FloatArray) -> FloatArray:
        beyond = np.abs(places) - half
        found: FloatArray = np.linalg.norm(beyond.clip(0.0), axis=1) + beyond.max(axis=1).clip(max=0.0)
        return found

    return distance


def _bar(radius: float, half: float) -> Distance:
    def distance(places: FloatArray) -> FloatArray:
        x, y, z = places.T
        found: FloatArray = np.sqrt(x * x + y * y + (np.abs(z) - half).clip(0.0) ** 2) - radius
        return found

    return distance


def _slab(hole: Hole) -> Distance:
    return lambda places: np.maximum(places[:, 2], -hole.depth_m - places[:, 2])


def _turned(profile: Profile) -> Distance:
    """Of the half plane (distance from the axis, height): how far the nearest side of the profile is."""
    heights, radii = np.array(profile, dtype=np.float64).T
    ends = [(heights[0], 0.0), *zip(heights, radii, strict=True), (heights[-1], 0.0)]
    sides = [(one, other) for one, other in pairwise(ends) if one != other]

    def distance(places: FloatArray) -> FloatArray:
        x, y, z = places.T
        out = np.sqrt(x * x + y * y)
        nearest = np.full(len(places), np.inf)
        for (height, radius), (next_height, next_radius) in sides:
            rise, widening = next_height - height, next_radius - radius
            length = rise * rise + widening * widening
            share = (((z - height) * rise + (out - radius) * widening) / length).clip(0.0, 1.0)
            gap = (z - height - share * rise) ** 2 + (out - radius - share * widening) ** 2
            np.minimum(nearest, gap, out=nearest)
        is_in = (z > heights[0]) & (z < heights[-1]) & (out < np.interp(z, heights, radii))
        found: FloatArray = np.sqrt(nearest)
        return np.where(is_in, -found, found)

    return distance


def hull_facets(shape: Convex) -> tuple[FloatArray, FloatArray]:
    """Return triangles (n, 3, 3) and outward normals (n, 3) of a hull with a volume; SciPy finds them.

    Raises
    ------
    NotImplementedError
        It is flat.
    """
    if np.linalg.matrix_rank(shape.vertices_m - shape.vertices_m[0]) < 3:
        raise NotImplementedError("a flat hull with a radius")
    hull = ConvexHull(shape.vertices_m)
    return shape.vertices_m[hull.simplices], hull.equations[:, :3]


def _hull(shape: Convex) -> Distance:
    triangles, normals = hull_facets(shape)
    offsets = np.einsum("ij,ij->i", normals, triangles[:, 0])

    def distance(places: FloatArray) -> FloatArray:
        planes: FloatArray = (places @ normals.T - offsets).max(axis=1)
        if shape.radius_m == 0.0:
            return planes
        near = np.flatnonzero((planes > 0.0) & (planes < 2.0 * shape.radius_m))
        planes[near] = _to_triangles(places[near], triangles, normals)
        return planes - shape.radius_m

    return distance


def _to_triangles(places: FloatArray, triangles: FloatArray, normals: FloatArray) -> FloatArray:
    """Return the distance of places (n, 3) from the nearest of some triangles."""
    heights = np.einsum("nk,mk->nm", places, normals) - np.einsum("mk,mk->m", normals, triangles[:, 0])
    is_over = np.ones(heights.shape, dtype=bool)
    nearest = np.full(heights.shape, np.inf)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        side = triangles[:, end] - triangles[:, start]
        arms = places[:, None] - triangles[None, :, start]
        third = triangles[:, 3 - start - end] - triangles[:, start]
        inwards = third - side * (np.einsum("mk,mk->m", third, side) / np.einsum("mk,mk->m", side, side))[:, None]
        is_over &= np.einsum("nmk,mk->nm", arms, inwards) >= 0.0
        share = (np.einsum("nmk,mk->nm", arms, side) / np.einsum("mk,mk->m", side, side)).clip(0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(arms - share[..., None] * side, axis=2))
    found: FloatArray = np.where(is_over, np.abs(heights), nearest).min(axis=1)
    return found
