"""Surfaces that run through themselves: `crosses_itself`."""

from __future__ import annotations

from typing import Any

import numpy as np

from cagepose.files.meshes.cuts import separate
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import DISTANCE_OUTSIDE, LEAST_PYRAMID
from cagepose.model.checks import FloatArray

TRIANGLES_ASKED = 2000
"""Triangles of each part; of more, so many of them in all places."""
ASKED_OF_LARGE, LARGE_PART = 500, 20_000
"""Triangles that are asked of parts with so many, which take milliseconds each."""


def crosses_itself(mesh: Triangles) -> bool:
    """Whether a part that hangs together runs through itself.

    Just outside of a triangle, a ray enters as often as it leaves, but for where something is enclosed twice. Parts of
    their own may share volume: they are shapes that overlap.
    """
    for part in separate(mesh.body()):
        found = Triangles.of(part)
        far = 3.0 * mesh.size * np.array((0.519, 0.623, 0.585))
        if part.num_tri() == 0 or _is_star(found, part, far):
            continue
        asked = ASKED_OF_LARGE if len(found.faces) > LARGE_PART else TRIANGLES_ASKED
        chosen = np.arange(0, len(found.faces), max(1, len(found.faces) // asked))
        middles = found.vertices[found.faces[chosen]].mean(axis=1)
        starts = middles + DISTANCE_OUTSIDE * mesh.size * found.normals[chosen]
        for start in starts:
            hits = part.ray_cast(start.tolist(), (start + far).tolist())
            if sum(1 if float(np.dot(hit.normal, far)) > 0.0 else -1 for hit in hits) != 0:
                return True
    return False


def _is_star(found: Triangles, part: Any, far: FloatArray) -> bool:
    """Whether all triangles of a part are seen from within, from one place, and cover its view once: it cannot cross
    itself then. What is convex is a star, and so is what is round and a little hollow where its facets meet.
    """
    middle = found.vertices.mean(axis=0)
    pyramids = np.einsum("ij,ij->i", found.areas, found.vertices[found.faces[:, 0]] - middle)
    is_seen = pyramids >= -LEAST_PYRAMID * found.size**3
    return bool(is_seen.all()) and len(part.ray_cast(middle.tolist(), (middle + far).tolist())) == 1
