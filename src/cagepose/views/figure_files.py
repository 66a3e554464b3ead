"""Names of picture files: which kinds there are, and whether one may be written. Needs no matplotlib."""

from __future__ import annotations

from pathlib import PurePath

from cagepose.files.write import check_can_write, is_made_by_us

FIGURE_SUFFIXES = (".png", ".svg", ".pdf")


def figure_suffix(name: str) -> str:
    """Return the kind of picture that a file name asks for.

    Raises
    ------
    ValueError
        None that we can write.
    """
    suffix = PurePath(name).suffix.lower()
    if suffix not in FIGURE_SUFFIXES:
        found = f"{suffix} is no known kind of picture" if suffix else "has no suffix that names a kind of picture"
        raise ValueError(f"{found}; use one of: {', '.join(FIGURE_SUFFIXES)}")
    return suffix


def check_can_draw(name: str) -> None:
    """Find out before a run whether a picture can be written to the file ``name``.

    Raises
    ------
    ValueError
        A kind that we cannot write.
    OSError
        The file cannot be written, see `check_can_write`; or holds something else than a picture of ours.
    """
    figure_suffix(name)
    check_can_write(name, is_made_by_us, "a picture that cagepose made")
