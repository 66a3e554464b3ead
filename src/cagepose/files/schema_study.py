"""The study file's shape: strict pydantic models, as for scene files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, ConfigDict, Field, StringConstraints, model_validator

from cagepose.files.schema_base import Mapping, Number, Positive, Vector, wrong

MOST_RUNS = 2**30
"""As many points as SciPy's Sobol sequence has."""
Question = Literal["friction", "margin", "jam", "play"]
"""What can be asked of each run."""
DISTRIBUTIONS = ("uniform", "normal", "triangular", "grid", "steps")
WATCHED = ("point", "gap", "angle", "distance")
Pair = Annotated[list[str], Field(min_length=2, max_length=2)]
"""A name of the cage, and one of the object."""


def _ordered(limits: list[float]) -> list[float]:
    if limits[0] == limits[-1]:
        raise wrong(f"is {limits}, which does not vary; give two different numbers, or leave this key out")
    if sorted(limits) != limits:
        raise wrong(f"is {limits}; give the lower number first")
    return limits


def _distinct(values: list[float]) -> list[float]:
    if len(set(values)) != len(values):
        raise wrong("holds a number twice; give each once")
    return values


def _asked_once(questions: list[Question]) -> list[Question]:
    if len(set(questions)) != len(questions):
        raise wrong("holds a question twice; ask each once")
    return questions


class NormalModel(Mapping):
    """A normal distribution."""

    sigma: Positive = Field(description="Standard deviation.", examples=[0.02])
    mean: Number | None = Field(None, description="Left out: the number that stands in the scene.")
    cut: Annotated[float, Field(gt=0.0, le=8.0)] | None = Field(
        None, description="How many sigmas from the mean no value lies beyond; left out: none.", examples=[3]
    )


class StepsModel(Mapping):
    """Values in equal steps."""

    first: Number = Field(description="The first value.", examples=[-0.5])
    last: Number = Field(description="The last value.", examples=[0.5])
    count: Annotated[int, Field(ge=2, le=100_000)] = Field(description="How many, both included.", examples=[21])

    @model_validator(mode="after")
    def _first_below_last(self) -> StepsModel:
        if self.first == self.last:
            raise wrong(f"run from {self.first!r} to {self.last!r}; give two different numbers, or leave this key out")
        if self.first > self.last:
            raise wrong(f"run from {self.first!r} to {self.last!r}; give the lower number first")
        return self


