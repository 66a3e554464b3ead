"""What Python hands to machine code: one slot of eight bytes for each number, and of what kinds the numbers are.

An array takes its address, its shape and its strides; a record its address; a tuple what its parts take. The kinds
say which machine code fits, as Numba's types do, but without Numba, whose import takes longer than a whole run.
"""

from __future__ import annotations

from collections.abc import Sequence
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
        Numbers, and the letter of each one as `struct` has it.
    """

    def __init__(self, values: Sequence[object]) -> None:
        self.slots = list[int | float]()
        self.formats = list[str]()
        self.kinds = tuple(self._take(value) for value in values)

    def _take(self, value: object) -> Kind:
        if isinstance(value, np.ndarray):
            flags = value.flags
            layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
            self._put("q" * (1 + 2 * value.ndim), value.ctypes.data, *value.shape, *value.strides)
            return ArrayKind(value.dtype, value.ndim, layout, flags.writeable)
        if isinstance(value, tuple):
            return TupleKind(type(value), tuple(self._take(part) for part in value))
        if isinstance(value, float):
            self._put("d", value)
            return FLOAT
        if isinstance(value, (bool, np.bool_)):
            self._put("q", int(value))
            return TRUTH
        if isinstance(value, (int, np.integer)):
            self._put("q", int(value))
            return INTEGER
        if isinstance(value, np.void) and value.dtype.fields:
            self._put("q", np.frombuffer(value, np.uint8).ctypes.data)
            return RecordKind(value.dtype)
        raise TypeError(f"a kernel takes numbers, arrays, records and tuples of them, and no {type(value).__name__}")

    def _put(self, formats: str, *numbers: int | float) -> None:
        self.formats.extend(formats)
        self.slots.extend(numbers)
