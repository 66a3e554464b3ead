"""Files of points and of meshes that a scene names: where, and whether they have changed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from cagepose.files.key_path import Path as KeyPath


def files_named(data: object) -> dict[KeyPath, str]:
    """Return where plain scene data name a file of points or of a mesh, and its name."""
    return dict(_named(data, ()))


def _named(here: object, path: KeyPath) -> Iterator[tuple[KeyPath, str]]:
    if isinstance(here, str) and path[-1:] == ("file",) and path[0] in ("object", "cage"):
        yield path, here
    pairs = here.items() if isinstance(here, dict) else enumerate(here) if isinstance(here, list) else ()
    for key, value in pairs:
        yield from _named(value, (*path, key))


def stamp_of(folder: Path, names: Sequence[str]) -> str:
    """Return what is another text once one of some files has been written, made or removed."""
    stamps = []
    for name in names:
        try:
            stat = (folder / name).stat()
            stamps.append(f"{stat.st_mtime_ns}-{stat.st_size}")
        except (OSError, ValueError):
            stamps.append("none")
    return " ".join(stamps)
