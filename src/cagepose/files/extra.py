"""Libraries of the files extra, imported where they are needed; a missing one is named with its install line."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from cagepose.errors import MissingExtraError


def files_library(module: str, need: str) -> Any:
    """Return a module of the files extra, see `extra_library`.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return extra_library(module, need, "files")


def extra_library(module: str, need: str, extra: str) -> Any:
    """Return a module of an extra; ``need`` says what needs it: "meshes need trimesh".

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise _missing(need, extra) from error


def require(module: str, need: str, extra: str) -> None:
    """As `extra_library`, but do not import it, which may take seconds."""
    if find_spec(module) is None:
        raise _missing(need, extra)


def _missing(need: str, extra: str) -> MissingExtraError:
    return MissingExtraError(
        f"{need}, which is not installed; install the {extra} extra: pip install 'cagepose[{extra}]'"
    )
