"""A model or solids of another program as a scene: `imported`. A body is the object, others are the cage."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from cagepose.errors import FileProblem, Problem, SceneFileError
from cagepose.exchange.imported_part import ImportedPart
from cagepose.exchange.model_document import Chosen, Data, model_document
from cagepose.exchange.model_parts import Weight
from cagepose.exchange.solids_document import SceneData, solids_document
from cagepose.exchange.source_solids import SOLIDS
from cagepose.files.scene_file import SceneText
from cagepose.files.yaml_source import YamlSource
from cagepose.model.scene import Scene


class Import(NamedTuple):
    """A scene, and what of the file is not in it as it was, in sentences; what each solid, or each body of a model, was
    and is; and of a model what its object weighs.
    """

    scene: Scene
    notes: tuple[str, ...]
    parts: tuple[ImportedPart, ...] = ()
    weight: Weight | None = None


def imported(
    source: str,
    object_name: str | None = None,
    cage_names: Sequence[str] = (),
    *,
    root: str | None = None,
    keyframe: str | None = None,
    qpos: str | None = None,
    fillets: bool = True,
) -> Import:
    """Read a model; what takes seconds is told, see `cagepose.files.progress`.

    Parameters
    ----------
    source
        The file.
    object_name
        The body that is held, with all that hangs on it; None: the only one that moves freely. Of solids, one of their
        names, or what they begin with before a "/".
    cage_names
        Bodies that hold it, each with all that hangs on it; none: all others.
    root
        Of a robot model: the folder under which its meshes and what it includes lie; None: its own.
    keyframe, qpos
        Of a robot model: the pose at which bodies are taken, a keyframe's name, and coordinates of joints, all or
        JOINT=NUMBER for some.
    fillets
        Whether hollow roundings of STEP files stay; else walls go on to where they meet.

    Raises
    ------
    SceneFileError
        A file that cannot be used, a body that is not there, or a scene that cannot be right.
    MissingExtraError
        There is no MuJoCo, or what reads solids.
    """
    is_solids = Path(source).suffix.lower() in SOLIDS
    check_name(source)
    try:
        if is_solids:
            return import_of(solids_document(source, object_name, cage_names, fillets=fillets), source)
        data = model_document(source, Chosen(object_name, cage_names, root, keyframe, qpos))
    except OSError as error:
        message = f"cannot be read ({error.strerror or error}); check the names of its files and their permissions"
        raise SceneFileError([FileProblem((), message, source)]) from None
    found = import_of(SceneData(data.document, data.notes), source)
    return found._replace(parts=data.source.parts(found.scene), weight=data.source.weight(found.scene))


def check_name(source: str) -> None:
    """Refuse a file whose name libraries cannot take."""
    if any("\udc80" <= letter <= "\udcff" for letter in os.path.abspath(source)):  # the bytes of no UTF-8
        message = "has a name, or is in a folder, whose letters are no UTF-8; rename it"
        raise SceneFileError([FileProblem((), message, source)])


def import_of(data: SceneData, source: str) -> Import:
    """Return the scene of the data that were read from a file; a problem of a shape says which, by its name.

    Raises
    ------
    SceneFileError
        It cannot be right.
    """
    try:
        scene = SceneText("", YamlSource(data.document, source), Path(source).parent).scene_file().scene
    except SceneFileError as error:
        raise SceneFileError([_by_name(problem, data.document, source) for problem in error.problems]) from None
    return Import(scene, tuple(dict.fromkeys(data.notes)), data.parts)


def _by_name(problem: Problem, document: Data, source: str) -> FileProblem:
    """Return a problem with the name of the shape that it is about in place of its number."""
    if problem.path[:1] not in (("object",), ("cage",)) or problem.path[1:2] != ("shapes",) or len(problem.path) < 3:
        return FileProblem(problem.path, problem.message, source)
    body, which = str(problem.path[0]), int(problem.path[2])
    name = document[body]["shapes"][which]["name"]
    return FileProblem((), f"{name!r} in the {body} {problem.message}", source)
