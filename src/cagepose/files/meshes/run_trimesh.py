"""trimesh in a process of its own: the content of a mesh file in, arrays of corners and triangles out.

A small file can ask its readers for much: a GLB of 2 kB for 8 GB, a text of 300,000 names for minutes.
"""

from __future__ import annotations

import io
import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cagepose.files.extra import require
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.own_process import answer, ask

CPU_SECONDS, WALL_SECONDS = 7, 60.0
"""Limits of the process; 32 MiB of text take four seconds."""
MOST_SOLIDS = 1000
SOLID_ENDS = re.compile(rb"endsolid[^\r\n]*\s*(solid[^\r\n]*)?", re.IGNORECASE)
"""The end of a solid in a text STL file, and the head of the next one."""


def surfaces(content: bytes, suffix: str, *, split: bool) -> dict[str, Triangles]:
    """Return the surfaces of a file's content by their names; ``split=False``: all as one, "".

    Raises
    ------
    SceneError
        trimesh cannot read it, or takes too much.
    MissingExtraError
        trimesh is not installed.
    """
    require("trimesh", "meshes need trimesh", "files")
    given = f"{suffix} {split:d}\n".encode() + content
    found = np.load(io.BytesIO(ask(__name__, given, WALL_SECONDS, "trimesh")))
    names = found["names"].tolist()
    return {name: Triangles(found[f"vertices {k}"], found[f"faces {k}"]) for k, name in enumerate(names)}


def surfaces_here(content: bytes, suffix: str, *, split: bool) -> dict[str, Triangles]:
    """As `surfaces`, in this process.

    Raises
    ------
    ValueError
        trimesh cannot read it.
    """
    import trimesh

    if suffix == ".stl" and is_text(content):
        content = _of_few_solids(content, split=split)
    # No resolver: a file may name others, such as textures, which are not opened.
    given: dict[str, Any] = {"file_type": suffix[1:], "skip_materials": True, "process": False}
    if split and suffix == ".obj":
        given["split_objects"] = True
    try:
        scene = trimesh.load_scene(io.BytesIO(content), **given)
        meshes = scene.dump() if split else [scene.to_mesh()]
    except Exception as error:  # whatever trimesh's readers raise on a damaged file
        words = " ".join(str(error).split())[:80] or type(error).__name__
        raise ValueError(f"cannot be read as a mesh ({words}); export it again") from None
    meshes = [mesh for mesh in meshes if len(getattr(mesh, "faces", ()))]
    if not meshes:
        raise ValueError("holds no triangles; export it again")
    if len(meshes) > MOST_SOLIDS:
        raise _too_many(len(meshes))
    if any(mesh.faces.max() >= len(mesh.vertices) or mesh.faces.min() < 0 for mesh in meshes):
        raise ValueError("has a triangle whose corner is not there; export it again")
    return {str(mesh.metadata["name"]) if split else "": _merged(mesh.vertices, mesh.faces) for mesh in meshes}


def is_text(stl: bytes) -> bool:
    """Whether an STL file is text."""
    return stl.lstrip().startswith(b"solid") and b"facet" in stl


def _of_few_solids(stl: bytes, *, split: bool) -> bytes:
    """Return a text that trimesh reads in time, which it does not of 100,000 solids: as one, unless they are asked for.

    Raises
    ------
    ValueError
        They are, and are too many.
    """
    if not split:
        return SOLID_ENDS.sub(b"", stl) + b"\nendsolid"
    n_solids = stl.lower().count(b"endsolid")
    if n_solids > MOST_SOLIDS:
        raise _too_many(n_solids)
    return stl


def _too_many(n_bodies: int) -> ValueError:
    return ValueError(f"holds {n_bodies:,} bodies, more than {MOST_SOLIDS:,}; export those that touch alone")


def _merged(vertices: ArrayLike, faces: ArrayLike) -> Triangles:
    """Return triangles whose corners are one where they are at the same place; those with two such are left out."""
    points, same = np.unique(np.array(vertices, dtype=np.float64), axis=0, return_inverse=True)
    corners = same.ravel()[np.array(faces, dtype=np.int64).reshape(-1, 3)]
    return Triangles(points, corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)])


def _answer(given: bytes) -> bytes:
    head, _, content = given.partition(b"\n")
    suffix, split = head.decode().split()
    found = surfaces_here(content, suffix, split=split == "1")
    arrays: dict[str, Any] = {"names": np.array(list(found))}
    for number, mesh in enumerate(found.values()):
        arrays |= {f"vertices {number}": mesh.vertices, f"faces {number}": mesh.faces}
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


if __name__ == "__main__":
    answer(_answer, CPU_SECONDS)
