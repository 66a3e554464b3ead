"""Casts with a verdict: turn what a caller passed into frozen float64 arrays, or say what is wrong with it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.vector import Vector

FloatArray = NDArray[np.float64]
"""As a field of a class: three numbers, unless it is annotated with another shape, as `finite_array` takes it."""
MOST_NUMBERS_SHOWN = 64
"""An error shows an array of so many numbers whole; of a longer one it names the first place that is wrong."""


def finite_array(value: ArrayLike, shape: tuple[int, ...], key: str) -> FloatArray:
    """Return a read-only float64 copy of ``value``; -1 in ``shape`` stands for any length of at least one.

    Raises
    ------
    SceneError
        Not numbers, another shape, NaN or infinite.
    """
    try:
        array = np.array(value, dtype=np.float64, order="C")  # as kernels take arrays
    except (TypeError, ValueError):
        message = f"is not made of numbers: {_cut(value)}; give {_numbers(shape)}"
        raise SceneError([Problem((key,), message)]) from None
    fits = array.ndim == len(shape) and all(
        found == wanted or (wanted == -1 and found >= 1) for found, wanted in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise SceneError([Problem((key,), f"has shape {array.shape}; give {_numbers(shape)}")])
    if not np.isfinite(array).all():
        if array.size <= MOST_NUMBERS_SHOWN:
            raise SceneError([Problem((key,), f"holds a number that is not finite: {array.tolist()}")])
        at = [int(index) for index in np.argwhere(~np.isfinite(array))[0]]
        raise SceneError([Problem((key, *at), f"is {array[tuple(at)]}; give a finite number")])
    array.setflags(write=False)
    return array


def _numbers(shape: tuple[int, ...]) -> str:
    return f"{' x '.join('n' if n == -1 else str(n) for n in shape)} numbers"


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a number, finite or not: no truth value."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_finite(value: object) -> bool:
    """Return whether a value is one finite number: no text, no list, no truth value."""
    return not isinstance(value, bool) and isinstance(value, Real) and math.isfinite(value)


def unit_vector(value: ArrayLike, key: str) -> FloatArray:
    """Return ``value`` scaled to length one.

    Raises
    ------
    SceneError
        As `finite_array`; also for a vector of length zero, which has no direction.
    """
    vector = finite_array(value, (3,), key)
    if not vector.any():
        raise SceneError([Problem((key,), "is zero, so it has no direction; give a vector of any other length")])
    unit: FloatArray = unit_rows(vector[None])[0]
    unit.setflags(write=False)
    return unit


def unit_rows(vectors: FloatArray) -> FloatArray:
    """Return each vector of (n, 3), none of which is zero, scaled to length one: number by number, so that a row among
    others has the same bits as alone.

    A vector that is unit to rounding is kept to the last digit, so that saved scenes come back unchanged.
    """
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = vectors / largest  # so that the squares of tiny or huge components neither vanish nor overflow
    x, y, z = scaled.T
    lengths = np.sqrt(x * x + y * y + z * z)[:, None]
    is_unit = np.abs(largest * lengths - 1.0) < 1e-15
    unit: FloatArray = np.where(is_unit, vectors, scaled / lengths)
    return unit


def as_vector(array: FloatArray) -> Vector:
    """Return a (3,) array as the tuple of Python floats that kernels take."""
    x, y, z = array.tolist()
    return x, y, z


def duplicates(names: Sequence[str]) -> dict[str, list[int]]:
    """Return each name that occurs more than once, with the indices where it stands."""
    places: dict[str, list[int]] = {}
    for index, name in enumerate(names):
        places.setdefault(name, []).append(index)
    return {name: indices for name, indices in places.items() if len(indices) > 1}


class ProblemList:
    """Collects the problems of several parts, so that a user sees all of them at once."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []

    def add(self, path: tuple[str | int, ...], message: str) -> None:
        self.problems.append(Problem(path, message))

    def raise_if_any(self) -> None:
        if self.problems:
            raise SceneError(self.problems)


