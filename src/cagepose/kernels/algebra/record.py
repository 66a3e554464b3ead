"""Records: memory of fixed size that kernels write to, one pointer each.

A tuple of arrays is seven numbers for each of them. With some seventy work arrays a kernel passed five hundred
numbers to every kernel it called, and compiling all that copying took longer than compiling the mechanics. A record
holds the arrays of fixed size, a row of records what there is for each contact, point or event.

Python hands a large record to a kernel as an array of one: NumPy describes a record's fields anew whenever its memory
is asked for, which took 40 us for the workspace of a proof; an array takes 0.2 us.
"""

from __future__ import annotations

import sys
from typing import Annotated, Any, Protocol, TypeVar, cast, get_args, get_origin, overload

import numpy as np
from numpy.typing import NDArray

R_co = TypeVar("R_co", covariant=True)

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_SCALARS: dict[str, type[np.generic]] = {"int": np.int64, "float": np.float64, "bool": np.bool_}
_ARRAYS: dict[str, type[np.generic]] = {"FloatArray": np.float64, "IntArray": np.int64}
_TAKEN = frozenset(dir(np.record))
_LAYOUTS: dict[type[object], np.dtype[Any]] = {}
"""Reading the annotations takes longer than many a run."""


class Rows(Protocol[R_co]):
    """An array of records, (n,): ``rows[i].field`` is one record's, and can be written to."""

    @overload
    def __getitem__(self, index: int, /) -> R_co: ...

    @overload
    def __getitem__(self, index: slice, /) -> Rows[R_co]: ...

    def __len__(self) -> int: ...


def dtype_of(record: type[object]) -> np.dtype[Any]:
    """Return the layout that a class's annotations describe.

    A field is an ``int``, ``float`` or ``bool``, another such class, or an array of fixed shape, as in
    ``Annotated[FloatArray, 6, 6]``.
    """
    if record in _LAYOUTS:
        return _LAYOUTS[record]
    fields = list[tuple[Any, ...]]()
    names = vars(sys.modules[record.__module__])
    for name in record.__annotations__.keys() & _TAKEN:
        raise TypeError(f"{record.__name__}.{name}: NumPy's records have an attribute of that name; choose another")
    for name, text in record.__annotations__.items():
        fields.append((name, *_type_and_shape(text, names)))
    _LAYOUTS[record] = np.dtype((np.record, np.dtype(fields, align=True)))
    return _LAYOUTS[record]


def _type_and_shape(text: str, names: dict[str, Any]) -> tuple[Any, ...]:
    """Return the type of a field, and of an array its shape.

    Annotations are taken apart as text: evaluating all those of one run takes 1 ms, most of it for compiling them.
    """
    if text in _SCALARS:
        return (_SCALARS[text],)
    if text.startswith("Annotated["):
        array, *shape = text.removeprefix("Annotated[").removesuffix("]").split(", ")
        return _ARRAYS[array], tuple([_length(part, names) for part in shape])
    hint = names[text]
    if get_origin(hint) is Annotated:
        array, *lengths = get_args(hint)
        return get_args(get_args(array)[1])[0], tuple(lengths)
    return (dtype_of(hint),)


def _length(text: str, names: dict[str, Any]) -> int:
    """Return what a number, a name or a sum of them, such as ``MOST_ROWS + 1``, stands for."""
    return sum([int(part) if part.isdigit() else names[part] for part in text.split(" + ")])


def empty_record(record: type[R_co]) -> R_co:
    """Return one record, all zero (plain Python)."""
    return empty_rows(record, 1)[0]


def empty_rows(record: type[R_co], n_rows: int) -> Rows[R_co]:
    """Return an array of ``n_rows`` records, all zero (plain Python)."""
    # Not a recarray: asking one for a field takes ten times as long.
    return cast(Rows[R_co], np.zeros(n_rows, dtype_of(record)))
