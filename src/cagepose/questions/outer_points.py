"""Points on the outside of a part, so many that their convex hull is that of the part, or for what is round nearly."""

from __future__ import annotations

import math

import numpy as np

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hull import hull_of
from cagepose.model.shapes import Convex, Rounded, Shape, Turned
from cagepose.model.volume import BOX_SIGNS

N_AROUND = 64
"""Points on each rim; their hull lacks a thousandth of the radius."""
N_ON_BALL = 256
"""Points spread over the sphere about each corner that is blown up."""
AROUND = 2.0 * math.pi * (np.arange(N_AROUND) + 0.5) / N_AROUND
CIRCLE = np.stack([np.cos(AROUND), np.sin(AROUND)], axis=1)


def outer_points(shape: Shape) -> FloatArray:
    """Return points on a shape in its body's frame, (n, 3), metres: its corners, and some of what is round."""
    if isinstance(shape, Turned):
        rings = [np.insert(radius * CIRCLE, 2, height, axis=1) for height, radius in shape.rims]
        return shape.pose_body_shape.transform(np.concatenate(rings))
    if isinstance(shape, Rounded) and shape.radius_m > 0.0:
        return shape.pose_body_shape.transform(_blown_up(shape))
    if isinstance(shape, Box):
        return shape.pose_body_shape.transform(BOX_SIGNS * shape.size_m / 2.0)
    return shape.nodes_body()


def lowest_points(shape: Shape, downs: FloatArray) -> FloatArray:
    """Return points of what is round of a shape that are its lowest when unit vectors (n, 3) point down, (m, 3)."""
    pose = shape.pose_body_shape
    local = downs @ pose.rotation
    if isinstance(shape, Turned):
        sides = local[np.linalg.norm(local[:, :2], axis=1) > 0.0, :2]
        sides = sides / np.linalg.norm(sides, axis=1, keepdims=True)
        return pose.transform(np.concatenate([np.insert(radius * sides, 2, z, axis=1) for z, radius in shape.rims]))
    if isinstance(shape, Rounded) and shape.radius_m > 0.0:
        core = shape.core()
        return pose.transform(core[np.argmax(local @ core.T, axis=1)] + shape.radius_m * local)
    return np.zeros((0, 3))


def is_round(shape: Shape) -> bool:
    """Whether its points are not all of it."""
    return isinstance(shape, Turned) or (isinstance(shape, Rounded) and shape.radius_m > 0.0)


def _blown_up(shape: Rounded) -> FloatArray:
    """Return points on balls about the corners of a core, where these are on the outside: over each flat face, around
    each edge, and spread over the rest.
    """
    hull = shape.hull if isinstance(shape, Convex) else hull_of(shape.core())
    corners = hull.vertices_m
    ways = [_spread(N_ON_BALL), hull.normals.reshape(-1, 3)]
    for one, other in hull.edges.tolist():
        axis = unit_rows((corners[other] - corners[one])[None])
        frame = np.linalg.svd(axis)[2][1:]
        ways.append(CIRCLE @ frame)
    downs = np.concatenate(ways)
    heights = downs @ corners.T
    is_lowest = heights >= heights.max(axis=1, keepdims=True) - 1e-12 * float(np.abs(corners).max(initial=1e-300))
    which, corner = np.nonzero(is_lowest)
    found: FloatArray = corners[corner] + shape.radius_m * downs[which]
    return found


def _spread(n: int) -> FloatArray:
    """Return unit vectors in all directions, (n, 3), on a spiral."""
    heights = (2.0 * np.arange(n) + 1.0) / n - 1.0
    angles = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(n)
    radii = np.sqrt(1.0 - heights**2)
    spread: FloatArray = np.stack([radii * np.cos(angles), radii * np.sin(angles), heights], axis=1)
    return spread
