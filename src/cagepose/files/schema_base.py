"""What all models of a scene or study file share: strict mappings, the numbers and names in them, and their schema."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints, model_validator
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import PydanticCustomError

LARGEST_NUMBER = 1e12
"""Greatest number in a scene file. The fifth power of a length (a moment of inertia) must stay a finite double."""
SMALLEST_NUMBER = 1e-12
"""Least size, mass and magnitude, for the same reason."""


def wrong(message: str) -> PydanticCustomError:
    return PydanticCustomError("cagepose", "{message}", {"message": message})


def _not_zero(values: list[float]) -> list[float]:
    if not any(values):
        raise wrong("is all zeros, which points nowhere; give at least one number other than 0")
    return values


def _not_tiny(value: float) -> float:
    if value < SMALLEST_NUMBER:
        raise wrong(f"is {value:g}; give a number of at least {SMALLEST_NUMBER:g}, or another unit")
    return value


def _printable(text: str) -> str:
    if not text.isprintable() or not text.strip():
        raise wrong(f"is {text!r}; give a name of visible characters")
    return text


Number = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER)]
Positive = Annotated[float, Field(gt=0.0, le=LARGEST_NUMBER), AfterValidator(_not_tiny)]
Distance = Annotated[float, Field(gt=0.0, le=LARGEST_NUMBER)]
"""How near is near, which may be far less than any size."""
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST_NUMBER)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Direction = Annotated[Vector, AfterValidator(_not_zero)]
Size = Annotated[list[Positive], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[Number], Field(min_length=4, max_length=4), AfterValidator(_not_zero)]
Name = Annotated[str, StringConstraints(min_length=1, max_length=100), AfterValidator(_printable)]


class Mapping(BaseModel):
    """Keys with values: no key more, no text for a number."""

    # Models are built when they are first asked for: those that are parts of another only there, and not twice.
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)


class PoseModel(Mapping):
    """Where something is and how it is turned. What is left out is zero."""

    position: Vector | None = Field(None, description="Origin [x, y, z].", examples=[[2, 4, 10]])
    euler_zyx_deg: Vector | None = Field(
        None, description="Yaw about z, then pitch about y, then roll about x, in degrees.", examples=[[0, 0.1, 0]]
    )
    quat_wxyz: Quaternion | None = Field(
        None,
        description="Instead of euler_zyx_deg: a quaternion, scalar first.",
        examples=[[1, 0, 0, 0]],
    )

    @model_validator(mode="after")
    def _one_orientation(self) -> PoseModel:
        if self.euler_zyx_deg is not None and self.quat_wxyz is not None:
            raise wrong("has both euler_zyx_deg and quat_wxyz; keep one of them")
        return self


def json_schema(model: type[BaseModel]) -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a file."""
    schema = model.model_json_schema(schema_generator=_InOurOrder)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


class _InOurOrder(GenerateJsonSchema):
    """Keys stay in the order of the classes; the examples read as people write them."""

    def sort(self, value: JsonSchemaValue, parent_key: str | None = None) -> JsonSchemaValue:  # noqa: ARG002 (pydantic's signature)
        return value
