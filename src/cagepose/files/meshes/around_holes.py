"""Cuts of a body that round holes ask for, which are filled in it: `cut_at_steps`, `set_apart`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import permutations
from typing import Any

import numpy as np

from cagepose.files.meshes.cuts import cut_above, tidy
from cagepose.files.meshes.edges import hollow_depth
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.tolerances import COSINE_ALONG_AXIS, DISTANCE_TO_BOTTOM, ROUNDING_OF_MESH, SAME_PLANE
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole

WIDTHS = (1.5, 1.2, 1.05)
"""Widths of a block around a hole, in widths of the hole's edge. The first that is convex is taken."""
SHARE_BEYOND = 0.1
"""Share of a hole's radius. A block goes on so far beyond both ends of the hole."""
SQUARE = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])


def cut_at_steps(body: Any, holes: Sequence[Hole]) -> list[Any]:
    """Return a body, cut where a hole ends at the bottom of a wider one; holes that are alike end in one plane."""
    size = Triangles.of(body).size
    parts, planes = [body], np.empty((0, 4))
    for hole, other in permutations(holes, 2):
        axis = hole.pose_body_shape.rotation[:, 2]
        for end in _ends_at_bottom(hole, other):
            plane = np.append(axis, axis @ end)
            apart = np.abs(np.concatenate([planes - plane, planes + plane])).max(axis=1) if len(planes) else [np.inf]
            if np.min(apart) > SAME_PLANE * size:
                planes = np.vstack([planes, plane])
                halves = [half for part in parts for half in cut_above(part, axis, float(axis @ end))]
                parts = tidy(halves, ROUNDING_OF_MESH * size)
    return parts


def set_apart(body: Any, holes: Sequence[Hole]) -> tuple[list[Any], Any]:
    """Return convex blocks of a body, each around one of the holes, and the rest of it. A hole that has no convex block
    around it stays in the rest.
    """
    blocks, rest = [], body
    mesh = Triangles.of(body)
    allowed = ROUNDING_OF_MESH * mesh.size
    for hole in sorted(holes, key=lambda one: -one.radius_m):  # a narrower one may go on from its bottom
        for width in WIDTHS:
            block = _block(mesh, hole, width, holes)
            inside = tidy([rest ^ block], allowed)
            if len(inside) == 1 and hollow_depth(inside[0], allowed) is not None:
                blocks += inside
                rest = (rest - block).as_original().simplify(allowed)
                break
    return blocks, rest


def _block(mesh: Triangles, hole: Hole, width: float, holes: Sequence[Hole]) -> Any:
    """Return a square prism around a hole, with sides along the largest face of a body that is along the hole."""
    axis, mouth = hole.pose_body_shape.rotation[:, 2], hole.pose_body_shape.position_m
    is_along = np.abs(mesh.normals @ axis) < COSINE_ALONG_AXIS
    largest = int(np.where(is_along, np.linalg.norm(mesh.areas, axis=1), -1.0).argmax())
    toward = mesh.normals[largest] if is_along.any() else hole.pose_body_shape.rotation[:, 0]
    half = width * max(radius for _, radius in hole.rims)
    sides = half * SQUARE @ np.stack([toward, np.cross(axis, toward)])
    beyond = SHARE_BEYOND * hole.radius_m
    goes_on = any(_ends_at_bottom(other, hole) for other in holes)
    ends = np.outer((beyond, -hole.depth_m - (0.0 if goes_on else beyond)), axis)
    return manifold3d().Manifold.hull_points((mouth + sides + ends[:, None]).reshape(-1, 3))


def _ends_at_bottom(hole: Hole, other: Hole) -> list[FloatArray]:
    """Return the end of a hole that is within the bottom of a wider one, if one is."""
    if hole.radius_m >= other.radius_m:
        return []
    found = []
    for end in hole.nodes_body():
        x, y, z = other.pose_body_shape.inverse_transform(end).tolist()
        if math.hypot(x, y) < other.radius_m and abs(z + other.depth_m) < DISTANCE_TO_BOTTOM * other.radius_m:
            found.append(end)
    return found
