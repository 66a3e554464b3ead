"""Solids of a file chosen by name: `solids_named`, `is_of`."""

from __future__ import annotations

from collections.abc import Iterable

from cagepose.errors import Problem, SceneError
from cagepose.model.wording import few

SHOWN = 12
"""So many names in a message."""


def solids_named(wanted: str, names: Iterable[str]) -> list[str]:
    """Return those names that are the wanted one, or begin with it before a "/".

    Raises
    ------
    SceneError
        There are none; the message lists those there are.
    """
    every = list(names)
    found = [name for name in every if is_of(name, wanted)]
    if not found:
        listed = few(filter(None, every), SHOWN) or "none has a name"
        raise SceneError([Problem((), f"has no solid {wanted!r}; its solids: {listed}")])
    return found


def is_of(name: str, element: str) -> bool:
    """Whether a name is that of an element, or of a part of it."""
    return name == element or name.startswith(f"{element}/")
