"""Surfaces of one file whose names divide what is drawn, not bodies: `joined_where_open`."""

from __future__ import annotations

import numpy as np

from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.sides import open_sides


def joined_where_open(surfaces: dict[str, Triangles]) -> dict[str, Triangles]:
    """Return surfaces of which those that are open, and have a corner of open sides in common, are one, by the lowest
    of their names. Corners of each are one where they are at the same place.
    """
    names, first = list(surfaces), dict[tuple[float, ...], int]()
    root = list(range(len(names)))

    def leading(k: int) -> int:
        while root[k] != k:
            root[k] = root[root[k]]
            k = root[k]
        return k

    for k, mesh in enumerate(surfaces.values()):
        corners = np.unique(mesh.faces.ravel()[open_sides(mesh.faces)])
        for place in mesh.vertices[corners].tolist():
            low, high = sorted((leading(k), leading(first.setdefault(tuple(place), k))))
            root[high] = low
    groups = dict[int, list[str]]()
    for k, name in enumerate(names):
        groups.setdefault(leading(k), []).append(name)
    return {min(group): _one([surfaces[name] for name in group]) for group in groups.values()}


def _one(meshes: list[Triangles]) -> Triangles:
    """Return several surfaces as one, whose corners are one where they are at the same place."""
    if len(meshes) == 1:
        return meshes[0]
    n_before = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    places, same = np.unique(np.concatenate([mesh.vertices for mesh in meshes]), axis=0, return_inverse=True)
    faces = np.concatenate([mesh.faces + n for mesh, n in zip(meshes, n_before, strict=False)])
    return Triangles(places, same.ravel()[faces])
