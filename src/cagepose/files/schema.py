"""The scene file's shape: strict pydantic models, one class for each mapping of the file.

Strict: ``true`` is not a number, ``"10"`` is not a number, unknown keys are errors. What a scene *means* (points
outside the object, names used once, ...) is checked where the model is made, not here.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    WithJsonSchema,
    model_validator,
)

from cagepose.files.parameters import parameter_name_message
from cagepose.files.schema_base import (
    Direction,
    Mapping,
    Name,
    NotNegative,
    Number,
    PoseModel,
    Positive,
    Size,
    Vector,
    json_schema,
    wrong,
)
from cagepose.files.schema_cage import POINTS, CageModel
from cagepose.files.schema_driven import Drives, Presses, StopModel
from cagepose.files.schema_shapes import CoefficientModel, Shapes, either
from cagepose.files.units import LengthUnit
from cagepose.model.methods import DEFAULT_METHOD, DEFAULT_METRIC, METHODS, NO_SLIP_ANGLE_DEFAULT_RAD, Metric
from cagepose.model.planar import Planar
from cagepose.model.tolerances import TOUCH_DEFAULT, TOUCH_GREATEST, TOUCH_LEAST

_BOX = {"size": [10, 20, 30], "position": [0, 0, 0]}


def _known_method(name: str) -> str:
    if name not in METHODS:
        raise wrong(f"is {name!r}; use one of: {', '.join(METHODS)}")
    return name


def _ordered(limits: list[float]) -> list[float]:
    if limits[0] >= limits[1]:
        raise wrong(f"runs from {limits[0]!r} to {limits[1]!r}; give the lower number first")
    return limits


Method = Annotated[str, AfterValidator(_known_method), WithJsonSchema({"type": "string", "enum": list(METHODS)})]


class UnitsModel(Mapping):
    """Units of the file. Angles are always degrees, masses kilograms, forces newtons; moments and stiffnesses have the
    file's unit of length.
    """

    length: LengthUnit = Field("mm", description="Unit of every length in this file.")


class BoxModel(Mapping):
    """One rectangular block of the object."""

    size: Size = Field(description="Full edge lengths [x, y, z].", examples=[[10, 20, 30]])
    position: Vector | None = Field(
        None, description="Centre of the box in the object's frame; left out: its origin.", examples=[[0, 0, 0]]
    )
    euler_zyx_deg: Vector | None = Field(
        None, description="How the box is turned in the object: yaw, pitch, roll in degrees.", examples=[[45, 0, 0]]
    )
    name: Name | None = Field(None, description="Shown with contacts; left out: box1, box2, ...", examples=["flange"])


class ObjectModel(Mapping):
    """The part that is held: a union of boxes and other shapes that move as one."""

    model_config = ConfigDict(json_schema_extra=either("boxes", "shapes"))

    boxes: Annotated[list[BoxModel], Field(min_length=1)] | None = Field(
        None, description="The part's blocks.", examples=[[_BOX]]
    )
    shapes: Shapes | None = Field(
        None,
        description="The part's shapes, in its frame; boxes among them are like those of boxes.",
        examples=[[{"cylinder": {"radius": 5, "length": 20}, "position": [0, 0, 0]}]],
    )
    center_of_gravity: Vector | None = Field(
        None, description="In the object's frame; left out: the centroid of the union's volume.", examples=[[0, 0, 0]]
    )
    mass: Positive | None = Field(
        None,
        description="Kilograms; left out: forces are per unit load, and the weight is negligible beside a force.",
        examples=[0.5],
    )
    inertia: Annotated[list[Vector], Field(min_length=3, max_length=3)] | None = Field(
        None,
        description="3 x 3 matrix about the centre of gravity, in the object's axes, kilograms by length unit squared;"
        " only together with mass; left out: uniform density of the union.",
        examples=[[[100, 0, 0], [0, 100, 0], [0, 0, 100]]],
    )
    pose: PoseModel | None = Field(None, description="Where the object starts: its origin in the world.")


class ForceModel(Mapping):
    """A push at one point, which rides on the object or stays in the world."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["at"]}, {"required": ["at_world"]}]})

    direction: Direction = Field(
        description="Its direction, any length: in the world, or in the object's frame if the force follows.",
        examples=[[1, 0, 0]],
    )
    at: Vector | None = Field(
        None,
        description="The point where it acts, in the object's frame: it moves with the object.",
        examples=[[0, 0, 0]],
    )
    at_world: Vector | None = Field(
        None,
        description="Instead of at: a point of the world, where the force acts wherever the object is (quasistatic).",
        examples=[[0, 0, 50]],
    )
    magnitude: Positive | None = Field(
        None,
        description="Newtons; may be left out if only gravity acts beside it: one unit of force.",
        examples=[10],
    )
    follows: bool | None = Field(
        None, description="Whether it turns with the object; left out: its direction stays fixed in the world."
    )

    @model_validator(mode="after")
    def _one_point(self) -> ForceModel:
        if (self.at is None) == (self.at_world is None):
            wrong_ = "has neither at nor at_world" if self.at is None else "has both at and at_world"
            raise wrong(f"{wrong_}; give one of them: at rides on the object, at_world stays in the world")
        return self


