"""What the exchange floor takes from the extras files and cad."""

from __future__ import annotations

from typing import Any

from cagepose.files.extra import extra_library, files_library


def mujoco() -> Any:
    """Return MuJoCo.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return files_library("mujoco", "this needs MuJoCo")


def open_cascade() -> Any:
    """Return Open CASCADE, the library of STEP files.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return extra_library("OCP", "STEP files need Open CASCADE", "cad")
