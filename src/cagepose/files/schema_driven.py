"""Drives of bodies in a scene file, legs of travels and turns and the limit at which they stop; and what presses."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from cagepose.files.schema_base import Direction, Mapping, Name, Number, Positive, Vector, wrong
from cagepose.files.schema_shapes import either


class TurnModel(Mapping):
    """A turn about an axis."""

    about: Direction = Field(
        description="Its axis in the cage's frame, right-handed, any length.", examples=[[0, 0, 1]]
    )
    through: Vector | None = Field(
        None, description="A point of the axis, in the cage's frame; left out: its origin.", examples=[[0, 0, 0]]
    )
    angle_deg: Number = Field(description="By which the body turns; below zero: the other way round.", examples=[30])


class LegModel(Mapping):
    """One leg of a body's way: a travel, a turn, or both together, which is a screw."""

    model_config = ConfigDict(json_schema_extra=either("travel", "turn"))

    travel: Direction | None = Field(
        None, description="How far it goes, [x, y, z] in the cage's frame.", examples=[[-25, 0, 0]]
    )
    turn: TurnModel | None = Field(
        None,
        description="How it turns; beside a travel, about its line.",
        examples=[{"about": [0, 0, 1], "angle_deg": 30}],
    )

    @model_validator(mode="after")
    def _some_way(self) -> LegModel:
        if self.travel is None and self.turn is None:
            raise wrong("has neither travel nor turn; give one of them, or both")
        return self


def _legs_form(value: object) -> str | None:
    """Which of the two ways to give the legs of a body this is."""
    if isinstance(value, list):
        return None if value and all(isinstance(item, (int, float)) for item in value) else "list"
    return "one" if isinstance(value, dict) else None


Legs = Annotated[
    Annotated[LegModel, Tag("one")]
    | Annotated[list[LegModel], Field(min_length=1, title="Legs, one after the other"), Tag("list")],
    Discriminator(_legs_form),
]

Drives = Annotated[dict[Name, Legs], Field(min_length=1)]


class PressSpringModel(Mapping):
    """A spring that presses."""

    stiffness: Positive = Field(
        description="Newtons for each unit of length of the file (N/mm with mm).", examples=[0.5]
    )
    preload: Number = Field(
        description="How hard it presses where the body stands in the scene, newtons.", examples=[8]
    )


class PressModel(Mapping):
    """What pushes a body along a direction, the only one in which it can move: a force, or a spring."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [key]} for key in ("force", "spring")]})

    along: Direction = Field(description="In which it is pushed, [x, y, z] in the cage's frame; any length.")
    force: Positive | None = Field(None, description="How hard, newtons.", examples=[12])
    spring: PressSpringModel | None = Field(
        None, description="Instead of force: a spring.", examples=[{"stiffness": 0.5, "preload": 8}]
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> PressModel:
        if self.force is None and self.spring is None:
            raise wrong("has neither force nor spring; give one of them")
        if self.force is not None and self.spring is not None:
            raise wrong("has both force and spring; give one of them")
        return self


Presses = Annotated[dict[Name, PressModel], Field(min_length=1)]


class StopModel(Mapping):
    """At which force or moment of the drive it stops."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [key]} for key in ("force", "moment")]})

    force: Positive | None = Field(None, description="Newtons along the travel.", examples=[200])
    moment: Positive | None = Field(
        None,
        description="About the axis, where all legs are turns alone: newtons times the file's unit of length (N mm with"
        " mm).",
        examples=[500],
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> StopModel:
        if self.force is None and self.moment is None:
            raise wrong("has neither force nor moment; give one of them")
        if self.force is not None and self.moment is not None:
            raise wrong("has both force and moment; give one of them")
        return self
