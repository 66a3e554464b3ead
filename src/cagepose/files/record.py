"""Runs and scenes as plain data without loss: SI units, every float to its last digit.

One rule serves all classes: what the constructor takes is saved, see `attributes_of`. A field that is added to a class
is so saved and read as well; one with a default may be missing from a file, which then is older than the field.

Reading is strict, and a damaged file is refused by the place of the damage: each class becomes a pydantic model.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache, partial, reduce
from operator import or_
from types import UnionType
from typing import Annotated, Any, NamedTuple, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, TypeAdapter, WrapValidator, create_model

from cagepose.files.attributes import attributes_of, without_frame
from cagepose.model.cage import Cage
from cagepose.model.parts import Object
from cagepose.model.tolerances import Tolerances
from cagepose.runs.proof import FreeMotion
from cagepose.runs.run import Motion

Kind = TypeVar("Kind")

PARTS_OF_A_SCENE = (Object, Cage, Tolerances)
"""Their fields stand among those of the scene."""
KEYS = {
    "through_world": "through_m",
    "place_world": "place_m",
    "places_world": "places_m",
    "at_world_m": "at_world_m",
    "names": "point_names",
    "points_cage": "points_m",
    "points_body": "points_m",
    "pose_world_cage": "cage_pose",
    "Cage.shapes": "cage_shapes",
    "Cage.holes": "cage_holes",
    "bodies": "cage_bodies",
}
"""The attributes (some of one class alone) whose key is another than their name without its frame."""
STANDING = {"points_cage": "points_m", "names": "names", "shapes": "shapes", "holes": "holes"}
"""What a cage has together with its bodies, and in `Cage.standing` without them, as its constructor takes it."""
INFINITE: dict[str, str | None] = {"distance_m": None}
"""What stands for an infinite number, which JSON has not, in some attributes; in all others, `NO_NUMBER`."""
NO_NUMBER = "none"


def record_of(thing: object) -> dict[str, Any]:
    """Return a run, a scene or a part of either as plain data: only dict, list, str, int, finite float, bool, None."""
    record: dict[str, Any] = {}
    kind: type = type(thing)
    for field in _fields(kind):
        value = _value_of(thing, field.attribute)
        if field.kind in PARTS_OF_A_SCENE:
            record |= record_of(value)
        elif _choices(field.kind):
            record[field.key] = [{item.kind: record_of(item)} for item in value]
        else:
            record[field.key] = _plain(value, field.attribute)
    return record


def _value_of(thing: object, attribute: str) -> Any:
    if isinstance(thing, Cage) and attribute in STANDING:
        return getattr(thing.standing, STANDING[attribute])
    return getattr(thing, attribute)


def from_record(kind: type[Kind], record: object) -> Kind:
    """Return the object that `record_of` was given.

    Raises
    ------
    pydantic.ValidationError
        Not such a record; or one of a scene that cannot be right, with the `SceneError` in its context.
    """
    plain_kind: type = kind  # mypy thinks that a type[Kind] cannot be hashed
    found: Kind = _reader(plain_kind).validate_python(record)
    return found


@cache
def _reader(kind: type) -> TypeAdapter[Any]:
    return TypeAdapter(_readable_class(kind))


class _Field(NamedTuple):
    """What is saved of an object: where it stands in the record and in the object, and what it is."""

    key: str
    argument: str
    attribute: str
    kind: Any
    is_required: bool


@cache
def _fields(kind: type) -> list[_Field]:
    return [
        _Field(
            key=KEYS.get(f"{kind.__name__}.{one.name}") or KEYS.get(one.name, without_frame(one.name)),
            argument=one.argument,
            attribute=one.name,
            kind=one.kind,
            is_required=one.is_required,
        )
        for one in attributes_of(kind)
    ]


def _choices(kind: object) -> tuple[Any, ...]:
    """Return the shapes of which a list holds any, each under its ``kind``; none: it is no such list."""
    item = get_args(kind)[0] if get_origin(kind) is tuple else None
    parts = get_args(item) if get_origin(item) in (Union, UnionType) else ()
    return parts if all(_is_ours(part) for part in parts) else ()


def _is_ours(kind: object) -> bool:
    return isinstance(kind, type) and kind.__module__.startswith("cagepose.")


def _plain(value: Any, attribute: str) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [_plain(item, attribute) for item in value]
    if isinstance(value, Mapping):
        return {key: _plain(item, attribute) for key, item in value.items()}
    if isinstance(value, float) and math.isinf(value):
        return INFINITE.get(attribute, NO_NUMBER)
    return record_of(value) if _is_ours(type(value)) else value


class _Record(BaseModel):
    """Nothing missing, nothing more, no text for a number, no number that is not finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True, defer_build=True)


