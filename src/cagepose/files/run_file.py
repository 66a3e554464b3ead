"""Saved runs: one JSON file that holds the ``--json`` document for readers, and every number exactly for `load_run`."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, NoReturn

from pydantic import ValidationError

from cagepose.errors import RunFileError, SceneError, key_path, printable
from cagepose.files.document import FORMAT_VERSION, run_document
from cagepose.files.run_record import run_from_record, run_record
from cagepose.files.units import LengthUnit
from cagepose.runs.run import Run


def save_run(run: Run, path: str | os.PathLike[str], length_unit: LengthUnit = "mm") -> None:
    """Write ``run`` to one file, whole or not at all; ``length_unit`` is for the part that people read.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    check_can_save(path)
    content = {**run_document(run, length_unit), "exact": run_record(run)}
    target = Path(path).resolve()  # a link stays a link; what it points to is replaced
    partial = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with partial.open("w", encoding="utf-8") as stream:
            json.dump(content, stream, indent=1, allow_nan=False)
            stream.write("\n")
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(target)
    finally:
        partial.unlink(missing_ok=True)


def check_can_save(path: str | os.PathLike[str]) -> None:
    """Find out before a long run whether `save_run` can write to ``path``.

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
    if target.exists() and not _holds_nothing_else(target):
        raise FileExistsError("holds something else than a saved run; name another file, or remove it first")
    if not target.parent.is_dir():
        raise FileNotFoundError("its folder does not exist; make the folder first")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise PermissionError("its folder cannot be written; name another")


def _holds_nothing_else(target: Path) -> bool:
    """Whether a file is empty or starts as a saved run does, so that nobody's work is lost when it is replaced."""
    with target.open("rb") as stream:
        head = stream.read(100)
    return not head.strip() or (head.lstrip().startswith(b"{") and b'"version"' in head)


def load_run(path: str | os.PathLike[str]) -> Run:
    """Read a run that `save_run` or ``cagepose run --out`` wrote.

    Raises
    ------
    RunFileError
        Not readable, not a saved run, of an unknown version, or damaged.
    """
    source = os.fspath(path)

    def refuse(message: str) -> NoReturn:
        raise RunFileError(printable(f"{source}: {message}"))

    content = _read_json(source, refuse)
    if not isinstance(content, dict) or "version" not in content or "phases" not in content:
        refuse("is JSON, but not a run; name a file that cagepose run --out wrote")
    version = content["version"]
    if version != FORMAT_VERSION or isinstance(version, bool):
        refuse(
            f"has format version {version!r}, and this cagepose knows {FORMAT_VERSION};"
            " read it with the cagepose that wrote it, or run the scene again"
        )
    if "exact" not in content:
        refuse("is what --json prints, without the exact numbers; save the run with --out FILE instead")
    try:
        return run_from_record(content["exact"])
    except ValidationError as error:
        first = error.errors()[0]
        place = key_path(("exact", *first["loc"]))
        refuse(f"is damaged: {place}: {first['msg'].lower()}; run the scene again")
    except SceneError as error:
        refuse(f"is damaged: its scene cannot be right ({error.problems[0]}); run the scene again")


def _read_json(source: str, refuse: Any) -> object:
    try:
        text = Path(source).read_text(encoding="utf-8")
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a NUL character in the name
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        refuse(f"cannot be read ({reason}); name a file that cagepose run --out wrote")
    try:
        content: object = json.loads(text)
    except ValueError as error:
        refuse(f"is not JSON ({error}); it is no saved run, or it was cut short")
    except RecursionError:
        refuse("is JSON nested too deep; it is no saved run")
    return content
