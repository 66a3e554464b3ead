"""How far one surface is from another: `farthest_from`."""

from __future__ import annotations

import numpy as np

from cagepose.files.extra import files_library
from cagepose.files.meshes.manifolds import Triangles

N_SAMPLES = 4000
"""Points of each surface that are asked how far they are from the other."""


def farthest_from(one: Triangles, other: Triangles, n_samples: int = N_SAMPLES, *, outside: bool = False) -> float:
    """Return how far points of one surface, so many spread evenly and as many at its corners, are from another at most.

    ``outside``: of those alone that are outside of it, as between the parts of a body there may be gaps within it.
    """
    trimesh = files_library("trimesh", "a mesh that is not convex needs trimesh")
    files_library("rtree", "a mesh that is not convex needs rtree")
    random = np.random.default_rng(0)
    doubled = np.linalg.norm(one.areas, axis=1)
    chosen = one.vertices[one.faces[random.choice(len(one.faces), n_samples, p=doubled / doubled.sum())]]
    inside = np.einsum("ij,ijk->ik", random.dirichlet(np.ones(3), n_samples), chosen)
    corners = one.vertices[:: max(1, len(one.vertices) // n_samples)]
    surface = trimesh.Trimesh(other.vertices, other.faces, process=False)
    points = np.concatenate([inside, corners])
    nearest, distances, faces = trimesh.proximity.closest_point(surface, points)
    is_outside = np.einsum("ij,ij->i", points - nearest, other.normals[faces]) > 0.0
    return float(distances[is_outside].max(initial=0.0) if outside else distances.max())