class DistributionModel(Mapping):
    """How one number varies: one of these keys."""

    uniform: Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_ordered)] | None = Field(
        None, description="All values between two are equally likely.", examples=[[-0.5, 0.5]]
    )
    normal: NormalModel | None = Field(None, description="A normal distribution.", examples=[{"sigma": 0.02}])
    triangular: Annotated[list[Number], Field(min_length=3, max_length=3), AfterValidator(_ordered)] | None = Field(
        None, description="Least, most likely and greatest value.", examples=[[0.05, 0.1, 0.2]]
    )
    grid: Annotated[list[Number], Field(min_length=1), AfterValidator(_distinct)] | None = Field(
        None,
        description="These values, equally likely; or each of them, where the sample is a grid.",
        examples=[[0.2, 0.5]],
    )
    steps: StepsModel | None = Field(
        None,
        description="As grid, with values in equal steps.",
        examples=[{"first": -0.5, "last": 0.5, "count": 21}],
    )

    @model_validator(mode="after")
    def _one(self) -> DistributionModel:
        given = [kind for kind in DISTRIBUTIONS if getattr(self, kind) is not None]
        if len(given) != 1:
            found = f"has both {given[0]} and {given[1]}" if given else "says nothing"
            raise wrong(f"{found}; give one of: {', '.join(DISTRIBUTIONS)}")
        return self

    @property
    def kind(self) -> str:
        return next(kind for kind in DISTRIBUTIONS if getattr(self, kind) is not None)

    @property
    def middle(self) -> float | None:
        """What stands for the nominal value where the scene has none; None: this does not say."""
        if self.normal is not None:
            return self.normal.mean
        if self.steps is not None:
            return (self.steps.first + self.steps.last) / 2.0
        if self.uniform is not None:
            return sum(self.uniform) / 2.0
        values = self.triangular or self.grid or []
        return values[len(values) // 2]


class SampleModel(Mapping):
    """Which values are run."""

    method: Literal["sobol", "latin hypercube", "random", "grid"] = Field(
        "sobol", description="How values are drawn; grid: every combination of the values of all.", examples=["sobol"]
    )
    runs: Annotated[int, Field(ge=1, le=MOST_RUNS)] | None = Field(
        None,
        description="How many runs; left out for a grid alone, which has as many as it has combinations.",
        examples=[10_000],
    )
    seed: Annotated[int, Field(ge=0, le=2**63)] = Field(1, description="Another seed draws other values.")


class WatchModel(Mapping):
    """What is followed: one of these keys."""

    point: Vector | None = Field(
        None, description="A point, in the object's frame and the scene's unit.", examples=[[600, 0, 0]]
    )
    of: Literal["object"] | None = Field(None, description="What the point is fixed to; left out: the object.")
    gap: Pair | None = Field(
        None,
        description="How far a point, a shape, a hole or a body of the cage and a part of the object, or all of the"
        " object, are apart; 0 where they touch.",
        examples=[["left", "board"]],
    )
    angle: Pair | None = Field(
        None,
        description="The angle, up to 90 degrees, between an axis of the cage and one of the object: of round shapes by"
        " their names, of others with .x, .y or .z; the world's and the object's own are world.z and object.z.",
        examples=[["bore", "pin"]],
    )
    distance: Pair | None = Field(
        None,
        description="How far the places of a point or a shape of the cage and of a part of the object, or a watched"
        " point, are apart; with .x, .y or .z behind one of them, how far the other is from that axis.",
        examples=[["bore.z", "tip"]],
    )

    @model_validator(mode="after")
    def _one(self) -> WatchModel:
        given = [kind for kind in WATCHED if getattr(self, kind) is not None]
        if len(given) != 1:
            found = f"has both {given[0]} and {given[1]}" if given else "says nothing"
            raise wrong(f"{found}; give one of: {', '.join(WATCHED)}")
        if self.of is not None and self.point is None:
            raise wrong("says of what it is, which a point alone does; leave of out")
        return self

    @property
    def kind(self) -> str:
        return next(kind for kind in WATCHED if getattr(self, kind) is not None)

    @property
    def pair(self) -> list[str]:
        """The two names; of a point there are none."""
        return self.gap or self.angle or self.distance or []


class MapModel(Mapping):
    """A capture map: two of the varied numbers, the others as in the scene; or three, of which the third takes a few
    values.
    """

    over: Annotated[list[str], Field(min_length=2, max_length=3)] = Field(
        description="Two keys of vary, or three: a map for each of a few values of the third.",
        examples=[["parameters.pitch", "parameters.yaw"]],
    )
    count: Annotated[int, Field(ge=2, le=1000)] = Field(60, description="Cells along each of the two.")


def _column(name: str) -> str:
    if not name.isidentifier() or name == "position":
        raise wrong("is no name of columns; use letters, digits and _, a letter first, and another than position")
    return name


ColumnName = Annotated[str, StringConstraints(max_length=100), AfterValidator(_column)]


class RunsModel(Mapping):
    """What studies and designs have in common: a scene, what varies in it, and which runs are good."""

    scene: Annotated[str, StringConstraints(min_length=1)] = Field(
        description="The scene's file, beside this one.", examples=["scene.yaml"]
    )
    vary: dict[str, DistributionModel] = Field(
        min_length=1,
        description="Numbers of the scene by their keys; * stands for all in a list or mapping, each on its own.",
        examples=[{"parameters.play": {"uniform": [0.2, 1.0]}}],
    )
    watch: dict[ColumnName, WatchModel] | None = Field(
        None,
        description="Points whose final places become columns, and gaps, angles and distances at the end that do.",
        examples=[{"tip": {"point": [600, 0, 0]}}],
    )
    ask: Annotated[list[Question], Field(min_length=1), AfterValidator(_asked_once)] | None = Field(
        None,
        description="Questions whose answers become columns, as of cagepose ask friction, run --margin, ask jam and"
        " play; each row's scene is built and run by itself.",
        examples=[["friction", "margin"]],
    )
    compute: dict[ColumnName, str] | None = Field(
        None,
        description="More columns, each an expression of others and of those before it: varied numbers, the final pose,"
        " watched points, forces, answers; with sqrt, hypot, sin, cos, tan, asin, acos, atan, atan2 (radians), degrees,"
        " radians.",
        examples=[{"phi": "degrees(atan2(position_x, position_y))"}],
    )
    accept: str | None = Field(
        None,
        description="Which runs are good: an expression of the columns; left out: those that end at rest.",
        examples=["verdict == 'rests' and abs(pitch_deg) < 0.05"],
    )


class StudyModel(RunsModel):
    """Many runs of one scene, and what is asked of them."""

    model_config = ConfigDict(title="cagepose study")

    sample: SampleModel = Field(description="Which values are run.", examples=[{"runs": 10_000}])
    forces: bool | None = Field(
        None, description="Whether each row holds the contact forces, which takes one run at a time; left out: no."
    )
    sensitivities: bool | None = Field(
        None,
        description="Whether the report says which number matters, by Sobol indices from some thousand runs of its own;"
        " left out: no.",
    )
    map: MapModel | None = Field(None, description="The capture map, from runs of its own; left out: none.")


def _apart(ends: list[float]) -> list[float]:
    if ends[0] == ends[1]:
        raise wrong(f"is {ends}; give two different numbers, the tight end first")
    return ends


class WishModel(Mapping):
    """What a design must reach: one of these keys."""

    share: Annotated[float, Field(gt=0.0, le=1.0)] | None = Field(
        None, alias="yield", description="At least this share of the runs is good.", examples=[0.997]
    )
    capture: Annotated[dict[str, Positive], Field(min_length=1, max_length=1)] | None = Field(
        None,
        description="A varied number, and how wide the range about its nominal value is, at least, in which all runs"
        " are good; all others are nominal.",
        examples=[{"parameters.pitch": 0.5}],
    )

    @model_validator(mode="after")
    def _one(self) -> WishModel:
        if (self.share is None) == (self.capture is None):
            found = "says nothing" if self.share is None else "has both yield and capture"
            raise wrong(f"{found}; give one of: yield, capture")
        return self

    @property
    def at_least(self) -> float:
        """The share, or the width."""
        return self.share if self.share is not None else next(iter((self.capture or {}).values()))


class DesignModel(RunsModel):
    """The loosest value of one number that keeps a wish."""

    model_config = ConfigDict(title="cagepose design")

    change: Annotated[
        dict[str, Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_apart)]],
        Field(min_length=1, max_length=1),
    ] = Field(
        description="The number that is to be chosen, and between which two values: the tight end first.",
        examples=[{"parameters.play": [0.1, 2.0]}],
    )
    wish: WishModel = Field(description="What must be reached.", examples=[{"yield": 0.997}])
    sample: SampleModel | None = Field(
        None, description="Which values are run for a yield; a capture range needs none.", examples=[{"runs": 4096}]
    )
