"""coacd in a process of its own: arrays of corners and triangles in, convex parts out."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from cagepose.files.extra import require
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.own_process import answer, ask
from cagepose.model.checks import FloatArray

MOST_SECONDS = 60.0
MOST_CONCAVITY = 0.05
"""Greatest concavity of parts, as coacd measures it."""
CORNERS_OF_PART = 100
SEARCH_ITERATIONS = 20
"""Iterations of its search for a cut. 60 take twice as long and are much nearer on one part of five. A wavy slab, a
ring, a slotted plate and two trays are 0.025, 0.023, 0.020, 0.011 and 0.025 of the size off then, and 0.026, 0.022,
0.012, 0.019 and 0.026 after these."""


def convex_parts(mesh: Triangles) -> list[FloatArray]:
    """Return the corners of convex parts, (n, 3) each.

    Raises
    ------
    SceneError
        It takes too long, or cannot.
    MissingExtraError
        coacd is not installed.
    """
    require("coacd", "a mesh that is not convex needs coacd", "files")
    given = io.BytesIO()
    np.savez(given, vertices=mesh.vertices, faces=mesh.faces, concavity=MOST_CONCAVITY)
    found = np.load(io.BytesIO(ask(__name__, given.getvalue(), MOST_SECONDS, "coacd")))
    return [found[key] for key in sorted(found.files, key=int)]


def _parts(mesh: bytes) -> bytes:
    import coacd

    given = np.load(io.BytesIO(mesh))
    coacd.set_log_level("off")
    parts = coacd.run_coacd(
        coacd.Mesh(given["vertices"], given["faces"]),
        threshold=float(given["concavity"]),
        preprocess_mode="off",
        mcts_iterations=SEARCH_ITERATIONS,
        decimate=True,
        max_ch_vertex=CORNERS_OF_PART,
    )
    found = io.BytesIO()
    arrays: dict[str, Any] = {str(index): np.asarray(corners) for index, (corners, _) in enumerate(parts)}
    np.savez(found, **arrays)
    return found.getvalue()


if __name__ == "__main__":
    answer(_parts)
