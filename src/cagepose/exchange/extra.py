"""Libraries of the files extra, imported where they are needed; a missing one is named with its install line."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from cagepose.errors import MissingExtraError


def manifold3d() -> Any:
    """Return the module that cuts and drills bodies.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return _library("manifold3d", "parts with holes need manifold3d")


def mujoco() -> Any:
    """Return MuJoCo.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    return _library("mujoco", "this needs MuJoCo")


def _library(module: str, need: str) -> Any:
    try:
        return import_module(module)
    except ImportError as error:
        message = f"{need}, which is not installed; install the files extra: pip install 'cagepose[files]'"
        raise MissingExtraError(message) from error
