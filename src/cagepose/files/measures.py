"""The one rule between mappings of a scene file and what they make: `made`, and back, `Measures.of`.

A key is the name of the constructor's argument without its unit, which says how the number is meant: ``radius_m``
stands under ``radius`` in the file's unit of length, ``angle_rad`` under ``angle_deg``, ``magnitude_nm`` in newtons
times that length. So a number that is added to a shape or to a load is written twice: in its class, and with what it
means to people in the schema of scene files.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple, TypeVar, cast, get_args

import numpy as np
from pydantic import BaseModel

from cagepose.files.attributes import Attribute, attributes_of, parted
from cagepose.files.units import METRES_OF, LengthUnit, to_metres

Kind = TypeVar("Kind")

FEWEST_DIGITS, MOST_DIGITS = 6, 17
"""A number is written with so many digits; 17 tell any two doubles apart."""
BESIDE = {"pose_body_shape", "pose_object_box", "name"}
"""Arguments of shapes that stand beside their numbers."""


class _Key(NamedTuple):
    """Where a file holds what an argument takes."""

    key: str
    ending: str
    attribute: Attribute


@cache
def _keys(kind: type) -> tuple[_Key, ...]:
    return tuple(_key(attribute) for attribute in attributes_of(kind) if attribute.argument not in BESIDE)


def _key(attribute: Attribute) -> _Key:
    key, ending = parted(attribute.argument)
    return _Key(f"{key}_deg" if ending == "_rad" else key, ending, attribute)


def made(kind: type[Kind], model: BaseModel, unit: LengthUnit, **beside: Any) -> Kind:
    """Return what a mapping of a scene file makes, its lengths in ``unit``; ``beside``: what else its class takes.

    Raises
    ------
    SceneError
        As its class.
    """
    given = dict[str, Any]()
    plain_kind: type = kind  # mypy thinks that a type[Kind] cannot be hashed
    for key, ending, attribute in _keys(plain_kind):
        value = getattr(model, key, None)
        if isinstance(value, BaseModel):
            given[attribute.argument] = made(_class_of(attribute), value, unit)
        elif value is not None:
            given[attribute.argument] = _from_file(value, ending, unit)
    return kind(**given, **beside)


def _class_of(attribute: Attribute) -> type:
    """Return the class of what is that, or nothing."""
    found: type = next(part for part in (attribute.kind, *get_args(attribute.kind)) if isinstance(part, type))
    return found


def _from_file(value: Any, ending: str, unit: LengthUnit) -> Any:
    if ending in ("_m", "_nm"):
        metres = to_metres(value, unit)
        return metres if isinstance(value, list) else float(metres)
    if ending == "_n_per_m":
        return value / float(to_metres(1.0, unit))
    return math.radians(value) if ending == "_rad" else value


class Measures:
    """Writes numbers for a scene file whose lengths have a unit, each with the fewest digits that are read as the same
    number.
    """

    def __init__(self, unit: LengthUnit) -> None:
        self.ratio = METRES_OF[unit]  # by which lengths of a scene are divided one by one, without NumPy
        self.metres = float(to_metres(1.0, unit))

    def of(self, thing: object) -> dict[str, Any]:
        """Return the mapping that `made` makes the same thing of; what is nothing, false or empty is left out."""
        found, kind = dict[str, Any](), cast("type", type(thing))
        for key, ending, attribute in _keys(kind):
            value = getattr(thing, attribute.name)
            if value is not None and value is not False and not (isinstance(value, tuple) and not value):
                found[key.removesuffix("_")] = self._to_file(value, ending)  # of "in_", which Python has a word for
        return found

    def _to_file(self, value: Any, ending: str) -> Any:
        if isinstance(value, np.ndarray):
            value = value.tolist()
        if isinstance(value, (list, tuple)):
            return [self._to_file(item, ending) for item in value]
        if isinstance(value, (str, bool)):
            return value
        if not isinstance(value, (int, float)):
            return self.of(value)
        if ending in ("_m", "_nm"):
            return self.length(value)
        if ending == "_n_per_m":
            return self.stiffness(value)
        return self.angle(value) if ending == "_rad" else plain_number(value)

    def length(self, length_m: float) -> float:
        """Return a length, or a moment."""
        numerator, denominator = self.ratio
        if numerator == denominator:
            return plain_number(float(length_m))
        return shortest(length_m * denominator / numerator, length_m, lambda shown: shown * numerator / denominator)

    def lengths(self, lengths_m: Any) -> list[float]:
        """Return a vector, (3,)."""
        return [self.length(length_m) for length_m in np.asarray(lengths_m, dtype=np.float64).tolist()]

    def stiffness(self, wanted: float) -> float:
        """Return newtons for each unit of length."""
        return shortest(wanted * self.metres, wanted, lambda shown: shown / self.metres)

    def inertia(self, wanted: float) -> float:
        """Return kilograms by unit of length squared."""
        square = self.metres**2
        return shortest(wanted / square, wanted, lambda shown: shown * square)

    def angle(self, angle_rad: float) -> float:
        """Return degrees."""
        return shortest(math.degrees(angle_rad), angle_rad, math.radians)


def plain_number(value: float) -> float:
    """Return a whole number as one."""
    return int(value) if value == int(value) and abs(value) < 1e15 else value


def shortest(value: float, wanted: float, back: Callable[[float], float]) -> float:
    """Return the number of fewest digits near ``value`` that ``back`` turns into ``wanted``."""
    for digits in range(FEWEST_DIGITS, MOST_DIGITS + 1):
        shown = float(f"{value:.{digits}g}")
        if back(shown) == wanted:
            return plain_number(shown)
    return value
