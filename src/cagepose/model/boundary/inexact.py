"""What of a boundary is exact, and how far it is from what its triangles stand for: `exact_faces`, `off_curves`,
`off_surfaces`.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np

from cagepose.model.boundary.curves import BOW, CHAIN
from cagepose.model.boundary.exact_surface import ExactSurface, surface_of
from cagepose.model.facets import Facets
from cagepose.model.finer import onto
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE
from cagepose.model.wording import counted


class ExactFaces(NamedTuple):
    """How many faces of a body are exact, by the kind of surface that they lie on, and how many triangles of others
    are flat facets.
    """

    of_kinds: dict[str, int]
    n_facets: int

    @property
    def in_words(self) -> str:
        """Those that are exact, such as "12 planes, 4 cylinders"."""
        return counted(*((number, kind, f"{kind}s") for kind, number in self.of_kinds.items()))


def exact_faces(shape: Facets) -> ExactFaces:
    """Return which faces of a body are exact; those of one surface that meet are one face."""
    if not shape.surfaces:
        return ExactFaces({}, len(shape.triangles))
    regions = surface_of(shape).regions
    is_exact = np.array(regions.is_exact)
    found = Counter(face.kind for face, exact in zip(regions.surfaces, regions.is_exact, strict=True) if exact)
    kinds = {kind: found[kind] for kind in (PLANE, CYLINDER, CONE, SPHERE) if found[kind]}
    return ExactFaces(kinds, int((~is_exact[regions.of_triangles]).sum()))


def off_curves(surface: ExactSurface) -> float:
    """Return how far chains of short edges are from the curves in which surfaces cross, metres."""
    farthest = 0.0
    for curve in surface.curves:
        beside, is_exact = (curve.left, curve.right), surface.regions.is_exact
        # a facet beside a bow crosses the round side anywhere
        known = [surface.regions.surfaces[region] for region in beside if curve.kind == CHAIN or is_exact[region]]
        if curve.kind in (CHAIN, BOW) and any(face.is_round for face in known):
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