class MomentModel(Mapping):
    """A pure moment, the same about every point."""

    direction: Direction = Field(
        description="Its axis, right-handed, any length: in the world, or in the object's frame where it follows.",
        examples=[[0, 0, 1]],
    )
    magnitude: Positive = Field(description="Newtons times the file's unit of length (N mm with mm).", examples=[50])
    follows: bool | None = Field(
        None, description="Whether its axis turns with the object; left out: it stays fixed in the world."
    )


class SpringModel(Mapping):
    """A straight spring from a point of the object to a point of the world, or of a body of the cage. Its tension along
    the line is the preload plus the stiffness times what it is longer than at the start poses.
    """

    at: Vector = Field(description="Its end on the object, in the object's frame.", examples=[[0, 0, 0]])
    to: Vector = Field(
        description="Its other end, in the world, or in the frame of the body that of names.",
        examples=[[0, 0, 50]],
    )
    of: Name | None = Field(
        None, description="The body of the cage that its other end moves with; left out: the world.", examples=["mate"]
    )
    stiffness: NotNegative = Field(
        description="Newtons for each unit of length of the file (N/mm with mm); 0: the tension is the preload.",
        examples=[0.5],
    )
    preload: Number | None = Field(
        None,
        description="Its tension at the object's start pose, newtons; below zero it pushes; left out: 0.",
        examples=[2],
    )


class LoadModel(Mapping):
    """One phase of the run: all that acts together. A phase without gravity has none."""

    name: Name = Field(description="Shown with the phase's events.", examples=["gravity"])
    gravity: Direction | None = Field(
        None, description="Direction; its length (m/s^2) counts only together with a mass.", examples=[[0, 0, -1]]
    )
    force: ForceModel | None = Field(None, description="A push at one point of the object.")
    forces: Annotated[list[ForceModel], Field(min_length=1)] | None = Field(
        None,
        description="Instead of force: several pushes.",
        examples=[[{"direction": [1, 0, 0], "at": [0, 0, 0], "magnitude": 10}]],
    )
    moments: Annotated[list[MomentModel], Field(min_length=1)] | None = Field(
        None, description="Pure moments.", examples=[[{"direction": [0, 0, 1], "magnitude": 50}]]
    )
    springs: Annotated[list[SpringModel], Field(min_length=1)] | None = Field(
        None, description="Springs.", examples=[[{"at": [0, 0, 0], "to": [0, 0, 50], "stiffness": 0.5}]]
    )
    drive: Drives | None = Field(
        None,
        description="BODY: its motion (quasistatic): a travel, a turn, both, or a list of these, one after the other."
        " All bodies move together, and stay where they were driven.",
        examples=[{"mate": {"travel": [-25, 0, 0]}}],
    )
    stop_at: StopModel | None = Field(
        None, description="Force or moment at which the drive stops; left out: no limit.", examples=[{"force": 200}]
    )
    press: Presses | None = Field(
        None,
        description="BODY: how it presses (quasistatic): with a force or a spring, along a direction. It moves until"
        " everything is at rest; a drive may go on at the same time.",
        examples=[{"pad": {"force": 12, "along": [1, 0, 0]}}],
    )


