"""Text out of a file that a user named, scenes and points files alike, and whether it is a saved run."""

from __future__ import annotations

import codecs
import difflib
import os
from pathlib import Path

from cagepose.errors import FileProblem, Key, SceneFileError

MAX_FILE_BYTES = 4 * 1024 * 1024
"""The size limit of a scene file and of a points file: about 100,000 points, far above any cage we know of."""

SCENE_SUFFIXES = (".yaml", ".yml", ".json")
LIKE_NAMES = 0.75
"""Likeness of names from 0 to 1. Names that are more alike are taken for a slip."""
HEAD_BYTES = 100
"""A saved run shows within the first bytes of a file that it is one."""


def read_text(path: Path, source: str, at: tuple[Key, ...] = ()) -> str:
    """Return the text of a UTF-8 file; ``at`` is the key of the scene that named it.

    Raises
    ------
    SceneFileError
        Missing, not a file, not readable, larger than `MAX_FILE_BYTES`, binary, or not UTF-8.
    """

    def refuse(message: str) -> SceneFileError:
        return SceneFileError([FileProblem(at, message, source)])

    try:
        if "\0" in source:
            raise refuse("is not a file name; remove the unprintable character")
        if path.is_dir():
            raise refuse("is a directory; name a file in it")
        if not path.exists():
            raise refuse(f"does not exist; {_meant(path)}check the name and the folder")
        if not path.is_file():
            raise refuse("is not a regular file; save the text in one and name that")
        with path.open("rb") as stream:
            content = stream.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        raise refuse(f"cannot be read ({error.strerror or error}); check its name and permissions") from None
    return decoded(content, source, at)


def decoded(content: bytes, source: str, at: tuple[Key, ...] = ()) -> str:
    """Return the text of what was read from a file, or from a pipe; ``source`` and ``at`` say in messages what it is.

    Raises
    ------
    SceneFileError
        Larger than `MAX_FILE_BYTES`, binary, or not UTF-8.
    """

    def refuse(message: str, line: int | None = None, column: int | None = None) -> SceneFileError:
        return SceneFileError([FileProblem(at, message, source, line, column)])

    if len(content) > MAX_FILE_BYTES:
        limit = f"{MAX_FILE_BYTES // 1024**2} MiB"
        raise refuse(f"is larger than {limit}, the size limit of scene and points files; give fewer points")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise refuse("is UTF-16 text; save it as UTF-8")
    if b"\0" in content:
        raise refuse("is a binary file; give a text file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - (before.rfind(b"\n") + 1) + 1
        byte = f"{content[error.start]:#04x}"
        raise refuse(f"holds byte {byte}, which is not UTF-8; save it as UTF-8", line, column) from None


def _meant(path: Path) -> str:
    """Return a question after a file beside the one that is missing, if there is one of a similar name."""
    try:
        names = [found.name for found in path.parent.iterdir() if found.suffix in SCENE_SUFFIXES]
    except OSError:
        return ""
    same = [name for name in names if Path(name).stem == path.name]
    close = same or difflib.get_close_matches(path.name, names, n=1, cutoff=LIKE_NAMES)
    return f"did you mean {path.parent / close[0]}? Else " if close else ""


def looks_like_run(path: str | os.PathLike[str]) -> bool:
    """Whether a file that can be read starts as a saved run does; a scene file never does."""
    try:
        with Path(path).open("rb") as stream:
            head = stream.read(HEAD_BYTES)
    except (OSError, ValueError):
        return False
    return starts_as_run(head.decode(errors="replace"))


def starts_as_run(text: str) -> bool:
    """As `looks_like_run`, of text that has been read: a pipe gives it only once."""
    head = text[:HEAD_BYTES]
    return head.lstrip().startswith("{") and '"version"' in head