FROM_THREE_NUMBERS = {
    "Box": "cagepose.Box({})",
    "Drive": "cagepose.Drive(travel={})",
    "Force": "cagepose.Force({}, at_m=(0, 0, 0))",
    "Load": "cagepose.Load('weight', gravity={})",
    "Moment": "cagepose.Moment({}, magnitude_nm=1.0)",
    "Pose": "cagepose.Pose({})",
}
"""What people mean who give three numbers in the place of an object."""
FROM_TEXT = {
    "Pose": "name={} gives a name",
    "Run": "cagepose.load_run({}) reads one that was saved",
    "Scene": "cagepose.load_scene({}) reads one",
}
"""What they mean who give text."""
FROM_OBJECTS = {
    ("Run", "Scene"): "cagepose.run(scene) makes one",
    ("Scene", "Run"): "run.scene is that of a run",
    ("Certificate", "Run"): "cagepose.certificate(run) makes one",
}
SHOWN_LENGTH = 40
"""Characters of a wrong value in a message."""


def check_kind(value: object, kind: type, path: tuple[str | int, ...], problems: ProblemList) -> None:
    """Note a problem where a value is of another class than ``kind``, and what may have been meant."""
    if isinstance(value, kind):
        return
    name, meant = kind.__name__, None
    if isinstance(value, str):
        meant = FROM_TEXT.get(name)
    elif isinstance(value, Sequence | np.ndarray):
        meant = FROM_THREE_NUMBERS.get(name) if len(value) == 3 and all(map(is_finite, value)) else None
        value = tuple(value.tolist()) if isinstance(value, np.ndarray) else value
    else:
        meant = FROM_OBJECTS.get((name, type(value).__name__))
    hint = "" if meant is None else f": {meant.format(_cut(value))}"
    problems.add(path, f"is {_found(value)}; give a cagepose.{name}{hint}")


def expect(value: object, kind: type, key: str) -> None:
    """Refuse a value of another class than ``kind``.

    Raises
    ------
    SceneError
        It is one.
    """
    problems = ProblemList()
    check_kind(value, kind, (key,), problems)
    problems.raise_if_any()


def expect_choice(value: object, known: Sequence[str], key: str) -> None:
    """Refuse a value that is none of some words.

    Raises
    ------
    SceneError
        It is none.
    """
    problems = ProblemList()
    check_choice(value, known, key, problems)
    problems.raise_if_any()


def expect_count(value: object, key: str) -> None:
    """Refuse what is no whole number from 1 upwards.

    Raises
    ------
    SceneError
        It is none.
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
        raise SceneError([Problem((key,), f"is {value!r}; give a whole number from 1 upwards")])


def number_found(value: object) -> str:
    """Name a wrong number: NumPy's as Python's; what is no number, as it is."""
    return repr(float(value)) if isinstance(value, float) else repr(value)


def degrees_of(angle_rad: object) -> str:
    """Name an angle that is wrong in degrees, as users of files know it; what is no number, as it is."""
    return f"{math.degrees(angle_rad):g} deg" if isinstance(angle_rad, float | int) else repr(angle_rad)


def check_choice(value: object, known: Sequence[str], key: str, problems: ProblemList) -> None:
    """Note a problem where a value is none of some words."""
    if not (isinstance(value, str) and value in known):
        problems.add((key,), f"is {_found(value)}; use one of: {', '.join(known)}")


def check_mapping(value: object, path: tuple[str | int, ...], problems: ProblemList) -> None:
    """Note a problem where a value is no mapping."""
    if not isinstance(value, Mapping):
        problems.add(path, f"is {_found(value)}; give a dict of names and numbers")


def check_text(value: object, path: tuple[str | int, ...], problems: ProblemList) -> None:
    """Note a problem where a value is no text."""
    if not isinstance(value, str):
        problems.add(path, f"is {_found(value)}; give text, such as 'weight'")


def _found(value: object) -> str:
    """Name a wrong value: itself if it is short, else its type."""
    is_plain = value is None or isinstance(value, str | tuple | list | bool | int | float)
    return repr(value) if is_plain and len(repr(value)) <= SHOWN_LENGTH else f"of type {type(value).__name__}"


def _cut(value: object) -> str:
    text = repr(value)
    return text if len(text) <= SHOWN_LENGTH else f"{text[: SHOWN_LENGTH - 3]}..."


def check_kinds(values: object, kind: type, key: str, problems: ProblemList) -> tuple[Any, ...]:
    """Return what is in a list; note a problem where that is no list, or holds another class than ``kind``."""
    if isinstance(values, kind | str) or not isinstance(values, Iterable):
        problems.add((key,), f"is {_found(values)}; give a list of cagepose.{kind.__name__}")
        return ()
    found = tuple(values)
    for index, value in enumerate(found):
        check_kind(value, kind, (key, index), problems)
    return found
