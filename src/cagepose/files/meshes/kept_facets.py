"""Facets of a large mesh kept in a file beside it, as to read, check and recognise it takes seconds: `kept`, `keep`."""

from __future__ import annotations

import io
from hashlib import sha256
from pathlib import Path
from zipfile import ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from cagepose.errors import SceneError
from cagepose.files.meshes.mesh_shapes import MeshShapes
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, write_whole
from cagepose.model.facets import Facets

FEWEST_TRIANGLES = 2000
"""Meshes with fewer are read again, which takes a second."""
MOST_BYTES = 64 * 1024 * 1024
"""A file that holds more was not kept by us."""
VERSION = 1


def kept(mesh_file: Path, name: str, unit: str) -> MeshShapes | None:
    """Return what was kept of a mesh file under a name and a unit; None: nothing was, or the mesh is another by now.

    What somebody changed in it is checked as any closed surface is.
    """
    path = _beside(mesh_file)
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return None
        content = path.read_bytes()
        if any(member.compress_type != ZIP_STORED for member in ZipFile(io.BytesIO(content)).infolist()):
            return None  # it could be made to fill the memory
        found = np.load(io.BytesIO(content), allow_pickle=False)
        if found["key"].tobytes() != _key(mesh_file, name, unit):
            return None
        shape = Facets(found["vertices"], found["triangles"], float(found["flat"]), None, name)
        return MeshShapes((shape,), 0.0, tuple(str(note) for note in found["notes"].tolist()))
    except (OSError, ValueError, TypeError, KeyError, EOFError, MemoryError, BadZipFile, SceneError):
        return None


def keep(mesh_file: Path, found: MeshShapes, unit: str) -> None:
    """Keep the shapes of a mesh file, if they are large facets. A folder that cannot be written keeps nothing."""
    shape = found.shapes[0]
    if len(found.shapes) > 1 or not isinstance(shape, Facets) or len(shape.triangles) < FEWEST_TRIANGLES:
        return
    stream, path = io.BytesIO(), _beside(mesh_file)
    try:
        np.savez(
            stream,
            what=np.frombuffer(f"facets of {mesh_file.name}, {MADE_BY}".encode(), np.uint8),
            key=np.frombuffer(_key(mesh_file, str(shape.name), unit), np.uint8),
            vertices=shape.vertices_m,
            triangles=shape.triangles,
            flat=shape.flat_m,
            notes=np.array(found.notes, str),
        )
        check_can_write(path, is_made_by_us, "facets of a mesh that cagepose kept")
        write_whole(path, stream.getvalue())
    except OSError:
        pass


def _beside(mesh_file: Path) -> Path:
    return mesh_file.with_name(f"{mesh_file.name}.facets.npz")


def _key(mesh_file: Path, name: str, unit: str) -> bytes:
    return sha256(f"{VERSION} {name}\0{unit}\0".encode() + mesh_file.read_bytes()).digest()
