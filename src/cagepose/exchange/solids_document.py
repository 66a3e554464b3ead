"""Solids of STEP and mesh files as the data of a scene file: `solids_document`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cagepose.errors import FileProblem, SceneError, SceneFileError
from cagepose.exchange.solids_note import SHOWN, read_solids_note
from cagepose.exchange.step_reader import off_volume
from cagepose.exchange.step_solids import read_step
from cagepose.exchange.stl import MM_PER_M
from cagepose.exchange.tolerances import SAME_END, SAME_VOLUME
from cagepose.files.meshes import mesh_file
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mesh_shapes import MeshShapes, mesh_shapes
from cagepose.files.meshes.surface_distance import farthest_from
from cagepose.files.progress import tell
from cagepose.files.scene_document import SceneWriter
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Capsule, Convex, Shape, Sphere
from cagepose.model.wording import counted, few

Data = dict[str, Any]

STEP = (".step", ".stp")
SOLIDS = (*STEP, *mesh_file.SUFFIXES)
MAX_STEP_BYTES = 32 * 1024 * 1024
METRES = SceneWriter("m")
ALONE = "has no solid but the object; give that as a `mesh` in a scene file with its cage"
LOSS_OF_ROUNDINGS = 0.05
"""Fraction of the size. Hollow roundings whose loss is more are kept, as many flat faces."""


def solids_document(source: str, object_name: str | None, cage_names: Sequence[str]) -> tuple[Data, list[str]]:
    """Return the data of a scene of solids, and what is not in it as in the file.

    Raises
    ------
    SceneFileError
        A file that cannot be used, or names that no solids have.
    MissingExtraError
        What reads it is not installed.
    """
    path, notes = Path(source), list[str]()
    note = read_solids_note(path, notes)
    damaged = [*notes]
    try:
        solids = _of_step(path, notes) if path.suffix.lower() in STEP else _of_mesh(path, bool(note), notes)
        held, walls = _chosen(list(solids), object_name, cage_names)
        left = [name for name in solids if name not in (*held, *walls)]
        if left:
            notes.append(f"solids left out: {few(left, 12)}")
        points = [name for name in walls if _short(name, walls) in note.get("points", ())]
        walls = [name for name in walls if name not in points]
        of_object, of_cage = (Pose(*note[key]) if note else Pose() for key in SHOWN.values())
        shapes: dict[str, list[Data]] = {"object": [], "cage": []}
        listed = [("object", name, held, of_object.inverse()) for name in held]
        listed += [("cage", name, walls, of_cage.inverse()) for name in walls]
        for body, name, names, frame in listed:
            of_solid = _shapes(_short(name, names), solids[name], frame, notes)
            shapes[body] += [METRES.shape(_named(shape, note.get("holes", {}))) for shape in of_solid]
    except SceneError as error:
        messages = [*(problem.message for problem in error.problems), *damaged]
        raise SceneFileError([FileProblem((), message, source) for message in messages]) from None
    finally:
        tell("")
    found: Data = {"name": note.get("name") or path.stem, "units": {"length": "m"}}
    found["object"] = {**note.get("object", {}), "shapes": shapes["object"]}
    found["cage"] = {"shapes": shapes["cage"], "pose": METRES.pose(of_cage)}
    found["cage"]["points"] = {
        _short(name, points): of_cage.inverse_transform(_middle(solids[name])).tolist() for name in points
    }
    found["cage"] = {key: value for key, value in found["cage"].items() if value}
    if not note:
        notes.append("the object has no mass there: here, uniform density")
        notes.append("loads: the weight alone, with a gravity of (0, 0, -9.81) m/s^2; no friction")
    found["loads"] = note.get("loads") or [{"name": "weight", "gravity": [0.0, 0.0, -9.81]}]
    elements = [*(shape["name"] for body in shapes.values() for shape in body), *found["cage"].get("points", ())]
    if note:
        found |= kept_friction(note, elements)
        lost = [one for one in note["friction"]["of"] if not any(is_of(name, one) for name in elements)]
        notes += [f"friction of {few(lost)} is lost, as nothing there has the name"] if lost else []
    return found | {key: note[key] for key in ("method", "metric", "tolerances") if key in note}, notes


def kept_friction(note: Data, names: Sequence[str]) -> Data:
    """Return the friction of a note as a scene file has it, for the elements that there are."""
    kept = note["friction"]
    of = {name: mu for name in names for element, mu in kept["of"].items() if is_of(name, element)}
    coefficient = {} if kept["coefficient"] is None else {"coefficient": kept["coefficient"]}
    return {"friction": {**coefficient, "of": of}} if of or coefficient else {}


def is_of(name: str, element: str) -> bool:
    return name == element or name.startswith(f"{element}/")


def _of_step(path: Path, notes: list[str]) -> dict[str, Data]:
    if not path.is_file():
        raise mesh_file.refused("is no file; check the name and the folder")
    if path.stat().st_size > MAX_STEP_BYTES:
        raise mesh_file.refused(f"is larger than {MAX_STEP_BYTES // 1024**2} MiB; export the parts that touch alone")
    tell(f"{path.name}: read by Open CASCADE")
    found = read_step(path)
    if found["out"]:
        notes.append(f"left out: {few(found['out'], 12)}")
    solids: dict[str, Data] = {}
    for solid in found["solids"]:
        name = solid["name"]
        solids[name if name not in solids else f"{name} {len(solids) + 1}"] = solid
    return solids


def _of_mesh(path: Path, is_ours: bool, notes: list[str]) -> dict[str, Data]:
    """Return bodies of a mesh file in millimetres."""
    is_glb = path.suffix.lower() == ".glb"
    if not (is_glb or is_ours):
        notes.append("the file does not say its unit: here, millimetres")
    found = mesh_file.read_solids(path)
    scale = MM_PER_M if is_glb else 1.0
    return {
        name.partition(", made by")[0]: {"vertices": scale * mesh.vertices, "faces": mesh.faces}
        for name, mesh in found.items()
    }


def _chosen(names: list[str], object_name: str | None, cage_names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the names of the solids of the object and of the cage."""

    def of(wanted: str) -> list[str]:
        found = [name for name in names if is_of(name, wanted)]
        if not found:
            raise mesh_file.refused(f"has no solid {wanted!r}; its solids: {few(names, 12) or 'none'}")
        return found

    if len(names) == 1 and object_name is None:
        raise mesh_file.refused(ALONE)
    if object_name is None and not any(is_of(name, "object") for name in names):
        raise mesh_file.refused(f"does not say which solid is held; give --object and one of: {few(names, 12)}")
    held = of(object_name or "object")
    chosen = [name for wanted in cage_names for name in of(wanted)] or names
    walls = [name for name in dict.fromkeys(chosen) if name not in held]
    if not walls:
        raise mesh_file.refused(ALONE)
    return held, walls


