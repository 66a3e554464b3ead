"""Flags that several commands share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from cagepose.errors import printable
from cagepose.model.methods import METHODS

if TYPE_CHECKING:
    FileName = str
    Method = str
else:  # both stay the words that were given; a shell offers files for the one, and these words for the other
    from pathlib import Path

    FileName = str | Path
    Method = Literal[METHODS] | str

FILE, METHOD = Parameter(metavar="FILE"), Parameter(metavar="METHOD", show_choices=False)
"""What help calls them."""
SceneArgument = Annotated[FileName, Parameter(help="Scene file (YAML or JSON).")]
SetOption = Annotated[
    tuple[str, ...],
    Parameter(
        name="--set",
        negative="",
        show_default=False,
        help="Change one value of the scene, such as object.boxes[0].size[2]=12; may be given several times.",
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
    Method | None,
    METHOD,
    Parameter(help=f"How to run the scene: {' or '.join(METHODS)}; left out: as the scene says."),
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
