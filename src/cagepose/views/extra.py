"""Is an extra there? Asked before anything is run, so that nobody waits for a picture that cannot be drawn."""

from __future__ import annotations

from importlib.util import find_spec

from cagepose.errors import MissingExtraError


def require_pillow() -> None:
    """Do nothing if Pillow is installed.

    Raises
    ------
    MissingExtraError
        It is not; the message says how to install it.
    """
    if find_spec("PIL") is None:
        raise MissingExtraError(
            "pictures need Pillow, which is not installed; install the view extra: pip install 'cagepose[view]'"
        )


def require_matplotlib() -> None:
    """Do nothing if matplotlib is installed.

    Raises
    ------
    MissingExtraError
        It is not; the message says how to install it.
    """
    if find_spec("matplotlib") is None:
        raise MissingExtraError(
            "pictures need matplotlib, which is not installed; install the plot extra: pip install 'cagepose[plot]'"
        )