def _short(name: str, names: Sequence[str]) -> str:
    """Return a name without that of its body before it, unless two would be one then."""
    short = name.partition("/")[2] or name
    return short if sum((other.partition("/")[2] or other) == short for other in names) == 1 else name


def _middle(solid: Data) -> FloatArray:
    corners = np.asarray(solid["core"] if "core" in solid else solid["vertices"])
    middle: FloatArray = (corners.max(axis=0) + corners.min(axis=0)) / 2.0 / MM_PER_M
    return middle


def _shapes(name: str, solid: Data, frame: Pose, notes: list[str]) -> list[Shape]:
    """Return a solid as shapes in the frame of its body, in metres."""
    if "core" in solid:
        shapes: Sequence[Shape] = [_rounded(np.array(solid["core"]), solid["radius"], name)]
    else:
        if "volume" in solid and (off := off_volume(solid)) > 0.0:
            found_off = f"{name!r} is {off:.1%} of its volume off as Open CASCADE makes triangles of it"
            raise mesh_file.refused(f"{found_off}; repair it, or export it as STL")
        given = Triangles(np.array(solid["vertices"]), np.array(solid["faces"]))
        mesh, mended_notes = mesh_file.sound(given, name, "mm", f"{name!r} ")
        notes += mended_notes
        if "sharp" in solid:
            solid, mesh = _sharp(solid, mesh, name, notes)
        found = mesh_shapes(mesh, name, "mm")
        if not _is_exact(found, solid):
            notes += found.notes
            if solid.get("off", 0.0) > found.error:
                notes.append(f"{name!r} has flat sides where it is round there, up to {solid['off']:.2g} mm off")
        shapes = found.shapes
    metres = [mesh_file.scaled(shape, 1.0 / MM_PER_M) for shape in shapes]
    return [shape.moved(frame @ shape.pose_body_shape) for shape in metres]


def _sharp(solid: Data, mesh: Triangles, name: str, notes: list[str]) -> tuple[Data, Triangles]:
    """Return a solid without its hollow roundings, and its surface; with them, where they are a great part of it."""
    try:
        given = Triangles(np.array(solid["sharp"]["vertices"]), np.array(solid["sharp"]["faces"]))
        sharp = mesh_file.checked(given, f"{name!r} ")
    except SceneError:  # Open CASCADE left it open or crossing itself
        return solid, mesh
    off = max(farthest_from(mesh, sharp), farthest_from(sharp, mesh))
    if off > LOSS_OF_ROUNDINGS * mesh.size:
        return solid, mesh
    roundings = counted((solid["n_fillets"], "hollow rounding", "hollow roundings"))
    notes.append(
        f"{name!r} has {roundings}, of {solid['radius']:.3g} mm at most: here, sharp corners, up to {off:.2g} mm off;"
        " where something rests in one, make it a chamfer"
    )
    return solid["sharp"], sharp


def _named(shape: Shape, mouths: Data) -> Shape:
    """Return a shape, with its name of old if it is a hole one of whose ends is where that had its mouth."""
    if isinstance(shape, Hole):
        ends = shape.nodes_body()[[0, -1]]
        for name, mouth in mouths.items():
            if np.linalg.norm(ends - mouth, axis=1).min() <= SAME_END * shape.radius_m:
                del mouths[name]
                return shape.renamed(name)
    return shape


def _rounded(core: FloatArray, radius: float, name: str) -> Shape:
    if len(core) == 1:
        return Sphere(radius, Pose(core[0]), name)
    if len(core) == 2:
        span = core[1] - core[0]
        return Capsule(radius, float(np.linalg.norm(span)), Pose(core.mean(axis=0), turn_from_z(span)), name)
    return Convex(core, radius, None, name)


def _is_exact(found: MeshShapes, solid: Data) -> bool:
    """Whether shapes have the volume of the surfaces that the triangles stand for."""
    volume = sum((-1.0 if isinstance(shape, Hole) else 1.0) * shape_moments(shape).volume_m3 for shape in found.shapes)
    return "volume" in solid and abs(volume - solid["volume"]) <= SAME_VOLUME * volume