class FrictionModel(CoefficientModel):
    """Friction of all contacts, or of single points and shapes."""

    of: dict[Name, NotNegative] | None = Field(
        None,
        description="NAME: coefficient, of single cage points, boxes and other shapes (quasistatic). The"
        " cage's part counts, else the object's part, else the coefficient of all.",
        examples=[{"C1": 0}],
    )


class TolerancesModel(Mapping):
    """What counts as touching and as grazing. The defaults suit nearly every scene."""

    touch: Annotated[float, Field(ge=TOUCH_LEAST, le=TOUCH_GREATEST)] | None = Field(
        None, description=f"As a fraction of the scene's size; left out: {TOUCH_DEFAULT:g}.", examples=[1e-8]
    )
    grazing_band_deg: Annotated[float, Field(ge=0.0, lt=45.0)] | None = Field(
        None,
        description="Degrees beyond a right angle to the load up to which a face still slips (stepwise); left out: 1.",
        examples=[1],
    )


class AdjustableModel(Mapping):
    """A number of this file that sliders and studies may vary."""

    key: str = Field(min_length=1, description="Where the number stands.", examples=["cage.pose.euler_zyx_deg[1]"])
    range: Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_ordered)] = Field(
        description="Lowest and highest value.", examples=[[-0.3, 0.3]]
    )


def _usable(name: str) -> str:
    if message := parameter_name_message(name):
        raise wrong(message)
    return name


class SceneModel(Mapping):
    """A part, the cage that holds it, and the loads that act on it one after the other."""

    model_config = ConfigDict(title="cagepose scene")

    name: Name = Field(description="The scene's name.", examples=["bracket"])
    units: UnitsModel | None = Field(None, description="Units of the file; left out: millimetres.")
    parameters: dict[Annotated[Name, AfterValidator(_usable)], Number] | None = Field(
        None,
        description="Named numbers. Wherever a number may stand, so may text that begins with = and says what it comes"
        " to, such as '=10 + play/2'; a parameter may use those above it.",
        examples=[{"play": 0.5}],
    )
    object: ObjectModel = Field(description="The part that is held.", examples=[{"boxes": [_BOX]}])
    cage: CageModel = Field(description="What holds it.", examples=[{"points": POINTS}])
    loads: list[LoadModel] = Field(
        min_length=1, description="Phases, run in order.", examples=[[{"name": "gravity", "gravity": [0, 0, -1]}]]
    )
    friction: FrictionModel | None = Field(
        None, description=f"Left out: none for quasistatic, an angle of {NO_SLIP_ANGLE_DEFAULT_RAD:g} rad for stepwise."
    )
    method: Method | None = Field(None, description=f"How to run the scene; left out: {DEFAULT_METHOD}.")
    metric: Metric | None = Field(
        None,
        description="What decides how the object starts to move (quasistatic): its inertia (release), or the same"
        f" resistance in all directions (drag); left out: {DEFAULT_METRIC}.",
    )
    planar: Planar | None = Field(
        None,
        description="The plane of the world that the object moves in (quasistatic): it travels along these two axes and"
        " turns about the third one; left out: it has all six freedoms.",
    )
    tolerances: TolerancesModel | None = Field(None, description="Left out: the defaults.")
    adjustable: dict[Name, AdjustableModel] | None = Field(None, description="Named numbers for sliders and studies.")
    left_out: Annotated[list[Name], Field(min_length=1)] | None = Field(
        None,
        description="Names of parts of the scene's source that the scene lacks; each run warns of them.",
        examples=[["terrain"]],
    )


def scene_json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a scene file: editors check and complete scenes with it."""
    return json_schema(SceneModel)
