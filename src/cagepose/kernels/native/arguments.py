"""What Python hands to machine code: one slot of eight bytes for each number, and of what kinds the numbers are.

An array takes its address, its shape and its strides; a record its address; a tuple what its parts take. The kinds
say which machine code fits, as Numba's types do, but without Numba, whose import takes longer than a whole run.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import addressof, c_char
from typing import Any, NamedTuple

import numpy as np


class ArrayKind(NamedTuple):
    """Arrays of the same machine code: ``layout`` is "C", "F" or, for any other strides, "A"."""

    dtype: np.dtype[Any]
    n_axes: int
    layout: str
    is_writable: bool


class RecordKind(NamedTuple):
    """Records of one layout."""

    dtype: np.dtype[Any]


class TupleKind(NamedTuple):
    """Tuples, named or not, of one class."""

    of: type[tuple[object, ...]]
    parts: tuple[Kind, ...]


Kind = str | ArrayKind | RecordKind | TupleKind
"""Or a letter: of a float, an integer or a truth value."""

FLOAT, INTEGER, TRUTH = "d", "q", "?"


class Arguments:
    """What a call is given, taken apart.

    Attributes
    ----------
    kinds
        Of each argument.
    slots, formats
        Numbers, and their letters as `struct` has them.
    """

    def __init__(self, values: Sequence[object]) -> None:
        self.slots = list[int | float]()
        self.formats = list[str]()
        self.kinds = tuple([self._take(value) for value in values])

    def _take(self, value: object) -> Kind:
        if isinstance(value, float):
            self.slots.append(value)
            self.formats.append("d")
            return FLOAT
        if isinstance(value, np.ndarray):
            # Each look at a record array takes a microsecond.
            array = value if type(value) is np.ndarray else value.view(np.ndarray)
            flags, n_axes = array.flags, array.ndim
            self.slots += (_address(array), *array.shape, *array.strides)
            self.formats.append("q" * (1 + 2 * n_axes))
            layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
            return ArrayKind(array.dtype, n_axes, layout, flags.writeable)
        if isinstance(value, tuple):
            return TupleKind(type(value), tuple([self._take(part) for part in value]))
        number: int
        kind: Kind
        if isinstance(value, (bool, np.bool_)):
            number, kind = int(value), TRUTH
        elif isinstance(value, (int, np.integer)):
            number, kind = int(value), INTEGER
        elif isinstance(value, np.void) and value.dtype.fields:
            number, kind = _address(np.frombuffer(value, np.uint8)), RecordKind(value.dtype)
        else:
            raise TypeError(f"a kernel takes numbers, arrays, records, tuples of them, and no {type(value).__name__}")
        self.slots.append(number)
        self.formats.append("q")
        return kind


def _address(array: Any) -> int:
    if array.dtype.fields is None:
        try:
            return addressof(c_char.from_buffer(array))  # a third of the time
        except (TypeError, ValueError):  # it is read-only, in pieces or empty
            pass
    address: int = array.ctypes.data
    return address
