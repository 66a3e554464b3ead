"""How far a boundary is from what its triangles stand for: `off_curves`, `off_surfaces`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cagepose.model.boundary.curves import CHAIN
from cagepose.model.finer import onto
from cagepose.model.surfaces import PLANE

if TYPE_CHECKING:
    from cagepose.model.boundary.exact_surface import ExactSurface
    from cagepose.model.facets import Facets


def off_curves(surface: ExactSurface) -> float:
    """Return how far chains of short edges are from the curves in which surfaces cross, metres."""
    farthest = 0.0
    for curve in surface.curves:
        known = [surface.regions.surfaces[region] for region in (curve.left, curve.right)]
        if curve.kind == CHAIN and any(face.is_round for face in known):
            places = surface.vertices_m[curve.nodes]
            middles = (places[:-1] + places[1:]) / 2.0
            farthest = max(farthest, float(np.linalg.norm(onto(middles, known) - middles, axis=1).max()))
    return farthest


def off_surfaces(surface: ExactSurface, shape: Facets) -> float:
    """Return how far flat facets are from the round surfaces that they stand for and are not known as, metres."""
    kinds = np.array([face.kind == PLANE for face in surface.regions.surfaces])[surface.regions.of_triangles]
    farthest = 0.0
    for index, known in enumerate(shape.surfaces):
        lost = kinds & (shape.on == index)
        if known.is_round and lost.any():
            corners = shape.vertices_m[shape.triangles[lost]]
            middles = np.concatenate(
                [corners.mean(axis=1), *((corners + np.roll(corners, 1, axis=1)) / 2.0).swapaxes(0, 1)]
            )
            farthest = max(farthest, float(np.abs(known.heights(middles)).max()))
    return farthest
