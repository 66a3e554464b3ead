"""A solid of a STEP file as facets that stand for its surfaces: `facets_on_surfaces`. Millimetres throughout."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cagepose.model.boundary.exact_surface import surface_of
from cagepose.model.boundary.inexact import off_curves, off_surfaces
from cagepose.model.facets import FLAT, Facets
from cagepose.model.surfaces import Surface

SLACK = 4.0
"""In what corners are off their surfaces at most: what is as near is on them."""


class OnSurfaces(NamedTuple):
    """A shape, how far it is from the solid at most, and what of it is not exact, in sentences."""

    shape: Facets
    error: float
    notes: tuple[str, ...]


def facets_on_surfaces(solid: dict[str, Any], name: str) -> OnSurfaces:
    """Return a solid's triangles, which stand for its planes, cylinders, cones and spheres; other faces are flat
    facets, and curves that are no lines or circles are chains of short edges.

    Parameters
    ----------
    solid
        One of those that `cagepose.files.step.solids.read_step` returns, its surface closed.
    name
        Of the shape.
    """
    vertices, triangles = np.array(solid["vertices"]), np.array(solid["faces"])
    surfaces = [Surface(kind, tuple(point), tuple(axis), *sizes) for kind, point, axis, *sizes in solid["known"]]
    size = float(np.ptp(vertices, axis=0).max())
    flat = max(FLAT * size, SLACK * solid["off_surfaces"])
    shape = Facets(vertices, triangles, flat, None, name, surfaces, solid["on"])
    surface = surface_of(shape)
    facets = max(solid["off_others"], off_surfaces(surface, shape))
    chains, notes = off_curves(surface), list[str]()
    if facets > 0.0:
        notes.append(
            f"{name!r} has flat facets where it is no plane, cylinder, cone or ball, up to {facets:.2g} mm off"
        )
    if chains > flat:
        notes.append(f"{name!r} has chains of short edges where round faces cross, up to {chains:.2g} mm off")
    return OnSurfaces(shape, max(facets, chains, solid["off_surfaces"]), tuple(notes))
