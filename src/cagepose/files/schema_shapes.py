"""Shapes in a scene file: one key that says what it is and holds its numbers, and beside it where it is."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from cagepose.files.schema_base import Distance, Mapping, Name, NotNegative, Positive, Size, Vector, wrong
from cagepose.files.schema_surfaces import SurfaceModel
from cagepose.files.units import LengthUnit


def either(*keys: str) -> dict[str, Any]:
    """Return what a JSON Schema says of a mapping that needs at least one of some keys."""
    return {"anyOf": [{"required": [key]} for key in keys]}


class CoefficientModel(Mapping):
    """Coulomb friction."""

    coefficient: NotNegative | None = Field(None, description="Friction force over normal force.", examples=[0.1])
    angle_deg: Annotated[float, Field(ge=0.0, lt=90.0)] | None = Field(
        None, description="The same as an angle: its tangent is the coefficient.", examples=[5.7]
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> CoefficientModel:
        if self.coefficient is not None and self.angle_deg is not None:
            raise wrong("has both of coefficient and angle_deg; give one of them")
        if self.coefficient is None and self.angle_deg is None and getattr(self, "of", None) is None:
            raise wrong("has neither of coefficient and angle_deg; give one of them")
        return self


class BoxSizeModel(Mapping):
    """A rectangular block, its middle at the shape's position."""

    size: Size = Field(description="Full edge lengths [x, y, z].", examples=[[10, 20, 30]])


class SphereModel(Mapping):
    """A ball."""

    radius: Positive = Field(description="Radius.", examples=[3])


class CapsuleModel(Mapping):
    """A round bar with round ends along z, its middle at the shape's position."""

    radius: Positive = Field(description="Radius.", examples=[3])
    length: Positive = Field(description="Between the centres of the two round ends.", examples=[20])


class CylinderModel(Mapping):
    """A round bar with flat ends along z, its middle at the shape's position."""

    radius: Positive = Field(description="Radius.", examples=[3])
    length: Positive = Field(description="From end to end.", examples=[20])


class ConeModel(Mapping):
    """A frustum of a cone with flat ends along z, its middle at the shape's position."""

    radius_bottom: NotNegative = Field(description="Radius at its lower end; 0: a tip.", examples=[5])
    radius_top: NotNegative = Field(description="Radius at its upper end; 0: a tip.", examples=[3])
    length: Positive = Field(description="From end to end.", examples=[20])


class ConvexModel(Mapping):
    """The convex hull of some points, with rounded edges if it has a radius."""

    vertices: Annotated[list[Vector], Field(min_length=1)] = Field(
        description="The points, from the shape's position.",
        examples=[[[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]]],
    )
    radius: NotNegative | None = Field(
        None,
        description="By how much the hull is blown up; left out: sharp edges. With one, a single vertex makes a ball,"
        " two a round bar, those of a polygon a plate with round edges.",
        examples=[1],
    )


class MeshModel(Mapping):
    """A body in a file of its own."""

    file: str = Field(
        min_length=1, description="STEP, STL, OBJ, PLY or GLB file beside this one; closed.", examples=["part.stl"]
    )
    unit: LengthUnit | None = Field(
        None,
        description="Of the file's lengths; left out: that of this scene, and metres of a GLB. STEP files say theirs.",
        examples=["mm"],
    )
    solid: str | None = Field(
        None,
        min_length=1,
        description="Which solid of a STEP file, by its name; left out: all of them as one body.",
        examples=["pin"],
    )
    fillets: bool = Field(
        True,
        description="Whether hollow roundings of a STEP file stay; else walls go on to where they meet.",
        examples=[False],
    )


class FacetsModel(Mapping):
    """A body within a closed surface of triangles, as a mesh is written with its numbers."""

    vertices: str = Field(
        min_length=1,
        description="The corners, from the shape's position: three numbers each, all in one text.",
        examples=["0 0 0, 10 0 0, 0 10 0, 0 0 10"],
    )
    triangles: str = Field(
        min_length=1,
        description="Of each triangle the numbers of three corners, from 0 on, counter-clockwise seen from outside.",
        examples=["0 2 1, 0 1 3, 0 3 2, 1 2 3"],
    )
    flat: Distance | None = Field(
        None,
        description="Corners this near to the plane of a face, or to a surface, lie in it; left out: a"
        " thousand-millionth of the size.",
        examples=[1e-8],
    )
    surfaces: list[SurfaceModel] | None = Field(
        None,
        description="What triangles stand for: there the body is as round as that.",
        examples=[[{"cylinder": {"point": [0, 0, 0], "axis": [0, 0, 1], "radius": 3}}]],
    )
    on: str | None = Field(
        None,
        min_length=1,
        description="Of each triangle the number of its surface, from 0 on; -1: it stands for none.",
        examples=["0 0 -1 -1"],
    )

    @model_validator(mode="after")
    def _both(self) -> FacetsModel:
        if (self.surfaces is None) != (self.on is None):
            raise wrong("has one of surfaces and on alone; give both, or none")
        return self


