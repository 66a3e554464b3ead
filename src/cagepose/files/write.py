"""Files that we write: whole or not at all, and never over somebody else's work."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

MADE_BY = "made by cagepose"
"""Stands in every picture and report that we write, so that the next one may replace it."""
MAX_OWN_BYTES = 64 * 1024 * 1024
"""No picture or report of ours is larger; what is, is not searched for the mark."""


def write_whole(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file, whole or not at all.

    Raises
    ------
    OSError
        It cannot be written.
    """
    with whole_file(path) as stream:
        stream.write(content)


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file to be written bit by bit: it is there, whole, once the context has ended without an error.

    Raises
    ------
    OSError
        It cannot be written.
    """
    target = Path(path).resolve()  # a link stays a link; what it points to is replaced
    partial = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with partial.open("wb") as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)


def json_text(document: dict[str, Any], **on_one_line: object) -> str:
    """Return a document as the text that is printed and saved; long tables of numbers stand last, a line each."""
    text = json.dumps(document, indent=1, allow_nan=False)
    for key, value in on_one_line.items():
        text = f'{text[:-2]},\n "{key}": {json.dumps(value, separators=(",", ":"), allow_nan=False)}\n}}'
    return text + "\n"


def json_line(document: dict[str, Any]) -> str:
    """Return a document on a line of its own, for those who read many."""
    return json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n"


def check_can_write(path: str | os.PathLike[str], may_replace: Callable[[Path], bool], what: str) -> None:
    """Find out before long work whether `write_whole` can write to ``path``.

    Parameters
    ----------
    path
        The file.
    may_replace
        Says of a file that stands there whether it is one of ours.
    what
        What such a file is, for the message: "a saved run".

    Raises
    ------
    OSError
        It cannot: no such folder, a folder or device of that name, no permission, or a file with other content stands
        there.
    """
    if "\0" in os.fspath(path):
        raise OSError("is not a file name; remove the unprintable character")
    target = Path(path).resolve()
    if target.is_dir():
        raise IsADirectoryError("is a directory; name a file in it")
    if target.exists() and not target.is_file():
        raise OSError("is not a regular file; name another")
    if target.exists() and not may_replace(target):
        raise FileExistsError(f"holds something else than {what}; name another file, or remove it first")
    if not target.parent.is_dir():
        raise FileNotFoundError("its folder does not exist; make the folder first")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise PermissionError("its folder cannot be written; name another")


def is_made_by_us(target: Path) -> bool:
    """Whether a file is empty or bears our mark."""
    size = target.stat().st_size
    return size == 0 or (size <= MAX_OWN_BYTES and MADE_BY.encode() in target.read_bytes())
