"""A STEP file as the shapes of a scene: `read_step_shapes`."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any, cast

from cagepose.files.meshes.mesh_file import refused, scaled, stamped
from cagepose.files.meshes.mesh_shapes import MeshShapes
from cagepose.files.progress import tell
from cagepose.files.solid_names import solids_named
from cagepose.files.step.kept_shapes import KeptShape, KeptShapes, keep, kept
from cagepose.files.step.solid_shapes import solid_shapes
from cagepose.files.step.solids import read_step
from cagepose.files.units import to_metres
from cagepose.model.wording import few

Data = dict[str, Any]

SUFFIXES = (".step", ".stp")
MAX_STEP_BYTES = 32 * 1024 * 1024
FILES_KEPT = 16
"""STEP files that are not read again for each scene of a study, and for each of their solids."""


def read_step_shapes(path: Path, solid: str | None, name: str, *, fillets: bool = True) -> MeshShapes:
    """Return the shapes that a STEP file is, in metres, where they are in the file.

    Parameters
    ----------
    path
        The file.
    solid
        The one that is meant, or what the names of some begin with before a "/"; None: all are one body.
    name
        Of the shapes. If they are of several solids, the name of each stands behind it: "NAME/SOLID".
    fillets
        Whether hollow roundings stay; else walls go on to where they meet.

    Raises
    ------
    SceneError
        A file that cannot be used, or has no such solid; the message begins with what is wrong.
    MissingExtraError
        What reads it is not installed.
    """
    with stamped(path) as stamp:
        return _shapes(*stamp, solid, name, fillets)


@lru_cache(maxsize=64)
def _shapes(file: str, changed: int, n_bytes: int, solid: str | None, name: str, fillets: bool) -> MeshShapes:
    path = Path(file)
    key = json.dumps([solid, name, fillets])
    found = kept(path, key)
    if found is None:
        found = _of_solids(_solids(file, changed, n_bytes, fillets), solid, name)
        keep(path, key, found)
    return MeshShapes(found.shapes, found.off_m, found.notes)


@lru_cache(maxsize=FILES_KEPT)
def _solids(file: str, _changed: int, _n_bytes: int, fillets: bool) -> Data:
    return read_step_file(Path(file), fillets=fillets)


def _of_solids(read: Data, wanted: str | None, name: str) -> KeptShapes:
    solids = named_solids(read)
    if not solids:
        raise refused("has no solid; export it as one")
    if wanted is not None:
        solids = {own: solids[own] for own in solids_named(wanted, solids)}
    notes = [f"left out: {few(read['out'], 12)}"] if read["out"] else []
    alone = len(solids) == 1
    made = [solid_shapes(name if alone else f"{name}/{own}", solid) for own, solid in solids.items()]
    notes += [note for one in made for note in one.notes]
    metres = float(to_metres(1.0, "mm"))
    shapes = tuple(scaled(shape, metres) for one in made for shape in one.shapes)
    return KeptShapes(cast(tuple[KeptShape, ...], shapes), metres * max(one.error for one in made), tuple(notes))


def named_solids(read: Data) -> dict[str, Data]:
    """Return the solids of a file by their names, which are numbered where several have the same."""
    found: dict[str, Data] = {}
    for solid in read["solids"]:
        name = solid["name"]
        found[name if name not in found else f"{name} {len(found) + 1}"] = solid
    return found


def read_step_file(path: Path, *, fillets: bool = True) -> Data:
    """As `cagepose.files.step.solids.read_step`, of a file that may not be there, or be too large.

    Raises
    ------
    SceneError
        It is such a file, or as `read_step`.
    """
    if not path.is_file():
        raise refused("is no file; check the name and the folder")
    if path.stat().st_size > MAX_STEP_BYTES:
        raise refused(f"is larger than {MAX_STEP_BYTES // 1024**2} MiB; export the parts that touch alone")
    tell(f"{path.name}: read by Open CASCADE")
    return read_step(path, fillets=fillets)
