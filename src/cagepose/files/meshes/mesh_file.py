"""Bodies from STL, OBJ, PLY and GLB files, read by trimesh; what is no body is refused: `read_mesh`, `read_solids`."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.meshes.crossings import crosses_itself
from cagepose.files.meshes.kept_facets import keep, kept
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.mended import mended
from cagepose.files.meshes.mesh_shapes import MeshShapes, mesh_shapes, tidied
from cagepose.files.meshes.run_trimesh import is_text, surfaces
from cagepose.files.meshes.tolerances import FLAT_OF_SIZE
from cagepose.files.progress import tell
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.shapes import Shape

SUFFIXES = (".stl", ".obj", ".ply", ".glb")
UNIT_OF_GLB: LengthUnit = "m"
"""By its standard; the other formats do not say theirs."""
MAX_MESH_BYTES = 32 * 1024 * 1024
"""One file has at most so many: 650,000 triangles of a binary STL."""
STL_HEADER_BYTES, STL_TRIANGLE_BYTES = 84, 50
"""The parts of a binary STL file. The last four bytes of its header are the number of triangles."""
STL_LAST_LINE = 1024
"""Bytes at the end of a text STL file, which ends with a name."""
LONGEST_SIZE, SHORTEST_SIZE = 1e9, 1e-9
"""In the unit of the file."""
MOST_AWAY = 1e6
"""From the origin, in sizes: the corners of what is farther away have too few digits."""
MESHES_KEPT = 64
"""Meshes that are not read again for each scene of a study."""


def read_mesh(path: Path, given: LengthUnit | None, of_scene: LengthUnit, name: str) -> MeshShapes:
    """Return the shapes that a mesh file is, in metres; see `mesh_shapes`.

    Parameters
    ----------
    path
        The file.
    given, of_scene
        The unit that the scene gives it in; None: that of a GLB file is the metre, of others that of the scene.
    name
        Of the shapes.

    Raises
    ------
    SceneError
        A file that cannot be used, or no closed body; the message begins with what is wrong.
    MissingExtraError
        trimesh is not installed.
    """
    if "\0" in os.fspath(path):
        raise refused("is not a file name; remove the unprintable character")
    unit = given or (UNIT_OF_GLB if path.suffix.lower() == ".glb" else of_scene)
    try:
        found = path.stat()
        return _shapes(os.fspath(path), found.st_mtime_ns, found.st_size, unit, name)
    except FileNotFoundError:
        raise refused("is no file; check the name and the folder") from None
    except OSError as error:
        raise refused(f"cannot be read ({error.strerror or error}); check its permissions") from None
    finally:
        tell("")


@lru_cache(maxsize=MESHES_KEPT)
def _shapes(file: str, _changed: int, _n_bytes: int, unit: LengthUnit, name: str) -> MeshShapes:
    path = Path(file)
    found = kept(path, name, unit)
    if found is None:
        mesh, moved = mended(read_solids(path, split=False)[""])
        found = mesh_shapes(checked(mesh, ""), name, unit)
        if moved > 0.0:
            closed = f"{name!r} has cracks of up to {moved:.2g} {unit}, which are closed here"
            found = found._replace(notes=(closed, *found.notes))
        keep(path, found, unit)
    metres = float(to_metres(1.0, unit))
    return MeshShapes(tuple(scaled(shape, metres) for shape in found.shapes), metres * found.error, found.notes)


def scaled(shape: Shape, factor: float) -> Shape:
    """Return a shape whose lengths are so many times as long."""
    return tidied(shape, factor, np.zeros(3))


def read_solids(path: Path, *, split: bool = True) -> dict[str, Triangles]:
    """Return the surfaces of a mesh file by their names, in its unit; ``split=False``: all as one, "".

    Raises
    ------
    SceneError
        A file that cannot be used.
    MissingExtraError
        trimesh is not installed.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise refused(f"has the suffix {path.suffix!r}; give a file of one of: .step, .stp, {', '.join(SUFFIXES)}")
    if not path.is_file():
        raise refused("is no file; check the name and the folder")
    if path.stat().st_size > MAX_MESH_BYTES:
        raise refused(f"is larger than {MAX_MESH_BYTES // 1024**2} MiB; simplify it")
    content = path.read_bytes()
    if not content:
        raise refused("is empty; copy or export it again")
    if suffix == ".stl":
        _check_whole(content)
    tell(f"{path.name}: read, {len(content) / 1024**2:.1f} MiB")
    found = surfaces(content, suffix, split=split)
    if not all(np.isfinite(mesh.vertices).all() for mesh in found.values()):
        raise refused("holds points that are no numbers; export it again")
    return found


def _check_whole(stl: bytes) -> None:
    """Refuse a binary STL file that is shorter than it says."""
    if is_text(stl):
        if b"endsolid" not in stl[-STL_LAST_LINE:]:
            raise refused("is truncated: its last line is no endsolid; copy or export it again")
        return
    n_triangles = int.from_bytes(stl[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    expected = STL_HEADER_BYTES + STL_TRIANGLE_BYTES * n_triangles
    if len(stl) < expected:
        raise refused(f"is truncated: {expected:,} bytes expected, {len(stl):,} found; copy or export it again")


def checked(mesh: Triangles, which: str) -> Triangles:
    """Return a surface that encloses a body; ``which`` begins the messages about others.

    Raises
    ------
    SceneError
        It is empty, huge, tiny, far away, flat, open, inside out, or crosses itself.
    """
    if len(mesh.faces) == 0:
        raise refused(f"{which}holds no triangles with an area; export it again")
    farthest = float(np.abs(mesh.vertices).max())
    if farthest > LONGEST_SIZE:
        raise refused(
            f"{which}has a corner at {farthest:.2g}, more than {LONGEST_SIZE:g}; check its unit and its place"
        )
    size = mesh.size
    if 0.0 < size < SHORTEST_SIZE:
        raise refused(f"{which}is {size:.2g} long, less than {SHORTEST_SIZE:g}; check its unit")
    if farthest > MOST_AWAY * size > 0.0:
        raise refused(f"{which}is {farthest / size:.2g} times its size away from the origin; move both bodies there")
    centered = Triangles((mesh.vertices - mesh.vertices.mean(axis=0)) / (size or 1.0), mesh.faces)
    spread = np.linalg.svd(centered.vertices, compute_uv=False)
    if size == 0.0 or len(spread) < 3 or spread[2] <= FLAT_OF_SIZE * spread[0]:
        raise refused(f"{which}encloses no volume: its points lie in one plane; give it a thickness")
    if not _is_closed(mesh) or centered.body().status() != manifold3d().Error.NoError:
        raise refused(
            f"{which}is not closed: triangles are missing or meet no neighbour; repair it, or export it as a solid"
        )
    if centered.body().volume() < 0.0:
        raise refused(f"{which}is inside out: its triangles face inwards; flip them")
    tell(f"{which}{len(mesh.faces):,} triangles: searched for crossings")
    if crosses_itself(centered):
        raise refused(f"{which}crosses itself; repair it, as by a union of its parts")
    return mesh


def _is_closed(mesh: Triangles) -> bool:
    """Whether each side of a triangle is as often one the other way round: what is not can crash libraries."""
    sides = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    there, back = (np.sort(side @ (len(mesh.vertices), 1)) for side in (sides, sides[:, ::-1]))
    return bool((there == back).all())


def refused(message: str) -> SceneError:
    """Return the error that says so of a file."""
    return SceneError([Problem((), message)])
