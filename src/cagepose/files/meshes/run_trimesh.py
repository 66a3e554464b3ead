"""trimesh in a process of its own: the content of a mesh file in, arrays of corners and triangles out.

A small file can ask its readers for much: a GLB of 2 kB for 8 GB, a text of 300,000 names for minutes.
"""

from __future__ import annotations

import io
import re
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cagepose.files.extra import require
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.own_process import answer, ask

CPU_SECONDS, WALL_SECONDS = 9, 60.0
"""Limits of the process; 400,000 triangles take one second in a binary STL file, two in OBJ, and four in a text STL."""
MOST_SOLIDS = 1000
STL_HEADER_BYTES = 84
"""The first part of a binary STL file. The last four bytes of it are the number of triangles."""
STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
"""The other parts of it."""
CORNER = re.compile(rb"vertex\s+(\S+\s+\S+\s+\S+)", re.IGNORECASE)
"""A corner of a triangle in a text STL file."""


def surfaces(content: bytes, suffix: str, *, split: bool) -> dict[str, Triangles]:
    """Return the surfaces of a file's content by their names; ``split=False``: all as one, "".

    Raises
    ------
    SceneError
        trimesh cannot read it, or takes too much.
    MissingExtraError
        trimesh is not installed.
    """
    if suffix == ".stl" and not split and not is_text(content):
        return {"": _corners_of_binary(content)}
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
        if not split:
            return {"": _corners_of_text(content)}
        if (n_solids := content.lower().count(b"endsolid")) > MOST_SOLIDS:
            raise _too_many(n_solids)  # trimesh takes half a minute for 100,000 of them
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


def _corners_of_binary(stl: bytes) -> Triangles:
    """Return the triangles of a binary STL file, which is as long as it says."""
    n_triangles = int.from_bytes(stl[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    corners = np.frombuffer(stl, STL_TRIANGLE, n_triangles, STL_HEADER_BYTES)["corners"]
    return _merged(corners.reshape(-1, 3), np.arange(3 * n_triangles))


def _corners_of_text(stl: bytes) -> Triangles:
    """Return the triangles of a text STL file as one surface: in a third of the time that trimesh takes.

    Raises
    ------
    ValueError
        A corner that is no number, or triangles that are cut short.
    """
    corners = CORNER.findall(stl)
    if not corners:
        raise ValueError("holds no triangles; export it again")
    with warnings.catch_warnings(action="error"):
        try:
            places = np.fromstring(b" ".join(corners), sep=" ").reshape(len(corners), 3)
        except (ValueError, DeprecationWarning):
            raise ValueError("has corners that are not three numbers each; export it again") from None
    if len(corners) % 3:
        raise ValueError(f"has {len(corners):,} corners, which are no whole triangles; export it again")
    return _merged(places, np.arange(len(places)))


def _too_many(n_bodies: int) -> ValueError:
    return ValueError(f"holds {n_bodies:,} bodies, more than {MOST_SOLIDS:,}; export those that touch alone")


def _merged(vertices: ArrayLike, faces: ArrayLike) -> Triangles:
    """Return triangles whose corners are one where they are at the same place; those with two such are left out."""
    places = np.array(vertices, dtype=np.float64) + 0.0  # no zero below zero
    _, same = np.unique(places[:, 0], return_inverse=True)
    for along in places.T[1:]:  # ten times as fast as numbers of rows at once
        values, which = np.unique(along, return_inverse=True)
        _, same = np.unique(same * len(values) + which, return_inverse=True)
    points = np.empty((int(same.max(initial=-1)) + 1, 3))
    points[same] = places
    corners = same[np.array(faces, dtype=np.int64).reshape(-1, 3)]
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
