"""Names of files that a run is exported to: which kinds there are, and whether one may be written."""

from __future__ import annotations

from pathlib import PurePath

from cagepose.files.write import check_can_write, is_made_by_us

EXPORT_SUFFIXES = (".html", ".png", ".gif")


def export_suffix(name: str) -> str:
    """Return the kind of file that a name asks for.

    Raises
    ------
    ValueError
        None that we can write.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in EXPORT_SUFFIXES:
        found = f"{suffix} is nothing that a run can be exported to" if suffix else "has no suffix that names its kind"
        raise ValueError(f"{found}; use one of: {', '.join(EXPORT_SUFFIXES)}")
    return suffix


def check_can_export(name: str) -> None:
    """Find out before a run whether it can be exported to the file ``name``.

    Raises
    ------
    ValueError
        A kind that we cannot write.
    OSError
        The file cannot be written, see `check_can_write`; or holds something that cagepose has not made.
    """
    export_suffix(name)
    check_can_write(name, is_made_by_us, "a page or picture that cagepose made")
