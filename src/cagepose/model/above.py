"""What scenes and results ask of the floors above their own: loaded by name when it is asked for (decision 25)."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

HOMES = {
    "text": "cagepose.cli.report:report_text",
    "run as html": "cagepose.views.notebook:run_html",
    "scene as html": "cagepose.views.notebook:scene_html",
    "changed scene": "cagepose.files.changed_scene:changed_scene",
}
"""Module and function of each."""


def from_above(what: str) -> Callable[..., Any]:
    """Return a function of a floor above."""
    module, _, name = HOMES[what].partition(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found