@cache
def _readable_class(kind: type) -> Any:
    model = create_model(kind.__name__, __base__=_Record, **_columns(kind))
    return Annotated[model, AfterValidator(partial(_built, kind))]


def _columns(kind: type) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    for field in _fields(kind):
        if field.kind in PARTS_OF_A_SCENE:
            columns |= _columns(field.kind)
        else:
            columns[field.key] = (_readable(field.kind, field.attribute), ... if field.is_required else None)
    return columns


def _built(kind: type, record: _Record) -> Any:
    """Construct what a record describes; what the file leaves out is left to the constructor."""
    arguments = {}
    for field in _fields(kind):
        if field.kind in PARTS_OF_A_SCENE:
            arguments[field.argument] = _built(field.kind, record)
        elif field.key in record.model_fields_set:
            arguments[field.argument] = getattr(record, field.key)
    made = kind(**arguments)
    if isinstance(made, Motion | FreeMotion):
        _check_line(made)
    return made


def _check_line(motion: Motion | FreeMotion) -> None:
    line = (motion.direction_world,) if motion.kind == "travel" else (motion.axis_world, motion.through_world)
    if any(part is None for part in line):
        raise ValueError(f"a {motion.kind} without its line")


def _readable(kind: Any, attribute: str) -> Any:
    """Return the type that pydantic reads a kind of value by."""
    if choices := _choices(kind):
        columns: dict[str, Any] = {shape.kind: (_readable_class(shape), None) for shape in choices}
        choice = create_model("Shape", __base__=_Record, **columns)
        return list.__class_getitem__(Annotated[choice, AfterValidator(_the_one)])
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return _array(parts[1], int if get_args(parts[0])[1] == np.dtype[np.int64] else float)
    if origin is np.ndarray:
        return _array((3,))
    if origin is tuple:
        items = tuple.__class_getitem__(tuple(_readable(part, attribute) for part in parts))
        return Annotated[items, Strict(False)]  # else pydantic makes no tuple of a list
    if origin is dict:
        return dict.__class_getitem__((parts[0], _readable(parts[1], attribute)))
    if origin in (Union, UnionType):
        return reduce(or_, (_readable(part, attribute) for part in parts))
    if kind is float:
        return Annotated[float, WrapValidator(partial(_number, INFINITE.get(attribute, NO_NUMBER)))]
    return _readable_class(kind) if _is_ours(kind) else kind


def _the_one(choice: _Record) -> Any:
    if len(choice.model_fields_set) != 1:
        raise ValueError(f"holds {len(choice.model_fields_set)} of its kinds; one is right")
    return getattr(choice, next(iter(choice.model_fields_set)))


def _array(shape: tuple[int, ...], number: type = float) -> Any:
    """Return the type of nested lists of numbers that become an array; -1 in ``shape`` stands for any length."""
    rows: Any = number
    for length in reversed(shape):
        rows = list[rows] if length < 0 else Annotated[list[rows], Field(min_length=length, max_length=length)]
    return Annotated[rows, AfterValidator(partial(_filled, shape, number))]


def _filled(shape: tuple[int, ...], number: type, rows: list[Any]) -> np.ndarray:
    """Return nested lists as an array; where they are empty, the lengths within them are those of ``shape``."""
    found: np.ndarray = np.array(rows, dtype=number)
    return found.reshape(found.shape + tuple(max(length, 0) for length in shape[found.ndim :]))


def _number(infinite: str | None, value: object, read: Callable[[object], float]) -> float:
    return math.inf if value == infinite else read(value)
