"""Bodies from STL, OBJ, PLY and GLB files, read by trimesh; what is no body is refused: `read_mesh`, `read_solids`."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.meshes.crossings import deepest_crossing
from cagepose.files.meshes.kept_facets import keep, kept
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.mended import mended, place, where_open
from cagepose.files.meshes.mesh_shapes import MeshShapes, mesh_shapes, tidied
from cagepose.files.meshes.named_parts import joined_where_open
from cagepose.files.meshes.odd_facets import is_closed
from cagepose.files.meshes.run_trimesh import STL_HEADER_BYTES, STL_TRIANGLE, is_text, surfaces
from cagepose.files.meshes.shells import as_bodies
from cagepose.files.meshes.tolerances import DEEPEST_CROSSING, FLAT_OF_SIZE, ROUNDING_OF_MESH
from cagepose.files.progress import tell
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.shapes import Shape

SUFFIXES = (".stl", ".obj", ".ply", ".glb")
UNIT_OF_GLB: LengthUnit = "m"
"""By its standard; the other formats do not say theirs."""
MAX_MESH_BYTES = 128 * 1024 * 1024
"""One file has at most so many: 430,000 triangles of a text STL with all digits."""
MOST_TRIANGLES = 1_000_000
"""More take more than 2 GB to run with."""
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
    unit = given or (UNIT_OF_GLB if path.suffix.lower() == ".glb" else of_scene)
    with stamped(path) as stamp:
        return _shapes(*stamp, unit, name)


@contextmanager
def stamped(path: Path) -> Iterator[tuple[str, int, int]]:
    """Yield the name of a file, when it was changed and how many bytes it has, by which shapes of it are remembered.

    Raises
    ------
    SceneError
        It is no file, or, as it is read within, cannot be read.
    """
    if "\0" in os.fspath(path):
        raise refused("is not a file name; remove the unprintable character")
    try:
        found = path.stat()
        yield os.fspath(path), found.st_mtime_ns, found.st_size
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
        found = sound_shapes(read_solids(path, split=False)[""], name, unit)
        keep(path, found, unit)
    metres = float(to_metres(1.0, unit))
    return MeshShapes(tuple(scaled(shape, metres) for shape in found.shapes), metres * found.error, found.notes)


def scaled(shape: Shape, factor: float) -> Shape:
    """Return a shape whose lengths are so many times as long."""
    return tidied(shape, factor, np.zeros(3))


def read_solids(path: Path, *, split: bool = True) -> dict[str, Triangles]:
    """Return the surfaces of a mesh file by their names, in its unit; ``split=False``: all as one, "". Those that are
    open and go on in each other are one.

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
    if (n_triangles := sum(len(mesh.faces) for mesh in found.values())) > MOST_TRIANGLES:
        raise refused(f"has {n_triangles:,} triangles, more than {MOST_TRIANGLES:,}; simplify it, or export it coarser")
    if not all(np.isfinite(mesh.vertices).all() for mesh in found.values()):
        raise refused("holds points that are no numbers; export it again")
    return joined_where_open(found) if len(found) > 1 else found


def _check_whole(stl: bytes) -> None:
    """Refuse a binary STL file that is shorter than it says."""
    if is_text(stl):
        if b"endsolid" not in stl[-STL_LAST_LINE:]:
            raise refused("is truncated: its last line is no endsolid; copy or export it again")
        return
    n_triangles = int.from_bytes(stl[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    expected = STL_HEADER_BYTES + STL_TRIANGLE.itemsize * n_triangles
    if len(stl) < expected:
        raise refused(f"is truncated: {expected:,} bytes expected, {len(stl):,} found; copy or export it again")


class Sound(NamedTuple):
    """A closed surface that faces outwards and does not cross itself, and what was done to make it so, in sentences."""

    mesh: Triangles
    notes: tuple[str, ...]


def sound(mesh: Triangles, name: str, unit: str, which: str = "") -> Sound:
    """Return the surface of a body, mended where that takes no more than a distance that is told.

    Parameters
    ----------
    mesh
        Triangles of a file.
    name
        Of the body, for the notes.
    unit
        Of its lengths, for what is said.
    which
        Begins the messages.

    Raises
    ------
    SceneError
        It is empty, huge, tiny, far away, flat, open, or crosses itself; the message says where.
    """
    _check_size(mesh, which)
    found = mended(mesh)
    if not is_closed(found.mesh):
        raise refused(f"{which}{where_open(found.nearest, unit)}; close it in CAD, or repair the mesh there")
    whole = found.mesh.body()
    if whole.status() != manifold3d().Error.NoError:
        raise refused(f"{which}is no surface of a body ({whole.status().name}); repair it, or export it as a solid")
    tell(f"{which}{len(mesh.faces):,} triangles: searched for crossings")
    shells = whole.decompose()
    notes = []
    for shell in shells:
        crossing = deepest_crossing(found.mesh if len(shells) == 1 else Triangles.of(shell))
        if crossing is not None:
            depth, where = f"{crossing.depth:.2g} {unit}", f"at {place(crossing.place, mesh.size)} {unit}"
            if crossing.depth > DEEPEST_CROSSING * mesh.size:
                times = f", in {crossing.n_crossings:,} pairs of triangles" if crossing.n_crossings > 1 else ""
                remedy = "draw it as bodies in CAD and take their union, or repair the mesh there"
                raise refused(f"{which}crosses itself by {depth} or more {where}{times}; {remedy}")
            notes.append(f"{name!r} runs through itself by up to {depth}, as {where}, and is left so")
    try:
        bodies = as_bodies(found.mesh, shells)
    except ValueError as error:
        raise refused(f"{which}{error}") from None
    notes += [f"{name!r}: {done}" for done in (*found.done, *bodies.done)]
    if found.moved > ROUNDING_OF_MESH * mesh.size:
        notes.insert(0, f"{name!r} has cracks of up to {found.moved:.2g} {unit}, which are closed here")
    return Sound(bodies.mesh, tuple(notes))


def sound_shapes(mesh: Triangles, name: str, unit: str, which: str = "") -> MeshShapes:
    """Return the shapes of a body, see `mesh_shapes`, whose surface is mended first, see `sound`."""
    closed, said = sound(mesh, name, unit, which)
    found = mesh_shapes(closed, name, unit)
    return found._replace(notes=(*said, *found.notes))


def checked(mesh: Triangles, which: str) -> Triangles:
    """Return the surface of a body, see `sound`, whose notes nobody reads."""
    return sound(mesh, "", "", which).mesh


def _check_size(mesh: Triangles, which: str) -> None:
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
    spread = np.linalg.svd((mesh.vertices - mesh.vertices.mean(axis=0)) / (size or 1.0), compute_uv=False)
    if size == 0.0 or len(spread) < 3 or spread[2] <= FLAT_OF_SIZE * spread[0]:
        raise refused(f"{which}encloses no volume: its points lie in one plane; give it a thickness")


def refused(message: str) -> SceneError:
    """Return the error that says so of a file."""
    return SceneError([Problem((), message)])
