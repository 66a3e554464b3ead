"""Shapes of a STEP file kept in a file beside it, as to start Open CASCADE alone takes a second: `kept`, `keep`."""

from __future__ import annotations

import json
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from cagepose.files.record import from_record, record_of
from cagepose.files.write import MADE_BY, check_can_write, is_made_by_us, write_whole
from cagepose.model.box import Box
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.shapes import AnyShape

MOST_BYTES = 64 * 1024 * 1024
"""A file that holds more was not kept by us."""
VERSION = 3
"""Of the way from a solid to shapes; what an older one made is made anew."""


KeptShape = AnyShape | Facets | Box | Hole


@dataclass(frozen=True)
class KeptShapes:
    """Shapes in metres, how far they are from the file's surfaces at most, and what is not in them, in sentences."""

    shapes: tuple[KeptShape, ...]
    off_m: float
    notes: tuple[str, ...]


def kept(step_file: Path, key: str) -> KeptShapes | None:
    """Return what was kept of a file under a key; None: nothing was, or the file is another by now.

    What somebody changed in it is checked as the shapes of any saved run are.
    """
    record = _kept_of_file(step_file).get(key)
    try:
        return None if record is None else from_record(KeptShapes, record)
    except ValueError:  # pydantic's errors, and ours within them
        return None


def keep(step_file: Path, key: str, found: KeptShapes) -> None:
    """Keep shapes of a file under a key, which says of what in it, and how they were made. A folder that cannot be
    written keeps nothing.
    """
    path = _beside(step_file)
    everything = {**_kept_of_file(step_file), key: record_of(found)}
    what = f"shapes of {step_file.name}, {MADE_BY}"
    content = json.dumps({"what": what, "of": _digest(step_file), "kept": everything}).encode()
    try:
        if len(content) <= MOST_BYTES:
            check_can_write(path, is_made_by_us, "shapes of a STEP file that cagepose kept")
            write_whole(path, content)
    except OSError:
        pass


def _kept_of_file(step_file: Path) -> dict[str, Any]:
    path = _beside(step_file)
    try:
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
            return {}
        found = json.loads(path.read_bytes())
        return dict(found["kept"]) if found["of"] == _digest(step_file) else {}
    except (OSError, ValueError, TypeError, KeyError, RecursionError, MemoryError):
        return {}


def _beside(step_file: Path) -> Path:
    return step_file.with_name(f"{step_file.name}.shapes.json")


def _digest(step_file: Path) -> str:
    return sha256(f"{VERSION}\0".encode() + step_file.read_bytes()).hexdigest()
