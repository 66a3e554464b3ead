"""Where the names in a model lead: `ModelRoot`. Nothing outside of one folder is ever read."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from cagepose.errors import FileProblem, SceneFileError

PACKAGE = re.compile("^(?:package|model)://([^/]+)/+(.+)$", re.DOTALL)
PLAIN_FILE = re.compile("^file://")
PACKAGE_NAME = re.compile(rb"<name>\s*([^<>\s]+)\s*</name>")
PACKAGE_BYTES = 65536
"""A package says its name within so many bytes."""
SHOWN = 80
"""Characters of a name in a message."""


class ModelRoot:
    """The folder under which a model's files lie.

    Attributes
    ----------
    folder
        That folder, without links.
    """

    def __init__(self, source: str, root: str | None = None) -> None:
        """
        Raises
        ------
        SceneFileError
            ``root`` is no folder, or the model does not lie in it.
        """
        self._source, self._root = source, root
        self._beside = Path(source).resolve().parent
        self.folder = self._beside if root is None else Path(root).resolve()
        if root is not None and not self.folder.is_dir():
            raise self._refused(f"is to be read under --root {root}, which is no folder; check the name")
        if not self._beside.is_relative_to(self.folder):
            raise self._refused(f"does not lie under --root {root}; give a folder above it")

    def inside(self, path: Path, name: str) -> Path:
        """Return a path without links; ``name``: as the model has it.

        Raises
        ------
        SceneFileError
            It leads out of the folder, through a link or not.
        """
        found = self._without_links(path, name)
        if found.is_relative_to(self.folder):
            return found
        both = Path(os.path.commonpath([self._beside, found]))
        where = "the model's folder" if self._root is None else f"--root {self._root}"
        remedy = "copy it there"
        if both != Path(both.anchor) and found.exists():
            remedy = f"give --root {short_path(both)}, under which files may lie then, or copy it there"
        raise self._refused(f"names {name[:SHOWN]!r}, which lies outside of {where}; {remedy}")

    def first(self, places: Iterable[Path], name: str) -> Path:
        """Return the first of several places where a file is, without links.

        Raises
        ------
        SceneFileError
            It leads out of the folder, or there is no file at any.
        """
        outside: Path | None = None
        for place in places:
            found = self._without_links(place, name)
            if not found.is_relative_to(self.folder):
                outside = outside or place
            elif found.is_file():
                return found
        if outside is not None:
            self.inside(outside, name)
        shown = f"names {name[:SHOWN]!r}"
        if (package := PACKAGE.match(name)) and not any(self._packages(package[1])):
            remedy = f"give the folder that holds {package[1]}, or one above it, with --root"
            raise self._refused(f"{shown}, and no folder above the model is or has that package; {remedy}")
        raise self._refused(f"{shown}, and there is no such file; copy it there, or correct the name")

    def places(self, name: str) -> Iterator[Path]:
        """Yield what a name of a URDF may mean: a file of a package, as ROS takes it; one that the folder of the model
        or the root has.
        """
        package = PACKAGE.match(name)
        if package is not None:
            yield from (folder / package[2] for folder in self._packages(package[1]))
            return
        plain = PLAIN_FILE.sub("", name)
        yield self._beside / plain
        yield self.folder / plain

    def _packages(self, package: str) -> Iterator[Path]:
        """Yield folders that may be a package, those above the model, nearest first: one that is called so or whose
        package.xml says so, and one in it that is called so.
        """
        for above in (self._beside, *self._beside.parents):
            if not above.is_relative_to(self.folder):
                return
            if package in (above.name, self._package_name(above)):
                yield above
            if self._without_links(above / package, package).is_dir():
                yield above / package

    def _package_name(self, folder: Path) -> str | None:
        described = (folder / "package.xml").resolve()
        if not (described.is_relative_to(self.folder) and described.is_file()):
            return None
        with described.open("rb") as stream:
            said = PACKAGE_NAME.search(stream.read(PACKAGE_BYTES))
        return said[1].decode(errors="replace") if said else None

    def _without_links(self, path: Path, name: str) -> Path:
        if "\0" in str(path):
            return Path(path.anchor or "/")
        try:
            return path.resolve()
        except (OSError, RuntimeError):
            raise self._refused(f"names {name[:SHOWN]!r}, a link that leads to itself; copy the file there") from None

    def _refused(self, message: str) -> SceneFileError:
        return SceneFileError([FileProblem((), message, self._source)])


def short_path(path: str | os.PathLike[str]) -> str:
    """Return a path as a user would type it."""
    relative = os.path.relpath(path)
    return relative if len(relative) < len(os.fspath(path)) else os.fspath(path)
