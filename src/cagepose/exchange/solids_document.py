"""Solids of STEP and mesh files as the data of a scene file: `solids_document`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import FileProblem, SceneError, SceneFileError
from cagepose.exchange.beside import SETTINGS
from cagepose.exchange.imported_part import ImportedPart
from cagepose.exchange.solids_note import SHOWN, read_solids_note
from cagepose.exchange.source_solids import SOLIDS, source_solids
from cagepose.exchange.tolerances import SAME_END
from cagepose.files.meshes.mesh_file import refused
from cagepose.files.progress import tell
from cagepose.files.scene_document import SceneWriter
from cagepose.files.solid_names import is_of, solids_named
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape
from cagepose.model.wording import few

Data = dict[str, Any]

METRES = SceneWriter("m")
WEIGHT = [{"name": "weight", "gravity": [0.0, 0.0, -9.81]}]
JOIN = "cagepose import --object FILE --cage FILE -o scene.yaml"
ALONE = "has no solid but the object; name the files of its cage: cagepose import --object {} --cage FILE -o scene.yaml"


class SceneData(NamedTuple):
    """The data of a scene, what of its files is not in it as it was, and what solids are in it, and were."""

    document: Data
    notes: list[str]
    parts: tuple[ImportedPart, ...] = ()


def solids_document(
    source: str, object_name: str | None, cage_names: Sequence[str], *, fillets: bool = True
) -> SceneData:
    """Return the data of a scene of solids, and what is not in it as in the file; arguments as of
    `cagepose.exchange.imported.imported`.

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
        solids = {solid.name: solid for solid in source_solids(path, notes, is_ours=bool(note), fillets=fillets)}
        held, walls = _chosen(source, list(solids), object_name, cage_names)
        left = [name for name in solids if name not in (*held, *walls)]
        if left:
            notes.append(f"solids left out: {few(left, 12)}")
        points = [name for name in walls if _short(name, walls) in note.get("points", ())]
        walls = [name for name in walls if name not in points]
        of_object, of_cage = (Pose(*note[key]) if note else Pose() for key in SHOWN.values())
        listed = [("object", name, held, of_object.inverse()) for name in held]
        listed += [("cage", name, walls, of_cage.inverse()) for name in walls]
        parts = [solids[name].part(body, _short(name, names), frame) for body, name, names, frame in listed]
    except SceneError as error:
        messages = [*(problem.message for problem in error.problems), *damaged]
        raise SceneFileError([FileProblem((), message, source) for message in messages]) from None
    finally:
        tell("")
    mouths = note.get("holes", {})
    shapes = {
        body: [METRES.shape(_named(shape, mouths)) for part in parts if part.body == body for shape in part.shapes]
        for body in ("object", "cage")
    }
    notes += [said for part in parts for said in part.notes]
    found: Data = {"name": note.get("name") or path.stem, "units": {"length": "m"}}
    found["object"] = {**note.get("object", {}), "shapes": shapes["object"]}
    found["cage"] = {"shapes": shapes["cage"], "pose": METRES.pose(of_cage)}
    found["cage"]["points"] = {
        _short(name, points): of_cage.inverse_transform(solids[name].middle_m()).tolist() for name in points
    }
    found["cage"] = {key: value for key, value in found["cage"].items() if value}
    if not note:
        return SceneData(with_weight_alone(found, notes), notes, tuple(parts))
    found["loads"] = note.get("loads") or WEIGHT
    elements = [*(shape["name"] for body in shapes.values() for shape in body), *found["cage"].get("points", ())]
    found |= kept_friction(note, elements)
    lost = [one for one in note["friction"]["of"] if not any(is_of(name, one) for name in elements)]
    notes += [f"friction of {few(lost)} is lost, as nothing there has the name"] if lost else []
    kept = {key: note[key] for key in SETTINGS if key in note}
    return SceneData(found | kept, notes, tuple(parts))


def with_weight_alone(found: Data, notes: list[str]) -> Data:
    """Return the data of a scene with the loads of one whose files say none."""
    notes.append("the object has no mass there: here, uniform density")
    notes.append("loads: the weight alone, with a gravity of (0, 0, -9.81) m/s^2; no friction")
    return {**found, "loads": WEIGHT}


def kept_friction(note: Data, names: Sequence[str]) -> Data:
    """Return the friction of a note as a scene file has it, for the elements that there are."""
    kept = note["friction"]
    of = {name: mu for name in names for element, mu in kept["of"].items() if is_of(name, element)}
    coefficient = {} if kept["coefficient"] is None else {"coefficient": kept["coefficient"]}
    return {"friction": {**coefficient, "of": of}} if of or coefficient else {}


def _chosen(
    source: str, names: list[str], object_name: str | None, cage_names: Sequence[str]
) -> tuple[list[str], list[str]]:
    """Return the names of the solids of the object and of the cage."""

    def of(wanted: str) -> list[str]:
        if Path(wanted).suffix.lower() in SOLIDS and not any(is_of(name, wanted) for name in names):
            raise refused(f"has no solid {wanted!r}; if that is a file, join both: {JOIN}")
        return solids_named(wanted, names)

    if len(names) == 1 and object_name is None:
        raise refused(ALONE.format(quote(source)))
    if object_name is None and not any(is_of(name, "object") for name in names):
        raise refused(f"does not say which solid is held; give --object and one of: {few(names, 12)}")
    held = of(object_name or "object")
    chosen = [name for wanted in cage_names for name in of(wanted)] or names
    walls = [name for name in dict.fromkeys(chosen) if name not in held]
    if not walls:
        raise refused(ALONE.format(quote(source)))
    return held, walls


def _short(name: str, names: Sequence[str]) -> str:
    """Return a name without that of its body before it, unless two would be one then."""
    short = name.partition("/")[2] or name
    return short if sum((other.partition("/")[2] or other) == short for other in names) == 1 else name


def _named(shape: Shape, mouths: Data) -> Shape:
    """Return a shape, with its name of old if it is a hole one of whose ends is where that had its mouth."""
    if isinstance(shape, Hole):
        ends = shape.nodes_body()[[0, -1]]
        for name, mouth in mouths.items():
            if np.linalg.norm(ends - mouth, axis=1).min() <= SAME_END * shape.radius_m:
                del mouths[name]
                return shape.renamed(name)
    return shape
