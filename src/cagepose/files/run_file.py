"""Saved runs: one JSON file that holds the ``--json`` document for readers, and every number exactly for `load_run`."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError

from cagepose.errors import Key, RunFileError, SceneError, key_path, printable
from cagepose.files.document import FORMAT_VERSION, run_document
from cagepose.files.read import looks_like_run
from cagepose.files.record import from_record, record_of
from cagepose.files.units import LENGTH_UNITS, LengthUnit
from cagepose.files.write import check_can_write, json_text, write_whole
from cagepose.model.checks import expect, expect_choice
from cagepose.runs.run import Run
from cagepose.studies.certificate import Certificate
from cagepose.studies.certify import certificate
from cagepose.studies.margin import Margin

Kind = TypeVar("Kind")


def save_run(
    run: Run,
    path: str | os.PathLike[str],
    length_unit: LengthUnit = "mm",
    margins: Sequence[Margin | None] | None = None,
) -> None:
    """Write ``run`` to one file, whole or not at all; ``length_unit`` is for the part that people read, where
    ``margins``, one for each phase, stand too.

    The file also holds the certificate of each phase's end, see `load_certificates`.

    Raises
    ------
    SceneError
        It is no run, or an unknown unit.
    OSError
        The file cannot be written.
    """
    expect(run, Run, "run")
    expect_choice(length_unit, LENGTH_UNITS, "length_unit")
    check_can_save(path)
    content = {**run_document(run, length_unit, margins), "exact": record_of(run)}
    certificates = (certificate(run, phase) for phase in range(len(run.phases)))
    records = [None if found is None else record_of(found) for found in certificates]
    write_whole(path, json_text(content, certificates=records).encode())


def check_can_save(path: str | os.PathLike[str]) -> None:
    """Find out before a long run whether `save_run` can write to ``path``.

    Raises
    ------
    OSError
        It cannot, see `check_can_write`.
    """
    check_can_write(path, lambda target: _is_blank(target) or looks_like_run(target), "a saved run")


def _is_blank(target: Path) -> bool:
    with target.open("rb") as stream:
        return not stream.read(100).strip()


@dataclass(frozen=True)
class RunFile:
    """A saved run, and the unit that its file shows lengths in."""

    run: Run
    length_unit: LengthUnit


def load_run(path: str | os.PathLike[str]) -> Run:
    """Read a run that `save_run` or ``cagepose run --out`` wrote.

    Raises
    ------
    RunFileError
        Not readable, not a saved run, of an unknown version, or damaged.
    """
    return read_run_file(path).run


def read_run_file(path: str | os.PathLike[str]) -> RunFile:
    """As `load_run`, and keep the file's length unit.

    Raises
    ------
    RunFileError
        As `load_run`.
    """
    content, refuse = _content(path)
    if "exact" not in content:
        refuse("is what --json prints, without the exact numbers; save the run with --out FILE instead")
    unit = content["units"].get("length") if isinstance(content.get("units"), dict) else None
    if unit not in LENGTH_UNITS:
        refuse(f"is damaged: units.length is {unit!r}; run the scene again")
    run = _read_record(Run, content["exact"], ("exact",), refuse)
    if not run.phases:
        refuse("is damaged: exact.phases: is empty; run the scene again")
    return RunFile(run, unit)


def load_certificates(path: str | os.PathLike[str]) -> tuple[Certificate | None, ...]:
    """Read the certificates of a saved run, one for each phase; None where `certificate` gave none.

    They are as the file says: `check_certificate` finds out whether they are right.

    Raises
    ------
    RunFileError
        As `load_run`, or the file is older than certificates.
    """
    content, refuse = _content(path)
    if not isinstance(content.get("certificates"), list):
        refuse("has no certificates; save its run again, or make one with cagepose.certificate(run)")
    return tuple(
        None if record is None else _read_record(Certificate, record, ("certificates", phase), refuse)
        for phase, record in enumerate(content["certificates"])
    )


def _content(path: str | os.PathLike[str]) -> tuple[dict[str, Any], Callable[[str], NoReturn]]:
    """Return what a saved run holds, its version being right, and how to refuse it by its name."""
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
    return content, refuse


def _read_record(kind: type[Kind], record: object, place: tuple[Key, ...], refuse: Callable[[str], NoReturn]) -> Kind:
    try:
        return from_record(kind, record)
    except ValidationError as error:
        first = error.errors()[0]
        reason = first.get("ctx", {}).get("error")
        if isinstance(reason, SceneError):
            refuse(f"is damaged: its scene cannot be right ({reason.problems[0]}); run the scene again")
        refuse(f"is damaged: {key_path((*place, *first['loc']))}: {first['msg'].lower()}; run the scene again")


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
