"""Edges at which a body is not convex, and how deep they are: `reflex_edges`, `hollow_depth`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import VOLUME_NOT_CONVEX

BLUNT = 0.9
"""Cosine between the faces of an edge. One with a greater cosine is a step of a round, and blunt."""
AT_ONCE = 1000
"""Points whose depths are found together: arrays of more take much memory."""


class Edges(NamedTuple):
    """Edges of a surface, (n, 2): their corners; and the two triangles at each."""

    corners: NDArray[np.int64]
    faces: NDArray[np.int64]

    def of(self, chosen: NDArray[np.bool_]) -> Edges:
        """Return some of them."""
        return Edges(self.corners[chosen], self.faces[chosen])


def edges_of(mesh: Triangles) -> Edges:
    """Return all edges of a closed surface."""
    sides = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    face = np.repeat(np.arange(len(mesh.faces)), 3)
    order = np.lexsort((sides.max(axis=1), sides.min(axis=1)))
    pairs = order.reshape(-1, 2)  # each edge is a side of two triangles
    return Edges(np.sort(sides[pairs[:, 0]], axis=1), face[pairs])


def reflex_edges(mesh: Triangles, allowed: float) -> Edges:
    """Return the edges that are hollow: on either side, the other triangle stands out by more than ``allowed``."""
    edges = edges_of(mesh)
    third = mesh.faces[edges.faces].sum(axis=2) - edges.corners.sum(axis=1)[:, None]
    start = mesh.vertices[edges.corners[:, 0]]
    out = [
        np.einsum("ij,ij->i", mesh.normals[edges.faces[:, side]], mesh.vertices[third[:, 1 - side]] - start)
        for side in (0, 1)
    ]
    return edges.of(np.minimum(*out) > allowed)


def hollow_depth(body: Any, allowed: float) -> float | None:
    """Return how deep the hollow edges of a body that hangs together are within its hull; None: it is not convex.

    It is, if the edges that are deeper than ``allowed`` are blunt, as between the facets of what is round.
    """
    hull = body.hull()
    if hull.volume() - body.volume() > max(VOLUME_NOT_CONVEX * hull.volume(), allowed * hull.surface_area()):
        return None
    mesh, around = Triangles.of(body), Triangles.of(hull)
    edges = reflex_edges(mesh, allowed)
    if len(edges.corners) == 0:
        return 0.0
    sides = around.vertices[np.roll(around.faces, -1, axis=1)] - around.vertices[around.faces]
    thin = np.linalg.norm(around.areas, axis=1) <= allowed * np.linalg.norm(sides, axis=2).max(axis=1)
    normals = around.normals[~thin]  # a thinner triangle tells no plane
    planes = np.einsum("ij,ij->i", normals, around.vertices[around.faces[~thin, 0]])
    ends = mesh.vertices[edges.corners]
    asked = np.concatenate([ends[:, 0], ends[:, 1], ends.mean(axis=1)])
    rows = np.array_split(asked, 1 + len(asked) // AT_ONCE)
    depths = np.concatenate([(planes - some @ normals.T).min(axis=1) for some in rows]).reshape(3, -1).max(axis=0)
    is_sharp = np.einsum("ij,ij->i", *np.moveaxis(mesh.normals[edges.faces], 1, 0)) < BLUNT
    return None if (is_sharp & (depths > allowed)).any() else float(depths.max())
