"""Files that pictures and pages are written to: which kinds there are, and whether one may be written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from cagepose.files.write import check_can_write, is_made_by_us

FIGURES, EXPORTS = (".png", ".svg", ".pdf"), (".html", ".png", ".gif", ".mp4")


def output_suffix(name: str, suffixes: Sequence[str]) -> str:
    """Return the kind of file that a name asks for.

    Raises
    ------
    ValueError
        None of ``suffixes``.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in suffixes:
        found = f"{suffix} is no known kind of file" if suffix else "has no suffix that names its kind"
        raise ValueError(f"{found}; use one of: {', '.join(suffixes)}")
    return suffix


def check_output(name: str, suffixes: Sequence[str]) -> None:
    """Find out before a run whether the file ``name`` can be written.

    Raises
    ------
    ValueError
        A kind that is none of ``suffixes``.
    OSError
        The file cannot be written, see `check_can_write`; or holds something that cagepose has not made.
    """
    output_suffix(name, suffixes)
    check_can_write(name, is_made_by_us, "a page or picture that cagepose made")
