"""coacd in a process of its own, which can be stopped: arrays of corners and triangles in, convex parts out."""

from __future__ import annotations

import io
import subprocess
import sys
from typing import Any

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.extra import files_library
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray

SECONDS = 60.0
CONCAVITY = 0.05
"""Of parts, as coacd measures it."""
CORNERS_OF_PART = 100


def convex_parts(mesh: Triangles) -> list[FloatArray]:
    """Return the corners of convex parts, (n, 3) each.

    Raises
    ------
    SceneError
        It takes too long.
    MissingExtraError
        coacd is not installed.
    """
    files_library("coacd", "a mesh that is not convex needs coacd")
    given = io.BytesIO()
    np.savez(given, vertices=mesh.vertices, faces=mesh.faces, concavity=CONCAVITY)
    command = [sys.executable, "-m", "cagepose.files.meshes.run_coacd"]
    try:
        done = subprocess.run(command, input=given.getvalue(), capture_output=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        message = f"takes coacd more than {SECONDS:g} s to make convex parts of; simplify it, or cut it into parts"
        raise SceneError([Problem((), message)]) from None
    if done.returncode != 0:
        raise SceneError([Problem((), "cannot be made of convex parts by coacd; repair it, or cut it into parts")])
    found = np.load(io.BytesIO(done.stdout))
    return [found[key] for key in sorted(found.files, key=int)]


def main() -> None:
    """Read a mesh from standard input, and write its parts to standard output."""
    import coacd

    given = np.load(io.BytesIO(sys.stdin.buffer.read()))
    coacd.set_log_level("off")
    parts = coacd.run_coacd(
        coacd.Mesh(given["vertices"], given["faces"]),
        threshold=float(given["concavity"]),
        preprocess_mode="off",
        mcts_iterations=60,
        decimate=True,
        max_ch_vertex=CORNERS_OF_PART,
    )
    found = io.BytesIO()
    arrays: dict[str, Any] = {str(index): np.asarray(corners) for index, (corners, _) in enumerate(parts)}
    np.savez(found, **arrays)
    sys.stdout.buffer.write(found.getvalue())


if __name__ == "__main__":
    main()