class DiscModel(Mapping):
    """A flat round disc without thickness, across z."""

    radius: Positive = Field(description="Radius.", examples=[3])


class ChamferModel(Mapping):
    """The cone that widens the mouth of a hole."""

    width: Positive = Field(description="How much wider the radius is at the mouth.", examples=[0.5])
    angle_deg: Annotated[float, Field(gt=0.0, lt=90.0)] = Field(
        description="Between the cone's wall and the hole's axis.", examples=[45]
    )


class HoleModel(Mapping):
    """A round hole along z: its mouth at the shape's position, z pointing out of the part."""

    radius: Positive = Field(description="Radius.", examples=[3])
    depth: Positive = Field(description="From the mouth to the bottom.", examples=[10])
    chamfer: ChamferModel | None = Field(
        None, description="A cone at the mouth; left out: a sharp rim.", examples=[{"width": 0.5, "angle_deg": 45}]
    )
    in_: Annotated[list[Name], Field(min_length=1)] | None = Field(
        None,
        alias="in",
        description="Names of the boxes and shapes of the same body that it is cut out of; left out: it stands alone,"
        " solid all around.",
        examples=[["plate"]],
    )


def _friction_form(value: object) -> str | None:
    """Which of the two ways to give friction this is."""
    if isinstance(value, bool):
        return None
    return "number" if isinstance(value, (int, float)) else "mapping" if isinstance(value, dict) else None


Friction = Annotated[
    Annotated[NotNegative, Tag("number")] | Annotated[CoefficientModel, Tag("mapping")], Discriminator(_friction_form)
]

KINDS = ("box", "sphere", "capsule", "cylinder", "cone", "convex", "mesh", "facets", "disc", "hole")
"""Keys that say what a shape is."""


class ShapeModel(Mapping):
    """One shape."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [kind]} for kind in KINDS]})

    box: BoxSizeModel | None = Field(None, description="A rectangular block.", examples=[{"size": [10, 20, 30]}])
    sphere: SphereModel | None = Field(None, description="A ball.", examples=[{"radius": 3}])
    capsule: CapsuleModel | None = Field(
        None, description="A round bar with round ends.", examples=[{"radius": 3, "length": 20}]
    )
    cylinder: CylinderModel | None = Field(
        None, description="A round bar with flat ends.", examples=[{"radius": 3, "length": 20}]
    )
    cone: ConeModel | None = Field(
        None, description="A frustum of a cone.", examples=[{"radius_bottom": 5, "radius_top": 3, "length": 20}]
    )
    convex: ConvexModel | None = Field(
        None,
        description="The convex hull of some points.",
        examples=[{"vertices": [[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]]}],
    )
    mesh: MeshModel | None = Field(None, description="A mesh.", examples=[{"file": "part.stl"}])
    facets: FacetsModel | None = Field(
        None,
        description="A closed surface of triangles.",
        examples=[{"vertices": "0 0 0, 10 0 0, 0 10 0, 0 0 10", "triangles": "0 2 1, 0 1 3, 0 3 2, 1 2 3"}],
    )
    disc: DiscModel | None = Field(None, description="A flat round disc.", examples=[{"radius": 3}])
    hole: HoleModel | None = Field(None, description="A round hole.", examples=[{"radius": 3, "depth": 10}])
    position: Vector | None = Field(
        None, description="Where it is in its body's frame; left out: at the origin.", examples=[[0, 0, 0]]
    )
    euler_zyx_deg: Vector | None = Field(
        None, description="How it is turned: yaw, pitch, roll in degrees.", examples=[[0, 90, 0]]
    )
    name: Name | None = Field(
        None, description="Shown with contacts; left out: sphere1, sphere2, ...", examples=["pin"]
    )
    friction: Friction | None = Field(
        None,
        description="Its own friction (quasistatic): a coefficient, or coefficient or angle_deg as for the scene; left"
        " out: that of all.",
        examples=[0.2],
    )

    @model_validator(mode="after")
    def _one_kind(self) -> ShapeModel:
        given = self.kinds_given()
        empty = [kind for kind in KINDS if kind in self.model_fields_set and kind not in given]
        if empty:
            raise wrong(f"has an empty {empty[0]}; give its numbers, or remove the key")
        if not given:
            raise wrong(f"does not say which shape it is; add one of: {', '.join(KINDS)}")
        if len(given) > 1:
            raise wrong(f"is {' and '.join(given)} at once; make each a shape of its own")
        return self

    def kinds_given(self) -> list[str]:
        """Return the keys that say what this shape is; of a checked one, there is one."""
        return [kind for kind in KINDS if getattr(self, kind) is not None]


Shapes = Annotated[list[ShapeModel], Field(min_length=1)]
