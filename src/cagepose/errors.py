"""What cagepose raises.

    CageposeError
    ├── SceneError           a scene that cannot be right: every problem found, each with its place
    │   └── SceneFileError   the same, found in a scene file: each place has its line and column
    ├── StudyFolderError     a folder that holds no study, another one, or a damaged part
    ├── RunFileError         a saved run that cannot be read
    ├── CertificateError     a certificate that proves nothing
    ├── MissingExtraError    a part of cagepose that is not installed
    └── KernelsError         the machine code that is built with cagepose is missing, or does not fit

Anything else that escapes is a bug of ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Key = str | int


class CageposeError(Exception):
    """Root of all errors that cagepose raises on purpose."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a scene.

    Attributes
    ----------
    path
        Keys and indices from the scene's root to the place, such as ``("object", "boxes", 1, "size")``.
    message
        What was found there and what to do about it, in the user's words.
    """

    path: tuple[Key, ...]
    message: str

    def under(self, *prefix: Key) -> Problem:
        """Return the same problem, seen from a noun that holds this one at ``prefix``."""
        return Problem((*prefix, *self.path), self.message)

    def __str__(self) -> str:
        return f"{key_path(self.path)}: {self.message}" if self.path else self.message


class SceneError(CageposeError, ValueError):
    """A scene that cannot be right. ``problems`` lists all that was found, not only the first."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))

    def under(self, *prefix: Key) -> SceneError:
        """Return the same error, seen from a noun that holds this one at ``prefix``."""
        return SceneError([problem.under(*prefix) for problem in self.problems])


@dataclass(frozen=True)
class FileProblem(Problem):
    """A problem with its place in a file.

    Attributes
    ----------
    source
        The file, as it was named by the user; or the ``--set`` argument that caused the problem.
    line, column
        Counted from 1; None where there is none: a missing file, a directory, a ``--set`` argument.
    """

    source: str
    line: int | None = None
    column: int | None = None

    def __str__(self) -> str:
        place = self.source if self.line is None else f"{self.source}:{self.line}:{self.column}"
        return printable(f"{place}: {super().__str__()}")


class SceneFileError(SceneError):
    """A scene or study file that cannot be used: missing, not YAML, or a scene that cannot be right."""


class StudyFolderError(CageposeError, ValueError):
    """A folder of a study that cannot be used: it holds none, another one, or a part that cannot be read."""


class RunFileError(CageposeError, ValueError):
    """A saved run that cannot be read: not one of ours, of an unknown version, or damaged."""


class CertificateError(CageposeError, ValueError):
    """A certificate that proves nothing: for another scene or pose, incomplete, or with a wrong number."""


class MissingExtraError(CageposeError, ImportError):
    """Something needs a package that comes with an extra of cagepose; the message says with which one."""


def key_path(path: tuple[Key, ...]) -> str:
    """Write a path the way users write it.

    >>> key_path(("object", "boxes", 1, "size"))
    'object.boxes[1].size'
    """
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else str(key)
    return text


def printable(text: str) -> str:
    r"""Escape what would break a line or move the cursor, so that one problem stays one line.

    >>> printable("two\nlines")
    'two\\nlines'
    """
    return "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in text)


class KernelsError(CageposeError, ImportError):
    """The machine code that is built with cagepose is missing, older than its sources, or not for this processor."""
