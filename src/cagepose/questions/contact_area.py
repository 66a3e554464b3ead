"""What of a part lies on a plane: which of its parts, and how far inside of it a point is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hull import hull_of
from cagepose.model.shapes import Rounded, Shape, Turned
from cagepose.model.volume import BOX_SIGNS

STEEP = 1e-6
"""Of one. A rim that leans by no more lies on the plane as a whole."""
AROUND = 2.0 * math.pi * np.arange(360) / 360


@dataclass(frozen=True)
class ContactArea:
    """What touches.

    Attributes
    ----------
    parts
        Numbers of the parts that touch.
    margin_m
        How far inside the hull of what touches a point is; of a line, how far from its nearer end, metres.
    is_flat
        Whether it is more than a line.
    """

    parts: tuple[int, ...]
    margin_m: float
    is_flat: bool


def contact_area(parts: Sequence[Shape], down: FloatArray, center_m: FloatArray, touch_m: float) -> ContactArea:
    """Return what of some parts touches a plane across ``down`` below them, and how far inside a centre is."""
    heights = np.array([float(part.heights_m(down[None])[0]) for part in parts])
    lowest = np.flatnonzero(heights >= heights.max() - touch_m).tolist()
    ways = np.linalg.svd(down[None])[2][1:]
    circles = [(ways @ (place - center_m), radius) for which in lowest for place, radius in _lowest(parts[which], down)]
    places, radii = np.array([place for place, _ in circles]), np.array([radius for _, radius in circles])
    spread = np.concatenate([places, *(place + radius * _ring() for place, radius in circles if radius > 0.0)])
    hull = hull_of(np.insert(spread, 2, 0.0, axis=1))
    if hull.dimension < 2:
        ends = hull.vertices_m[:, :2]
        along = ends[-1] - ends[0]
        length = float(np.linalg.norm(along))
        inside = min(float(-ends[0] @ along), float(ends[-1] @ along)) / length if length > touch_m else 0.0
        return ContactArea(tuple(lowest), max(inside, 0.0), False)
    loop = hull.vertices_m[list(hull.faces[0]), :2]
    sides = (np.roll(loop, -1, axis=0) - loop) @ np.array([(0.0, -1.0), (1.0, 0.0)])
    outward = sides * math.copysign(1.0, float(np.einsum("ij,ij->i", sides, loop - loop.mean(axis=0)).sum()))
    directions = np.concatenate([outward, -places[(radii > 0.0) & (np.linalg.norm(places, axis=1) > touch_m)]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    reach = (directions @ places.T + radii).max(axis=1)
    return ContactArea(tuple(lowest), max(float(reach.min()), 0.0), True)


def _ring() -> FloatArray:
    ring: FloatArray = np.stack([np.cos(AROUND), np.sin(AROUND)], axis=1)
    return ring


def _lowest(part: Shape, down: FloatArray) -> list[tuple[FloatArray, float]]:
    """Return the lowest places of a part in its body's frame, each the middle of a circle; of a point, radius zero."""
    pose = part.pose_body_shape
    local = pose.rotation.T @ down
    if isinstance(part, Turned):
        across = float(np.linalg.norm(local[:2]))
        lies = across <= STEEP
        rims = [(height, radius, height * float(local[2]) + radius * across) for height, radius in part.rims]
        deepest = max(depth for _, _, depth in rims)
        size = max(abs(height) + radius for height, radius, _ in rims)
        found = []
        for height, radius, depth in rims:
            if depth < deepest - STEEP * size:
                continue
            aside = (0.0, 0.0) if lies else radius * local[:2] / across
            found.append((pose.transform(np.array((*aside, height))), radius if lies else 0.0))
        return found
    if isinstance(part, Box):
        corners, radius = BOX_SIGNS * part.size_m / 2.0, 0.0
    elif isinstance(part, Rounded):
        corners, radius = part.core(), part.radius_m
    else:
        corners, radius = pose.inverse_transform(part.nodes_body()), 0.0
    heights = corners @ local
    extent = float(np.ptp(corners, axis=0).max()) + radius
    at_bottom = corners[heights >= heights.max() - STEEP * extent]
    return [(place, 0.0) for place in pose.transform(at_bottom + radius * local)]
