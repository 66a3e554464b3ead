"""Flags that several commands share."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from cagepose.errors import printable
from cagepose.model.methods import METHODS

SceneArgument = Annotated[str, Parameter(help="Scene file (YAML or JSON).")]
SetOption = Annotated[
    tuple[str, ...],
    Parameter(
        name="--set",
        negative="",
        show_default=False,
        help="Change one value: key.path=value, such as object.boxes[0].size[2]=12. May be given again.",
    ),
]
AtOption = Annotated[
    tuple[str, ...],
    Parameter(
        help="A point of the object, x,y,z in its frame and the scene's unit, such as --at=-600,20,-60.7; may be given"
        " several times.",
        negative=(),
        show_default=False,
        allow_leading_hyphen=True,
    ),
]
MethodOption = Annotated[
    str | None, Parameter(help=f"How to run the scene: {' or '.join(METHODS)}; left out: as the scene says.")
]
Switch = Parameter(negative="", show_default=False)


def unknown_method(method: str | None) -> list[str]:
    """Return the problem of a method that there is not; none of one that there is."""
    if method is None or method in METHODS:
        return []
    return [printable(f"--method {method}: is no known method; use one of: {', '.join(METHODS)}")]


def refusal(option: str, error: Exception) -> str:
    """Return why what ``option`` names cannot be used."""
    return printable(f"{option}: {getattr(error, 'strerror', None) or error}")
