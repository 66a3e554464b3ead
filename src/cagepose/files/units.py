"""Lengths and angles of files, and those inside: metres and radians."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray

LengthUnit = Literal["mm", "m", "in"]
LENGTH_UNITS: tuple[LengthUnit, ...] = get_args(LengthUnit)

# Each unit as a ratio of whole numbers: 29.52 mm becomes 29.52 / 1000, the double nearest to 0.02952 (29.52 * 0.001 may
# miss it).
_METRES: dict[LengthUnit, tuple[float, float]] = {"mm": (1.0, 1000.0), "m": (1.0, 1.0), "in": (127.0, 5000.0)}


def to_metres(lengths: ArrayLike, unit: LengthUnit) -> FloatArray:
    """Turn lengths of a file into metres.

    >>> to_metres([29.52, 4.0], "mm").tolist()
    [0.02952, 0.004]
    """
    numerator, denominator = _METRES[unit]
    array: FloatArray = np.asarray(lengths, dtype=np.float64) * numerator / denominator
    return array


def from_metres(lengths_m: ArrayLike, unit: LengthUnit) -> FloatArray:
    """Turn metres into lengths of a file.

    >>> float(from_metres(0.0254, "in"))
    1.0
    """
    numerator, denominator = _METRES[unit]
    array: FloatArray = np.asarray(lengths_m, dtype=np.float64) * denominator / numerator
    return array
