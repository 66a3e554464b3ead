"""A solid of a STEP file as facets that stand for its surfaces: `facets_on_surfaces`. Millimetres throughout."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cagepose.files.meshes.mesh_file import scaled
from cagepose.files.units import to_metres
from cagepose.model.boundary.exact_surface import surface_of
from cagepose.model.boundary.inexact import exact_faces, off_curves, off_surfaces
from cagepose.model.facets import FLAT, Facets
from cagepose.model.surfaces import Surface
from cagepose.model.wording import counted

MM = float(to_metres(1.0, "mm"))
"""Metres of a millimetre."""

SLACK = 4.0
"""In what corners are off their surfaces at most: what is as near is on them."""


class OnSurfaces(NamedTuple):
    """A shape, how far it is from the solid at most, and what of it is not exact, in sentences."""

    shape: Facets
    error: float
    notes: tuple[str, ...]


def facets_on_surfaces(solid: dict[str, Any], name: str) -> OnSurfaces:
    """Return a solid's triangles, which stand for its planes, cylinders, cones, spheres and tori; other faces are
    flat facets, and curves that are no lines or circles are chains of short arcs.

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
    metres = scaled(shape, MM)  # as scenes have it, which find the same surface again
    assert isinstance(metres, Facets)
    surface, faces = surface_of(metres), exact_faces(metres)
    facets, chains = max(solid["off_others"], off_surfaces(surface, metres) / MM), off_curves(surface) / MM
    notes = list[str]()
    if facets > 0.0:
        n_facets = counted((faces.n_facets, "flat facet", "flat facets"))
        off = f"where it is no plane, cylinder, cone, ball or outward torus, up to {facets:.2g} mm off"
        notes.append(f"{name!r} has {n_facets} {off}; exact: {faces.in_words or 'nothing'}")
    if chains > flat:
        notes.append(f"{name!r} has chains of short arcs where round faces cross, up to {chains:.2g} mm off")
    return OnSurfaces(shape, max(facets, chains, solid["off_surfaces"]), tuple(notes))
