"""The loads of a checked scene file: forces, moments, springs, drives and presses."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

from cagepose.errors import Key, Problem, SceneError
from cagepose.files.measures import made
from cagepose.files.schema import LoadModel
from cagepose.files.schema_driven import LegModel, Legs, PressModel, StopModel
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.drive import Drive
from cagepose.model.load import Force, Load, Moment
from cagepose.model.press import Press
from cagepose.model.spring import Spring

Given = TypeVar("Given")
Noun = TypeVar("Noun")

KEYS_OF_TURN: dict[Key, tuple[Key, ...]] = {
    "about": ("turn", "about"),
    "through": ("turn", "through"),
    "angle": ("turn", "angle_deg"),
}
"""Where a file holds what a `Drive` takes."""


def load_of(model: LoadModel, unit: LengthUnit) -> Load:
    """Return a load whose file has lengths in ``unit``.

    Raises
    ------
    SceneError
        All that is wrong with it, with paths from the load.
    """
    parts = _Parts(unit)
    force = None if model.force is None else parts.make(("force",), partial(made, Force), model.force)
    forces = parts.listed("forces", partial(made, Force), model.forces or [])
    moments = parts.listed("moments", partial(made, Moment), model.moments or [])
    springs = parts.listed("springs", partial(made, Spring), model.springs or [])
    drive = {
        name: [one for place, leg in _placed(legs) if (one := parts.make(("drive", name, *place), _leg, leg))]
        for name, legs in (model.drive or {}).items()
    }
    presses = {name: parts.make(("press", name), _press, press) for name, press in (model.press or {}).items()}
    if parts.problems:
        raise SceneError(parts.problems)
    load = Load(
        model.name,
        gravity=model.gravity,
        force=force,
        forces=forces,
        moments=moments,
        springs=springs,
        drive=drive,
        stop_at=None if model.stop_at is None else _limit(model.stop_at, unit),
        press={name: press for name, press in presses.items() if press},
    )
    if model.stop_at is not None:
        _check_kind_of_limit(model.stop_at, load)
    return load


class _Parts:
    """Makes the parts of a load, and collects what is wrong with each of them."""

    def __init__(self, unit: LengthUnit) -> None:
        self.unit = unit
        self.problems: list[Problem] = []

    def make(self, place: tuple[Key, ...], maker: Callable[[Given, LengthUnit], Noun], model: Given) -> Noun | None:
        try:
            return maker(model, self.unit)
        except SceneError as error:
            self.problems += error.under(*place).problems
            return None

    def listed(self, key: str, maker: Callable[[Given, LengthUnit], Noun], models: Sequence[Given]) -> list[Noun]:
        made = [self.make((key, number), maker, model) for number, model in enumerate(models)]
        return [one for one in made if one is not None]


def _placed(legs: Legs) -> list[tuple[tuple[Key, ...], LegModel]]:
    """Return the legs of a body, each with its place among them."""
    return [((), legs)] if isinstance(legs, LegModel) else [((index,), leg) for index, leg in enumerate(legs)]


def _leg(model: LegModel, unit: LengthUnit) -> Drive:
    travel, turn = None if model.travel is None else to_metres(model.travel, unit), model.turn
    if turn is None:
        return Drive(travel)
    through = None if turn.through is None else to_metres(turn.through, unit)
    try:
        return Drive(travel, turn.about, through, math.radians(turn.angle_deg))
    except SceneError as error:
        places = [(KEYS_OF_TURN.get(problem.path[0], problem.path), problem.message) for problem in error.problems]
        raise SceneError([Problem(path, message) for path, message in places]) from None


def _press(model: PressModel, unit: LengthUnit) -> Press:
    if model.spring is None:
        assert model.force is not None  # the schema asks for one of the two
        return Press(model.along, model.force)
    return Press(model.along, model.spring.preload, model.spring.stiffness / float(to_metres(1.0, unit)))


def _limit(model: StopModel, unit: LengthUnit) -> float | None:
    return float(to_metres(model.moment, unit)) if model.moment is not None else model.force


def _check_kind_of_limit(model: StopModel, load: Load) -> None:
    if load.stops_at_moment and model.force is not None:
        message = "is a force, and the drive turns alone, which takes a moment; give moment instead"
        raise SceneError([Problem(("stop_at", "force"), message)])
    if not load.stops_at_moment and model.moment is not None:
        message = "is a moment, and the drive travels, which takes a force along it; give force instead"
        raise SceneError([Problem(("stop_at", "moment"), message)])
