"""What the exchange floor takes from the files extra."""

from __future__ import annotations

from typing import Any

from cagepose.files.extra import files_library


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
