"""A model or solids of another program as a scene: `imported`. A body is the object, others are the cage."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from cagepose.errors import FileProblem, SceneFileError
from cagepose.exchange.model_document import Chosen, model_document
from cagepose.exchange.solids_document import SOLIDS, solids_document
from cagepose.files.scene_file import SceneText
from cagepose.files.yaml_source import YamlSource
from cagepose.model.scene import Scene


class Import(NamedTuple):
    """A scene, and what of the file is not in it as it was, in sentences."""

    scene: Scene
    notes: tuple[str, ...]


def imported(
    source: str,
    object_name: str | None = None,
    cage_names: Sequence[str] = (),
    *,
    root: str | None = None,
    keyframe: str | None = None,
    qpos: str | None = None,
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

    Raises
    ------
    SceneFileError
        A file that cannot be used, a body that is not there, or a scene that cannot be right.
    MissingExtraError
        There is no MuJoCo, or what reads solids.
    """
    is_solids = Path(source).suffix.lower() in SOLIDS
    if any("\udc80" <= letter <= "\udcff" for letter in os.path.abspath(source)):  # the bytes of no UTF-8
        message = "has a name, or is in a folder, whose letters are no UTF-8; rename it"
        raise SceneFileError([FileProblem((), message, source)])
    try:
        if is_solids:
            document, notes = solids_document(source, object_name, cage_names)
        else:
            document, notes = model_document(source, Chosen(object_name, cage_names, root, keyframe, qpos))
    except OSError as error:
        message = f"cannot be read ({error.strerror or error}); check the names of its files and their permissions"
        raise SceneFileError([FileProblem((), message, source)]) from None
    scene = SceneText("", YamlSource(document, source), Path(source).parent).scene_file().scene
    return Import(scene, tuple(dict.fromkeys(notes)))
