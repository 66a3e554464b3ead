"""What of a boundary is exact, and how far it is from what its triangles stand for: `exact_faces`, `off_curves`,
`off_surfaces`.
"""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np

from cagepose.model.boundary.chains import ALONG, exact_beside
from cagepose.model.boundary.curves import ARC
from cagepose.model.boundary.exact_surface import ExactSurface, surface_of
from cagepose.model.facets import Facets
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE, TORUS
from cagepose.model.wording import counted

PLURALS = {TORUS: "tori"}
"""Of kinds of surfaces that have no s."""


class ExactFaces(NamedTuple):
    """How many faces of a body are exact, by the kind of surface that they lie on, and how many triangles of others
    are flat facets.
    """

    of_kinds: dict[str, int]
    n_facets: int

    @property
    def in_words(self) -> str:
        """Those that are exact, such as "12 planes, 4 cylinders"."""
        return counted(*((number, kind, PLURALS.get(kind, f"{kind}s")) for kind, number in self.of_kinds.items()))


def exact_faces(shape: Facets) -> ExactFaces:
    """Return which faces of a body are exact; those of one surface that meet are one face."""
    if not shape.surfaces:
        return ExactFaces({}, len(shape.triangles))
    regions = surface_of(shape).regions
    is_exact = np.array(regions.is_exact)
    found = Counter(face.kind for face, exact in zip(regions.surfaces, regions.is_exact, strict=True) if exact)
    kinds = {kind: found[kind] for kind in (PLANE, CYLINDER, CONE, SPHERE, TORUS) if found[kind]}
    return ExactFaces(kinds, int((~is_exact[regions.of_triangles]).sum()))


def off_curves(surface: ExactSurface) -> float:
    """Return how far lines and arcs are from the curves in which surfaces cross, metres."""
    farthest = 0.0
    for curve in surface.curves:
        beside = exact_beside(curve, surface.regions)
        if not any(face.is_round for face in beside):
            continue
        if curve.kind == ARC:
            places = curve.at(ALONG, surface.vertices_m)
        else:
            start, end = surface.vertices_m[curve.nodes[[0, -1]]]
            places = start + np.outer(ALONG, end - start)
        farthest = max(farthest, *(float(np.abs(face.heights(places)).max()) for face in beside))
    return farthest


def off_surfaces(surface: ExactSurface, shape: Facets) -> float:
    """Return how far flat facets are from the round surfaces that they stand for and are not known as, metres."""
    kinds = np.array([face.kind == PLANE for face in surface.regions.surfaces])[surface.regions.of_triangles]
    farthest = 0.0
    for index, known in enumerate(shape.surfaces):
        lost = kinds & (surface.on == index)
        if known.is_round and lost.any():
            corners = surface.vertices_m[surface.triangles[lost]]
            middles = np.concatenate(
                [corners.mean(axis=1), *((corners + np.roll(corners, 1, axis=1)) / 2.0).swapaxes(0, 1)]
            )
            farthest = max(farthest, float(np.abs(known.changed(1.0, shape.pose_body_shape).heights(middles)).max()))
    return farthest
