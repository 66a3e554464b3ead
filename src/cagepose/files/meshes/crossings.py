"""Surfaces that run through themselves: `crosses_itself`."""

from __future__ import annotations

import numpy as np

from cagepose.files.meshes.cuts import separate
from cagepose.files.meshes.manifolds import Triangles

ASKED = 2000
"""Triangles of each part; of more, so many of them in all places."""
FEWER, LARGE = 500, 20_000
"""Of parts with so many triangles, which take milliseconds each."""
ABOVE = 1e-6
"""Of the size: so far outside of a triangle there is nothing of the part."""


def crosses_itself(mesh: Triangles) -> bool:
    """Whether a part that hangs together runs through itself.

    Just outside of a triangle, a ray enters as often as it leaves, but for where something is enclosed twice. Parts of
    their own may share volume: they are shapes that overlap.
    """
    for part in separate(mesh.body()):
        found = Triangles.of(part)
        if part.volume() >= (1.0 - 1e-9) * part.hull().volume() or part.num_tri() == 0:
            continue
        asked = FEWER if len(found.faces) > LARGE else ASKED
        chosen = np.arange(0, len(found.faces), max(1, len(found.faces) // asked))
        middles = found.vertices[found.faces[chosen]].mean(axis=1)
        starts = middles + ABOVE * mesh.size * found.normals[chosen]
        far = 3.0 * mesh.size * np.array((0.519, 0.623, 0.585))
        for start in starts:
            hits = part.ray_cast(start.tolist(), (start + far).tolist())
            if sum(1 if float(np.dot(hit.normal, far)) > 0.0 else -1 for hit in hits) != 0:
                return True
    return False
