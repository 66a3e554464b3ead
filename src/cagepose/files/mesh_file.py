"""Convex shapes from mesh files: STL, OBJ, PLY and GLB, read by trimesh."""

from __future__ import annotations

import io
import os
from functools import lru_cache
from pathlib import Path

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.extra import files_library
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.checks import FloatArray

SUFFIXES = (".stl", ".obj", ".ply", ".glb")
UNIT_OF_GLB: LengthUnit = "m"
"""By its standard; the other formats do not say theirs."""
MAX_MESH_BYTES = 32 * 1024 * 1024
"""Of one file: 650,000 triangles of a binary STL."""
MOST_CORNERS = 300
"""Of a convex hull: the time of runs grows with the square of it."""
NOT_CONVEX = 1e-5
"""Of the hull's volume: a mesh that is less by more is not convex; single precision is off by some 1e-7."""
ROUNDING = 3e-7
"""Of the mesh's size: corners of the hull that stand out by less are none. Single precision is off by as much."""
KEPT = 64
"""Meshes that are not read again for each scene of a study."""


def read_mesh(path: Path, given: LengthUnit | None, of_scene: LengthUnit) -> FloatArray:
    """Return the corners of a convex mesh, (n, 3), metres.

    Parameters
    ----------
    path
        The file.
    given, of_scene
        The unit that the scene gives it in; None: that of a GLB file is the metre, of others that of the scene.

    Raises
    ------
    SceneError
        A file that cannot be used, or no convex mesh; the message begins with what is wrong.
    MissingExtraError
        trimesh is not installed.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise _refused(f"has the suffix {path.suffix!r}; give a file of one of: {', '.join(SUFFIXES)}")
    try:
        if not path.is_file():
            raise _refused("is no file; check the name and the folder")
        found = path.stat()
        if found.st_size > MAX_MESH_BYTES:
            raise _refused(f"is larger than {MAX_MESH_BYTES // 1024**2} MiB; simplify it")
        corners = _corners(os.fspath(path), found.st_mtime_ns, found.st_size)
    except OSError as error:
        raise _refused(f"cannot be read ({error.strerror or error}); check its permissions") from None
    unit = given or (UNIT_OF_GLB if suffix == ".glb" else of_scene)
    return to_metres(corners, unit)


@lru_cache(maxsize=KEPT)
def _corners(name: str, _changed: int, _n_bytes: int) -> FloatArray:
    """Return the corners of a mesh's hull in the unit of the file."""
    trimesh = files_library("trimesh", "meshes need trimesh")
    manifold3d = files_library("manifold3d", "meshes need manifold3d")
    path = Path(name)
    content = io.BytesIO(path.read_bytes())
    try:
        # No resolver: a file may name others, such as textures, which are not opened.
        mesh = trimesh.load_mesh(content, file_type=path.suffix.lower()[1:], skip_materials=True)
        vertices, faces = np.array(mesh.vertices, dtype=np.float64), np.array(mesh.faces)
        is_closed = bool(mesh.is_watertight)
    except Exception as error:  # whatever trimesh's readers raise on a damaged file
        raise _refused(f"cannot be read as a mesh ({_first_words(error)}); export it again") from None
    if len(faces) == 0 or not np.isfinite(vertices).all():
        raise _refused("holds no triangles, or points that are no numbers; export it again")
    size = float(np.ptp(vertices, axis=0).max())
    hull = manifold3d.Manifold.hull_points((vertices - vertices.mean(axis=0)) / size if size > 0.0 else vertices)
    full = float(hull.volume()) * size**3
    if full <= NOT_CONVEX * size**3:
        raise _refused("encloses no volume: its points lie in one plane; give it a thickness")
    if not is_closed:
        raise _refused("is not closed: triangles are missing or meet no neighbour; repair it, or export it as a solid")
    a, b, c = np.moveaxis(vertices[faces] - vertices.mean(axis=0), 1, 0)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    if volume < 0.0:
        raise _refused("is inside out: its triangles face inwards; flip them")
    if volume < (1.0 - NOT_CONVEX) * full:
        share = 1.0 - volume / full
        raise _refused(
            f"is not convex: {share:.2%} of its hull is not in it; cut it into convex parts, a mesh each, or make it of"
            " boxes and cylinders, with `hole` for what is drilled"
        )
    corners = hull.simplify(ROUNDING).to_mesh64().vert_properties[:, :3] * size + vertices.mean(axis=0)
    if len(corners) > MOST_CORNERS:
        raise _refused(
            f"has {len(corners)} corners, more than {MOST_CORNERS}; make it coarser, or take sphere, capsule, cylinder"
            " or cone for what is round"
        )
    return _as_given(corners, vertices)


def _as_given(corners: FloatArray, vertices: FloatArray) -> FloatArray:
    """Return the vertices of the file that corners of its hull are, to their last digit."""
    nearest = sorted({int(np.linalg.norm(vertices - corner, axis=1).argmin()) for corner in corners})
    chosen: FloatArray = vertices[nearest]
    chosen.setflags(write=False)
    return chosen


def _first_words(error: Exception) -> str:
    return " ".join(str(error).split())[:80] or type(error).__name__


def _refused(message: str) -> SceneError:
    return SceneError([Problem((), message)])
