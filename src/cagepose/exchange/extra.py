"""What the exchange floor takes from the extras files and cad."""

from __future__ import annotations

from typing import Any

from cagepose.files.extra import extra_library, files_library


def manifold3d() -> Any:
    """Return the module that cuts and drills bodies.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return files_library("manifold3d", "parts with holes need manifold3d")


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
