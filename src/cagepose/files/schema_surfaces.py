"""What triangles of facets stand for, in a scene file: planes, cylinders, cones, spheres and tori."""

from __future__ import annotations

from pydantic import ConfigDict, Field, model_validator

from cagepose.files.schema_base import Direction, Mapping, Number, Positive, Vector, wrong


class PlaneModel(Mapping):
    """A plane that triangles stand for."""

    point: Vector = Field(description="A point of it.", examples=[[0, 0, 5]])
    normal: Direction = Field(description="Unit vector out of the body.", examples=[[0, 0, 1]])


class CylinderSurfaceModel(Mapping):
    """The round side of a cylinder that triangles stand for."""

    point: Vector = Field(description="A point of its axis.", examples=[[0, 0, 0]])
    axis: Direction = Field(description="Unit vector along its axis.", examples=[[0, 0, 1]])
    radius: Positive = Field(description="Radius.", examples=[3])
    hollow: bool = Field(False, description="Whether it is the wall of a hole.", examples=[True])


class ConeSurfaceModel(CylinderSurfaceModel):
    """The side of a cone that triangles stand for; its radius is that at its point."""

    slope: Number = Field(description="By how much the radius grows for each length along the axis.", examples=[-0.5])


class SphereSurfaceModel(Mapping):
    """A ball that triangles stand for."""

    center: Vector = Field(description="Its centre.", examples=[[0, 0, 0]])
    radius: Positive = Field(description="Radius.", examples=[3])
    hollow: bool = Field(False, description="Whether the body is outside of it.", examples=[True])


class TorusSurfaceModel(Mapping):
    """A torus that triangles stand for, as the rounded rim of a rod."""

    center: Vector = Field(description="Its centre.", examples=[[0, 0, 0]])
    axis: Direction = Field(description="Unit vector along its axis.", examples=[[0, 0, 1]])
    radius: Positive = Field(description="Radius of the circle in the middle of its tube.", examples=[3])
    tube: Positive = Field(description="Radius of its tube.", examples=[1])
    hollow: bool = Field(False, description="Whether the body is outside of its tube.", examples=[True])


SURFACES = ("plane", "cylinder", "cone", "sphere", "torus")
"""Keys that say what a surface is."""


class SurfaceModel(Mapping):
    """One surface."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [kind]} for kind in SURFACES]})

    plane: PlaneModel | None = Field(None, description="A plane.")
    cylinder: CylinderSurfaceModel | None = Field(None, description="The round side of a cylinder.")
    cone: ConeSurfaceModel | None = Field(None, description="The side of a cone.")
    sphere: SphereSurfaceModel | None = Field(None, description="A ball.")
    torus: TorusSurfaceModel | None = Field(None, description="A torus.")

    @model_validator(mode="after")
    def _one(self) -> SurfaceModel:
        found = [kind for kind in SURFACES if getattr(self, kind) is not None]
        if len(found) != 1:
            raise wrong(f"has {' and '.join(found) or 'no surface'}; give one of: {', '.join(SURFACES)}")
        return self
