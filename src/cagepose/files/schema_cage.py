"""The cage of a scene file: points in their forms, shapes, and bodies of both."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Discriminator, Field, Tag

from cagepose.files.schema_base import Mapping, Name, PoseModel, Vector
from cagepose.files.schema_shapes import Shapes, either

POINTS = [[4, 4, 0], [-4, 4, 0], [0, -4, 0]]
"""Points of an example."""


def _points_form(value: object) -> str | None:
    """Which of the three ways to give points this is."""
    if isinstance(value, list):
        return "list"
    if isinstance(value, dict):
        return "file" if "file" in value and not isinstance(value["file"], list) else "names"
    return None


class PointsFileModel(Mapping):
    """Points in a file of their own."""

    file: str = Field(
        min_length=1,
        description="CSV file beside this one, rows of x,y,z or name,x,y,z in the scene's length unit.",
        examples=["points.csv"],
    )


Points = Annotated[
    Annotated[list[Vector], Field(min_length=1, title="Points named C1, C2, ..."), Tag("list")]
    | Annotated[dict[Name, Vector], Field(min_length=1, title="Points with names"), Tag("names")]
    | Annotated[PointsFileModel, Tag("file")],
    Discriminator(_points_form),
]


def _body_points_form(value: object) -> str:
    """Which of the two ways to give the points of a body this is."""
    return "names" if isinstance(value, dict) else "list"


BodyPoints = Annotated[
    Annotated[list[Vector], Field(min_length=1, title="Points named BODY/C1, BODY/C2, ..."), Tag("list")]
    | Annotated[dict[Name, Vector], Field(min_length=1, title="Points with names"), Tag("names")],
    Discriminator(_body_points_form),
]


class CageBodyModel(Mapping):
    """A body of the cage that a phase can drive; where none does, it stands still."""

    model_config = ConfigDict(json_schema_extra=either("points", "shapes"))

    points: BodyPoints | None = Field(
        None,
        description="A list of [x, y, z], or NAME: [x, y, z] for each, in the body's frame.",
        examples=[POINTS],
    )
    shapes: Shapes | None = Field(
        None,
        description="Shapes in the body's frame.",
        examples=[[{"cylinder": {"radius": 5, "length": 20}, "position": [0, 0, 0]}]],
    )
    pose: PoseModel | None = Field(
        None, description="Where the body starts, in the cage's frame; left out: its frame is the cage's."
    )


class CageModel(Mapping):
    """What holds it: points and shapes that do not move, and bodies that can be driven."""

    model_config = ConfigDict(json_schema_extra=either("points", "shapes", "bodies"))

    points: Points | None = Field(
        None,
        description="A list of [x, y, z], or NAME: [x, y, z] for each, or file: points.csv.",
        examples=[POINTS],
    )
    shapes: Shapes | None = Field(
        None,
        description="Shapes in the cage's frame.",
        examples=[[{"cylinder": {"radius": 5, "length": 20}, "position": [0, 0, 0]}]],
    )
    bodies: Annotated[dict[Name, CageBodyModel], Field(min_length=1)] | None = Field(
        None,
        description="NAME: points, shapes and pose of each body that a phase can drive.",
        examples=[{"mate": {"points": [[40, 0, 0]]}}],
    )
    pose: PoseModel | None = Field(None, description="Moves all points, shapes and bodies at once: a misaligned cage.")
