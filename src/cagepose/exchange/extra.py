"""What the exchange floor takes from the extra `files`."""

from __future__ import annotations

from typing import Any

from cagepose.files.extra import files_library


def mujoco() -> Any:
    """Return MuJoCo.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return files_library("mujoco", "this needs MuJoCo")
