"""The text of an MJCF or URDF file, before any compiler sees it: what could do harm is refused here."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from cagepose.errors import FileProblem, SceneFileError
from cagepose.files.read import MAX_FILE_BYTES, read_text

MAX_MESH_BYTES = 64 * 1024 * 1024
"""All files that a model names have at most so many bytes together."""
SUFFIXES = (".xml", ".urdf")
FOLDERS = ("meshdir", "texturedir", "assetdir")
"""Attributes that name a folder."""
NAME = "file"
"""Attributes that name a file begin so: file, filename, fileright of a texture."""
SCHEMES = re.compile("^(package|file|model)://")
DECLARATIONS = re.compile("<!(DOCTYPE|ENTITY)", re.IGNORECASE)


class ModelText(NamedTuple):
    """A model that may be compiled: its root element, and whether it is URDF (else MJCF)."""

    root: ElementTree.Element
    is_urdf: bool


def read_model_text(source: str, others: Sequence[str] = ()) -> ModelText:
    """Read and check a model and the files that it includes; ``others``: what suffixes files may have that are read
    elsewhere.

    Raises
    ------
    SceneFileError
        It cannot be read, is no MJCF or URDF, declares entities, names a file outside of its folder, or is too large.
    """
    folder = Path(source).parent
    if Path(source).suffix not in SUFFIXES:
        message = f"has the suffix {Path(source).suffix!r}; give a file of one of: {', '.join((*SUFFIXES, *others))}"
        raise SceneFileError([FileProblem((), message, source)])
    root = _parsed(Path(source), source)
    if root.tag not in ("mujoco", "robot"):
        message = f"is XML with the root <{root.tag}>; give MJCF (<mujoco>) or URDF (<robot>)"
        raise SceneFileError([FileProblem((), message, source)])
    seen, waiting, n_bytes = {Path(source).resolve()}, [root], 0
    folders = [folder]
    while waiting:
        model = waiting.pop()
        given = [name for element in model.iter() for key in FOLDERS if (name := element.get(key)) is not None]
        folders += [_inside(folder, name, source) for name in given]
        for element in model.iter():
            names = [name for key, name in element.attrib.items() if key.startswith(NAME)]
            for path in dict.fromkeys(_inside(where, name, source) for where in folders for name in names):
                if path in seen or not path.is_file():
                    continue  # a missing one is told by the compiler, which knows where else to look
                seen.add(path)
                n_bytes += path.stat().st_size
                if n_bytes > MAX_MESH_BYTES:
                    message = f"names files of more than {MAX_MESH_BYTES // 1024**2} MiB; simplify the meshes"
                    raise SceneFileError([FileProblem((), message, source)])
                if element.tag == "include":
                    waiting.append(_parsed(path, str(path)))
    return ModelText(root, root.tag == "robot")


def _inside(folder: Path, name: str, source: str) -> Path:
    """Return the path that a name in a model means.

    Raises
    ------
    SceneFileError
        It lies outside of the model's folder, through a link or not.
    """
    plain = SCHEMES.sub("", name)
    try:
        path = (folder / plain).resolve() if "\0" not in plain else Path("/")
    except (OSError, RuntimeError):
        message = f"names {name[:80]!r}, a link that leads to itself; copy the file there"
        raise SceneFileError([FileProblem((), message, source)]) from None
    if not path.is_relative_to(Path(source).parent.resolve()):
        message = f"names {name[:80]!r}, which lies outside of the model's folder; copy it there"
        raise SceneFileError([FileProblem((), message, source)])
    return path


def _parsed(path: Path, source: str) -> ElementTree.Element:
    if path.is_file() and path.stat().st_size > MAX_FILE_BYTES:
        message = f"is larger than {MAX_FILE_BYTES // 1024**2} MiB, the size limit of models; put meshes into files"
        raise SceneFileError([FileProblem((), message, source)])
    text = read_text(path, source)
    if DECLARATIONS.search(text):
        message = "declares a document type or entities, which models need not and bombs are made of; remove them"
        raise SceneFileError([FileProblem((), message, source)])
    try:
        return ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        message = f"is not XML ({str(error).partition(':')[0]}); correct this line"
        raise SceneFileError([FileProblem((), message, source, line, column + 1)]) from None
