"""What Python hands to machine code: eight bytes for each number, the address and the shape of each array.

Arrays lie in one piece, rows first (C order). The letters of ``kinds`` say what stands in the slots, so that machine
code is never given what it was not compiled for.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np


class Slots:
    """An argument of a kernel, taken apart.

    Attributes
    ----------
    value
        The argument; it must not be freed as long as the slots are used.
    kinds
        "d" for a float, "q" for an integer, "?" for a truth value, such as "[<f8,2]" for an array of two axes,
        such as "{|V96}" for a record.
    packed
        The slots.

    Raises
    ------
    TypeError
        It holds what no kernel takes, or an array in pieces.
    """

    __slots__ = ("kinds", "packed", "value")

    def __init__(self, value: object) -> None:
        kinds, formats, numbers = list[str](), list[str](), list[int | float]()
        _take(value, kinds, formats, numbers)
        self.value = value
        self.kinds = "".join(kinds)
        self.packed = struct.pack("=" + "".join(formats), *numbers)


def _take(value: object, kinds: list[str], formats: list[str], numbers: list[int | float]) -> None:
    if isinstance(value, float):
        kinds.append("d")
        formats.append("d")
        numbers.append(value)
    elif isinstance(value, tuple):
        for part in value:
            _take(part, kinds, formats, numbers)
    elif isinstance(value, np.ndarray):
        if not value.flags.c_contiguous:
            raise TypeError("a kernel takes arrays in one piece, rows first; copy this one")
        kinds.append(f"[{value.dtype.str},{value.ndim}]")
        formats.append("q" * (1 + value.ndim))
        numbers.extend((value.ctypes.data, *value.shape))
    elif isinstance(value, np.void):
        kinds.append(f"{{{value.dtype.str}}}")
        formats.append("q")
        numbers.append(_address(value))
    elif isinstance(value, (bool, np.bool_)):
        kinds.append("?")
        formats.append("q")
        numbers.append(int(value))
    elif isinstance(value, (int, np.integer)):
        kinds.append("q")
        formats.append("q")
        numbers.append(int(value))
    else:
        raise TypeError(f"a kernel takes numbers, arrays, records, and tuples of them, and no {type(value).__name__}")


def _address(record: Any) -> int:
    address: int = np.frombuffer(record, np.uint8).ctypes.data
    return address
