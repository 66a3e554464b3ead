"""Convex parts of a body that is not convex, by coacd, and how far they are from it: `decomposed`."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cagepose.files.extra import require
from cagepose.files.meshes import run_coacd
from cagepose.files.meshes.cuts import together
from cagepose.files.meshes.flat_sides import FlatSides
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.surface_distance import farthest_from
from cagepose.files.progress import tell
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, json_line, write_whole
from cagepose.model.checks import FloatArray

MOST_TRIANGLES_GIVEN = 2000
"""coacd is given at most so many triangles. Of twice as many it makes parts that are no nearer, in half as much time
again."""
MOST_KEPT = 8
"""Bodies of one mesh."""
KEPT_VERSION = 3


class Decomposition(NamedTuple):
    """Corners of convex parts, (n, 3) each, and the largest distance between their surface and the body's."""

    parts: list[FloatArray]
    error: float


def decomposed(mesh: Triangles) -> Decomposition:
    """Return convex parts of a body.

    Raises
    ------
    SceneError
        It takes too long.
    MissingExtraError
        coacd is not installed.
    """
    require("rtree", "a mesh that is not convex needs rtree", "files")  # which is asked for only after a minute
    most_s = run_coacd.MOST_SECONDS
    tell(f"coacd makes convex parts of {len(mesh.faces):,} triangles, which takes it {most_s:g} s at most")
    found = run_coacd.convex_parts(_simplified(mesh))
    ends = np.cumsum([len(corners) for corners in found])
    parts = np.split(FlatSides.of(mesh).taking(np.concatenate(found)), ends[:-1])
    hulls = [manifold3d().Manifold.hull_points(corners) for corners in parts]
    tell(f"{len(hulls)} convex parts: how far they are off")
    union = Triangles.of(together(hulls))
    error = max(farthest_from(mesh, union), farthest_from(union, mesh, outside=True))
    return Decomposition([Triangles.of(hull).vertices for hull in hulls], error)


def kept_beside(mesh_file: Path, mesh: Triangles) -> Decomposition:
    """As `decomposed`; what was found is kept in a file beside the mesh, and taken from there while that is the same.

    A folder that cannot be written keeps nothing.
    """
    settings = f"{KEPT_VERSION} {run_coacd.MOST_CONCAVITY}".encode()
    key = sha256(mesh.vertices.tobytes() + mesh.faces.tobytes() + settings).hexdigest()
    path = mesh_file.with_name(f"{mesh_file.name}.parts.json")
    kept = _kept(path)
    if key in kept:
        try:
            corners = [np.array(part, dtype=np.float64).reshape(-1, 3) for part in kept[key]["parts"]]
            return Decomposition(corners, float(kept[key]["error"]))
        except (TypeError, ValueError, KeyError):
            pass  # somebody changed it: found anew, and written over
    found = decomposed(mesh)
    kept |= {key: {"parts": [part.tolist() for part in found.parts], "error": found.error}}
    last = dict(list(kept.items())[-MOST_KEPT:])
    document = {"what": f"convex parts of {mesh_file.name}, {MADE_BY}", "parts_of": last}
    try:
        check_can_write(path, is_made_by_us, "parts of a mesh that cagepose kept")
        write_whole(path, json_line(document).encode())
    except OSError:
        pass
    return found


def _kept(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text()) if path.is_file() else {}
    except (OSError, ValueError, RecursionError):
        return {}
    return dict(found.get("parts_of") or {}) if isinstance(found, dict) else {}


def _simplified(mesh: Triangles) -> Triangles:
    """Return a body of few triangles near a body of many."""
    body, tolerance = mesh.body(), 1e-4 * mesh.size
    while body.num_tri() > MOST_TRIANGLES_GIVEN:
        body = body.simplify(tolerance)
        tolerance *= 1.5
    return Triangles.of(body)
